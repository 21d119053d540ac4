#pragma once
#include <map>

#include "score/measure/planes_hoover.hpp"
#include "score/read/scan_result.hpp"
#include "score/read/scene_truth.hpp"

namespace score {

// How far the normals of correctly found planes are from the true ones, against what the samples allow: the
// Cramer-Rao bound of a plane's direction under range noise of one size, which no unbiased fit of these
// samples beats (root of the trace of the 2 x 2 covariance). The noise is the plane's own: 1.4826 times the
// median absolute difference of its samples' measured and true ranges.
struct NormalScore {
  int planes = 0;                                     // compared: correct in the Hoover row given
  int within_3 = 0;                                   // error at most three times the bound
  double median = 0, percentile_95 = 0, largest = 0;  // of error over bound
  double median_bound_deg = 0;
};

// Range noise of 1 m; radians. Points in the scan frame, on the plane or near it. Infinite where they fix no
// direction.
double direction_bound_rad(const Plane& plane, const std::vector<Eigen::Vector3f>& points);

// `planes_in_scan`: true normals and offsets in the scan frame. Points of a grid without x y z are none.
NormalScore score_normals(const LabelledGrid& grid, const TrueSamples& truth, const HooverScore& hoover,
                          const Normals& region_normals,
                          const std::map<std::uint32_t, Plane>& planes_in_scan);

}  // namespace score
