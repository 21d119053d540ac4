#include "stages/planes/step_lines.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <optional>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr std::int64_t kMostForLines = 8000;  // of a larger plane windows tell
constexpr std::int64_t kSparsest = 100;  // samples of the image to one of the plane: across the seam, say
constexpr int kDirections = 60;
constexpr std::size_t kBins = 128;     // across a plane
constexpr double kLeastLineGain = 16;  // nats: thousands of lines are tried
constexpr double kMostStray = 16;      // chi square of a sample that takes part
constexpr double kLeastOfSide = 0.5;   // of the least part's samples

// A sample of a plane, in coordinates along it.
struct Height {
  double u_m, v_m, over_m, weight;
  std::uint32_t node;
};

// Weighted sums over samples: of 1, u and v, and of what is left of the heights.
struct SideSums {
  Vec3 ones = Vec3::Zero();
  double rest = 0;
  std::int64_t count = 0;

  void add(const SideSums& other) {
    ones += other.ones;
    rest += other.rest;
    count += other.count;
  }
};

class LineSearch {
 public:
  LineSearch(const RangeImage& image, const RangeNoise& noise, const std::vector<std::uint32_t>& labels,
             const Plane& plane, const PlaneExtent& extent, double excess)
      : image_(image), plane_(plane), label_(extent.label) {
    u_ = plane.normal.unitOrthogonal();
    v_ = plane.normal.cross(u_);
    for (int row = extent.top; row < std::min(extent.bottom, image.rows); ++row)
      for (int col = extent.left; col < std::min(extent.right, image.cols); ++col) {
        const std::size_t i = image.index(row, col);
        if (labels[i] != label_) continue;
        const PlaneHeight height = height_over(image, noise, plane, i);
        if (height.weight == 0) continue;
        const Vec3 point = image.point(i);
        if (heights_.empty()) origin_ = point;
        heights_.push_back({u_.dot(point - origin_), v_.dot(point - origin_), height.height_m,
                            height.weight / (excess * excess), static_cast<std::uint32_t>(i)});
      }
  }

  std::optional<StepProposal> propose(std::int64_t least) {
    if (!level()) return {};
    double most = kLeastLineGain;
    std::optional<Plane> border;
    for (int k = 0; k < kDirections; ++k) {
      const double turn = std::numbers::pi * k / kDirections;
      search(std::cos(turn), std::sin(turn), least, most, border);
    }
    if (!border || gain_of_bend(border->normal) >= most) return {};
    return proposal(*border);
  }

 private:
  // Takes level and slopes off the heights. False when the samples fix none.
  bool level() {
    Vec3 right = Vec3::Zero();
    for (const Height& s : heights_) {
      const Vec3 ones(1, s.u_m, s.v_m);
      matrix_ += s.weight * ones * ones.transpose();
      right += s.weight * s.over_m * ones;
    }
    solver_.compute(matrix_);
    const Vec3 model = solver_.solve(right);
    if (solver_.info() != Eigen::Success || !model.allFinite()) return false;
    for (Height& s : heights_) s.over_m -= model.dot(Vec3(1, s.u_m, s.v_m));
    std::erase_if(heights_, [](const Height& s) { return s.weight * s.over_m * s.over_m > kMostStray; });
    return true;
  }

