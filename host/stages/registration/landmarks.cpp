#include "stages/registration/landmarks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace hybrid::stages {
namespace {

using Points = std::vector<Vec3>;

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

std::string name_of(const std::vector<LandmarkPair>& pairs, std::size_t i) {
  return pairs[i].name.empty() ? fmt::format("landmark {}", i + 1) : pairs[i].name;
}

// No coordinate system on Earth goes farther, in millimetres either.
constexpr double kFarthest_m = 1e12;

std::string in_metres(const Vec3& p) {
  if (!(p.cwiseAbs().maxCoeff() <= kFarthest_m))
    return fmt::format("({:g}, {:g}, {:g})", p.x(), p.y(), p.z());
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x(), p.y(), p.z());
}

void check_finite(const std::vector<LandmarkPair>& pairs) {
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (!pairs[i].point_in_scan.allFinite() || !pairs[i].point_in_model.allFinite())
      fail_input(
          "{}: expected finite coordinates, found scan {} and model {}; a pixel without a return has none",
          name_of(pairs, i), in_metres(pairs[i].point_in_scan), in_metres(pairs[i].point_in_model));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (std::max(pairs[i].point_in_scan.cwiseAbs().maxCoeff(),
                 pairs[i].point_in_model.cwiseAbs().maxCoeff()) > kFarthest_m)
      fail_input("{}: expected coordinates of at most {:g} m, found scan {} and model {}; correct them",
                 name_of(pairs, i), kFarthest_m, in_metres(pairs[i].point_in_scan),
                 in_metres(pairs[i].point_in_model));
}

std::size_t nearest_vertex(const std::vector<Vec3>& vertices, const Vec3& pick) {
  std::size_t nearest = 0;
  for (std::size_t v = 1; v < vertices.size(); ++v)
    if ((vertices[v] - pick).squaredNorm() < (vertices[nearest] - pick).squaredNorm()) nearest = v;
  return nearest;
}

// Of a model that was read in another unit, or with another axis up, than it has: the picks, which are metres
// with z up, all lie on vertices then. "" or "; ..." with what to say in the scene file.
std::string hint_of_unit(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
                         double tolerance_m) {
  struct Unit {
    double metres;
    const char* name;
    const char* remedy;
  };
  constexpr Unit kUnits[] = {
      {1, "", ""},
      {0.001, "is in millimetres", "say unit = \"mm\" in [model]"},
      {0.01, "is in centimetres", "scale it by 0.01"},
      {0.0254, "is in inches", "scale it by 0.0254"},
      {0.3048, "is in feet", "scale it by 0.3048"},
      {1000, "is in metres, and was read as millimetres", "say unit = \"m\" in [model]"}};
  for (const bool y_up : {false, true})
    for (const Unit& unit : kUnits) {
      if (!y_up && unit.metres == 1) continue;
      std::vector<Vec3> vertices;
      for (const Vec3& v : model.vertices)
        vertices.push_back(unit.metres * (y_up ? Vec3(v.x(), -v.z(), v.y()) : v));
      if (!std::all_of(pairs.begin(), pairs.end(), [&](const LandmarkPair& pair) {
            const Vec3& pick = pair.point_in_model;
            return !pair.snap || (vertices[nearest_vertex(vertices, pick)] - pick).norm() <= tolerance_m;
          }))
        continue;
      const bool scaled = unit.metres != 1;
      return fmt::format("; all picks lie on vertices if the model {}{}{}: {}{}{}", unit.name,
                         scaled && y_up ? " and " : "", y_up ? "has y up" : "", unit.remedy,
                         scaled && y_up ? ", and " : "", y_up ? "say up = \"y\" in [model]" : "");
    }
  return "";
}

Vec3 snapped(const PolygonModel& model, const std::vector<LandmarkPair>& pairs, std::size_t i,
             double tolerance_m) {
  const Vec3& pick = pairs[i].point_in_model;
  if (!pairs[i].snap) return pick;
  if (model.vertices.empty()) fail_input("{}: the model has no vertices to snap to", name_of(pairs, i));
  const std::size_t nearest = nearest_vertex(model.vertices, pick);
  const double distance = (model.vertices[nearest] - pick).norm();
  if (!(distance <= tolerance_m))
    fail_input(
        "{}: expected a model vertex within {} m of {}, found the nearest (vertex {} at {}) {:.3f} m away; "
        "pick that vertex, or say snap = false for a control point that is no vertex{}",
        name_of(pairs, i), tolerance_m, in_metres(pick), nearest, in_metres(model.vertices[nearest]),
        distance, hint_of_unit(model, pairs, tolerance_m));
  return model.vertices[nearest];
}

// Index of the two ends of the longest chord, and how far the farthest other point is from that line relative
// to its length: what three points need to fix a rotation.
struct Spread {
  std::size_t a = 0, b = 0;
  double width = 0;
};

Spread spread(const Points& points) {
  Spread found;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if ((points[i] - points[j]).norm() > (points[found.a] - points[found.b]).norm()) found = {i, j, 0};
  const Vec3 line = points[found.b] - points[found.a];
  if (line.norm() == 0) return found;
  for (const Vec3& p : points)
    found.width = std::max(found.width, (p - points[found.a]).cross(line).norm() / line.squaredNorm());
  return found;
}

// Below this width the turn about the line through the picks is lost in their errors.
constexpr double kMinWidth = 0.01;

