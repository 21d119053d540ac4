#include "score/measure/common_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "score/error.hpp"

namespace score {

CommonFit fit_in_common(const std::vector<PosePair>& poses) {
  if (poses.size() < 2) bad_input("a common fit needs at least 2 poses, found {}", poses.size());
  constexpr double kAxis_m = 5;
  constexpr Eigen::Index kPoints = 7;
  const auto count = static_cast<Eigen::Index>(poses.size());
  Eigen::Matrix3Xd found(3, kPoints * count), truth(3, kPoints * count);
  Vec3 centre = Vec3::Zero();
  for (Eigen::Index i = 0; i < count; ++i) {
    const PosePair& pair = poses[static_cast<std::size_t>(i)];
    centre += pair.truth.translation / static_cast<double>(count);
    for (Eigen::Index k = 0; k < kPoints; ++k) {
      Vec3 point = Vec3::Zero();
      if (k > 0) point((k - 1) / 2) = k % 2 ? kAxis_m : -kAxis_m;
      found.col(kPoints * i + k) = pair.found * point;
      truth.col(kPoints * i + k) = pair.truth * point;
    }
  }
  // About the truth's centre: coordinates may be UTM-sized.
  const Eigen::Matrix4d motion = Eigen::umeyama(Eigen::Matrix3Xd(found.colwise() - centre),
                                                Eigen::Matrix3Xd(truth.colwise() - centre), false);
  const Mat3 turn = motion.topLeftCorner<3, 3>();
  CommonFit fit;
  fit.scans = poses.size();
  fit.moved_deg = rotation_angle_deg(turn);
  fit.moved_mm = 1000 * motion.topRightCorner<3, 1>().norm();
  for (const PosePair& pair : poses) {
    const Vec3 place = turn * (pair.found.translation - centre) + motion.topRightCorner<3, 1>() + centre;
    const double mm = 1000 * (place - pair.truth.translation).norm();
    const double deg = rotation_angle_deg(turn * pair.found.rotation * pair.truth.rotation.transpose());
    fit.place_rms_mm += mm * mm / static_cast<double>(count);
    fit.rotation_rms_deg += deg * deg / static_cast<double>(count);
    fit.place_largest_mm = std::max(fit.place_largest_mm, mm);
    fit.rotation_largest_deg = std::max(fit.rotation_largest_deg, deg);
  }
  fit.place_rms_mm = std::sqrt(fit.place_rms_mm);
  fit.rotation_rms_deg = std::sqrt(fit.rotation_rms_deg);
  return fit;
}

}  // namespace score
