#include "cases/blend_ranked_case.hpp"

#include "reference/photo_sight.hpp"

namespace hybrid::testing {
namespace {

// METHOD 10 with the ranked penalties of one point, best first.
std::vector<double> weights(const std::vector<double>& penalties, std::size_t kept, double pixel_rad) {
  const double end = penalties.size() == kept ? penalties.back() : 1.01 * penalties.back();
  std::vector<double> out;
  for (double p : penalties) out.push_back(std::max(0.0, 1 - p / end) / (p + pixel_rad));
  if (!(penalties.front() < end)) out.front() = 1;  // all of them 0, or 0 / 0
  for (std::size_t r = 1; r < out.size() && !(penalties.front() < end); ++r) out[r] = 0;
  return out;
}

}  // namespace

BlendRankedCase::Output BlendRankedCase::reference(const Input& input) {
  const auto& blend = input.rank.blend;
  const std::size_t count = blend.count();
  Output out{std::vector<float>(blend.planes() * count, 0), std::vector<std::int32_t>(count, -1)};
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> penalties;
    for (std::size_t at = i; at < input.ranks.photo.size() && input.ranks.photo[at] >= 0; at += count)
      penalties.push_back(input.ranks.penalty[at]);
    if (penalties.empty()) continue;
    const auto weight = weights(penalties, input.rank.kept, blend.pixel_rad);
    std::vector<WeighedLight> lights;
    for (std::size_t r = 0; r < weight.size(); ++r) {
      const std::int32_t photograph = input.ranks.photo[r * count + i];
      const auto& photo = blend.photos[static_cast<std::size_t>(photograph)];
      const auto sight = photo_sight(blend, static_cast<std::size_t>(photograph), i);
      if (weight[r] > 0)
        lights.push_back({photograph, sight->feather * weight[r], photo_light(photo, sight->pixel),
                          photo_bands(photo, sight->pixel, blend.mix)});
    }
    write_sums(lights, blend.mix, count, i, out.sums, out.best);
  }
  return out;
}

}  // namespace hybrid::testing
