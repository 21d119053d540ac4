#include "io/intensity_map.hpp"

#include <algorithm>
#include <cmath>

#include "io/scan_builder.hpp"

namespace hybrid::io {

IntensityMap map_intensity(const Scan& scan, const std::optional<std::array<float, 2>>& limits) {
  IntensityMap map;
  if (scan.intensity.empty() || !limits || scan.intensity_limits == limits) return map;
  const auto [least, greatest] = *limits;
  if (!scan.intensity_limits && within(scan.intensity, least, greatest)) return map;
  map.to = *limits;
  map.from = scan.intensity_limits.value_or(std::array{INFINITY, -INFINITY});
  if (!scan.intensity_limits)
    for (const float value : scan.intensity)
      if (std::isfinite(value)) map.from = {std::min(map.from[0], value), std::max(map.from[1], value)};
  const double extent = static_cast<double>(map.from[1]) - static_cast<double>(map.from[0]);
  map.scale = extent > 0 ? (static_cast<double>(greatest) - static_cast<double>(least)) / extent : 0;
  map.shift = static_cast<double>(least) - map.scale * (extent >= 0 ? static_cast<double>(map.from[0]) : 0);
  return map;
}

}  // namespace hybrid::io
