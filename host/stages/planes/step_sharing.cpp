#include "stages/planes/step_sharing.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

namespace hybrid::stages {
namespace {

constexpr int kMargin = 12;           // samples around a proposal that are shared out
constexpr double kBorderPrice = 0.8;  // nats per pair of neighbours on different sides
constexpr double kMostNats = 4.5;     // a sample three sigmas off says no more than that
constexpr int kRounds = 4, kSweeps = 6;
// What a part must gain, nats: in all, per sample, and per sample beside the border, where noise makes its
// own parts. Measured on the church: steps 0.9 to 1.7 per sample, noise at most 0.8 with every sample beside
// it.
constexpr double kLeastGain = 12, kGainEach = 0.2, kGainBeside = 0.8;
constexpr double kGainOfRim = 1.5;  // per sample, of curved strips too narrow for a plane
constexpr double kLeastInside = 0.33, kMostStrays = 0.25;  // of its samples
constexpr double kMostOnwards = 0.5;                       // of those beside the border
constexpr double kSharp = 0.65;    // of the step lies within the few samples at the border
constexpr double kLevel = 0.35;    // of the step: plane and part are level to that
constexpr double kMostChi2 = 1.6;  // per sample
// Of a part that a line proposes, per sample of it: before and beyond the line; what one apart from the rest
// gains.
constexpr double kMostBeyondLine = 0.2, kFewestBeforeLine = 0.8, kMostBeforeLine = 1.5;
constexpr double kGainApart = 2;
constexpr std::int64_t kLeastsOfPlane = 6;  // times the least part
constexpr std::int64_t kFewestOfRim = 12;
constexpr int kNear = 3;  // samples from the border
constexpr std::int64_t kFewestNear = 8;
constexpr double kMostStretch = 3;  // of a move along the surface, against the plane's own

}  // namespace

PlaneHeight height_over(const RangeImage& image, const RangeNoise& noise, const Plane& plane, std::size_t i) {
  if (image.mask[i] != kMeasured) return {};
  const Vec3 point = image.point(i);
  const double range = point.norm(), cosine = std::abs(plane.normal.dot(point)) / range;
  const double sigma = noise.at(range, cosine) * cosine;
  if (!(sigma > 0)) return {};
  return {plane.distance(point), 1 / (sigma * sigma)};
}

bool surface_goes_on(const Plane& plane, const Vec3& from, const Vec3& to, double slack_m) {
  const Vec3 move = to - from, along = to * (plane.offset_m / plane.normal.dot(to)) - from;
  const double out = std::abs(plane.normal.dot(move));
  return out <= std::sqrt(std::max(move.squaredNorm() - out * out, 0.0)) + slack_m &&
         move.norm() <= kMostStretch * along.norm() + slack_m;
}

StepSharing::StepSharing(const RangeImage& image, const RangeNoise& noise,
                         const std::vector<std::uint32_t>& labels, const Plane& plane,
                         const StepProposal& proposal, double excess)
    : image_(image),
      plane_(plane),
      border_(proposal.border),
      top_(std::max(proposal.top - kMargin, 0)),
      left_(std::max(proposal.left - kMargin, 0)),
      width_(std::min(proposal.right + kMargin, image.cols) - left_ + 2),
      proposed_(proposal.mean.count),
      sigma_m_(std::sqrt(static_cast<double>(proposal.mean.count) / proposal.mean.weight)),
      model_(0, 0, 0, proposal.mean.value_m()) {
  beside_ = {-width_ - 1, -width_, -width_ + 1, -1, 1, width_ - 1, width_, width_ + 1};
  const int rows = std::min(proposal.bottom + kMargin, image.rows) - top_;
  samples_.resize(static_cast<std::size_t>(rows + 2) * static_cast<std::size_t>(width_));
  sides_.assign(samples_.size(), kStranger);
  unsettled_.resize(samples_.size());
  favours_.resize(samples_.size());
  const Vec3 u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
  std::optional<Vec3> origin;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < width_ - 2; ++col) {
      const std::size_t i = image.index(top_ + row, left_ + col);
      if (labels[i] != proposal.label) continue;
      const auto at = static_cast<std::uint32_t>((row + 1) * width_ + col + 1);
      own_.push_back(at);
      Sample& sample = samples_[at];
      sides_[at] = kPlane;
      const PlaneHeight height = height_over(image, noise, plane, i);
      if (height.weight == 0) continue;
      const Vec3 point = image.point(i);
      if (!origin) origin = point;
      sample.height_m = static_cast<float>(height.height_m);
      sample.weight = static_cast<float>(height.weight / (excess * excess));
      sample.u_m = static_cast<float>(u.dot(point - *origin));
      sample.v_m = static_cast<float>(v.dot(point - *origin));
    }
}

