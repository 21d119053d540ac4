#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "geometry/plane.hpp"
#include "geometry/pose.hpp"
#include "io/samples/number_code.hpp"

namespace hybrid::io {

inline constexpr char kSampleFileMark[] = "HYBRIDSF";  // 8 bytes
inline constexpr std::uint32_t kSampleFileVersion = 1;
inline constexpr int kBandRows = 64;

// The first block of a sample file: what its bands are read with.
struct SampleHeader {
  int rows = 0, cols = 0;
  bool wraps = false;
  std::vector<double> elevation_rad, azimuth_rad;
  // Cosine and sine of each angle: kept, because libraries differ in their last digit.
  std::vector<std::array<double, 2>> elevation_ray, azimuth_ray;
  std::vector<Plane> planes;  // [id - 1]
  Vec3 origin = Vec3::Zero();
  NumberCode point, intensity_code;
  bool intensity = false, colour = false;
  std::uint64_t samples = 0, discarded = 0, extra = 0;
  std::optional<Pose> world_from_scan;
  std::string crs;

  Vec3 ray(int row, int col) const {
    const auto& e = elevation_ray[static_cast<std::size_t>(row)];
    const auto& a = azimuth_ray[static_cast<std::size_t>(col)];
    return {e[0] * a[0], e[0] * a[1], e[1]};
  }
  int bands() const { return (rows + kBandRows - 1) / kBandRows; }
  std::uint64_t nodes() const { return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(cols); }
};

// Compressed. parse_header() throws ErrorKind::input naming `place`: a part that is missing, odd or of
// another size than the grid's.
std::string header_bytes(const SampleHeader& header);
SampleHeader parse_header(std::string_view bytes, const std::string& place);

}  // namespace hybrid::io
