#include "stages/icp_pairs.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "shared/params_icp_sums.h"
#include "stages/proxy_triangles.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kBlock = 256;  // samples per partial sum

device::Array<float> column(device::Queue& queue, const std::vector<std::array<float, 4>>& rows,
                            std::size_t k) {
  std::vector<float> values(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) values[i] = rows[i][k];
  return queue.array(values);
}

void store_linear(const Pose& pose, float* target) {
  const Mat3 linear = pose.scale * pose.rotation.toRotationMatrix();
  for (int k = 0; k < 9; ++k) target[k] = static_cast<float>(linear(k / 3, k % 3));
}

}  // namespace

ClosestPointParams closest_point_params(const Pose& local_from_scan, double gate_m, double normal_deg,
                                        std::size_t queries, std::size_t triangles) {
  const float infinity = std::numeric_limits<float>::infinity();
  const bool any_normal = normal_deg < 0 || normal_deg >= 180;
  ClosestPointParams params{};
  store_linear(local_from_scan, params.linear);
  for (int k = 0; k < 3; ++k) params.translation[k] = static_cast<float>(local_from_scan.translation(k));
  params.gate2 = gate_m > 0 ? static_cast<float>(gate_m * gate_m) : infinity;
  params.min_facing =
      any_normal ? -infinity
                 : static_cast<float>(local_from_scan.scale * std::cos(normal_deg * std::numbers::pi / 180));
  params.queries = static_cast<std::uint32_t>(queries);
  params.triangles = static_cast<std::uint32_t>(triangles);
  return params;
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

IcpPairs::IcpPairs(device::Queue& queue, const PlanarSamples& samples, const PolygonModel& model,
                   const Pose& start, const IcpOptions& options)
    : queue_(queue), count_(samples.points.size()), gate_m_(options.gate_m), normal_deg_(options.normal_deg) {
  double total = 0;
  for (const auto& p : samples.points) {
    areas_.push_back(p[3]);
    total += p[3];
    centre_ += static_cast<double>(p[3]) * Vec3(p[0], p[1], p[2]);
  }
  centre_ /= total;
  for (const auto& p : samples.points)
    radius_ += static_cast<double>(p[3]) * (Vec3(p[0], p[1], p[2]) - centre_).squaredNorm() / total;
  radius_ = std::sqrt(radius_);
  origin_ = start * centre_;

  x_ = column(queue, samples.points, 0);
  y_ = column(queue, samples.points, 1);
  z_ = column(queue, samples.points, 2);
  area_ = column(queue, samples.points, 3);
  nx_ = column(queue, samples.normals, 0);
  ny_ = column(queue, samples.normals, 1);
  nz_ = column(queue, samples.normals, 2);
  distance_ = queue.array<float>(count_);
  height_ = queue.array<float>(count_);
  near_x_ = queue.array<float>(count_);
  near_y_ = queue.array<float>(count_);
  near_z_ = queue.array<float>(count_);
  triangle_ = queue.array<std::uint32_t>(count_);
  partial_ = queue.array<float>((count_ + kBlock - 1) / kBlock * ICP_PLANE_SUMS);
  const auto records = proxy_triangles(model, origin_);
  triangle_count_ = records.size();
  triangles_ = queue.array(records);
}

void IcpPairs::find(const Pose& world_from_scan) {
  local_from_scan_ = world_from_scan;
  local_from_scan_.translation -= origin_;
  const int lanes = queue_.vector_width();
  const auto items = (count_ + static_cast<std::size_t>(lanes) - 1) / static_cast<std::size_t>(lanes);
  queue_.launch("closest_point", queue_.kernel("closest_point", {{"VW", lanes}}), device::grid(items),
                closest_point_params(local_from_scan_, gate_m_, normal_deg_, count_, triangle_count_), x_, y_,
                z_, nx_, ny_, nz_, triangles_, distance_, height_, triangle_, near_x_, near_y_, near_z_);
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
  const std::size_t blocks = (count_ + kBlock - 1) / kBlock;
  const auto& kernel = queue_.kernel(
      "icp_sums", {{"VW", queue_.vector_width()}, {"BLOCK", static_cast<int>(kBlock)}, {"POINT", point}});
  queue_.launch("icp_sums", kernel, device::grid(blocks), params, x_, y_, z_, area_,
                point ? distance_ : height_, triangle_, near_x_, near_y_, near_z_, triangles_, partial_);
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