StepVerdict StepSharing::share(const std::function<bool(std::size_t)>& is_free, std::int64_t least) {
  if (border_ && !start_by_border(*border_)) return StepVerdict::none;
  for (int round = 0; round < kRounds; ++round) {
    start_by_windows();
    for (int sweep = 0; sweep < kSweeps && settle(); ++sweep) {
    }
    if (!fit(kFewestOfRim)) return StepVerdict::none;
    // Most proposals are noise, and far from what a part must gain.
    const Evidence so_far = weigh();
    if (so_far.gain < kLeastGain / 2 + kGainEach * static_cast<double>(so_far.part.count))
      return StepVerdict::none;
  }
  measure_rings();
  const Evidence evidence = weigh();
  height_ = evidence.part;
  const auto count = static_cast<double>(evidence.part.count), beside = static_cast<double>(evidence.beside);
  const bool stands_out = static_cast<double>(evidence.strays) <= kMostStrays * count &&
                          evidence.gain >= kLeastGain + kGainEach * count + kGainBeside * beside;
  const bool broad =
      2 * proposed_ >= least && evidence.part.count >= least && count - beside >= kLeastInside * count;
  if (border_)
    return stands_out && along_border(*border_, evidence, least) ? StepVerdict::step : StepVerdict::none;
  if (!stands_out || !(broad || evidence.gain >= kGainOfRim * count)) return StepVerdict::none;
  if (static_cast<double>(smooth_rim(is_free)) > kMostOnwards * beside) return StepVerdict::curved;
  return broad && is_sharp(evidence) ? StepVerdict::step : StepVerdict::none;
}

// Log of how much likelier the part makes the sample than the plane.
double StepSharing::favour(const Sample& sample) const {
  const double over = over_plane(sample), off = over - step_m();
  return std::min(sample.weight * over * over / 2, kMostNats) -
         std::min(sample.weight * off * off / 2, kMostNats);
}

// Neither makes it likely: it says nothing of them.
bool StepSharing::is_stray(const Sample& sample) const {
  const double over = over_plane(sample), off = over - step_m();
  return sample.weight * std::min(over * over, off * off) / 2 > kMostNats;
}

void StepSharing::start_by_windows() {
  for (const std::uint32_t at : own_) favours_[at] = favour(samples_[at]);
  for (const std::uint32_t at : own_) {
    double sum = favours_[at];
    for (std::size_t k = 0; k < beside_.size(); ++k) sum += favours_[neighbour(at, k)];
    sides_[at] = sum > 0 ? kPart : kPlane;
    unsettled_[at] = 1;
  }
}

// What lies before the border is the part. False when no model comes of it.
bool StepSharing::start_by_border(const Plane& border) {
  for (const std::uint32_t at : own_)
    sides_[at] = border.distance(image_.point(node_of(at))) > 0 ? kPart : kPlane;
  return fit(kFewestOfRim);
}

// False when nothing changed sides.
bool StepSharing::settle() {
  // What a neighbour of each side adds for the part.
  constexpr double kDiagonal = kBorderPrice / std::numbers::sqrt2;
  constexpr std::array<double, 3> kBeside = {0, -kBorderPrice, kBorderPrice},
                                  kAcross = {0, -kDiagonal, kDiagonal};
  bool changed = false;
  for (const std::uint32_t at : own_) {
    if (!std::exchange(unsettled_[at], std::uint8_t{0})) continue;
    const auto side_of = [&](std::size_t k) { return sides_[neighbour(at, k)]; };
    double gain = favours_[at];
    gain += kAcross[side_of(0)];
    gain += kBeside[side_of(1)];
    gain += kAcross[side_of(2)];
    gain += kBeside[side_of(3)];
    gain += kBeside[side_of(4)];
    gain += kAcross[side_of(5)];
    gain += kBeside[side_of(6)];
    gain += kAcross[side_of(7)];
    const Side side = gain > 0 ? kPart : kPlane;
    if (side == sides_[at]) continue;
    changed = true;
    sides_[at] = side;
    for (std::size_t k = 0; k < beside_.size(); ++k) unsettled_[neighbour(at, k)] = 1;
  }
  return changed;
}

// False when too few samples make a part, or they fix no model.
bool StepSharing::fit(std::int64_t least) {
  // Sums of weights times products of u and v, and times the heights: of all, and of the part.
  double all = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, h = 0, hu = 0, hv = 0;
  double part = 0, part_u = 0, part_v = 0, part_h = 0;
  std::int64_t count = 0;
  for (const std::uint32_t at : own_) {
    const Sample& s = samples_[at];
    if (s.weight == 0 || is_stray(s)) continue;
    const double w = s.weight, wu = w * s.u_m, wv = w * s.v_m, wh = w * s.height_m;
    all += w;
    u += wu;
    v += wv;
    uu += wu * s.u_m;
    uv += wu * s.v_m;
    vv += wv * s.v_m;
    h += wh;
    hu += wh * s.u_m;
    hv += wh * s.v_m;
    if (sides_[at] != kPart) continue;
    part += w;
    part_u += wu;
    part_v += wv;
    part_h += wh;
    count += 1;
  }
  if (count < least) return false;
  Eigen::Matrix4d matrix;
  matrix << all, u, v, part,  //
      u, uu, uv, part_u,      //
      v, uv, vv, part_v,      //
      part, part_u, part_v, part;
  const Eigen::LDLT<Eigen::Matrix4d> solver(matrix);
  const Eigen::Vector4d model = solver.solve(Eigen::Vector4d(h, hu, hv, part_h));
  if (solver.info() != Eigen::Success || !model.allFinite() || model[3] == 0) return false;
  model_ = model;
  return true;
}

