#include "io/scan_frame.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace hybrid::io {
namespace {

bool is_identity(const Pose& pose) {
  const PoseDifference apart = difference(pose, Pose());
  return apart.angle_rad < 1e-12 && apart.distance_m < 1e-12;
}

}  // namespace

void place_scanner(Scan& scan, const Vec3& scanner) {
  if (!scanner.allFinite())
    fail_input("scanner: expected finite numbers, found {}, {}, {}", scanner.x(), scanner.y(), scanner.z());
  if (scan.range_grid)
    fail_input("scanner: a range image has the scanner at its origin; remove the position");
  constexpr double kSamePlace_m = 1e-3;
  if (scan.world_from_scan && !is_identity(*scan.world_from_scan)) {
    const Vec3& t = scan.world_from_scan->translation;
    if ((t - scanner).norm() > kSamePlace_m)
      fail_input(
          "scanner: the file has the scanner's pose (at {}, {}, {}), and its points are taken to be in the "
          "scanner's frame; remove the position or, if the points are in the frame that the pose leads to, "
          "give that "
          "one",
          t.x(), t.y(), t.z());
    scan.notes.emplace_back(
        "its points are in the frame that the scanner's position is given in: the file's pose is "
        "used for nothing else");
  }
  scan.scanner_is_known = true;
  const Vec3 shift = scan.origin - scanner;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  parallel_for(
      scan.points.size(),
      [&](std::size_t i) {
        auto& point = scan.points[i];
        const bool none = scan.point(i).isZero();
        for (std::size_t k = 0; k < 3; ++k)
          point[k] =
              none ? kNone : static_cast<float>(double{point[k]} + shift[static_cast<Eigen::Index>(k)]);
      },
      4096);
  scan.origin = Vec3::Zero();
  scan.world_from_scan = Pose{1, Eigen::Quaterniond::Identity(), scanner};
}

double metres_of_unit(std::string_view name) {
  for (const ScanUnit& unit : kScanUnits)
    if (unit.name == name) return unit.metres;
  fail_input("unit: expected m, cm, mm, ft or us-ft, found {}", name);
}

void scale_lengths(Scan& scan, double metres) {
  if (metres == 1) return;
  if (scan.range_grid) fail_input("unit: a range image is in metres; remove the key");
  parallel_for(
      scan.points.size(),
      [&](std::size_t i) {
        for (float& length : scan.points[i]) length = static_cast<float>(length * metres);
      },
      4096);
  scan.origin *= metres;
  if (scan.world_from_scan) scan.world_from_scan->translation *= metres;
}

ScanAxes scan_axes_of(std::string_view name) {
  const auto at = std::find(kScanAxesNames.begin(), kScanAxesNames.end(), name);
  if (at == kScanAxesNames.end())
    fail_input("axes: expected one of {}, found {}", fmt::join(kScanAxesNames, ", "), name);
  return static_cast<ScanAxes>(at - kScanAxesNames.begin());
}

Pose file_from_scanner(ScanAxes axes) {
  Mat3 rotation = Mat3::Identity();
  if (axes == ScanAxes::camera) rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  if (axes == ScanAxes::opengl) rotation << 0, -1, 0, 0, 0, 1, -1, 0, 0;
  return {1, Eigen::Quaterniond(rotation), Vec3::Zero()};
}

void turn_axes(Scan& scan, ScanAxes axes) {
  if (axes == ScanAxes::z_up) return;
  if (scan.range_grid) fail_input("axes: a range image is in the scanner's frame; remove the key");
  const Pose file_from_scan = file_from_scanner(axes);
  const Mat3 turn = file_from_scan.rotation.toRotationMatrix().transpose().array().round();
  const Eigen::Matrix3f turn_point = turn.cast<float>();
  parallel_for(
      scan.points.size(),
      [&](std::size_t i) {
        Eigen::Map<Eigen::Vector3f> point(scan.points[i].data());
        point = (turn_point * point).eval();
      },
      4096);
  scan.origin = turn * scan.origin;
  if (scan.world_from_scan) scan.world_from_scan = *scan.world_from_scan * file_from_scan;
}

std::string doubt_of_scanner(const Scan& scan) {
  if (scan.organised() || scan.range_grid || (scan.world_from_scan && !is_identity(*scan.world_from_scan)))
    return "";
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (const Vec3 point = scan.point(i); point.allFinite() && !point.isZero()) box.extend(point);
  if (box.isEmpty()) return "";
  const double away = box.exteriorDistance(Vec3::Zero().eval()), size = box.diagonal().norm();
  if (!(away > size)) return "";
  return fmt::format(
      "its points are {:.1f} m away from the origin, where the scanner is taken to have stood, and {:.1f} m "
      "across; say where it stood: scanner = [x, y, z] of [[scan]], or hybrid planes --scanner x,y,z",
      away, size);
}

}  // namespace hybrid::io
