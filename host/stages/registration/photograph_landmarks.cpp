#include "stages/registration/photograph_landmarks.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/error.hpp"
#include "stages/registration/landmarks.hpp"

namespace hybrid::stages {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Rays that meet under less tell nothing of how far away.
constexpr double kLeastParallaxDeg = 0.5;
// A pick that misses the others' fit by less may be a good one, made by hand.
constexpr double kHandError_px = 5, kHandError_m = 0.05;
// Picks that agree no better than both do not belong together.
constexpr double kFarApart_m = 0.25, kFarApartShare = 0.05;

using Row7 = Eigen::Matrix<double, 3, 7>;
using Sums7 = Eigen::Matrix<double, 7, 7>;
using Vec7 = Eigen::Matrix<double, 7, 1>;

// A pick in the cameras' frame.
struct PickSight {
  Vec3 origin;  // the camera's centre, or the point itself
  std::optional<Vec3> direction;
  double focal_px = 0;
  Vec3 world;  // its point of the model
};

PickSight sight_of(const PhotographPick& pick, const std::vector<Photograph>& photographs,
                   const Vec3& world) {
  if (!pick.photograph) return {pick.point, std::nullopt, 0, world};
  const Photograph& photograph = photographs[*pick.photograph];
  const Camera& camera = photograph.camera;
  if (!pick.pixel) return {photograph.centre(), std::nullopt, 0, world};
  const auto at = [&] {
    return fmt::format("pixel [{:g}, {:g}]", pick.pixel->y() - 0.5, pick.pixel->x() - 0.5);
  };
  if (!(pick.pixel->x() >= 0 && pick.pixel->y() >= 0 && pick.pixel->x() <= camera.width &&
        pick.pixel->y() <= camera.height))
    fail_input("{}: {}: expected a row and a column of photograph {}, which has {} rows and {} columns",
               pick.name, at(), photograph.name, camera.height, camera.width);
  const Vec3 ray = camera.ray(*pick.pixel);
  if (!ray.allFinite())
    fail_input("{}: {}: there the distortion of photograph {}'s camera folds back; pick nearer to its middle",
               pick.name, at(), photograph.name);
  const Vec3 direction = photograph.cam_from_world.rotation.conjugate() * ray;
  return {photograph.centre(), direction.normalized(), std::sqrt(camera.fx * camera.fy), world};
}

// The point with the least squared distances from the rays; nothing where they are parallel.
std::optional<Vec3> meeting_point(const std::vector<const PickSight*>& rays) {
  Mat3 sum = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  double least_cosine = 1;
  for (const PickSight* ray : rays) {
    const Mat3 across = Mat3::Identity() - *ray->direction * ray->direction->transpose();
    sum += across;
    right += across * (ray->origin - rays.front()->origin);
    least_cosine = std::min(least_cosine, ray->direction->dot(*rays.front()->direction));
  }
  if (least_cosine > std::cos(kLeastParallaxDeg * M_PI / 180)) return std::nullopt;
  return rays.front()->origin + sum.ldlt().solve(right);
}

// Pairs of points in the cameras' frame and in the world: of pixels, one for each point of the model.
struct Pairs {
  std::vector<Vec3> from, to;
  std::vector<std::string> names;
  std::size_t alone = 0;  // points of the model that photographs show from one direction only
};

Pairs pairs_of(const std::vector<PhotographPick>& picks, const std::vector<PickSight>& sights) {
  std::map<std::array<double, 3>, std::size_t>
      numbers;  // of the model's points in order of their first picks
  std::vector<std::vector<std::size_t>> groups;
  Pairs pairs;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Vec3& at = sights[i].world;
    if (!sights[i].direction) {
      pairs.from.push_back(sights[i].origin);
      pairs.to.push_back(at);
      pairs.names.push_back(picks[i].name);
      continue;
    }
    const auto [found, is_new] = numbers.try_emplace({at.x(), at.y(), at.z()}, groups.size());
    if (is_new) groups.emplace_back();
    groups[found->second].push_back(i);
  }
  for (const auto& group : groups) {
    std::vector<const PickSight*> rays;
    for (const std::size_t i : group) rays.push_back(&sights[i]);
    const auto point = meeting_point(rays);
    pairs.alone += !point;
    if (!point) continue;
    pairs.from.push_back(*point);
    pairs.to.push_back(rays.front()->world);
    pairs.names.push_back(picks[group.front()].name);
  }
  return pairs;
}

// From the model's point to the ray, or point, in metres.
double miss_m(const PickSight& sight, const Pose& world_from_photographs) {
  const Vec3 to = sight.world - world_from_photographs * sight.origin;
  if (!sight.direction) return to.norm();
  const Vec3 ray = world_from_photographs.rotation * *sight.direction;
  return to.dot(ray) > 0 ? to.cross(ray).norm() : to.norm();
}

