#include "io/e57/e57_outline.hpp"

#include <algorithm>
#include <charconv>

#include "core/error.hpp"

namespace hybrid::io {
namespace {

struct Attribute {
  std::string_view name;
  TextRange value;
};

struct Open {
  std::string_view name, type;
  std::size_t begin = 0;
  std::optional<std::size_t> part;
};

// Walks the tags of well-formed XML, which keeps the place of each, as a parsed tree does not.
class Walk {
 public:
  Walk(const std::string& file, std::string_view xml) : file_(file), xml_(xml) {}

  E57Outline run() {
    while ((at_ = xml_.find('<', at_)) != xml_.npos) {
      if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<?", "?>") || skip("<!", ">")) continue;
      if (xml_.substr(at_).starts_with("</"))
        close_tag();
      else
        open_tag();
    }
    if (!open_.empty()) complain("the end of every element");
    return std::move(outline_);
  }

 private:
  [[noreturn]] void complain(const char* expected) const {
    const auto seen = xml_.substr(0, std::min(at_, xml_.size()));
    fail_input("{}: XML section, line {}: expected {}, found none; export the file again", file_,
               1 + std::count(seen.begin(), seen.end(), '\n'), expected);
  }

  bool skip(std::string_view begin, std::string_view end) {
    if (!xml_.substr(at_).starts_with(begin)) return false;
    const std::size_t found = xml_.find(end, at_ + begin.size());
    if (found == xml_.npos) complain("the end of a comment or section");
    at_ = found + end.size();
    return true;
  }

  void skip_blanks() { at_ = std::min(xml_.find_first_not_of(" \t\r\n", at_), xml_.size()); }

  std::string_view name() {
    const std::size_t begin = at_;
    at_ = std::min(xml_.find_first_of(" \t\r\n/>=", at_), xml_.size());
    return xml_.substr(begin, at_ - begin);
  }

  Attribute attribute() {
    Attribute found{.name = name(), .value = {}};
    skip_blanks();
    if (at_ >= xml_.size() || xml_[at_] != '=') complain("the value of an attribute");
    ++at_;
    skip_blanks();
    const std::size_t end = at_ < xml_.size() && (xml_[at_] == '"' || xml_[at_] == '\'')
                                ? xml_.find(xml_[at_], at_ + 1)
                                : xml_.npos;
    if (end == xml_.npos) complain("the value of an attribute in quotes");
    found.value = {at_ + 1, end};
    at_ = end + 1;
    return found;
  }

  std::string_view text(TextRange range) const { return xml_.substr(range.begin, range.end - range.begin); }

  void open_tag() {
    Open element{.name = {}, .type = {}, .begin = at_, .part = {}};
    ++at_;
    element.name = name();
    std::vector<Attribute> attributes;
    for (skip_blanks(); at_ < xml_.size() && xml_[at_] != '>' && xml_[at_] != '/'; skip_blanks()) {
      const Attribute one = attribute();
      // Of one that is there twice the first counts, as in parse_e57_xml().
      if (std::ranges::find(attributes, one.name, &Attribute::name) != attributes.end()) continue;
      attributes.push_back(one);
      if (one.name == "type") element.type = text(one.value);
    }
    const bool empty = at_ < xml_.size() && xml_[at_] == '/';
    at_ += empty;
    if (at_ >= xml_.size() || xml_[at_] != '>') complain("the end of a tag");
    ++at_;
    // A prototype is an example of its records: blobs in it have no bytes.
    if ((element.type == "Blob" || element.type == "CompressedVector") && !within("prototype"))
      element.part = add_part(element, attributes);
    open_.push_back(element);
    if (empty) end_element();
  }

  void close_tag() {
    const std::size_t end = xml_.find('>', at_);
    if (end == xml_.npos || open_.empty()) complain("a tag for every end of an element");
    at_ = end + 1;
    end_element();
  }

  bool within(std::string_view name) const {
    return std::ranges::any_of(open_, [&](const Open& element) { return element.name == name; });
  }
  std::size_t add_part(const Open& element, const std::vector<Attribute>& attributes) {
    E57Part part{.name = std::string(element.name), .blob = element.type == "Blob"};
    for (const Attribute& attribute : attributes) {
      const std::string_view value = text(attribute.value);
      std::uint64_t number = 0;
      std::from_chars(value.data(), value.data() + value.size(), number);
      if (attribute.name == "length") part.length = number;
      if (attribute.name == "recordCount") part.count_text = attribute.value;
      if (attribute.name != "fileOffset") continue;
      part.offset = number;
      part.offset_text = attribute.value;
    }
    if (part.offset_text.begin == 0) complain("a fileOffset");
    if (open_.size() >= 3 && open_[1].name == "data3D") part.scan = outline_.scans.size();
    part.points = part.scan && open_.size() == 3 && element.name == "points";
    outline_.parts.push_back(std::move(part));
    return outline_.parts.size() - 1;
  }

  void end_element() {
    const Open element = open_.back();
    open_.pop_back();
    const TextRange range{element.begin, at_};
    if (element.part) outline_.parts[*element.part].element = range;
    const auto table = std::ranges::find_if(open_, [](const Open& outer) { return outer.part.has_value(); });
    if (element.type == "String" && within("prototype") && table != open_.end())
      outline_.texts.push_back({std::string(element.name), range, *table->part});
    if (open_.size() == 3 && open_[1].name == "data3D" && element.name == "pointGroupingSchemes")
      outline_.groupings.push_back({range, outline_.scans.size()});
    if (open_.size() != 2) return;
    if (open_[1].name == "data3D") outline_.scans.push_back(range);
    if (open_[1].name == "images2D") outline_.images.push_back(range);
  }

  const std::string& file_;
  std::string_view xml_;
  std::size_t at_ = 0;
  std::vector<Open> open_;
  E57Outline outline_;
};

}  // namespace

E57Outline outline_e57_xml(const std::string& file, std::string_view xml) {
  return Walk(file, xml).run();
}

std::string edited(std::string_view text, std::vector<TextEdit> edits) {
  std::ranges::stable_sort(edits, [](const TextEdit& a, const TextEdit& b) {
    return a.range.begin != b.range.begin ? a.range.begin < b.range.begin : a.range.end > b.range.end;
  });
  std::string result;
  std::size_t at = 0;
  for (const TextEdit& edit : edits) {
    if (edit.range.begin < at) continue;
    result += text.substr(at, edit.range.begin - at);
    result += edit.by;
    at = edit.range.end;
  }
  result += text.substr(at);
  return result;
}

}  // namespace hybrid::io
