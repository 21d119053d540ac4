#include "io/intensity_map.hpp"

namespace hybrid::io {

IntensityMap map_intensity(const ScanStream& scan, const std::optional<std::array<float, 2>>& limits) {
  IntensityMap map;
  const auto& of_scan = scan.head().intensity_limits;
  const SampleFacts& facts = scan.facts();
  if (!scan.has_intensity() || !limits || of_scan == limits) return map;
  const auto [least, greatest] = *limits;
  if (!of_scan && facts.least >= least && facts.greatest <= greatest) return map;
  map.to = *limits;
  map.from = of_scan.value_or(std::array{facts.least_finite, facts.greatest_finite});
  const double extent = static_cast<double>(map.from[1]) - static_cast<double>(map.from[0]);
  map.scale = extent > 0 ? (static_cast<double>(greatest) - static_cast<double>(least)) / extent : 0;
  map.shift = static_cast<double>(least) - map.scale * (extent >= 0 ? static_cast<double>(map.from[0]) : 0);
  return map;
}

}  // namespace hybrid::io