double miss_px(const PickSight& sight, const Pose& world_from_photographs) {
  if (!sight.direction) return kNan;
  const Vec3 ray = world_from_photographs.rotation * *sight.direction;
  const Vec3 to = sight.world - world_from_photographs * sight.origin;
  return sight.focal_px * std::atan2(to.cross(ray).norm(), to.dot(ray));
}

// The model's points in the cameras' frame about their middle; what is refined is a similarity of these.
struct Unknowns {
  std::vector<Vec3> about;
  Vec3 middle = Vec3::Zero();

  Unknowns moved(const Vec7& step) const {
    const Vec3 turn = step.head<3>();
    const double angle = turn.norm();
    const Eigen::Quaterniond rotation = angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle))
                                                  : Eigen::Quaterniond::Identity();
    Unknowns result = *this;
    for (Vec3& point : result.about) point = std::exp(step[3]) * (rotation * point);
    result.middle += step.tail<3>();
    return result;
  }
};

// Of the chords between the directions in which points are seen and lie, times focal lengths.
double square_sum(const std::vector<PickSight>& sights, const Unknowns& at, Sums7* normal = nullptr,
                  Vec7* right = nullptr) {
  double sum = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Vec3 to = at.middle + at.about[i] - sights[i].origin;
    const double distance = to.norm();
    if (!(distance > 0)) return std::numeric_limits<double>::infinity();
    const Vec3 seen = to / distance;
    const Vec3 miss = sights[i].focal_px * (seen - *sights[i].direction);
    sum += miss.squaredNorm();
    if (normal == nullptr) continue;
    Row7 slope;
    slope.block<3, 3>(0, 0) << 0, at.about[i].z(), -at.about[i].y(), -at.about[i].z(), 0, at.about[i].x(),
        at.about[i].y(), -at.about[i].x(), 0;
    slope.col(3) = at.about[i];
    slope.block<3, 3>(0, 4) = Mat3::Identity();
    slope = (sights[i].focal_px / distance * (Mat3::Identity() - seen * seen.transpose()) * slope).eval();
    *normal += slope.transpose() * slope;
    *right -= slope.transpose() * miss;
  }
  return sum;
}

Pose refined(const std::vector<PickSight>& sights, const Pose& start) {
  const Pose photographs_from_world = start.inverse();
  Unknowns at;
  std::vector<Vec3> world;
  for (const PickSight& sight : sights) {
    at.about.push_back(photographs_from_world * sight.world);
    at.middle += at.about.back() / static_cast<double>(sights.size());
    world.push_back(sight.world);
  }
  for (Vec3& point : at.about) point -= at.middle;
  constexpr int kMostSteps = 200;
  double damping = 1e-4, sum = square_sum(sights, at);
  for (int step = 0; step < kMostSteps && damping < 1e12; ++step) {
    Sums7 normal = Sums7::Zero();
    Vec7 right = Vec7::Zero();
    square_sum(sights, at, &normal, &right);
    normal.diagonal() *= 1 + damping;
    const Vec7 move = normal.ldlt().solve(right);
    const Unknowns next = at.moved(move);
    const double now = square_sum(sights, next);
    if (!(now < sum)) {
      damping *= 10;
      continue;
    }
    const bool done = sum - now <= 1e-12 * sum;
    at = next, sum = now, damping /= 10;
    if (done) break;
  }
  std::vector<Vec3> seen;
  for (const Vec3& point : at.about) seen.push_back(at.middle + point);
  return horn(seen, world, {}, true);
}

bool all_pixels(const std::vector<PickSight>& sights) {
  return std::all_of(sights.begin(), sights.end(), [](const PickSight& sight) { return sight.direction; });
}

// Nothing where the picks do not fix it.
std::optional<Pose> placed_by(const std::vector<PhotographPick>& picks,
                              const std::vector<PickSight>& sights) {
  const Pairs pairs = pairs_of(picks, sights);
  if (pairs.from.size() < 3 || !fix_rotation(pairs.from) || !fix_rotation(pairs.to)) return std::nullopt;
  const Pose start = horn(pairs.from, pairs.to, {}, true);
  return all_pixels(sights) ? refined(sights, start) : start;
}

void check_enough(const PolygonModel& model, const Pairs& pairs) {
  if (pairs.from.size() < 3)
    fail_input(
        "expected at least 3 points (4 are better) of the model, each in two or more photographs that show "
        "it "
        "from different directions, or as a camera position or point, found {}{}; pick them in further "
        "photographs",
        pairs.from.size(),
        pairs.alone > 0 ? fmt::format(" and {} seen from one direction only", pairs.alone) : "");
  std::vector<LandmarkPair> checked;
  for (std::size_t i = 0; i < pairs.from.size(); ++i)
    checked.push_back({pairs.names[i], pairs.from[i], pairs.to[i], false});
  LandmarkOptions options;
  options.free_scale = true;
  options.frame = "cameras' frame";
  fit_landmarks(model, checked, options);  // throws
}

double rms_without(const std::vector<double>& misses, std::optional<std::size_t> left_out) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < misses.size(); ++i)
    if (i != left_out) sum += misses[i] * misses[i], ++count;
  return std::sqrt(sum / count);
}

