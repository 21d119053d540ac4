#include "stages/planes/sparse_seeds.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.hpp"
#include "lib/random.h"

namespace hybrid::stages {
namespace {

constexpr int kWindow = 8, kStride = 4;
constexpr std::size_t kFewestOfWindow = 12;
constexpr double kWindowShareOfSeed = 0.4;  // of the free samples
constexpr std::uint32_t kTestPlanes = 32, kSeed = 1;
constexpr double kSigmas = 3;
constexpr double kSliver = 1e-2;  // sine of the angle between two sides of a test triangle

struct WindowPoint {
  Vec3 at;
  double range;
  int bit;  // of WindowSeed::members
};

void free_in_window(const RangeImage& image, const std::vector<std::uint8_t>& use, std::uint32_t corner,
                    std::vector<WindowPoint>& points) {
  const int row = static_cast<int>(corner) / image.cols, col = static_cast<int>(corner) % image.cols;
  points.clear();
  for (int r = row; r < std::min(row + kWindow, image.rows); ++r)
    for (int c = col; c < std::min(col + kWindow, image.cols); ++c)
      if (const std::size_t i = image.index(r, c); use[i] == kFree) {
        const Vec3 point = image.point(i);
        points.push_back({point, point.norm(), (r - row) * kWindow + c - col});
      }
}

// How many samples of the window's rows are free, by column: where few are, as in most windows, none need be
// taken.
std::vector<int> free_in_columns(const RangeImage& image, const std::vector<std::uint8_t>& use, int row) {
  std::vector<int> free(static_cast<std::size_t>(image.cols));
  for (int r = row; r < std::min(row + kWindow, image.rows); ++r) {
    const std::uint8_t* const of_row = use.data() + image.index(r, 0);
    for (std::size_t col = 0; col < free.size(); ++col) free[col] += of_row[col] == kFree ? 1 : 0;
  }
  return free;
}

// |measured - predicted range| on the plane through `a` with this unit normal, in sigmas.
bool lies_on(const RangeNoise& noise, const Vec3& normal, double offset, const WindowPoint& point) {
  const double cosine = normal.dot(point.at) / point.range;
  return std::abs(cosine) >= kSeedCosine &&
         std::abs(point.range - offset / cosine) <= kSigmas * noise.at(point.range, std::abs(cosine));
}

// The points on the best of the test planes, a bit each; 0 = too few on any.
std::uint64_t best_members(const std::vector<WindowPoint>& points, const RangeNoise& noise,
                           std::uint32_t corner) {
  const auto count = static_cast<std::uint32_t>(points.size());
  if (points.size() < kFewestOfWindow) return 0;
  std::size_t most =
      std::max(kFewestOfWindow, static_cast<std::size_t>(std::ceil(kWindowShareOfSeed * count))) - 1;
  std::uint64_t best = 0;
  for (std::uint32_t k = 0; k < kTestPlanes; ++k) {
    const Vec3 &a = points[random_below(kSeed, corner, 3 * k, count)].at,
               &b = points[random_below(kSeed, corner, 3 * k + 1, count)].at,
               &c = points[random_below(kSeed, corner, 3 * k + 2, count)].at;
    const Vec3 cross = (b - a).cross(c - a);
    const double area = cross.norm();
    if (!(area > kSliver * (b - a).norm() * (c - a).norm())) continue;
    const Vec3 normal = cross / area;
    const double offset = cross.dot(a) / area;
    std::uint64_t on = 0;
    std::size_t found = 0;
    // Until the rest could not make it the best.
    for (std::size_t i = 0; i < points.size() && found + (points.size() - i) > most; ++i)
      if (lies_on(noise, normal, offset, points[i])) {
        on |= std::uint64_t{1} << points[i].bit;
        found += 1;
      }
    if (found <= most) continue;
    most = found;
    best = on;
  }
  return best;
}

}  // namespace

std::vector<std::uint32_t> sparse_seed_samples(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                               const WindowSeed& seed) {
  std::vector<std::uint32_t> samples;
  for (int bit = 0; bit < kWindow * kWindow; ++bit)
    if ((seed.members >> bit & 1) != 0) {
      const auto i = seed.sample + static_cast<std::uint32_t>(bit / kWindow * image.cols + bit % kWindow);
      if (use[i] == kFree) samples.push_back(i);
    }
  return samples;
}

std::vector<WindowSeed> find_sparse_seeds(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                          const RangeNoise& noise) {
  const auto rows = static_cast<std::size_t>((image.rows + kStride - 1) / kStride);
  std::vector<std::vector<WindowSeed>> of_row(rows);
  parallel_for(rows, [&](std::size_t row) {
    const std::vector<int> free = free_in_columns(image, use, static_cast<int>(row) * kStride);
    std::vector<WindowPoint> points;
    for (int col = 0; col < image.cols; col += kStride) {
      const auto window = free.begin() + col;
      if (std::accumulate(window, window + std::min(kWindow, image.cols - col), std::size_t{0}) <
          kFewestOfWindow)
        continue;
      const auto corner = static_cast<std::uint32_t>(image.index(static_cast<int>(row) * kStride, col));
      free_in_window(image, use, corner, points);
      WindowSeed seed{corner, kSparseSeed, 0, best_members(points, noise, corner)};
      if (seed.members == 0) continue;
      const auto samples = sparse_seed_samples(image, use, seed);
      seed.member = samples[samples.size() / 2];
      of_row[row].push_back(seed);
    }
  });
  std::vector<WindowSeed> seeds;
  for (const auto& list : of_row) seeds.insert(seeds.end(), list.begin(), list.end());
  return seeds;
}

}  // namespace hybrid::stages
