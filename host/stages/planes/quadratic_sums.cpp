#include "stages/planes/quadratic_sums.hpp"

#include <algorithm>
#include <cmath>

#include "core/cpu_clones.hpp"
#include "core/lanes.hpp"

// Sums over all heights of a region, as loops over lanes of fixed order (ray_equations.cpp says why; compiled
// with options of its own, host/CMakeLists.txt).
namespace hybrid::stages {
namespace {

// Powers a^i b^j with i + j <= 4, in this order, and the height times those with i + j <= 2.
constexpr std::size_t kPowers = 15, kTerms = kPowers + 6;
enum Power : std::size_t { k00, k10, k01, k20, k11, k02, k30, k21, k12, k03, k40, k31, k22, k13, k04 };

// Heights side by side; the last are filled up with the last one, which counts 0 there.
struct Lanes {
  alignas(64) LaneValues a, b, h, counts;
};

HYBRID_INLINE void load(const std::vector<Vec3>& heights, std::size_t from, Lanes& lanes) {
  const std::size_t count = std::min(heights.size() - from, kVectorLanes);
  const Vec3* const first = heights.data() + from;
  if (count == kVectorLanes) {
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      lanes.a[k] = first[k].x();
      lanes.b[k] = first[k].y();
      lanes.h[k] = first[k].z();
      lanes.counts[k] = 1;
    }
    return;
  }
  for (std::size_t k = 0; k < kVectorLanes; ++k) {
    const Vec3& one = first[std::min(k, count - 1)];
    lanes.a[k] = one.x();
    lanes.b[k] = one.y();
    lanes.h[k] = one.z();
    lanes.counts[k] = k < count ? 1 : 0;
  }
}

}  // namespace

HYBRID_CPU_CLONES
HeightExtent extent_of(const std::vector<Vec3>& heights) {
  alignas(64) std::array<LaneValues, 5> sums{};
  Lanes lanes;
  for (std::size_t from = 0; from < heights.size(); from += kVectorLanes) {
    load(heights, from, lanes);
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      const double a = lanes.counts[k] * lanes.a[k], b = lanes.counts[k] * lanes.b[k];
      sums[0][k] += a;
      sums[1][k] += b;
      sums[2][k] += a * a;
      sums[3][k] += a * b;
      sums[4][k] += b * b;
    }
  }
  const double count = static_cast<double>(heights.size());
  HeightExtent extent;
  extent.mean = Vec2(sum_of_lanes(sums[0]), sum_of_lanes(sums[1])) / count;
  extent.products << sum_of_lanes(sums[2]), sum_of_lanes(sums[3]), sum_of_lanes(sums[3]),
      sum_of_lanes(sums[4]);
  extent.products /= count;
  return extent;
}

HYBRID_CPU_CLONES
Vec2 reach_of(const std::vector<Vec3>& heights, const HeightAxes& axes) {
  const double ma = axes.mean.x(), mb = axes.mean.y();
  const double aa = axes.turn(0, 0) / axes.scale.x(), ab = axes.turn(0, 1) / axes.scale.x();
  const double ba = axes.turn(1, 0) / axes.scale.y(), bb = axes.turn(1, 1) / axes.scale.y();
  alignas(64) LaneValues largest_a{}, largest_b{};
  Lanes lanes;
  for (std::size_t from = 0; from < heights.size(); from += kVectorLanes) {
    load(heights, from, lanes);
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      const double x = lanes.a[k] - ma, y = lanes.b[k] - mb;
      const double a = std::abs(aa * x + ab * y), b = std::abs(ba * x + bb * y);
      largest_a[k] = largest_a[k] < a ? a : largest_a[k];
      largest_b[k] = largest_b[k] < b ? b : largest_b[k];
    }
  }
  return {*std::max_element(largest_a.begin(), largest_a.end()),
          *std::max_element(largest_b.begin(), largest_b.end())};
}

HYBRID_CPU_CLONES
QuadraticSums quadratic_sums(const std::vector<Vec3>& heights, const HeightAxes& axes) {
  const double ma = axes.mean.x(), mb = axes.mean.y();
  const double aa = axes.turn(0, 0) / axes.scale.x(), ab = axes.turn(0, 1) / axes.scale.x();
  const double ba = axes.turn(1, 0) / axes.scale.y(), bb = axes.turn(1, 1) / axes.scale.y();
  alignas(64) std::array<LaneValues, kTerms> terms{};
  alignas(64) LaneValues squares{};
  Lanes lanes;
  for (std::size_t from = 0; from < heights.size(); from += kVectorLanes) {
    load(heights, from, lanes);
    for (std::size_t k = 0; k < kVectorLanes; ++k) {
      const double one = lanes.counts[k], x = lanes.a[k] - ma, y = lanes.b[k] - mb, h = one * lanes.h[k];
      const double a = one * (aa * x + ab * y), b = one * (ba * x + bb * y);
      const double a2 = a * a, b2 = b * b, axb = a * b;
      terms[k00][k] += one;
      terms[k10][k] += a;
      terms[k01][k] += b;
      terms[k20][k] += a2;
      terms[k11][k] += axb;
      terms[k02][k] += b2;
      terms[k30][k] += a2 * a;
      terms[k21][k] += a2 * b;
      terms[k12][k] += a * b2;
      terms[k03][k] += b2 * b;
      terms[k40][k] += a2 * a2;
      terms[k31][k] += a2 * axb;
      terms[k22][k] += a2 * b2;
      terms[k13][k] += axb * b2;
      terms[k04][k] += b2 * b2;
      terms[kPowers][k] += h;
      terms[kPowers + 1][k] += h * a;
      terms[kPowers + 2][k] += h * b;
      terms[kPowers + 3][k] += h * a2;
      terms[kPowers + 4][k] += h * axb;
      terms[kPowers + 5][k] += h * b2;
      squares[k] += h * h;
    }
  }
  std::array<double, kTerms> s;
  for (std::size_t t = 0; t < kTerms; ++t) s[t] = sum_of_lanes(terms[t]);
  QuadraticSums sums;
  sums.normal << s[k00], s[k10], s[k01], s[k20], s[k11], s[k02],  //
      s[k10], s[k20], s[k11], s[k30], s[k21], s[k12],             //
      s[k01], s[k11], s[k02], s[k21], s[k12], s[k03],             //
      s[k20], s[k30], s[k21], s[k40], s[k31], s[k22],             //
      s[k11], s[k21], s[k12], s[k31], s[k22], s[k13],             //
      s[k02], s[k12], s[k03], s[k22], s[k13], s[k04];
  for (std::size_t t = 0; t < 6; ++t) sums.right[static_cast<Eigen::Index>(t)] = s[kPowers + t];
  sums.squares = sum_of_lanes(squares);
  return sums;
}

}  // namespace hybrid::stages
