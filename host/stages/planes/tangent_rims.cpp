#include "stages/planes/tangent_rims.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/disjoint_sets.hpp"
#include "core/parallel.hpp"
#include "geometry/tiles.hpp"
#include "stages/planes/step_sharing.hpp"

namespace hybrid::stages {
namespace {

// In samples, of a scan whose squares have kSquare samples a side and whose steps are kStep_rad or more;
// denser scans are looked at every few samples.
constexpr int kSquare = 7, kTile = 32, kInwards = 14, kOnwards = 6;
constexpr int kMostStride = 8;
constexpr double kStep_rad = 0.0018;
constexpr double kTile_rad = 0.115;  // a rim is straight so far, and the longer it is, the better known
constexpr int kApart = 4;            // samples: rims farther from each other than that to twice that are two
constexpr double kLeastElevationCosine = 0.1;  // of a tile's elevation
constexpr std::size_t kFewestAlongRim = 12;    // samples of a rim
constexpr double kMostWidth = 0.35;            // of a rim, against its length
constexpr int kStarts = 28;                    // of the curve, that are tried
constexpr double kMostOfResidual = 9;          // of a sample's residual, in sigmas
constexpr double kMostCurveChi2 = 2;           // per sample
constexpr double kBetter = 8;                  // of chi2, than a crease
constexpr double kLeastGainOfCurve = 40;       // of chi2, against the plane alone
constexpr double kStraightest_m = 100;         // radius

struct Sample {
  Vec2 at;  // on the plane
  double height_m, weight;
};

// The samples around a rim of one plane.
struct Rim {
  std::vector<Sample> inside, outside;
  Vec2 middle, outwards;  // of the rim
};

// The rim's line and the side on which the surface goes on; false where it is no line.
bool orient(Rim& rim, const std::vector<Vec2>& points) {
  rim.middle = Vec2::Zero();
  for (const Vec2& point : points) rim.middle += point / static_cast<double>(points.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Vec2& point : points) scatter += (point - rim.middle) * (point - rim.middle).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scatter);
  if (!(solver.eigenvalues()[0] < kMostWidth * kMostWidth * solver.eigenvalues()[1])) return false;
  rim.outwards = solver.eigenvectors().col(0);
  double side = 0;
  for (const Sample& sample : rim.outside)
    side += rim.outwards.dot(sample.at - rim.middle) / static_cast<double>(rim.outside.size());
  for (const Sample& sample : rim.inside)
    side -= rim.outwards.dot(sample.at - rim.middle) / static_cast<double>(rim.inside.size());
  if (side < 0) rim.outwards = -rim.outwards;
  return side != 0;
}

struct Fit {
  double chi2 = 0, start_m = 0, rise = 0;  // height = level + rise * (s - start)^power
};

// The best start of a rise of this power; of power 0 the level alone.
Fit fit_rise(const Rim& rim, int power, double first_m, double last_m) {
  Fit best{std::numeric_limits<double>::infinity(), 0, 0};
  for (int k = 0; k <= (power == 0 ? 0 : kStarts); ++k) {
    const double start = first_m + (last_m - first_m) * k / kStarts;
    const auto rise = [&](const Sample& sample) {
      const double s = std::max(0.0, rim.outwards.dot(sample.at - rim.middle) - start);
      return power == 2 ? s * s : power == 1 ? s : 0.0;
    };
    double w = 0, wx = 0, wxx = 0, wh = 0, wxh = 0;
    for (const auto* side : {&rim.inside, &rim.outside})
      for (const Sample& sample : *side) {
        const double x = rise(sample);
        w += sample.weight;
        wx += sample.weight * x;
        wxx += sample.weight * x * x;
        wh += sample.weight * sample.height_m;
        wxh += sample.weight * x * sample.height_m;
      }
    const double determinant = w * wxx - wx * wx;
    const double slope = power > 0 && determinant > 0 ? (w * wxh - wx * wh) / determinant : 0;
    const double level = (wh - slope * wx) / w;
    double chi2 = 0;
    for (const auto* side : {&rim.inside, &rim.outside})
      for (const Sample& sample : *side) {
        const double off = sample.height_m - level - slope * rise(sample);
        chi2 += std::min(sample.weight * off * off, kMostOfResidual);
      }
    if (chi2 < best.chi2) best = {chi2, start, slope};
  }
  return best;
}

// Where the curve begins, metres outwards from the rim's middle, if it is one.
std::optional<double> curve_start(const Rim& rim) {
  double first = 0, last = 0;
  for (const Sample& sample : rim.inside) first = std::min(first, rim.outwards.dot(sample.at - rim.middle));
  for (const Sample& sample : rim.outside) last = std::max(last, rim.outwards.dot(sample.at - rim.middle));
  const auto count = static_cast<double>(rim.inside.size() + rim.outside.size());
  const Fit flat = fit_rise(rim, 0, 0, 0), curve = fit_rise(rim, 2, first, last),
            crease = fit_rise(rim, 1, first, last);
  if (curve.chi2 > kMostCurveChi2 * count || curve.chi2 > crease.chi2 - kBetter ||
      curve.chi2 > flat.chi2 - kLeastGainOfCurve || !(2 * std::abs(curve.rise) * kStraightest_m > 1))
    return std::nullopt;
  return curve.start_m;
}

class RimFinder {
 public:
  RimFinder(const RangeImage& image, const RangeNoise& noise, double excess,
            const std::vector<std::uint32_t>& labels, const std::vector<Plane>& planes,
            const PlaneRegions& regions, int stride)
      : image_(image),
        noise_(noise),
        excess_(excess),
        labels_(labels),
        planes_(planes),
        regions_(regions),
        stride_(stride) {}