  // Of the lines across (du, dv) the one that gains more than `most`.
  void search(double du, double dv, std::int64_t least, double& most, std::optional<Plane>& border) const {
    double low = std::numeric_limits<double>::max(), high = -low;
    for (const Height& s : heights_) {
      const double along = du * s.u_m + dv * s.v_m;
      low = std::min(low, along);
      high = std::max(high, along);
    }
    if (!(high > low)) return;
    std::array<SideSums, kBins> bins{};
    SideSums all;
    for (const Height& s : heights_) {
      const double share = (du * s.u_m + dv * s.v_m - low) / (high - low);
      SideSums& bin = bins[std::min(static_cast<std::size_t>(share * kBins), kBins - 1)];
      bin.ones += s.weight * Vec3(1, s.u_m, s.v_m);
      bin.rest += s.weight * s.over_m;
      bin.count += 1;
    }
    for (const SideSums& bin : bins) all.add(bin);
    const auto fewest = static_cast<std::int64_t>(kLeastOfSide * static_cast<double>(least));
    SideSums before;
    for (std::size_t k = 0; k + 1 < kBins; ++k) {
      before.add(bins[k]);
      if (before.count < fewest || all.count - before.count < fewest) continue;
      // What of the step level and slopes do not explain.
      const double own = before.ones.x() - before.ones.dot(solver_.solve(before.ones));
      if (!(own > 1e-9 * before.ones.x())) continue;
      const double gain = before.rest * before.rest / own / 2;
      if (gain <= most) continue;
      most = gain;
      const double at = low + (high - low) * static_cast<double>(k + 1) / kBins;
      const double sign = 2 * before.count > all.count ? 1 : -1;
      const Vec3 across = sign * (du * u_ + dv * v_);
      border = Plane{across, across.dot(origin_) + sign * at};
    }
  }

  // What a bend along a direction gains instead of a step: a quadratic term.
  double gain_of_bend(const Vec3& along) const {
    const double du = along.dot(u_), dv = along.dot(v_);
    Vec3 ones = Vec3::Zero();
    double own = 0, rest = 0;
    for (const Height& s : heights_) {
      const double way = du * s.u_m + dv * s.v_m, square = way * way;
      ones += s.weight * square * Vec3(1, s.u_m, s.v_m);
      own += s.weight * square * square;
      rest += s.weight * square * s.over_m;
    }
    own -= ones.dot(solver_.solve(ones));
    return own > 0 ? rest * rest / own / 2 : 0;
  }

  StepProposal proposal(const Plane& border) const {
    StepProposal found{label_, {}, image_.rows, image_.cols, 0, 0, border};
    for (const Height& s : heights_) {
      const Vec3 point = image_.point(s.node);
      const int row = static_cast<int>(s.node) / image_.cols, col = static_cast<int>(s.node) % image_.cols;
      if (border.distance(point) > 0) found.mean.add(PlaneHeight{plane_.distance(point), s.weight});
      found.top = std::min(found.top, row);
      found.left = std::min(found.left, col);
      found.bottom = std::max(found.bottom, row + 1);
      found.right = std::max(found.right, col + 1);
    }
    return found;
  }

  const RangeImage& image_;
  const Plane& plane_;
  std::uint32_t label_;
  Vec3 u_, v_, origin_ = Vec3::Zero();
  std::vector<Height> heights_;
  Mat3 matrix_ = Mat3::Zero();
  Eigen::LDLT<Mat3> solver_;
};

}  // namespace

std::vector<StepProposal> propose_by_lines(const RangeImage& image, const RangeNoise& noise,
                                           const std::vector<std::uint32_t>& labels,
                                           const std::vector<Plane>& plane_of_label,
                                           const std::vector<PlaneExtent>& extents, double excess,
                                           std::int64_t least) {
  std::vector<std::optional<StepProposal>> of_plane(extents.size());
  parallel_for(extents.size(), [&](std::size_t k) {
    const PlaneExtent& extent = extents[k];
    const auto box = std::int64_t{extent.bottom - extent.top} * (extent.right - extent.left);
    if (extent.samples < least || extent.samples > kMostForLines || box > kSparsest * extent.samples) return;
    of_plane[k] =
        LineSearch(image, noise, labels, plane_of_label[extent.label - 1], extent, excess).propose(least);
  });
  std::vector<StepProposal> proposals;
  for (const auto& proposal : of_plane)
    if (proposal) proposals.push_back(*proposal);
  return proposals;
}

}  // namespace hybrid::stages
