#include "score/measure/decimation.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_set>

#include "score/error.hpp"
#include "score/measure/polygon.hpp"

namespace score {
namespace {

// A measured point as the file holds it, bit by bit: kept samples come back unchanged.
struct Bits {
  std::array<std::uint32_t, 3> words;
  bool operator==(const Bits&) const = default;
};
Bits bits_of(const Eigen::Vector3f& point) {
  Bits bits;
  for (int axis = 0; axis < 3; ++axis) {
    const float value = point[axis] + 0.0f;  // -0 is 0
    std::memcpy(&bits.words[static_cast<std::size_t>(axis)], &value, sizeof value);
  }
  return bits;
}
struct BitsHash {
  std::size_t operator()(const Bits& bits) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15ull;
    for (const std::uint32_t word : bits.words)
      hash = (hash ^ word) * 0xbf58476d1ce4e5b9ull, hash ^= hash >> 29;
    return static_cast<std::size_t>(hash);
  }
};

constexpr double kLeastMatched = 0.5;  // of detail.ply's points; extra samples are on no node of the grid

}  // namespace

DecimationScore score_decimation(const LabelledGrid& grid, const std::map<std::uint32_t, ResultPlane>& planes,
                                 const std::vector<Eigen::Vector3f>& kept, const TrueSamples& truth,
                                 const std::string& name) {
  std::unordered_set<Bits, BitsHash> kept_bits;
  kept_bits.reserve(kept.size());
  for (const auto& point : kept) kept_bits.insert(bits_of(point));
  std::map<std::uint32_t, PlanePolygon> polygons;
  for (const auto& [id, plane] : planes) polygons.emplace(id, PlanePolygon(plane.plane, plane.rings));

  DecimationScore score;
  // A grid's places without a return are no samples.
  score.input_samples = std::count_if(truth.range_m.begin(), truth.range_m.end(),
                                      [](double range) { return std::isfinite(range); });
  std::vector<std::size_t> discarded;
  std::int64_t matched = 0;
  for (std::size_t i = 0; i < grid.source.size(); ++i) {
    if (grid.source[i] == kNoSource) continue;
    if (kept_bits.count(bits_of(grid.point[i])))
      ++matched;
    else
      discarded.push_back(i);
  }
  if (static_cast<double>(matched) < kLeastMatched * static_cast<double>(kept_bits.size()))
    bad_input(
        "{}: expected points that range.exr beside it holds, found {} of {} there; write both from one run",
        name, matched, kept_bits.size());
  score.discarded = static_cast<std::int64_t>(discarded.size());

  std::vector<double> distances(discarded.size());
  tbb::parallel_for(std::size_t{0}, discarded.size(), [&](std::size_t k) {
    const std::size_t i = discarded[k];
    const auto polygon = polygons.find(grid.label[i]);
    const Vec3 direction = grid.point[i].cast<double>().normalized();
    distances[k] = polygon == polygons.end()
                       ? std::numeric_limits<double>::quiet_NaN()
                       : polygon->second.distance_m(direction * truth.range_m[grid.source[i]]);
  });
  std::erase_if(distances, [](double distance) { return !std::isfinite(distance); });
  score.without_polygon = score.discarded - static_cast<std::int64_t>(distances.size());
  if (distances.empty()) return score;
  std::sort(distances.begin(), distances.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.999 * static_cast<double>(distances.size()))) - 1;
  score.percentile_999_mm = 1000 * distances[rank];
  score.largest_mm = 1000 * distances.back();
  return score;
}

}  // namespace score
