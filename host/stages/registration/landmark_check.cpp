#include "stages/registration/landmark_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hybrid::stages {
namespace {

using Points = std::vector<Vec3>;

// Corners are picked within centimetres, of a model whose corners are off by as much and sometimes by a
// wall's displacement.
constexpr double kPickError_m = 0.05, kRough_m = 0.25, kRoughShare = 0.05;
// An explanation makes the picks agree so many times better, and so many times better than any other does.
constexpr double kExplains = 4, kUnlikeOthers = 2;

struct Picks {
  const std::vector<LandmarkPair>& pairs;
  Points from, to;
  bool free_scale = false;

  Picks(const std::vector<LandmarkPair>& snapped, bool free) : pairs(snapped), free_scale(free) {
    for (const LandmarkPair& pair : snapped) {
      from.push_back(pair.point_in_scan);
      to.push_back(pair.point_in_model);
    }
  }
  double extent_m() const {  // world
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : to) centre += (p - to[0]) / static_cast<double>(to.size());
    double sum = 0;
    for (const Vec3& p : to) sum += (p - to[0] - centre).squaredNorm();
    return std::sqrt(sum / static_cast<double>(to.size()));
  }
};

struct Exchange {
  std::size_t a = 0, b = 0;
  double rms_m = 0;
};

std::string names(const std::vector<LandmarkPair>& pairs, const Exchange& exchange) {
  return pairs[exchange.a].name + " and " + pairs[exchange.b].name;
}

// The exchanges of two picks' model points that make all agree, best first; those that do about as well as
// the best.
std::vector<Exchange> exchanges(const Picks& picks, double most_m) {
  std::vector<Exchange> found;
  for (std::size_t a = 0; a < picks.to.size(); ++a)
    for (std::size_t b = a + 1; b < picks.to.size(); ++b) {
      Points to = picks.to;
      std::swap(to[a], to[b]);
      const double rms = rms_of(horn(picks.from, to, {}, picks.free_scale), picks.from, to);
      if (rms <= most_m) found.push_back({a, b, rms});
    }
  std::stable_sort(found.begin(), found.end(),
                   [](const Exchange& a, const Exchange& b) { return a.rms_m < b.rms_m; });
  std::erase_if(found, [&](const Exchange& one) { return one.rms_m > kUnlikeOthers * found[0].rms_m; });
  return found;
}

// "" when no exchange explains the residuals.
std::string exchanged(const Picks& picks, double most_m) {
  const auto found = exchanges(picks, most_m);
  if (found.empty()) return "";
  std::string who = names(picks.pairs, found[0]);
  for (std::size_t k = 1; k < found.size(); ++k) who += ", or " + names(picks.pairs, found[k]);
  return fmt::format(
      "{} seem exchanged: with their model points exchanged all agree within {:.3f} m; exchange them", who,
      found[0].rms_m);
}

std::string of_another_scale(const Picks& picks, double most_m) {
  if (picks.free_scale) return "";
  const Pose pose = horn(picks.from, picks.to, {}, true);
  const double rms = rms_of(pose, picks.from, picks.to);
  if (rms > most_m * std::max(1.0, pose.scale)) return "";
  return fmt::format(
      "they agree within {:.3g} m where the model is {:.4g} times as large as the scan: check unit in "
      "[model] and the scan's unit, or say scale = \"free\" in [register]",
      rms, pose.scale);
}

std::string mirrored(const Picks& picks, double most_m) {
  Points from = picks.from;
  for (Vec3& p : from) p.x() = -p.x();
  const double rms = rms_of(horn(from, picks.to, {}, picks.free_scale), from, picks.to);
  if (rms > most_m) return "";
  return fmt::format(
      "they agree within {:.3f} m with the model's mirror image: if the model is mirrored, negate one axis "
      "of "
      "its vertices, else check which corners were picked",
      rms);
}

