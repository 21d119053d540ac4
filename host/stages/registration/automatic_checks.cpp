#include "stages/registration/automatic_checks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybrid::stages {
namespace {

// Sine of the angle that normals must at least span in every direction.
constexpr double kSpan = 0.1;
constexpr double kNothing = 10;  // so many times as much off the faces as on them: nothing to speak of is on

// Planes beyond the least. Up to kFew they must fit better, within kBetter tolerances and kMostTurned_rad:
// corners off by a centimetre turn a wall of some metres by less, another room's oblique walls are seldom as
// near. From kMany they may be off.
constexpr double kFew = 1, kBetter = 0.7, kMany = 3;
constexpr double kMostTurned_rad = 0.5 * std::numbers::pi / 180;
// The better all fit the more doubt there may be: as shares of their limits no more than this in sum.
constexpr double kTogether = 2, kTogetherOfFew = 1.2;

// Landmarks are corners of a model: between scans there are none, and who asks says what to do.
const char* remedy(const AutomaticOptions& options) {
  return options.of_scan ? "" : "; give 3 or more landmarks (the landmark sheet helps) or a pose";
}

const char* other_side(const AutomaticOptions& options) {
  return options.of_scan ? "other scan" : "model";
}

// Asks of what does not fit.
const char* is_it(const AutomaticOptions& options) {
  return options.of_scan ? "is it of another place" : "is it the model of another place";
}

// Least singular direction of unit normals: near 0 when they all lie in one plane, as those of a corridor
// without ends do.
template <typename T>
double span_of(const std::vector<T>& planes) {
  Mat3 sum = Mat3::Zero();
  for (const T& plane : planes) sum += plane.plane.normal * plane.plane.normal.transpose();
  return std::sqrt(std::max(Eigen::SelfAdjointEigenSolver<Mat3>(sum).eigenvalues()(0), 0.0));
}

template <typename T>
bool all_parallel(const std::vector<T>& planes) {
  return std::all_of(planes.begin(), planes.end(), [&](const T& plane) {
    return std::abs(plane.plane.normal.dot(planes[0].plane.normal)) > std::cos(kSpan);
  });
}

template <typename T>
std::string lacking(const std::vector<T>& planes, const char* whose, const char* what_to_do) {
  if (planes.size() < 3)
    return fmt::format("automatic alignment needs at least 3 planes, the {} has {}{}", whose, planes.size(),
                       what_to_do);
  if (all_parallel(planes))
    return fmt::format(
        "automatic alignment needs planes in three directions, those of the {} are all parallel{}", whose,
        what_to_do);
  if (span_of(planes) < kSpan)
    return fmt::format(
        "automatic alignment needs planes in three directions, those of the {} leave one open: it could "
        "slide "
        "along them{}",
        whose, what_to_do);
  return "";
}

}  // namespace

std::string unsuitable(const ScanEvidence& scan, const ModelShapes& model, const AutomaticOptions& options) {
  if (std::string words = lacking(scan.planes, "scan", remedy(options)); !words.empty()) return words;
  if (!model.has_large_faces())
    return fmt::format(
        "automatic alignment needs a model of large faces: this one is a mesh of {}, of which the largest {} "
        "are {:.0f} % of the area{}",
        model.all_faces, model.faces.size(), 100 * model.kept_area_m2 / model.area_m2, remedy(options));
  if (std::string words = lacking(model.planes, other_side(options), remedy(options)); !words.empty())
    return words;
  if (options.free_scale && !options.of_scan)
    return "automatic alignment with a free scale is not offered: three planes fix a rigid pose only; give "
           "the model's unit and scale = \"fixed\", or 3 or more landmarks";
  const std::string words = odd_size(scan, model, 1, kSizeRatio);
  if (words.empty() || !options.of_scan) return words;
  return fmt::format(
      "the other scan's planes are {:.3g} m across, this one's {:.3g} m: is one in millimetres?{}",
      model.box.diagonal().norm(), 2 * scan.reach_m, remedy(options));
}

