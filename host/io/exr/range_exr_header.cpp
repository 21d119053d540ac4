#include "io/exr/range_exr_header.hpp"

#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>

#include <cmath>

#include "core/error.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

using namespace range_attribute;

std::vector<double> numbers_of_text(const std::string& file, const char* name, std::string text) {
  for (char& c : text)
    if (c == ',' || c == '[' || c == ']' || c == '\n' || c == '\r') c = ' ';
  std::vector<double> values;
  for (const std::string_view word : words(text)) {
    double value = 0;
    if (!parse_real(word, value))
      fail_input("{}: header: {}: expected a number, found {}; write numbers separated by blanks", file, name,
                 in_quotes(word));
    values.push_back(value);
  }
  return values;
}

// Nothing without the attribute.
std::optional<std::vector<double>> numbers(const std::string& file, const Imf::Header& header,
                                           const char* name) {
  const auto found = header.find(name);
  if (found == header.end()) return std::nullopt;
  const Imf::Attribute& attribute = found.attribute();
  if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute))
    return numbers_of_text(file, name, text->value());
  if (const auto* list = dynamic_cast<const Imf::FloatVectorAttribute*>(&attribute))
    return std::vector<double>(list->value().begin(), list->value().end());
  if (const auto* real = dynamic_cast<const Imf::DoubleAttribute*>(&attribute))
    return std::vector<double>{real->value()};
  if (const auto* real = dynamic_cast<const Imf::FloatAttribute*>(&attribute))
    return std::vector<double>{static_cast<double>(real->value())};
  if (const auto* whole = dynamic_cast<const Imf::IntAttribute*>(&attribute))
    return std::vector<double>{static_cast<double>(whole->value())};
  fail_input(
      "{}: header: {}: expected text, floatvector, float, double or int, found type {}; write it as text",
      file, name, in_quotes(attribute.typeName()));
}

std::optional<double> one_number(const std::string& file, const Imf::Header& header, const char* name) {
  const auto values = numbers(file, header, name);
  if (!values) return std::nullopt;
  if (values->size() != 1 || !std::isfinite(values->front()))
    fail_input(
        "{}: header: {}: expected one finite number, found {}; correct it", file, name,
        values->size() == 1 ? fmt::format("{}", values->front()) : fmt::format("{} numbers", values->size()));
  return values->front();
}

}  // namespace

bool is_range_format(const std::string& name) {
  return name == range_attribute::kFormatName || name == "range image 2";
}

bool is_range_attribute(const std::string& name) {
  for (const char* known : {kFormat, kElevation, kAzimuth, kElevationFirst, kElevationStep, kAzimuthFirst,
                            kAzimuthStep, kWraps, kPose, kExtra, kChecksum})
    if (name == known) return true;
  return false;
}

std::string text_attribute(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
  return attribute ? attribute->value() : std::string();
}

std::vector<double> angle_attribute(const std::string& file, const Imf::Header& header,
                                    const AngleAttributes& names, int count, double most_rad) {
  std::vector<double> angles;
  if (auto table = numbers(file, header, names.table)) {
    if (table->size() != static_cast<std::size_t>(count))
      fail_input(
          "{}: header: {}: expected {} angles, found {}; write one per row of pixels (elevation) and per "
          "column (azimuth), or copy the file again",
          file, names.table, count, table->size());
    angles = std::move(*table);
  } else {
    const auto first = one_number(file, header, names.first), step = one_number(file, header, names.step);
    if (!first && !step) return {};
    if (!first || !step)
      fail_input("{}: header: expected {} and {}, found no {}; write both, or the table {}", file,
                 names.first, names.step, first ? names.step : names.first, names.table);
    for (int i = 0; i < count; ++i) angles.push_back(*first + i * *step);
  }
  for (std::size_t i = 0; i < angles.size(); ++i)
    if (!(std::abs(angles[i]) <= most_rad))
      fail_input("{}: header: {}: angle {}: expected radians, at most {:.2f}, found {}; are these degrees?",
                 file, names.table, i, most_rad, angles[i]);
  return angles;
}

std::optional<Pose> pose_attribute(const std::string& file, const Imf::Header& header) {
  const auto values = numbers(file, header, kPose);
  if (!values) return std::nullopt;
  if (values->size() != 16)
    fail_input("{}: header: {}: expected 16 numbers (4 x 4, row-major), found {}; correct it or leave it out",
               file, kPose, values->size());
  std::array<double, 16> matrix{};
  std::copy(values->begin(), values->end(), matrix.begin());
  try {
    return pose_from_row_major(matrix);
  } catch (const Error& error) {
    fail_input("{}: header: {}: {}; correct it, or leave it out and register the scan", file, kPose,
               error.what());
  }
}

std::optional<std::int64_t> whole_attribute(const std::string& file, const Imf::Header& header,
                                            const char* name) {
  const auto value = one_number(file, header, name);
  if (!value) return std::nullopt;
  if (!(std::abs(*value) <= 4e9) || *value != std::floor(*value))
    fail_input("{}: header: {}: expected a whole number, found {}; correct it", file, name, *value);
  return static_cast<std::int64_t>(*value);
}

}  // namespace hybrid::io