  // Rims of the planes in a tile; samples of the rim lie in it.
  std::vector<std::vector<std::uint32_t>> trimmed(const Tile& tile) const {
    std::map<std::uint32_t, std::vector<std::uint32_t>> rims;
    for (int row = tile.row; row < tile.row + tile.rows; ++row)
      for (int col = tile.col; col < tile.col + tile.cols; ++col) {
        const auto i = static_cast<std::uint32_t>(image_.index(row, col));
        const std::uint32_t label = labels_[i];
        if (label != 0 && image_.mask[i] == kMeasured && !regions_.regions[label - 1].curved &&
            goes_on_smoothly(row, col, planes_[label - 1]))
          rims[label].push_back(i);
      }
    std::vector<std::vector<std::uint32_t>> lists;
    for (const auto& [label, samples] : rims)
      for (const auto& rim : apart(tile, samples))
        if (rim.size() >= kFewestAlongRim)
          if (auto list = trim(tile, label, rim); !list.empty()) lists.push_back(std::move(list));
    return lists;
  }

 private:
  bool free_at(int row, int col) const {
    return row >= 0 && row < image_.rows && col >= 0 && col < image_.cols &&
           is_on_no_plane(image_, labels_, regions_, image_.index(row, col));
  }
  bool goes_on_smoothly(int row, int col, const Plane& plane) const {
    constexpr std::array<std::array<int, 2>, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    const std::uint32_t own = labels_[image_.index(row, col)];
    return std::any_of(kSides.begin(), kSides.end(), [&](const auto& side) {
      const int r = row + side[0], c = col + side[1];
      if (r < 0 || r >= image_.rows || c < 0 || c >= image_.cols || labels_[image_.index(r, c)] == own)
        return false;
      if (!free_at(r, c) || !free_at(row + 2 * side[0], col + 2 * side[1])) return false;
      const std::size_t i = image_.index(row, col), first = image_.index(row + side[0], col + side[1]),
                        second = image_.index(row + 2 * side[0], col + 2 * side[1]);
      const PlaneHeight height = height_over(image_, noise_, plane, i);
      return height.weight > 0 &&
             surface_goes_on(plane, image_.point(i), image_.point(first),
                             kContinuitySigmas / std::sqrt(height.weight)) &&
             surface_goes_on(plane, image_.point(first), image_.point(second), 0);
    });
  }

