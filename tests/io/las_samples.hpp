#pragma once
#include <cmath>
#include <string>

#include "io/scan_samples.hpp"

namespace hybrid::testing {

inline constexpr const char* kSampleWkt =
    "PROJCS[\"OSGB36 / British National "
    "Grid\",GEOGCS[\"OSGB36\",UNIT[\"degree\",0.01745]],UNIT[\"metre\",1]]";

// The four points of scan_samples.hpp, intensity times 1000, colour times 257: LAS 1.`minor` as its
// specification lays it out, written by hand, scale 0.125, offset (-1, 0, 0). 1.4: point format 7 with a WKT;
// else 2 with GeoTIFF keys for EPSG:27700.
inline std::string las_sample(int minor) {
  const bool new_kind = minor == 4;
  const auto zeros = [](std::size_t count) { return std::string(count, '\0'); };
  std::string body;
  if (new_kind) {
    body = std::string(kSampleWkt) + '\0';
  } else {
    for (const std::uint16_t word : {1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, 27700, 3076, 0, 1, 9001})
      body += raw(word);
  }
  const std::string record = raw(std::uint16_t{0}) + "LASF_Projection" + zeros(1) +
                             raw(static_cast<std::uint16_t>(new_kind ? 2112 : 34735)) +
                             raw(static_cast<std::uint16_t>(body.size())) + zeros(32) + body;
  const std::uint16_t header_bytes = new_kind ? 375 : minor == 3 ? 235 : 227;
  std::string file = "LASF" + raw(std::uint16_t{0}) + raw(static_cast<std::uint16_t>(new_kind ? 16 : 0)) +
                     zeros(16) + '\1' + static_cast<char>(minor) + zeros(64) + raw(std::uint32_t{0}) +
                     raw(header_bytes) + raw(static_cast<std::uint32_t>(header_bytes + record.size())) +
                     raw(std::uint32_t{1}) + static_cast<char>(new_kind ? 7 : 2) +
                     raw(static_cast<std::uint16_t>(new_kind ? 36 : 26));
  const std::uint32_t few = new_kind ? 0 : 4;
  file += raw(few) + raw(few) + zeros(16);
  for (int axis = 0; axis < 3; ++axis) file += raw(0.125);
  file += raw(-1.0) + raw(0.0) + raw(0.0);
  for (const double value : {1.5, -3.0, 2.0, -4.0, 2.0, -0.5}) file += raw(value);
  if (minor >= 3) file += zeros(8);
  if (new_kind)
    file += zeros(8) + raw(std::uint32_t{0}) + raw(std::uint64_t{4}) + raw(std::uint64_t{4}) + zeros(112);
  file += record;
  for (int i = 0; i < 4; ++i) {
    const auto* p = kSamplePoints[i];
    for (int axis = 0; axis < 3; ++axis)
      file += raw(static_cast<std::int32_t>(std::lround((p[axis] + (axis == 0 ? 1 : 0)) / 0.125f)));
    file += raw(static_cast<std::uint16_t>(1000 * kSampleIntensity[i]));
    file += new_kind ? '\x11' : '\x09';
    file += zeros(new_kind ? 15 : 5);
    for (const std::uint8_t value : kSampleRgb[i]) file += raw(static_cast<std::uint16_t>(257 * value));
  }
  return file;
}

}  // namespace hybrid::testing
