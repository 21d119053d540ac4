#pragma once
#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <string>

#include "io/e57/e57_model.hpp"

namespace hybrid::io {

// Where in a file's XML section an error lies.
struct XmlPlace {
  std::string file;
  std::string_view text;  // the whole section
  // "<file>: XML line <n>, <element>"
  std::string of(const pugi::xml_node& node) const;
};

// The element's text; that of all its text and CDATA parts.
std::string text_of(const pugi::xml_node& node);

// Numbers of an element or an attribute; without any text they are 0 (elements only: E57 writes zeros so).
// Throws ErrorKind::input for what is no number, or not of this range.
double real_of(const XmlPlace& place, const pugi::xml_node& node);
std::int64_t integer_of(const XmlPlace& place, const pugi::xml_node& node);
std::uint64_t unsigned_of(const XmlPlace& place, const pugi::xml_node& node, const char* attribute);

// An Integer, ScaledInteger or Float element's value.
double value_of(const XmlPlace& place, const pugi::xml_node& node);

// Minimum and maximum named so below `node`, where both are.
std::optional<E57Limits> limits_of(const XmlPlace& place, const pugi::xml_node& node, const char* minimum,
                                   const char* maximum);

// What a prototype's element declares.
E57Field field_of(const XmlPlace& place, const pugi::xml_node& node, std::string name);

}  // namespace hybrid::io
