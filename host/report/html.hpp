#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace hybrid::report {

using Json = nlohmann::ordered_json;

// Text and attribute values: every character that HTML gives a meaning.
std::string escape(std::string_view text);

// A relative path as a link: scan ids and view names may hold blanks, #, % and ?.
std::string link(const std::string& path);

// A JSON document that stands inside a <script> element: no "<" is left, so that it cannot end there; bytes
// that are no UTF-8 become the replacement character.
std::string script_json(const Json& document);

// A whole page: our style and script inside, a policy that forbids every request outside of the folder. The
// body is HTML. `times` = "timing.js" loads that file beside the page, the only one whose bytes differ from
// run to run; empty: none.
std::string page(const std::string& title, const std::string& body, const std::string& times);

// A picture with its caption. `preview` is what the page shows, `full` what a click opens.
std::string figure(const std::string& preview, const std::string& full, const std::string& caption);

// A table that a reader can sort and filter. One call of column() per column, then rows.
class Table {
 public:
  // Of numbers with so many decimals; `help` explains the heading.
  Table& number(const std::string& name, const std::string& unit, int digits, const std::string& help = "");
  Table& text(const std::string& name, const std::string& help = "");

  // A row is a JSON array of cells: null, a number, a text, or {"text", "href", "state": "bad" | "good"};
  // {"value": number, ...} for a number with a state or a link.
  void add(Json row) { rows_.push_back(std::move(row)); }
  bool empty() const { return rows_.empty(); }
  // Sorted by a column at first (else as added).
  Table& sorted_by(const std::string& name, bool descending);
  std::string html() const;

 private:
  Json columns_ = Json::array(), rows_ = Json::array(), sort_;
};

// A number of a summary, times `factor`; null when it is not there.
Json cell(const Json& document, const char* pointer, double factor = 1);

}  // namespace hybrid::report
