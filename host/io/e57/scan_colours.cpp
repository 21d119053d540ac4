#include "io/e57/scan_colours.hpp"

#include <algorithm>
#include <vector>

namespace hybrid::io {
namespace {

// Over the scan's three colour fields.
double largest_value(const E57RecordReader& reader, const E57Table& table,
                     const std::array<std::size_t, 3>& fields) {
  std::vector<double> largest(reader.count() / E57RecordReader::kRange + 1, 0);
  reader.read(fields, 0, reader.count(), [&](const E57Records& records) {
    std::vector<double> values(records.count);
    double& most = largest[records.first / E57RecordReader::kRange];
    for (std::size_t k = 0; k < 3; ++k) {
      values_of(table.fields[fields[k]], records, k, values);
      for (const double value : values) most = std::max(most, value);
    }
  });
  return *std::ranges::max_element(largest);
}

}  // namespace

ColourScale::ColourScale(const E57RecordReader& reader, const E57Scan& scan, const ScanColumns& columns) {
  const auto slots = *columns.colour;
  std::array<std::size_t, 3> fields{};
  bool bytes = true, reals = true;
  for (std::size_t k = 0; k < 3; ++k) {
    fields[k] = columns.fields[slots[k]];
    const E57Field& field = scan.points.fields[fields[k]];
    bytes = bytes && field.type == E57Type::integer && field.minimum == 0 && field.maximum == 255;
    reals = reals && field.type != E57Type::integer;
  }
  for (std::size_t k = 0; k < 3 && scan.colour; ++k) {
    const E57Limits& limits = (*scan.colour)[k];
    low_[k] = limits.minimum;
    factor_[k] = limits.maximum > limits.minimum ? 255 / (limits.maximum - limits.minimum) : 0;
  }
  if (scan.colour) return;
  factor_.fill(1);
  if (bytes) return;
  const double largest = largest_value(reader, scan.points, fields);
  if (reals && largest <= 1)
    factor_.fill(255);
  else if (largest > 255)
    factor_.fill(1.0 / 257);
}

}  // namespace hybrid::io