std::string list_of_residuals(const Picks& picks, const LandmarkFit& fit) {
  std::string list;
  for (std::size_t i = 0; i < picks.pairs.size(); ++i)
    list += fmt::format("{}{} {:.2f} m", i ? ", " : "", picks.pairs[i].name, fit.residual_m[i]);
  return fmt::format(
      "no single pick is to blame, nor the exchange of two: {}; check which corners were picked", list);
}

std::string scan_place(const Vec3& p) {
  return fmt::format("scan ({:.3f}, {:.3f}, {:.3f})", p.x(), p.y(), p.z());
}

// The fit without a pick, whose figures stay in their places.
LandmarkFit fit_without(const PolygonModel& model, const std::vector<LandmarkPair>& pairs, std::size_t pick,
                        double miss_m, const LandmarkOptions& options) {
  const auto at = static_cast<std::ptrdiff_t>(pick);
  auto others = pairs;
  others.erase(others.begin() + at);
  LandmarkFit fit = fit_landmarks(model, others, options);
  fit.residual_m.insert(fit.residual_m.begin() + at, miss_m);
  fit.left_out = pick;
  return fit;
}

// Leaves out the pick that the others contradict, if there is one.
void leave_out(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
               const LandmarkOptions& options, CheckedLandmarks& checked) {
  const auto pick = outlying_pick(checked.fit);
  if (!pick) return;
  const LandmarkFit all = std::move(checked.fit);
  const double miss = all.leave_one_out_m[*pick];
  // Of four picks the others' fit misses a good one by many times its error. The fit of all follows such a
  // pick: the residual is the miss times 1 less its leverage.
  const double standardised = std::sqrt(all.residual_m[*pick] * miss);
  if (standardised < kPickError_m * all.world_from_scan.scale) {
    checked.fit = all;
    return;
  }
  checked.fit = fit_without(model, pairs, *pick, miss, options);
  // What the fit of all says of each pick is what the others' fit says of it.
  checked.fit.leave_one_out_m = all.leave_one_out_m;
  checked.fit.rms_without_m = all.rms_without_m;
  checked.warning = fmt::format(
      "{}, {}, is left out of the fit: it misses the fit of the others by {:.3f} m, and these agree within "
      "{:.3f} m (with it {:.3f} m, its own residual {:.3f} m); pick that corner again",
      pairs[*pick].name,
      pairs[*pick].place.empty() ? scan_place(pairs[*pick].point_in_scan) : pairs[*pick].place, miss,
      all.rms_without_m[*pick], all.rms_m, all.residual_m[*pick]);
}

}  // namespace

CheckedLandmarks check_landmarks(const PolygonModel& model, const std::vector<LandmarkPair>& given,
                                 const LandmarkOptions& options) {
  CheckedLandmarks checked;
  checked.fit = fit_landmarks(model, given, options);
  const double rms_m = checked.fit.rms_m, scale = checked.fit.world_from_scan.scale;
  const auto pairs = snap_landmarks(model, given, options.snap_tolerance_m);
  const Picks picks(pairs, options.free_scale);
  const double limit_m = std::max(kRough_m * scale, kRoughShare * picks.extent_m());
  const double most_m = std::min(limit_m, rms_m / kExplains);
  if (rms_m > kPickError_m * scale) checked.warning = exchanged(picks, most_m);
  // Before a pick is left out: without one the others may lie in a plane, which no mirror changes.
  std::string why = checked.warning.empty() && rms_m > limit_m ? mirrored(picks, most_m) : checked.warning;
  if (why.empty()) leave_out(model, pairs, options, checked);
  if (checked.fit.rms_m <= limit_m) return checked;
  if (why.empty()) why = of_another_scale(picks, most_m);
  if (why.empty()) why = list_of_residuals(picks, checked.fit);
  checked.warning.clear();
  checked.refusal = fmt::format(
      "the landmarks do not belong together: rms {:.2f} m, at most {:.2f} m may be where they lie {:.1f} m "
      "from their middle; {}",
      rms_m, limit_m, picks.extent_m(), why);
  return checked;
}

}  // namespace hybrid::stages
