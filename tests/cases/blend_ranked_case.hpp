#pragma once
#include "cases/rank_photos_case.hpp"

namespace hybrid::testing {

// Photographs blended into points by ranks that the reference of rank_photos made.
struct BlendRankedCase {
  static constexpr const char* kName = "blend_ranked";
  struct Input {
    RankPhotosCase::Input rank;
    RankPhotosCase::Output ranks;
  };
  struct Output {
    std::vector<float> sums;
    std::vector<std::int32_t> best;
  };

  static Input make(std::size_t size, std::uint32_t seed) {
    auto rank = RankPhotosCase::make(size, seed);
    auto ranks = RankPhotosCase::reference(rank);
    return {std::move(rank), std::move(ranks)};
  }
  static Output run(device::Queue& queue, const Input& input) {
    const auto& blend = input.rank.blend;
    const int width = blend.vector_width ? blend.vector_width : queue.vector_width();
    const auto surface = queue.array(blend.surface), linear = queue.array(blend.linear);
    const auto penalty = queue.array(input.ranks.penalty);
    const auto ranked = queue.array(input.ranks.photo);
    const auto sums = queue.array(std::vector<float>(blend.planes() * blend.count(), 0.0f));
    const auto best = queue.array(std::vector<std::int32_t>(blend.count(), -1));
    for (std::size_t i = 0; i < blend.photos.size(); ++i) {
      const auto pixels = queue.array(blend.photos[i].pixels);
      const auto low = queue.array(blend.photos[i].low_halves());
      BlendRankedParams params{};
      params.camera = blend.photos[i].record();
      params.cols = blend.cols;
      params.rows = blend.rows;
      params.mix = blend.mix;
      params.photograph = static_cast<int>(i);
      params.kept = input.rank.kept;
      params.feather_px = blend.feather_px;
      params.pixel_rad = blend.pixel_rad;
      queue.launch(kName, queue.kernel(kName, {{"VW", width}}),
                   stages::packet_grid(width, blend.cols, blend.rows), params, surface, penalty, ranked,
                   pixels, low, linear, sums, best);
      queue.finish();
    }
    return {queue.read(sums), queue.read(best)};
  }
  static Output reference(const Input& input);  // reference/blend_ranked.cpp

  // Weights up to 1 / pixel_rad = 1000 come from penalties good to 1e-7 relative; two that are alike to 1e-6
  // may be ordered either way.
  static bool agrees(const Output& got, const Output& expected, std::size_t i) {
    const std::size_t count = got.best.size();
    if (got.best[i] != expected.best[i]) return false;
    const float weight = expected.sums[BLEND_SUM_WEIGHT * count + i];
    for (std::size_t plane = 0; plane < expected.sums.size() / count; ++plane) {
      const bool relative = (plane >= BLEND_BEST_R && plane <= BLEND_BEST_SHARE) || plane >= BLEND_PLANES;
      const float tolerance = 2e-3f * (relative ? 1 : 1e-3f + weight);
      if (!(std::abs(got.sums[plane * count + i] - expected.sums[plane * count + i]) < tolerance))
        return false;
    }
    return true;
  }
  static constexpr double kUndecided = 5e-4;

  static double items(const Input& input) { return BlendPhotosCase::items(input.rank.blend); }
  static double bytes(const Input& input) { return (124.0 + 8 * input.rank.kept) * items(input); }
  static double flops(const Input& input) { return 150.0 * items(input); }
};

}  // namespace hybrid::testing