template <typename T>
std::vector<T> without(std::vector<T> all, std::size_t one) {
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(one));
  return all;
}

// Root of the mean square distance of the picks' points from their middle.
double extent_m(const std::vector<PickSight>& sights) {
  Vec3 middle = Vec3::Zero();
  for (const PickSight& sight : sights) middle += sight.world / static_cast<double>(sights.size());
  double sum = 0;
  for (const PickSight& sight : sights) sum += (sight.world - middle).squaredNorm();
  return std::sqrt(sum / static_cast<double>(sights.size()));
}

class PickFit {
 public:
  PickFit(const std::vector<PhotographPick>& picks, const std::vector<PickSight>& sights)
      : picks_(picks), sights_(sights), in_px_(all_pixels(sights)) {}

  PhotographFit solve(const Pose& of_all) {
    PhotographFit fit;
    fit.world_from_photographs = of_all;
    leave_out(fit);
    for (const PickSight& sight : sights_) {
      fit.residual_m.push_back(miss_m(sight, fit.world_from_photographs));
      fit.residual_px.push_back(miss_px(sight, fit.world_from_photographs));
    }
    fit.rms_m = rms_without(fit.residual_m, fit.left_out);
    const double most_m = std::max(kFarApart_m, kFarApartShare * extent_m(sights_));
    if (fit.rms_m > most_m)
      fail_input(
          "the picks do not belong together: rms {:.2f} m, at most {:.2f} m may be: {}; check which points "
          "were picked",
          fit.rms_m, most_m, worst(fit));
    return fit;
  }

 private:
  double miss(const PickSight& sight, const Pose& pose) const {
    return in_px_ ? miss_px(sight, pose) : miss_m(sight, pose);
  }

  // In pixels, or metres.
  void leave_out(PhotographFit& fit) const {
    LandmarkFit each;
    std::vector<std::optional<Pose>> others_pose;
    for (std::size_t i = 0; i < sights_.size(); ++i) {
      const auto others = without(sights_, i);
      others_pose.push_back(placed_by(without(picks_, i), others));
      const Pose pose = others_pose[i].value_or(Pose());
      std::vector<double> misses;
      for (const PickSight& sight : others) misses.push_back(miss(sight, pose));
      each.residual_m.push_back(miss(sights_[i], fit.world_from_photographs));
      each.leave_one_out_m.push_back(others_pose[i] ? miss(sights_[i], pose) : kNan);
      each.rms_without_m.push_back(others_pose[i] ? rms_without(misses, std::nullopt) : kNan);
    }
    const auto pick = outlying_pick(each);
    if (!pick) return;
    // As of scans' landmarks: the residual is the miss times 1 less the pick's leverage.
    const double missed = each.leave_one_out_m[*pick];
    if (std::sqrt(each.residual_m[*pick] * missed) < (in_px_ ? kHandError_px : kHandError_m)) return;
    fit.left_out = *pick;
    fit.world_from_photographs = *others_pose[*pick];
    const char* unit = in_px_ ? "pixels" : "m";
    fit.warning = fmt::format(
        "{} is left out of the fit: it misses the fit of the others by {:.3g} {}, and these agree within "
        "{:.3g} "
        "{}; pick that point again",
        picks_[*pick].name, missed, unit, each.rms_without_m[*pick], unit);
  }

  // The picks that fit worst.
  std::string worst(const PhotographFit& fit) const {
    constexpr std::size_t kMost = 5;
    std::vector<std::size_t> order(picks_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return fit.residual_m[a] > fit.residual_m[b]; });
    std::string text;
    for (std::size_t k = 0; k < std::min(kMost, order.size()); ++k)
      text += fmt::format("{}{} {:.2f} m", k ? ", " : "", picks_[order[k]].name, fit.residual_m[order[k]]);
    return text + (order.size() > kMost ? ", the others less" : "");
  }

  const std::vector<PhotographPick>& picks_;
  const std::vector<PickSight>& sights_;
  const bool in_px_;
};

}  // namespace

PhotographFit fit_photographs(const PolygonModel& model, const std::vector<Photograph>& photographs,
                              const std::vector<PhotographPick>& picks, double snap_tolerance_m) {
  std::vector<LandmarkPair> pairs;
  for (const PhotographPick& pick : picks)
    pairs.push_back({pick.name, pick.point, pick.point_in_model, pick.snap});
  pairs = snap_landmarks(model, pairs, snap_tolerance_m);
  std::vector<PickSight> sights;
  for (std::size_t i = 0; i < picks.size(); ++i)
    sights.push_back(sight_of(picks[i], photographs, pairs[i].point_in_model));
  const auto pose = placed_by(picks, sights);
  if (!pose) {
    check_enough(model, pairs_of(picks, sights));
    fail_input("the picks do not fix where the cameras' frame lies");
  }
  return PickFit(picks, sights).solve(*pose);
}

}  // namespace hybrid::stages
