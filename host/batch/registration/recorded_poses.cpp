#include "batch/registration/recorded_poses.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>

#include "geometry/angles.hpp"

namespace hybrid::batch {
namespace {

constexpr double kSame_m = 1e-3, kSameRad = 1e-4;  // poses in files that are one
// ICP leaves scans there whose files were registered before; of rough poses (satellites, a compass) it leaves
// none.
constexpr double kAgree_m = 0.02, kAgreeDeg = 0.2;
constexpr std::size_t kAgreePerDiffer = 5;
constexpr double kLeastSigma_m = 1e-3, kLeastSigmaRad = 1e-4;
// So many of the scans around one are asked.
constexpr std::size_t kAsked = 3;
// Poses of a scan that different evidence gives are of one place so near each other.
constexpr double kOnePlace_m = 0.3, kOnePlaceDeg = 3;

}  // namespace

bool agree(const Pose& a, const Pose& b, double more_m) {
  return difference(a, b).within(kAgree_m + more_m, kAgreeDeg * kDegree);
}

bool is_one_place(const Pose& a, const Pose& b) {
  return difference(a, b).within(kOnePlace_m, kOnePlaceDeg * kDegree);
}

bool RecordedWord::is_trusted() const {
  return agree > 0 && kAgreePerDiffer * differ <= agree;
}

std::array<double, 36> RecordedWord::covariance(const Pose& world_from_scan) const {
  const double rad = std::max(farthest_rad, kLeastSigmaRad), metres = std::max(farthest_m, kLeastSigma_m);
  const Vec3& at = world_from_scan.translation;
  Eigen::Matrix<double, 6, 6> sigma = Eigen::Matrix<double, 6, 6>::Zero();  // by rotation and shift there
  sigma.diagonal() << rad, rad, rad, metres, metres, metres;
  Mat3 cross;
  cross << 0, -at.z(), at.y(), at.z(), 0, -at.x(), -at.y(), at.x(), 0;
  sigma.block<3, 3>(3, 0) = rad * cross;  // of the world's origin
  std::array<double, 36> covariance;
  Eigen::Map<Eigen::Matrix<double, 6, 6>>(covariance.data()) = sigma * sigma.transpose();
  return covariance;
}

RecordedPoses::RecordedPoses(const std::vector<ScanProduct>& products, ScanToScan& scan_to_scan)
    : products_(products), scan_to_scan_(scan_to_scan), agrees_(products.size()) {}

std::optional<Pose> RecordedPoses::pose_by(std::size_t i, std::size_t by, const Pose& world_from_by) const {
  const auto &own = products_[i].recorded_pose, &other = products_[by].recorded_pose;
  if (!own || !other || difference(*own, *other).within(kSame_m, kSameRad)) return std::nullopt;
  return world_from_by * (other->inverse() * *own);
}

std::vector<std::size_t> RecordedPoses::nearest(std::size_t i) const {
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < products_.size(); ++k)
    if (k != i && pose_by(i, k, Pose())) others.push_back(k);
  const auto distance = [&](std::size_t k) {
    return (products_[k].recorded_pose->translation - products_[i].recorded_pose->translation).norm();
  };
  std::stable_sort(others.begin(), others.end(),
                   [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  return others;
}

std::optional<RecordedPoses::Start> RecordedPoses::start_of(std::size_t i,
                                                            const Registrations& registrations) const {
  return start_by(i, nearest(i), registrations);
}

std::optional<RecordedPoses::Start> RecordedPoses::trusted_start_of(std::size_t i,
                                                                    const Registrations& registrations) {
  if (!word().is_trusted()) return std::nullopt;
  auto others = nearest(i);
  std::erase_if(others, [&](std::size_t k) { return !agrees_[k]; });
  return start_by(i, std::move(others), registrations);
}

std::optional<RecordedPoses::Start> RecordedPoses::start_by(std::size_t i, std::vector<std::size_t> others,
                                                            const Registrations& registrations) const {
  std::erase_if(others, [&](std::size_t k) { return !registrations[k]; });
  if (others.empty()) return std::nullopt;
  std::stable_partition(others.begin(), others.end(),
                        [&](std::size_t k) { return !registrations[k]->slides(); });
  const auto by = [&](std::size_t k) { return *pose_by(i, k, registrations[k]->world_from_scan()); };
  const Pose pose = by(others.front());
  const auto here =
      std::count_if(others.begin(), others.end(), [&](std::size_t k) { return is_one_place(by(k), pose); });
  if (2 * here <= std::ssize(others)) return std::nullopt;
  return Start{pose, others.front()};
}

// On those beside it that hold it firmly, until it agrees with one; where none does, it says nothing.
void RecordedPoses::ask(std::size_t i, RecordedWord& word) {
  auto others = nearest(i);
  others.resize(std::min(others.size(), kAsked));
  bool held = false;
  for (const std::size_t k : others) {
    Registrations other(products_.size());
    other[k].emplace();
    const Pose start = *pose_by(i, k, Pose());
    if (largest_overlap(scan_to_scan_.look(i, start, other).on_scans.icp) < kFirmOverlap) continue;
    held = true;
    const auto laid = scan_to_scan_.lay(i, start, other);
    const auto moved = difference(start, laid.on_scans.icp.icp.world_from_scan);
    if (!laid.contradiction.empty() || !agree(start, laid.on_scans.icp.icp.world_from_scan)) continue;
    ++word.agree;
    agrees_[i] = 1;
    word.farthest_m = std::max(word.farthest_m, moved.distance_m);
    word.farthest_rad = std::max(word.farthest_rad, moved.angle_rad);
    return;
  }
  word.differ += held;
}

const RecordedWord& RecordedPoses::word() {
  if (!word_) {
    word_.emplace();
    for (std::size_t i = 0; i < products_.size(); ++i) ask(i, *word_);
  }
  return *word_;
}

std::string RecordedPoses::contradiction_of(std::size_t i, const Registrations& registrations) {
  const auto by_file = start_of(i, registrations);
  const Pose& pose = registrations[i]->world_from_scan();
  if (!by_file || is_one_place(by_file->world_from_scan, pose) || !word().is_trusted()) return "";
  const auto apart = difference(by_file->world_from_scan, pose);
  return fmt::format(
      "its file has it {:.2f} m and {:.1f} degrees from there, beside scan {}, and the files' poses of {} "
      "scans "
      "agree with what these see of each other: check the landmarks, or poses, of both",
      apart.distance_m, apart.angle_rad / kDegree, products_[by_file->by].id, word().agree);
}

void RecordedPoses::keep(std::size_t i, const Start& start, ScanRegistration& one) {
  one.unjudged = true;
  one.held_by_model = false;
  one.recorded = {products_[start.by].id, word()};
  one.icp.world_from_scan = start.world_from_scan;
  one.icp.covariance = word().covariance(start.world_from_scan);
  one.icp.converged = true;
  warn(products_[i],
       fmt::format("its place is where its file has it beside scan {}, as nothing else holds it: the files' "
                   "poses of {} scans agree with what these see of each other, within {:.1f} mm and {:.3f} "
                   "degrees",
                   one.recorded->by, word().agree, 1000 * word().farthest_m, word().farthest_rad / kDegree),
       one);
}

}  // namespace hybrid::batch
