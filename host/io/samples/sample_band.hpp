#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "io/samples/sample_file.hpp"
#include "io/samples/sample_header.hpp"

namespace hybrid::io {

// One band of kBandRows rows from `first_row` on, as columns.
struct EncodedBand {
  std::string bytes;
  std::uint64_t discarded_bytes = 0;
};
EncodedBand encode_band(const SampleHeader& header, const SampleFileInput& input, int first_row);

// Fills the band's nodes of a scan whose vectors have one element per node, of the rows from `scan_row` on.
// Bands touch disjoint memory. Returns the number of samples. Throws ErrorKind::input naming `place`.
std::uint64_t decode_band(const SampleHeader& header, std::string_view bytes, const std::string& place,
                          int first_row, Scan& scan, int scan_row = 0);

// The point that the band stores for a node.
inline std::array<float, 3> stored_point(const SampleFileInput& input, std::size_t node) {
  if (input.georeferenced) return input.georeferenced->points[input.image.source[node]];
  return {input.image.x[node], input.image.y[node], input.image.z[node]};
}

}  // namespace hybrid::io
