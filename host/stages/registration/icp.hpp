#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/registration/proxy_model.hpp"

namespace hybrid::stages {

struct IcpOptions {
  // "point": Horn on closest points; with robust = "none" and normal_deg = 180 it is the paper's ICP.
  std::string step = "plane";    // "point" | "plane" (point-to-plane)
  std::string robust = "tukey";  // "none" | "tukey"
  double gate_m = 0;  // pairs farther apart are ignored; 0 = no gate (robust weights narrow by themselves)
  double normal_deg = 45;  // compatible normals: closest face among those within this angle; 180 = all
  int max_iterations = 60;
  double tau = 1e-5;  // "point" only: stop at this relative change of the mean squared distance (paper)
  double scale_floor_m = 0.0002;  // Tukey's scale never falls below
  int max_samples = 200000;       // planar samples used, chosen by area; 0 = all
  bool free_scale = false;
  int seed = 1;
};
const std::vector<OptionRow<IcpOptions>>& icp_option_table();

// Samples of surfaces, scan frame. Those of superclusters are the source of ICP to the proxy (planar data
// only, METHOD 6).
struct PlanarSamples {
  std::vector<std::array<float, 4>> points;   // x y z, weight (area in m2 the sample stands for)
  std::vector<std::array<float, 4>> normals;  // of the surface, towards the scanner; w = 0
  std::vector<std::uint32_t> supercluster;    // index of each sample's, or empty: ICP does not need it
};

// Measured planar samples, thinned by *area* (solid angle x r^2 / cos) to about max_samples (0 = all),
// projected onto their supercluster's plane (FINDINGS.md); superclusters in order, row by row. One sample is
// drawn per equal share of the area at a random place in it (`seed`), so that the grid's rows cannot beat
// with a regular step. Deterministic for any thread count.
PlanarSamples choose_planar_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                    int max_samples, int seed);

// The same of the measured samples outside superclusters but strays, thinned by area as if seen head on, each
// with the normal that its neighbours tell; what has none is left out. `stray` per node, or empty.
PlanarSamples choose_free_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                  const std::vector<std::uint8_t>& stray, int max_samples, int seed);

struct Registration {
  Pose world_from_scan;
  bool converged = false;
  int iterations = 0;
  double rms_m = 0;    // of inlier pairs, weighted: height over the face (plane step), distance (point step)
  double overlap = 0;  // share of the planar area within 5 cm of a compatible face
  // 6x6 row-major: rotation vector (rad), translation (m); world, left perturbation. From the pairs within
  // 5 cm, each supercluster's error counting as one (a proxy's faces are off as wholes), so that it does not
  // shrink with the sampling. Variance 1e6 along degenerate directions. Where opposite faces contradict each
  // other it says how far, not which of them is right. What displaced faces have in common moves the proxy as
  // a whole: no residual shows it, and it is not in here.
  std::array<double, 36> covariance{};
  // Directions not determined, in words: "free to slide along (1.00, 0.00, 0.00)", "free to turn about ...",
  // "free to scale". The plane step leaves the start pose as it is along them; a
  // scale that is open is the start's, and the covariance is that of a pose of this scale.
  std::vector<std::string> degenerate;
  // Where all that is not determined is how far it slides along one direction: that, world, unit.
  std::optional<Vec3> only_slide;
  std::vector<double> rms_history_m;  // rms_m before each step, and of the result
};

// METHOD 6 (paper 2.3): closest points on the model's polygons found on the device each iteration. Kernels:
// closest_point, icp_sums. The plane step (FINDINGS.md): Tukey weights whose scale 1.4826 median |height| may
// at most halve per iteration, 6x6 (7x7 with free_scale) normal equations, rotation at most 0.35 rad per
// step, until a step is below 1e-6 rad and 5e-6 m with the scale settled. The start's scale is kept unless
// free_scale. Throws ErrorKind::input: no planar samples, no faces, a start that is not finite, no sample
// with a compatible face.
Registration register_to_model(device::Queue& queue, const PlanarSamples& samples, const ProxyModel& model,
                               const Pose& start, const IcpOptions& options = {});

// What register_to_model() says of a pose, for one that was found otherwise: rms, overlap, covariance,
// degenerate directions; converged, no iterations.
Registration assess_pose(device::Queue& queue, const PlanarSamples& samples, const ProxyModel& model,
                         const Pose& pose, const IcpOptions& options = {});

// Distance from every measured node to the closest compatible face (NaN for nodes without a measured sample),
// world scale, metres. `normal_deg` < 0 ignores normals; so do nodes outside superclusters, which have none.
// NaN too where no face is compatible. Kernel: closest_point. Used for the shares
// within 5 and 10 cm, and to see which planar samples a face explains.
std::vector<float> distance_to_model(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const ProxyModel& model,
                                     const Pose& world_from_scan, double normal_deg);

// The same with a sign: above 0 in front of the face, below 0 behind it. For residual pictures. Nodes outside
// superclusters that are no nearer than `free_gate_m` (world scale) to any face may be NaN; 0 = all are
// measured.
std::vector<float> signed_distance_to_model(device::Queue& queue, const RangeImage& image,
                                            const PlaneSegmentation& segmentation, const ProxyModel& model,
                                            const Pose& world_from_scan, double normal_deg,
                                            double free_gate_m = 0);

// Per `wanted` node (0 or 1), within how many of the distances (world scale, descending, ends included) the
// closest compatible face lies; 0 for the others.
std::vector<std::uint8_t> near_faces(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const ProxyModel& model,
                                     const Pose& world_from_scan, double normal_deg,
                                     const std::vector<float>& within_m,
                                     const std::vector<std::uint8_t>& wanted);

}  // namespace hybrid::stages