std::string odd_size(const ScanEvidence& scan, const ModelShapes& model, double scale, double ratio) {
  const double model_m = model.box.diagonal().norm(), scan_m = 2 * scale * scan.reach_m;
  if (model_m > ratio * scan_m)
    return fmt::format(
        "the model is {:.0f} m across, the scan's planes {:.1f} m: is the model in millimetres? Then say "
        "unit "
        "= \"mm\" in [model]",
        model_m, scan_m);
  if (scan_m > ratio * model_m)
    return fmt::format(
        "the model is {:.3f} m across, the scan's planes {:.1f} m: is the scan in millimetres, or [model] "
        "unit wrong?",
        model_m, scan_m);
  return "";
}

std::string nothing_fits(const AutomaticOptions& options) {
  return fmt::format("no pose lays the scan's planes on those of the {}; is it of another place?{}",
                     other_side(options), remedy(options));
}

std::string doubts(const TileFit& fit, const AutomaticAlignment& best, const AutomaticOptions& options) {
  const SightShares& shares = best.shares;
  if (shares.supported < options.least_support)
    return fmt::format(
        "under the best pose only {:.0f} % of the scan's planar area lie on faces, at least {:.0f} % should; "
        "{}?{}",
        100 * shares.supported, 100 * options.least_support, is_it(options), remedy(options));
  if (shares.through > options.most_through)
    return fmt::format(
        "under the best pose {:.0f} % of the scan's planar area would be seen through faces, at most {:.0f} "
        "% may; {}?{}",
        100 * shares.through, 100 * options.most_through, is_it(options), remedy(options));
  if (best.planes < options.least_planes)
    return fmt::format(
        "under the best pose planes of the {} hold the scan that count {}, at least {} should (one with "
        "3 % of the planar area counts 1, with 1 % a half): another place with such a corner would fit as "
        "well{}",
        other_side(options), best.planes, options.least_planes, remedy(options));
  const double beyond = best.planes - options.least_planes;
  const bool few = beyond < kFew;
  const double most_off_m = (few ? kBetter : 1) * options.tolerance_m;
  if (beyond < kMany && best.farthest_m > most_off_m)
    return fmt::format(
        "under the best pose planes of the {} hold the scan that count {}, and one of them lies {:.0f} mm "
        "off, at most {:.0f} may where they are no more: {} of nearly the same size?{}",
        other_side(options), best.planes, 1000 * best.farthest_m, 1000 * most_off_m, is_it(options),
        remedy(options));
  if (few && best.farthest_rad > kMostTurned_rad)
    return fmt::format(
        "under the best pose planes of the {} hold the scan that count {}, and one of them is turned by "
        "{:.2f} degrees, at most {:.2f} may where they are no more: {}?{}",
        other_side(options), best.planes, best.farthest_rad * 180 / std::numbers::pi,
        kMostTurned_rad * 180 / std::numbers::pi, is_it(options), remedy(options));
  if (best.doubt > options.most_doubt && best.doubt > kNothing)
    return fmt::format(
        "under the best pose hardly any planar area that faces along some direction lies on faces of the "
        "{0}: "
        "the scan shows too little of the {0} to hold it there, or the {0} lacks walls{1}",
        other_side(options), remedy(options));
  const double off = std::min(best.farthest_m / options.tolerance_m, 1.0);
  const double most_doubt = ((few ? kTogetherOfFew : kTogether) - off) * options.most_doubt;
  if (best.doubt > most_doubt)
    return fmt::format(
        "under the best pose {:.0f} % as much planar area lies off faces of the {} as on them, along some "
        "direction; at most {:.0f} % may where planes that count {} hold the scan and one of them lies "
        "{:.0f} mm off: {}, or one that lacks walls?{}",
        100 * best.doubt, other_side(options), 100 * most_doubt, best.planes, 1000 * best.farthest_m,
        is_it(options), remedy(options));
  if (fit.least_share < options.least_hold)
    return fmt::format("the planes hold the pose too weakly along ({:.2f}, {:.2f}, {:.2f}){}",
                       fit.weakest.x(), fit.weakest.y(), fit.weakest.z(), remedy(options));
  return "";
}

std::string doubts_by_rivals(const AutomaticAlignment& best, const AutomaticOptions& options) {
  if (best.rivals.empty() || best.rivals[0].strength >= 1) return "";
  return fmt::format("another pose explains the scan nearly as well: {}{}", best.rivals[0].words,
                     remedy(options));
}

}  // namespace hybrid::stages
