#pragma once
#include <vector>

#include "stages/registration/scan_icp.hpp"
#include "stages/registration/scan_pairs.hpp"

namespace hybrid::stages {

// Places of a scan beside a pose, along a line, on scans whose poses stay: compared are the planar samples of
// all of them whose normals have a component along it. The references must outlive it.
class LineOfPlaces {
 public:
  // `direction`: world, unit; `most_samples`: of each scan.
  LineOfPlaces(device::Queue& queue, const IcpScan& scan, const std::vector<PlacedScan>& placed,
               const Pose& world_from_scan, const Vec3& direction, std::size_t most_samples,
               const ScanIcpOptions& options = {});
  LineOfPlaces(const LineOfPlaces&) = delete;  // its pairs refer to its samples
  LineOfPlaces& operator=(const LineOfPlaces&) = delete;

  Pose at(double shift_m) const;

  // Of areas times the squared component along the line, both ways: within `within_m` of surfaces of the
  // other, and seen through (ScanIcpOptions::clear_m).
  struct Bearing {
    double on_m2 = 0, through_m2 = 0;
    std::vector<double> on_other_m2;  // of on_m2, by scan placed
    double speaks_m2() const { return on_m2 - through_m2; }
  };
  Bearing bearing(double shift_m, double within_m);

  // This place and `steps` on either side, step_m(within_m) apart.
  static double step_m(double within_m) { return 1.5 * within_m; }
  struct Place {
    double shift_m = 0;
    Bearing bearing;
  };
  std::vector<Place> places(double shift_m, double within_m, int steps);
  // The one that most speaks for, the first where several do.
  static const Place& best(const std::vector<Place>& places);

  // Robust ICP along the line alone, as register_to_scans(). `sigma_m`: from what the pairs are off, each
  // supercluster's error counting as one.
  struct Settled {
    double shift_m = 0, sigma_m = 0;
    bool converged = false;  // false, too, without pairs
  };
  Settled settle(double shift_m, double gate_m);

 private:
  struct OnOther {
    std::size_t other = 0;
    ScanPairs pairs;
    std::vector<double> bears_m2;  // by sample
  };
  void add(std::size_t other, const IcpScan::Samples& samples, const Pose& world_from_samples,
           const ScanSurface& surface, bool forward);
  void find(double shift_m, double gate_m);

  device::Queue& queue_;
  const std::vector<PlacedScan>& placed_;
  ScanIcpOptions options_;
  Pose start_;
  Vec3 direction_;
  IcpScan::Samples own_;
  std::vector<IcpScan::Samples> theirs_;
  std::vector<OnOther> all_;
};

}  // namespace hybrid::stages
