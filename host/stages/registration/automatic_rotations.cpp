#include "stages/registration/automatic_rotations.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kScanPlanes = 14, kModelPlanes = 24, kMostRotations = 48;
constexpr double kLeastShare = 0.01;    // of the largest plane's area
constexpr double kEqualAngleDeg = 3;    // between the two scan planes and the two model planes
constexpr double kSameRotationDeg = 4;  // before refinement; a quarter of it after
constexpr double kSupportShare = 0.6;   // of the best rotation's
constexpr double kLargestTiltDeg = 5;   // of a levelled scan
constexpr double kWallDeg = 20;         // from vertical

template <typename T>
std::vector<T> largest(const std::vector<T>& planes, std::size_t most) {
  std::vector<T> kept;
  for (const T& plane : planes)
    if (kept.size() < most && plane.area_m2 >= kLeastShare * planes.front().area_m2) kept.push_back(plane);
  return kept;
}

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b);
}

// Rotation that takes the frame of two directions onto that of two others, both pairs about equally wide.
Eigen::Quaterniond frame_rotation(const Vec3& a1, const Vec3& a2, const Vec3& b1, const Vec3& b2) {
  const auto frame = [](const Vec3& p, const Vec3& q) {
    Mat3 m;
    m.col(0) = (p + q).normalized();
    m.col(1) = (p - q).normalized();
    m.col(2) = m.col(0).cross(m.col(1));
    return m;
  };
  return Eigen::Quaterniond(Mat3(frame(b1, b2) * frame(a1, a2).transpose())).normalized();
}

struct Supported {
  Mat3 cross = Mat3::Zero();  // sum of area n_scan n_model^T
  double area_m2 = 0;
};

Supported support_of(const Eigen::Quaterniond& q, const std::vector<ScanPlane>& scan,
                     const std::vector<ModelPlane>& model) {
  Supported sum;
  const Mat3 r = q.toRotationMatrix();
  for (const ScanPlane& plane : scan) {
    const Vec3 normal = r * plane.plane.normal;
    double best = std::cos(kAlongDeg * kDegree);
    const ModelPlane* along = nullptr;
    for (const ModelPlane& candidate : model)
      if (const double cosine = candidate.plane.normal.dot(normal); cosine > best) {
        best = cosine;
        along = &candidate;
      }
    if (!along) continue;
    const double area = std::min(plane.area_m2, along->area_m2);
    sum.area_m2 += area;
    sum.cross += area * plane.plane.normal * along->plane.normal.transpose();
  }
  return sum;
}

// The rotation closest to taking all scan normals onto their model normals. A little of the guess itself
// keeps what they leave open.
Eigen::Quaterniond refined(const Eigen::Quaterniond& guess, const Supported& support) {
  const Mat3 cross = support.cross + 1e-3 * support.area_m2 * guess.toRotationMatrix().transpose();
  const Eigen::JacobiSVD<Mat3> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 sign = Mat3::Identity();
  sign(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
  return Eigen::Quaterniond(Mat3(svd.matrixV() * sign * svd.matrixU().transpose())).normalized();
}

class Collector {
 public:
  void add(const Eigen::Quaterniond& q) {
    for (const auto& known : found_)
      if (angle_between(known, q) < kSameRotationDeg * kDegree) return;
    found_.push_back(q);
  }
  const std::vector<Eigen::Quaterniond>& found() const { return found_; }

 private:
  std::vector<Eigen::Quaterniond> found_;
};

void add_turns(const std::vector<ScanPlane>& scan, const std::vector<ModelPlane>& model, Collector& into) {
  const auto is_wall = [](const Plane& plane) {
    return std::abs(plane.normal.z()) < std::sin(kWallDeg * kDegree);
  };
  const auto azimuth = [](const Vec3& n) { return std::atan2(n.y(), n.x()); };
  for (const ScanPlane& a : scan)
    for (const ModelPlane& b : model)
      if (is_wall(a.plane) && is_wall(b.plane))
        into.add(Eigen::Quaterniond(
            Eigen::AngleAxisd(azimuth(b.plane.normal) - azimuth(a.plane.normal), Vec3::UnitZ())));
}

void add_pairs(const std::vector<ScanPlane>& scan, const std::vector<ModelPlane>& model, Collector& into) {
  const auto angle = [](const Plane& a, const Plane& b) {
    return std::acos(std::clamp(a.normal.dot(b.normal), -1.0, 1.0));
  };
  for (std::size_t i = 0; i < scan.size(); ++i)
    for (std::size_t j = i + 1; j < scan.size(); ++j) {
      const double scan_angle = angle(scan[i].plane, scan[j].plane);
      if (scan_angle < 30 * kDegree || scan_angle > 150 * kDegree) continue;
      for (std::size_t k = 0; k < model.size(); ++k)
        for (std::size_t l = 0; l < model.size(); ++l)
          if (k != l &&
              std::abs(angle(model[k].plane, model[l].plane) - scan_angle) < kEqualAngleDeg * kDegree)
            into.add(frame_rotation(scan[i].plane.normal, scan[j].plane.normal, model[k].plane.normal,
                                    model[l].plane.normal));
    }
}

}  // namespace

std::vector<RotationGuess> guess_rotations(const ScanEvidence& scan, const ModelShapes& model,
                                           bool levelled) {
  std::vector<RotationGuess> guesses;
  if (scan.planes.empty() || model.planes.empty()) return guesses;
  const auto scan_planes = largest(scan.planes, kScanPlanes);
  const auto model_planes = largest(model.planes, kModelPlanes);
  Collector found;
  if (levelled)
    add_turns(scan_planes, model_planes, found);
  else
    add_pairs(scan_planes, model_planes, found);

  for (Eigen::Quaterniond q : found.found()) {
    for (int pass = 0; pass < 2; ++pass) q = refined(q, support_of(q, scan_planes, model_planes));
    if (levelled && (q * Vec3::UnitZ()).z() < std::cos(kLargestTiltDeg * kDegree)) continue;
    const double area = support_of(q, scan_planes, model_planes).area_m2;
    const bool known = std::any_of(guesses.begin(), guesses.end(), [&](const RotationGuess& other) {
      return angle_between(other.world_from_scan, q) < kSameRotationDeg / 4 * kDegree;
    });
    if (!known && area > 0) guesses.push_back({q, area});
  }
  std::stable_sort(guesses.begin(), guesses.end(),
                   [](const RotationGuess& a, const RotationGuess& b) { return a.area_m2 > b.area_m2; });
  while (!guesses.empty() && (guesses.size() > kMostRotations ||
                              guesses.back().area_m2 < kSupportShare * guesses.front().area_m2))
    guesses.pop_back();
  return guesses;
}

}  // namespace hybrid::stages