void StepSharing::measure_rings() {
  for (int ring = 1; ring <= kNear; ++ring)
    for (const std::uint32_t at : own_) {
      Sample& sample = samples_[at];
      if (sample.ring != 0) continue;
      bool touches = false;
      for (std::size_t k = 0; k < beside_.size(); ++k) {
        const std::uint32_t place = neighbour(at, k);
        if (sides_[place] == kStranger) continue;
        touches = touches || (ring == 1 ? sides_[place] != sides_[at]
                                        : sides_[place] == sides_[at] && samples_[place].ring == ring - 1);
      }
      if (touches) sample.ring = static_cast<std::uint8_t>(ring);
    }
}

StepSharing::Evidence StepSharing::weigh() const {
  Evidence evidence;
  for (const std::uint32_t at : own_) {
    const Sample& s = samples_[at];
    if (s.weight == 0) continue;
    const bool is_part = sides_[at] == kPart;
    if (is_stray(s)) {
      evidence.strays += is_part;
      continue;
    }
    const PlaneHeight over{over_plane(s), s.weight};
    if (is_part) {
      evidence.part.add(PlaneHeight{s.height_m, s.weight});
      evidence.gain += favour(s);
      const double off = over.height_m - step_m();
      evidence.chi2 += s.weight * off * off;
      evidence.beside += s.ring == 1;
    }
    // Beside the border samples were shared out by their own noise: they say more of it than of the step.
    if (s.ring > 1) (is_part ? evidence.inside : evidence.outside).add(over);
    if (is_part && s.ring == 0) evidence.deep.add(over);
  }
  return evidence;
}

bool StepSharing::is_sharp(const Evidence& evidence) const {
  const double level = kLevel * std::abs(step_m());
  return evidence.chi2 <= kMostChi2 * static_cast<double>(evidence.part.count) &&
         evidence.inside.count >= kFewestNear && evidence.outside.count >= kFewestNear &&
         (evidence.inside.value_m() - evidence.outside.value_m()) / step_m() >= kSharp &&
         std::abs(evidence.outside.value_m()) <= level &&
         (evidence.deep.count < std::max(kFewestNear, evidence.part.count / 8) ||
          std::abs(evidence.deep.value_m() - step_m()) <= level);
}

// What a line proposed has to prove more: noise makes parts, too, and of the thousands of lines across a
// plane one is near them.
bool StepSharing::along_border(const Plane& border, const Evidence& evidence, std::int64_t least) const {
  std::int64_t before = 0, beyond = 0;  // samples before the border; of the part beyond it
  for (const std::uint32_t at : own_) {
    const bool is_before = border.distance(image_.point(node_of(at))) > 0;
    before += is_before;
    beyond += !is_before && sides_[at] == kPart;
  }
  const auto count = static_cast<double>(evidence.part.count), beside = static_cast<double>(evidence.beside);
  const auto share = [&](std::int64_t some) { return static_cast<double>(some) / count; };
  if (evidence.part.count < least || share(beyond) > kMostBeyondLine || share(before) < kFewestBeforeLine ||
      share(before) > kMostBeforeLine || evidence.chi2 > kMostChi2 * count)
    return false;
  if (std::min(evidence.inside.count, evidence.outside.count) < kFewestNear)
    return evidence.gain >= kGainApart * count;
  return std::ssize(own_) >= kLeastsOfPlane * least && count - beside >= kLeastInside * count &&
         is_sharp(evidence);
}

// Samples of the part from which it goes on so for two samples, the first of which may be a noisy step away.
std::int64_t StepSharing::smooth_rim(const std::function<bool(std::size_t)>& is_free) const {
  std::int64_t rim = 0;
  for_each_of_part([&](std::size_t i) {
    const int row = static_cast<int>(i) / image_.cols, col = static_cast<int>(i) % image_.cols;
    const auto beyond = [&](int down, int right) {
      const int r = row + 2 * down, c = col + 2 * right;
      if (r < 0 || r >= image_.rows || c < 0 || c >= image_.cols) return false;
      const std::size_t first = image_.index(row + down, col + right), second = image_.index(r, c);
      return is_free(first) && is_free(second) &&
             surface_goes_on(plane_, image_.point(i), image_.point(first), kContinuitySigmas * sigma_m_) &&
             surface_goes_on(plane_, image_.point(first), image_.point(second), 0);
    };
    rim += beyond(1, 0) || beyond(-1, 0) || beyond(0, 1) || beyond(0, -1);
  });
  return rim;
}

}  // namespace hybrid::stages
