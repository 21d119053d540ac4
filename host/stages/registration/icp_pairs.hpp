#pragma once
#include <Eigen/Core>
#include <vector>

#include "device/queue.hpp"
#include "geometry/pose.hpp"
#include "stages/registration/icp.hpp"
#include "stages/registration/proxy_search.hpp"

namespace hybrid::stages {

inline constexpr std::size_t kSamplesPerSum = 256;  // a partial sum's

// The k-th of each row's numbers, on the device.
device::Array<float> column(device::Queue& queue, const std::vector<std::array<float, 4>>& rows,
                            std::size_t k);

using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

// Sums over the pairs inside the robust weights' cutoff.
struct PairSums {
  double weight = 0;         // area times robust weight
  double inlier_area = 0;    // m2
  double inlier_square = 0;  // m2 times squared error

  double mean_square() const { return inlier_area > 0 ? inlier_square / inlier_area : 0; }
};

// Normal equations of the plane step about the pivot: unknowns rotation vector, translation, relative scale.
struct PlaneSums : PairSums {
  Matrix7 matrix = Matrix7::Zero();
  Vector7 right = Vector7::Zero();
};

// What Horn's closed form needs; l in the scan frame, r in the world, both about their centroids.
struct PointSums : PairSums {
  Vec3 centroid_scan = Vec3::Zero(), centroid_world = Vec3::Zero();
  Mat3 cross = Mat3::Zero();  // sum w l r^T
  double scan_square = 0;     // sum w |l|^2
};

// The pairs sample / closest point of the model, kept on the device from one iteration to the next.
class IcpPairs {
 public:
  IcpPairs(device::Queue& queue, const PlanarSamples& samples, const ProxyModel& model, const Pose& start,
           const IcpOptions& options);

  // Finds the closest compatible points under this pose.
  void find(const Pose& world_from_scan);
  // Of the last find(), per sample; NaN without a pair.
  std::vector<float> heights() { return queue_.read(pairs_.height); }
  std::vector<float> distances() { return queue_.read(pairs_.distance); }
  PlaneSums plane_sums(double cutoff_m);
  PointSums point_sums(double cutoff_m);

  const std::vector<float>& areas() const { return areas_; }
  // Centroid of the samples (scan frame) and their rms distance from it.
  const Vec3& centre_in_scan() const { return centre_; }
  double radius_m() const { return radius_; }

 private:
  std::vector<double> sums(int point, int count, double cutoff_m);

  device::Queue& queue_;
  std::size_t count_ = 0;
  Vec3 centre_ = Vec3::Zero(), origin_ = Vec3::Zero();  // origin of the local frame, world
  double radius_ = 0, gate_m_ = 0, normal_deg_ = 0;
  Pose local_from_scan_;
  std::vector<float> areas_;
  SearchQueries samples_;
  SearchAnswers pairs_;
  ProxySearch search_;
  device::Array<float> area_, partial_;
};

// Weighted median of |value| over the values that are not NaN, to 1 part in 4096 and within 1 um .. 1 km: the
// scale of robust weights needs no more, and a histogram needs no sorting. -1 when there are none.
double weighted_median(const std::vector<float>& values, const std::vector<float>& weights);

}  // namespace hybrid::stages