void check_spread(const std::vector<LandmarkPair>& pairs, const Points& points, const std::string& where) {
  const Spread found = spread(points);
  const double length = (points[found.b] - points[found.a]).norm();
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if ((points[i] - points[j]).norm() <= 1e-6 * length)
        fail_input("{} and {} are the same point {} of the {}; pick different corners", name_of(pairs, i),
                   name_of(pairs, j), in_metres(points[i]), where);
  if (found.width >= kMinWidth) return;
  std::string names;
  for (std::size_t i = 0; i < pairs.size(); ++i) names += (i ? ", " : "") + name_of(pairs, i);
  fail_input(
      "{} are collinear in the {}: within {:.2g} m of the line from {} to {}, {:.3f} m long; the turn about "
      "that "
      "line is not determined: pick a corner off it",
      names, where, found.width * length, name_of(pairs, found.a), name_of(pairs, found.b), length);
}

void leave_one_out(const Points& from, const Points& to, bool free_scale, LandmarkFit& fit) {
  for (std::size_t left = 0; left < from.size(); ++left) {
    Points others_from = from, others_to = to;
    others_from.erase(others_from.begin() + static_cast<std::ptrdiff_t>(left));
    others_to.erase(others_to.begin() + static_cast<std::ptrdiff_t>(left));
    double miss = kNotKnown, rms = kNotKnown;
    if (fix_rotation(others_from) && fix_rotation(others_to)) {
      const Pose pose = horn(others_from, others_to, {}, free_scale);
      miss = (pose * from[left] - to[left]).norm();
      rms = rms_of(pose, others_from, others_to);
    }
    fit.leave_one_out_m.push_back(miss);
    fit.rms_without_m.push_back(rms);
  }
}

}  // namespace

Eigen::Quaterniond horn_rotation(const Mat3& s) {
  Eigen::Matrix4d n;
  n << s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0),  //
      s(1, 2) - s(2, 1), s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2),   //
      s(2, 0) - s(0, 2), s(0, 1) + s(1, 0), -s(0, 0) + s(1, 1) - s(2, 2), s(1, 2) + s(2, 1),  //
      s(0, 1) - s(1, 0), s(2, 0) + s(0, 2), s(1, 2) + s(2, 1), -s(0, 0) - s(1, 1) + s(2, 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(n);
  const Eigen::Vector4d q = solver.eigenvectors().col(3);  // eigenvalues ascend
  const double sign = q(0) < 0 ? -1 : 1;
  return Eigen::Quaterniond(sign * q(0), sign * q(1), sign * q(2), sign * q(3)).normalized();
}

Pose horn(const Points& from, const Points& to, const std::vector<double>& weights, bool free_scale) {
  const auto weight = [&](std::size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  double sum = 0;
  Vec3 from_centre = Vec3::Zero(), to_centre = Vec3::Zero();
  // About the first pair, so that georeferenced coordinates cost no digits.
  for (std::size_t i = 0; i < from.size(); ++i) {
    sum += weight(i);
    from_centre += weight(i) * (from[i] - from[0]);
    to_centre += weight(i) * (to[i] - to[0]);
  }
  from_centre = from[0] + from_centre / sum;
  to_centre = to[0] + to_centre / sum;
  Mat3 cross = Mat3::Zero();
  double from_square = 0, to_square = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vec3 l = from[i] - from_centre, r = to[i] - to_centre;
    cross += weight(i) * l * r.transpose();
    from_square += weight(i) * l.squaredNorm();
    to_square += weight(i) * r.squaredNorm();
  }
  Pose pose;
  pose.rotation = horn_rotation(cross);
  pose.scale = free_scale ? std::sqrt(to_square / from_square) : 1.0;
  pose.translation = to_centre - pose.scale * (pose.rotation * from_centre);
  return pose;
}

bool fix_rotation(const Points& points) {
  return spread(points).width >= kMinWidth;
}

double rms_of(const Pose& pose, const Points& from, const Points& to) {
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (pose * from[i] - to[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(from.size()));
}

std::vector<LandmarkPair> snap_landmarks(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
                                         double tolerance_m) {
  check_finite(pairs);
  std::vector<LandmarkPair> points = pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    points[i].point_in_model = snapped(model, pairs, i, tolerance_m);
    points[i].snap = false;
  }
  return points;
}

LandmarkFit fit_landmarks(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
                          const LandmarkOptions& options) {
  if (pairs.size() < 3)
    fail_input(
        "landmarks: expected at least 3 pairs (4 are better), found {}; add some, or register without any",
        pairs.size());
  Points from, to;
  for (const LandmarkPair& pair : snap_landmarks(model, pairs, options.snap_tolerance_m)) {
    from.push_back(pair.point_in_scan);
    to.push_back(pair.point_in_model);
  }
  check_spread(pairs, from, options.frame);
  check_spread(pairs, to, "model");

  LandmarkFit fit;
  fit.world_from_scan = horn(from, to, {}, options.free_scale);
  for (std::size_t i = 0; i < from.size(); ++i)
    fit.residual_m.push_back((fit.world_from_scan * from[i] - to[i]).norm());
  fit.rms_m = rms_of(fit.world_from_scan, from, to);
  if (from.size() > 3) leave_one_out(from, to, options.free_scale, fit);
  return fit;
}

std::optional<std::size_t> outlying_pick(const LandmarkFit& fit, double factor) {
  const auto& rms = fit.rms_without_m;
  std::optional<std::size_t> worst;
  for (std::size_t i = 0; i < rms.size(); ++i)
    if (!std::isnan(rms[i]) && (!worst || rms[i] < rms[*worst])) worst = i;
  if (!worst || !(fit.leave_one_out_m[*worst] > std::max(factor * rms[*worst], 1e-3))) return std::nullopt;
  for (std::size_t i = 0; i < rms.size(); ++i)
    if (i != *worst && !(rms[i] >= 2 * rms[*worst])) return std::nullopt;
  return worst;
}

}  // namespace hybrid::stages
