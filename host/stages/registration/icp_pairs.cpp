#include "stages/registration/icp_pairs.hpp"

#include <bit>
#include <cmath>

#include "shared/params_icp_sums.h"

namespace hybrid::stages {
namespace {

void store_linear(const Pose& pose, float* target) {
  const Mat3 linear = pose.scale * pose.rotation.toRotationMatrix();
  for (int k = 0; k < 9; ++k) target[k] = static_cast<float>(linear(k / 3, k % 3));
}

Vec3 centre_of(const PlanarSamples& samples) {
  double total = 0;
  Vec3 centre = Vec3::Zero();
  for (const auto& p : samples.points) {
    total += p[3];
    centre += static_cast<double>(p[3]) * Vec3(p[0], p[1], p[2]);
  }
  return centre / total;
}

}  // namespace

device::Array<float> column(device::Queue& queue, const std::vector<std::array<float, 4>>& rows,
                            std::size_t k) {
  std::vector<float> values(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) values[i] = rows[i][k];
  return queue.array(values);
}

double weighted_median(const std::vector<float>& values, const std::vector<float>& weights) {
  // A float's leading bits are its logarithm: 11 bits of mantissa give 2048 bins per octave.
  constexpr std::uint32_t kShift = 12, kLowest = (127u - 20u) << 11, kHighest = (127u + 10u) << 11;
  std::vector<double> bins(kHighest - kLowest + 1);
  double total = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    const std::uint32_t key = std::bit_cast<std::uint32_t>(std::abs(values[i])) >> kShift;
    bins[std::min(std::max(key, kLowest), kHighest) - kLowest] += weights[i];
    total += weights[i];
  }
  if (!(total > 0)) return -1;
  double sum = 0;
  std::uint32_t bin = 0;
  while (bin + 1 < bins.size() && (sum += bins[bin]) < 0.5 * total) ++bin;
  const std::uint32_t middle = ((bin + kLowest) << kShift) + (1u << (kShift - 1));
  return std::bit_cast<float>(middle);
}

IcpPairs::IcpPairs(device::Queue& queue, const PlanarSamples& samples, const ProxyModel& model,
                   const Pose& start, const IcpOptions& options)
    : queue_(queue),
      count_(samples.points.size()),
      centre_(centre_of(samples)),
      origin_(start * centre_),
      gate_m_(options.gate_m),
      normal_deg_(options.normal_deg),
      samples_{count_,
               column(queue, samples.points, 0),
               column(queue, samples.points, 1),
               column(queue, samples.points, 2),
               column(queue, samples.normals, 0),
               column(queue, samples.normals, 1),
               column(queue, samples.normals, 2)},
      pairs_(queue, count_),
      search_(queue, model, origin_) {
  double total = 0, square = 0;
  for (const auto& p : samples.points) {
    areas_.push_back(p[3]);
    total += p[3];
    square += static_cast<double>(p[3]) * (Vec3(p[0], p[1], p[2]) - centre_).squaredNorm();
  }
  radius_ = std::sqrt(square / total);
  area_ = queue.array(areas_);
  partial_ = queue.array<float>((count_ + kSamplesPerSum - 1) / kSamplesPerSum * ICP_PLANE_SUMS);
}

void IcpPairs::find(const Pose& world_from_scan) {
  local_from_scan_ = world_from_scan;
  local_from_scan_.translation -= origin_;
  search_.find(samples_, local_from_scan_, gate_m_, normal_deg_, pairs_);
}

std::vector<double> IcpPairs::sums(int point, int count, double cutoff_m) {
  IcpSumsParams params{};
  store_linear(local_from_scan_, params.linear);
  const Vec3 centre_local = local_from_scan_ * centre_;
  for (int k = 0; k < 3; ++k) {
    params.centre_scan[k] = static_cast<float>(centre_(k));
    params.centre_local[k] = static_cast<float>(centre_local(k));
  }
  params.cutoff = static_cast<float>(cutoff_m);
  params.samples = static_cast<std::uint32_t>(count_);
  const std::size_t blocks = (count_ + kSamplesPerSum - 1) / kSamplesPerSum;
  const auto& kernel = queue_.kernel(
      "icp_sums",
      {{"VW", queue_.vector_width()}, {"BLOCK", static_cast<int>(kSamplesPerSum)}, {"POINT", point}});
  queue_.launch("icp_sums", kernel, device::grid(blocks), params, samples_.x, samples_.y, samples_.z, area_,
                point ? pairs_.distance : pairs_.height, pairs_.triangle, pairs_.near_x, pairs_.near_y,
                pairs_.near_z, search_.triangles(), partial_);
  std::vector<float> partial(blocks * static_cast<std::size_t>(count));
  queue_.read(partial_, std::span<float>(partial));
  std::vector<double> sums(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < partial.size(); ++k) sums[k % sums.size()] += static_cast<double>(partial[k]);
  return sums;
}

PlaneSums IcpPairs::plane_sums(double cutoff_m) {
  const auto s = sums(0, ICP_PLANE_SUMS, cutoff_m);
  PlaneSums out;
  std::size_t k = 0;
  for (int row = 0; row < 7; ++row) {
    for (int col = row; col < 7; ++col) out.matrix(row, col) = out.matrix(col, row) = s[k++];
    out.right(row) = s[static_cast<std::size_t>(28 + row)];
  }
  out.weight = s[35];
  out.inlier_area = s[36];
  out.inlier_square = s[37];
  return out;
}

PointSums IcpPairs::point_sums(double cutoff_m) {
  const auto s = sums(1, ICP_POINT_SUMS, cutoff_m);
  PointSums out;
  out.weight = s[17];
  out.inlier_area = s[18];
  out.inlier_square = s[19];
  if (!(out.weight > 0)) return out;
  // The device's sums are about fixed centres; the centroids' share is taken off here, in double. Both
  // centres went to the device as floats, so the same floats are put back.
  const Vec3 scan_centre = centre_.cast<float>().cast<double>();
  const Vec3 local_centre = (local_from_scan_ * centre_).cast<float>().cast<double>();
  const Vec3 mean_l = Vec3(s[0], s[1], s[2]) / out.weight, mean_r = Vec3(s[3], s[4], s[5]) / out.weight;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      out.cross(a, b) = s[static_cast<std::size_t>(6 + 3 * a + b)] - out.weight * mean_l(a) * mean_r(b);
  out.scan_square = s[15] - out.weight * mean_l.squaredNorm();
  out.centroid_scan = scan_centre + mean_l;
  out.centroid_world = origin_ + local_centre + mean_r;
  return out;
}

}  // namespace hybrid::stages
