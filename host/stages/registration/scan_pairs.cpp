#include "stages/registration/scan_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hybrid::stages {

ScanPairs::ScanPairs(device::Queue& queue, const IcpScan::Samples& samples, const ScanSurface& surface,
                     double own_spacing, bool forward)
    : samples_(samples),
      own_spacing_(own_spacing),
      forward_(forward),
      queue_(queue),
      surface_(surface),
      answers_(queue, samples.queries.count) {}

void ScanPairs::find(const Pose& world_from, const Pose& world_to, double gate_m, double normal_deg) {
  scan_from_queries_ = world_to.inverse() * world_from;
  world_from_grid_ = world_to * surface_.grid_from_scan().inverse();
  world_from_ = world_from;
  clearances_.reset();
  heights_.reset();
  dense_heights_.reset();
  if (samples_.queries.count > 0)
    surface_.find(samples_.queries, scan_from_queries_, gate_m / world_to.scale, normal_deg, answers_);
}

const std::vector<float>& ScanPairs::in_world(const std::vector<float>& values,
                                              std::vector<float>& scaled) const {
  if (world_from_grid_.scale == 1) return values;
  scaled = values;
  for (float& value : scaled) value *= static_cast<float>(world_from_grid_.scale);
  return scaled;
}

const std::vector<float>& ScanPairs::raw_heights() {
  if (!heights_) heights_ = queue_.read(answers_.height);
  return *heights_;
}

const std::vector<float>& ScanPairs::raw_clearances() {
  if (!clearances_) clearances_ = queue_.read(answers_.clearance);
  return *clearances_;
}

// What lies in no plane is told by the samples around, and the worse the farther these are: where two scans
// have it, it is where the denser one says. (With the coarser one's word churches held through a door came to
// lie two to eight times as far off.)
const std::vector<float>& ScanPairs::raw_used() {
  if (!(own_spacing_ > 0)) return raw_heights();
  if (dense_heights_) return *dense_heights_;
  dense_heights_ = raw_heights();
  const Mat3 linear = scan_from_queries_.scale * scan_from_queries_.rotation.toRotationMatrix();
  const double own = scan_from_queries_.scale * own_spacing_ / surface_.spacing();
  for (std::size_t i = 0; i < dense_heights_->size(); ++i) {
    float& height = (*dense_heights_)[i];
    if (std::isnan(height)) continue;
    const auto& p = samples_.points[i];
    const Vec3 point(p[0], p[1], p[2]);
    if ((linear * point + scan_from_queries_.translation).squaredNorm() > own * own * point.squaredNorm())
      height = std::numeric_limits<float>::quiet_NaN();
  }
  dense_ = queue_.array(*dense_heights_);
  return *dense_heights_;
}

// In the axes of the grid, in its scale.
void ScanPairs::sum(const Vec3& pivot, double cutoff_m) {
  sums_.reset();
  const std::size_t count = samples_.queries.count;
  if (count == 0) return;
  const Pose grid_from_queries = surface_.grid_from_scan() * scan_from_queries_;
  const Mat3 linear = grid_from_queries.scale * grid_from_queries.rotation.toRotationMatrix();
  const Vec3 centre = world_from_.inverse() * pivot;
  IcpSumsParams params{};
  for (int k = 0; k < 9; ++k) params.linear[k] = static_cast<float>(linear(k / 3, k % 3));
  for (int k = 0; k < 3; ++k) params.centre_scan[k] = static_cast<float>(centre(k));
  params.cutoff = static_cast<float>(cutoff_m / world_from_grid_.scale);
  params.samples = static_cast<std::uint32_t>(count);
  const std::size_t blocks = (count + kSamplesPerSum - 1) / kSamplesPerSum;
  if (partial_.count() == 0) partial_ = queue_.array<float>(blocks * ICP_PLANE_SUMS);
  if (own_spacing_ > 0) raw_used();
  const auto& kernel = queue_.kernel("icp_sums", {{"VW", queue_.vector_width()},
                                                  {"BLOCK", static_cast<int>(kSamplesPerSum)},
                                                  {"POINT", 0},
                                                  {"NORMALS", 1}});
  const auto no_triangle = queue_.array<std::uint32_t>(0);
  const auto no_triangles = queue_.array<ProxyTriangle>(0);
  queue_.launch("icp_sums", kernel, device::grid(blocks), params, samples_.queries.x, samples_.queries.y,
                samples_.queries.z, samples_.area, own_spacing_ > 0 ? dense_ : answers_.height, no_triangle,
                answers_.normal_x, answers_.normal_y, answers_.normal_z, no_triangles, partial_);
}

// A sample of the scan that stays, on a surface of the one that moves, has the Jacobian of the former with
// the other sign.
void ScanPairs::add_sums(double factor, PlaneSums& total) {
  if (samples_.queries.count == 0) return;
  if (!sums_) {
    sums_.emplace();
    const auto partial = queue_.read(partial_);
    for (std::size_t k = 0; k < partial.size(); ++k)
      (*sums_)[k % sums_->size()] += static_cast<double>(partial[k]);
  }
  const auto& sums = *sums_;
  const double scale = world_from_grid_.scale;
  Matrix7 matrix;
  Vector7 right;
  std::size_t k = 0;
  for (int row = 0; row < 7; ++row) {
    for (int col = row; col < 7; ++col) matrix(row, col) = matrix(col, row) = sums[k++];
    right(row) = sums[static_cast<std::size_t>(28 + row)];
  }
  Matrix7 to_world = Matrix7::Zero();
  const Mat3 turn = world_from_grid_.rotation.toRotationMatrix();
  to_world.topLeftCorner<3, 3>() = scale * turn;
  to_world.block<3, 3>(3, 3) = turn;
  to_world(6, 6) = scale;
  total.matrix += factor * (to_world * matrix * to_world.transpose());
  total.right += (forward_ ? factor : -factor) * scale * (to_world * right);
  total.weight += factor * sums[35];
  total.inlier_area += factor * sums[36];
  total.inlier_square += factor * scale * scale * sums[37];
}

bool PairsCutoff::update(const std::vector<float>& heights, const std::vector<float>& areas) {
  const double middle = weighted_median(heights, areas);
  paired_ = middle >= 0;
  if (!paired_) return false;
  const double wanted = std::max(1.4826 * middle, floor_);
  settled_ = wanted >= 0.5 * scale_;
  scale_ = std::max(wanted, 0.5 * scale_);
  return true;
}

void PairObservations::add(ScanPairs& pairs, double cutoff_m) {
  const auto& heights = pairs.used_heights();
  const auto& with = pairs.samples();
  double of_this = 0;
  const auto end_plane = [&] {
    squares_ += of_this * of_this;
    of_this = 0;
  };
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (i > 0 && with.normals[i] != with.normals[i - 1]) end_plane();
    if (!(std::abs(static_cast<double>(heights[i])) < cutoff_m)) continue;
    area_ += with.area_m2[i];
    of_this += with.area_m2[i];
    ++samples_;
  }
  end_plane();
}

}  // namespace hybrid::stages
