#include "report/html.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cstring>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "report/page_parts.hpp"

namespace hybrid::report {

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string link(const std::string& path) {
  std::string out;
  for (const char c : path) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || (c != 0 && std::strchr("/._-~", c));
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string script_json(const Json& document) {
  std::string out;
  for (const char c : json_text(document, -1)) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return out;
}

std::string page(const std::string& title, const std::string& body, const std::string& times) {
  const std::string load = times.empty() ? "" : fmt::format("<script src=\"{}\"></script>\n", link(times));
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src 'self' file: "
      "data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline' 'self' file:\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{0}</title>\n<style>\n{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n{2}</main>\n"
      "<script>\n{3}</script>\n{4}</body>\n</html>\n",
      escape(title), kPageStyle, body, kPageScript, load);
}

std::string figure(const std::string& preview, const std::string& full, const std::string& caption) {
  return fmt::format(
      "<figure><a href=\"{}\"><img src=\"{}\" alt=\"\" loading=\"lazy\"></a><figcaption>{}</figcaption>"
      "</figure>\n",
      link(full), link(preview), escape(caption));
}

Table& Table::number(const std::string& name, const std::string& unit, int digits, const std::string& help) {
  columns_.push_back({{"name", name}, {"unit", unit}, {"digits", digits}, {"help", help}});
  return *this;
}

Table& Table::text(const std::string& name, const std::string& help) {
  columns_.push_back({{"name", name}, {"help", help}});
  return *this;
}

Table& Table::sorted_by(const std::string& name, bool descending) {
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (columns_[i]["name"] == name) {
      sort_ = {i, descending};
      return *this;
    }
  fail(ErrorKind::failed, "report: a table has no column '{}' to be sorted by", name);
}

std::string Table::html() const {
  Json data = {{"columns", columns_}, {"rows", rows_}};
  if (!sort_.is_null()) data["sort"] = sort_;
  return "<div class=\"table\"><script type=\"application/json\">" + script_json(data) +
         "</script><noscript>This table needs JavaScript; its figures are in the JSON files "
         "beside.</noscript>"
         "</div>\n";
}

Json cell(const Json& document, const char* pointer, double factor) {
  const Json::json_pointer place(pointer);
  if (!document.contains(place) || !document.at(place).is_number()) return nullptr;
  const Json& value = document.at(place);
  if (value.is_number_integer() && factor == 1) return value;
  return factor * value.get<double>();
}

}  // namespace hybrid::report
