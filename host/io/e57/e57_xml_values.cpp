#include "io/e57/e57_xml_values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.hpp"

namespace hybrid::io {
namespace {

constexpr std::size_t kLongestShown = 60;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const auto first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  text = text.substr(first, text.find_last_not_of(kBlank) - first + 1);
  if (text.size() > 1 && text[0] == '+') text.remove_prefix(1);  // std::from_chars takes none
  return text;
}

template <typename T>
T number(const XmlPlace& place, const pugi::xml_node& node, const char* what, std::string_view written) {
  const std::string_view text = trimmed(written);
  T value{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code == std::errc{} && end == text.data() + text.size()) return value;
  if constexpr (std::is_integral_v<T>) {  // "255.0", from writers that know one kind of number
    const double real = number<double>(place, node, what, written);
    if (real == std::floor(real) && std::abs(real) < 9e15 && (real >= 0 || std::is_signed_v<T>))
      return static_cast<T>(real);
  }
  fail_input("{}: expected {}, found \"{}\"; export the file again", place.of(node), what,
             text.substr(0, kLongestShown));
}

bool is_type(const pugi::xml_node& node, const char* type) {
  return std::string_view(node.attribute("type").value()) == type;
}

double attribute_or(const XmlPlace& place, const pugi::xml_node& node, const char* name, double fallback) {
  const pugi::xml_attribute attribute = node.attribute(name);
  return attribute ? number<double>(place, node, name, attribute.value()) : fallback;
}

}  // namespace

std::string XmlPlace::of(const pugi::xml_node& node) const {
  const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0));
  const auto line = std::count(
      text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size())), '\n');
  return fmt::format("{}: XML section, line {}, <{}>", file, line + 1,
                     std::string_view(node.name()).substr(0, kLongestShown));
}

std::string text_of(const pugi::xml_node& node) {
  std::string text;
  for (const pugi::xml_node& part : node.children())
    if (part.type() == pugi::node_pcdata || part.type() == pugi::node_cdata) text += part.value();
  return text;
}

double real_of(const XmlPlace& place, const pugi::xml_node& node) {
  const std::string text = text_of(node);
  return trimmed(text).empty() ? 0 : number<double>(place, node, "a number", text);
}

std::int64_t integer_of(const XmlPlace& place, const pugi::xml_node& node) {
  const std::string text = text_of(node);
  return trimmed(text).empty() ? 0 : number<std::int64_t>(place, node, "a whole number", text);
}

std::uint64_t unsigned_of(const XmlPlace& place, const pugi::xml_node& node, const char* attribute) {
  return number<std::uint64_t>(place, node, fmt::format("{} as a whole number from 0", attribute).c_str(),
                               node.attribute(attribute).value());
}

double value_of(const XmlPlace& place, const pugi::xml_node& node) {
  if (!is_type(node, "ScaledInteger")) return real_of(place, node);
  return static_cast<double>(integer_of(place, node)) * attribute_or(place, node, "scale", 1) +
         attribute_or(place, node, "offset", 0);
}

std::optional<E57Limits> limits_of(const XmlPlace& place, const pugi::xml_node& node, const char* minimum,
                                   const char* maximum) {
  const pugi::xml_node low = node.child(minimum), high = node.child(maximum);
  if (!low || !high) return {};
  return E57Limits{value_of(place, low), value_of(place, high)};
}

E57Field field_of(const XmlPlace& place, const pugi::xml_node& node, std::string name) {
  E57Field field{.name = std::move(name)};
  if (is_type(node, "Float")) {
    const std::string_view precision = node.attribute("precision").value();
    if (!precision.empty() && precision != "single" && precision != "double")
      fail_input("{}: expected precision single or double, found \"{}\"; export the file again",
                 place.of(node), precision.substr(0, kLongestShown));
    field.type = precision == "single" ? E57Type::single_real : E57Type::double_real;
    if (node.attribute("minimum")) field.lowest = attribute_or(place, node, "minimum", 0);
    if (node.attribute("maximum")) field.highest = attribute_or(place, node, "maximum", 0);
    return field;
  }
  if (is_type(node, "String")) {
    field.type = E57Type::text;
    return field;
  }
  field.type = is_type(node, "ScaledInteger") ? E57Type::scaled_integer : E57Type::integer;
  if (field.type == E57Type::integer && !is_type(node, "Integer"))
    fail_input(
        "{}: expected the type Integer, ScaledInteger, Float or String, found \"{}\"; export the file again",
        place.of(node), std::string_view(node.attribute("type").value()).substr(0, kLongestShown));
  if (const auto low = node.attribute("minimum"))
    field.minimum = number<std::int64_t>(place, node, "minimum as a whole number", low.value());
  if (const auto high = node.attribute("maximum"))
    field.maximum = number<std::int64_t>(place, node, "maximum as a whole number", high.value());
  if (field.minimum > field.maximum)
    fail_input("{}: expected a minimum of at most the maximum {}, found {}; export the file again",
               place.of(node), field.maximum, field.minimum);
  if (field.type == E57Type::scaled_integer) {
    field.scale = attribute_or(place, node, "scale", 1);
    field.offset = attribute_or(place, node, "offset", 0);
    if (!std::isfinite(field.scale) || field.scale == 0 || !std::isfinite(field.offset))
      fail_input(
          "{}: expected a finite scale that is not 0 and a finite offset, found {} and {}; export the file "
          "again",
          place.of(node), field.scale, field.offset);
  }
  return field;
}

}  // namespace hybrid::io