  // The rims that samples of a tile make: those in cells that touch are of one.
  std::vector<std::vector<std::uint32_t>> apart(const Tile& tile,
                                                const std::vector<std::uint32_t>& samples) const {
    const int side = kApart * stride_, cols = (tile.cols + side - 1) / side,
              rows = (tile.rows + side - 1) / side;
    const auto cell_of = [&](std::uint32_t i) {
      return (static_cast<int>(i) / image_.cols - tile.row) / side * cols +
             (static_cast<int>(i) % image_.cols - tile.col) / side;
    };
    std::vector<bool> held(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
    for (const std::uint32_t i : samples) held[static_cast<std::size_t>(cell_of(i))] = true;
    DisjointSets sets(held.size());
    for (int row = 0; row < rows; ++row)
      for (int col = 0; col < cols; ++col)
        for (const auto& [down, right] : {std::pair{0, 1}, {1, -1}, {1, 0}, {1, 1}}) {
          const int r = row + down, c = col + right;
          if (r >= rows || c < 0 || c >= cols) continue;
          const auto one = static_cast<std::size_t>(row * cols + col),
                     other = static_cast<std::size_t>(r * cols + c);
          if (held[one] && held[other]) sets.join(one, other);
        }
    std::map<std::uint32_t, std::vector<std::uint32_t>> rims;
    for (const std::uint32_t i : samples) rims[sets.of(static_cast<std::uint32_t>(cell_of(i)))].push_back(i);
    std::vector<std::vector<std::uint32_t>> lists;
    for (auto& [first, rim] : rims) lists.push_back(std::move(rim));
    return lists;
  }

  std::vector<std::uint32_t> trim(const Tile& tile, std::uint32_t label,
                                  const std::vector<std::uint32_t>& rim_samples) const {
    const Plane& plane = planes_[label - 1];
    const Vec3 u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u),
               origin = image_.point(rim_samples[0]);
    const auto on_plane = [&](std::size_t i) {
      const Vec3 arm = image_.point(i) - origin;
      return Vec2(u.dot(arm), v.dot(arm));
    };
    Rim rim;
    std::vector<Vec2> points;
    for (const std::uint32_t i : rim_samples) points.push_back(on_plane(i));
    const int inwards = kInwards * stride_, onwards = kOnwards * stride_;
    // How far each sample of the tile and its surroundings is from the rim.
    const int top = std::max(tile.row - inwards, 0), left = std::max(tile.col - inwards, 0),
              bottom = std::min(tile.row + tile.rows + inwards, image_.rows),
              right = std::min(tile.col + tile.cols + inwards, image_.cols), width = right - left;
    std::vector<std::uint8_t> reach(static_cast<std::size_t>(bottom - top) * static_cast<std::size_t>(width));
    for (std::size_t k = 0; k < rim_samples.size(); k += static_cast<std::size_t>(stride_)) {
      const std::uint32_t i = rim_samples[k];
      const int row = static_cast<int>(i) / image_.cols, col = static_cast<int>(i) % image_.cols;
      for (int r = std::max(row - inwards, top); r < std::min(row + inwards + 1, bottom); ++r)
        for (int c = std::max(col - inwards, left); c < std::min(col + inwards + 1, right); ++c) {
          auto& near = reach[static_cast<std::size_t>((r - top) * width + c - left)];
          const int away = std::max(std::abs(r - row), std::abs(c - col));
          near = std::max<std::uint8_t>(near, static_cast<std::uint8_t>(inwards + 1 - away));
        }
    }
    const auto away = [&](int row, int col) {
      return inwards + 1 - reach[static_cast<std::size_t>((row - top) * width + col - left)];
    };
    for (int row = top; row < bottom; row += stride_)
      for (int col = left; col < right; col += stride_) {
        const std::size_t i = image_.index(row, col);
        const bool inside = labels_[i] == label;
        if (away(row, col) > (inside ? inwards : onwards) || (!inside && !free_at(row, col))) continue;
        const PlaneHeight height = height_over(image_, noise_, plane, i);
        if (height.weight == 0) continue;
        const Sample sample{on_plane(i), height.height_m, height.weight / (excess_ * excess_)};
        (inside ? rim.inside : rim.outside).push_back(sample);
      }
    if (rim.inside.size() < kFewestAlongRim || rim.outside.size() < kFewestAlongRim || !orient(rim, points))
      return {};
    // Beyond the rim, and less than 45 degrees out of the plane.
    std::erase_if(rim.outside, [&](const Sample& sample) {
      const double s = rim.outwards.dot(sample.at - rim.middle);
      return !(s > 0) || std::abs(sample.height_m) > s + kContinuitySigmas / std::sqrt(sample.weight);
    });
    if (rim.outside.size() < kFewestAlongRim) return {};
    const auto start = curve_start(rim);
    std::vector<std::uint32_t> beyond;
    if (!start) return beyond;
    for (int row = top; row < bottom; ++row)
      for (int col = left; col < right; ++col)
        if (const std::size_t i = image_.index(row, col);
            labels_[i] == label && image_.mask[i] == kMeasured && away(row, col) <= inwards &&
            rim.outwards.dot(on_plane(i) - rim.middle) > *start)
          beyond.push_back(static_cast<std::uint32_t>(i));
    return beyond;
  }

