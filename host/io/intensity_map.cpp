#include "io/intensity_map.hpp"

namespace hybrid::io {

IntensityMap map_intensity(const ScanStream& scan, const std::optional<std::array<float, 2>>& limits,
                           bool whole) {
  IntensityMap map;
  const auto& of_scan = scan.head().intensity_limits;
  const SampleFacts& facts = scan.facts();
  if (!scan.has_intensity() || !limits || of_scan == limits) return map;
  const auto [least, greatest] = *limits;
  constexpr float kSteps = 255;  // that fractions may be rounded to
  const bool within = facts.least >= least && facts.greatest <= greatest;
  if (!of_scan && within && (!whole || facts.whole || facts.greatest - facts.least >= kSteps)) return map;
  map.to = *limits;
  const bool unit = whole && facts.least >= 0 && facts.greatest <= 1;
  map.from =
      of_scan.value_or(unit ? std::array{0.0f, 1.0f} : std::array{facts.least_finite, facts.greatest_finite});
  const double extent = static_cast<double>(map.from[1]) - static_cast<double>(map.from[0]);
  map.scale = extent > 0 ? (static_cast<double>(greatest) - static_cast<double>(least)) / extent : 0;
  map.shift = static_cast<double>(least) - map.scale * (extent >= 0 ? static_cast<double>(map.from[0]) : 0);
  return map;
}

}  // namespace hybrid::io
