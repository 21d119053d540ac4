#include "cases/resolve_blend_case.hpp"

namespace hybrid::testing {

ResolveBlendCase::Output ResolveBlendCase::reference(const Input& input) {
  Output out;
  const std::size_t count = input.seen.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double mean =
          double{input.sums[(BLEND_SUM_R + k) * count + i]} / input.sums[BLEND_SUM_WEIGHT * count + i];
      const double best =
          double{input.sums[(BLEND_BEST_R + k) * count + i]} / input.sums[BLEND_BEST_SHARE * count + i];
      double bands = mean + best;
      for (std::size_t plane = BLEND_PLANES; plane < input.sums.size() / count; plane += BLEND_BAND_PLANES)
        bands += double{input.sums[(plane + k) * count + i]} / input.sums[(plane + 3) * count + i];
      double colour = input.mode == BLEND_NEAREST  ? best
                      : input.mode == BLEND_LINEAR ? mean
                                                   : std::max(bands, 0.0);
      if (input.seen[i] == 0) colour = k == 0 ? 1 : 0;
      if (std::isnan(input.surface_x[i])) colour = std::numeric_limits<double>::quiet_NaN();
      out.colour.push_back(static_cast<float>(colour));
    }
  return out;
}

}  // namespace hybrid::testing