  const RangeImage& image_;
  const RangeNoise& noise_;
  double excess_;
  const std::vector<std::uint32_t>& labels_;
  const std::vector<Plane>& planes_;
  const PlaneRegions& regions_;
  int stride_;  // samples
};

// Tiles of `side` rows, and of as many columns more as these lie closer together towards the poles.
std::vector<Tile> rim_tiles(const RangeImage& image, int side) {
  std::vector<Tile> tiles;
  for (int row = 0; row < image.rows; row += side) {
    const int rows = std::min(side, image.rows - row);
    const double cosine = std::cos(image.elevation_rad[static_cast<std::size_t>(row + rows / 2)]);
    const int cols =
        static_cast<int>(std::min(side / std::max(cosine, kLeastElevationCosine), 1.0 * image.cols));
    for (int col = 0; col < image.cols; col += cols)
      tiles.push_back({row, col, rows, std::min(cols, image.cols - col)});
  }
  return tiles;
}

}  // namespace

std::vector<std::uint32_t> trim_tangent_rims(const RangeImage& image, const RangeNoise& noise, double excess,
                                             std::vector<std::uint32_t>& labels,
                                             const std::vector<Plane>& planes, const PlaneRegions& regions,
                                             int square) {
  const double step_rad = image.step_rad();
  const auto dense = static_cast<int>(std::lround(std::min(kStep_rad / step_rad, 1.0 * kMostStride)));
  const int stride = std::clamp(std::max((square + kSquare / 2) / kSquare, dense), 1, kMostStride);
  const RimFinder finder(image, noise, excess, labels, planes, regions, stride);
  const auto wide = static_cast<int>(std::lround(std::min(kTile_rad / step_rad, 1.0 * image.rows)));
  const auto tiles = rim_tiles(image, std::max(kTile * stride, wide));
  std::vector<std::vector<std::vector<std::uint32_t>>> trimmed(tiles.size());
  parallel_for(tiles.size(), [&](std::size_t t) { trimmed[t] = finder.trimmed(tiles[t]); });
  std::vector<std::uint32_t> changed;
  for (const auto& lists : trimmed)
    for (const auto& list : lists)
      for (const std::uint32_t i : list) {
        if (labels[i] == 0) continue;
        if (changed.empty() || changed.back() != labels[i]) changed.push_back(labels[i]);
        labels[i] = 0;
      }
  return changed;
}

}  // namespace hybrid::stages
