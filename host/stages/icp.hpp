#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

struct IcpOptions {
  std::string step = "plane";    // "point" (the paper's: Horn on closest points) | "plane" (point-to-plane)
  std::string robust = "tukey";  // "none" | "tukey"
  double gate_m = 0;  // pairs farther apart are ignored; 0 = no gate (robust weights narrow by themselves)
  double normal_deg = 45;  // compatible normals: closest face among those within this angle
  int max_iterations = 60;
  double tau = 1e-5;         // stop: relative change of the mean squared distance (paper)
  int max_samples = 200000;  // planar samples used, chosen by area; 0 = all
  bool free_scale = false;
  int seed = 1;
};
const std::vector<OptionRow<IcpOptions>>& icp_option_table();

// Samples of superclusters, scan frame: the source of ICP (planar data only, METHOD 6).
struct PlanarSamples {
  std::vector<std::array<float, 4>> points;   // x y z, weight (area in m2 the sample stands for)
  std::vector<std::array<float, 4>> normals;  // of the supercluster, towards the scanner; w = 0
};

// Measured planar samples, thinned by *area* (solid angle x r^2 / cos) to about max_samples, projected onto
// their supercluster's plane (FINDINGS.md). Deterministic.
PlanarSamples choose_planar_samples(const RangeImage& image, const PlaneSegmentation& segmentation,
                                    int max_samples, int seed);

struct Registration {
  Pose world_from_scan;
  bool converged = false;
  int iterations = 0;
  double rms_m = 0;    // of inlier pairs, weighted
  double overlap = 0;  // share of the planar area within 5 cm of a compatible face
  std::array<double, 36>
      covariance{};  // 6x6 row-major: rotation vector (rad), translation (m); world, left perturbation
  std::vector<std::string> degenerate;  // directions not determined, in words
};

// METHOD 6 (paper 2.3): closest points on the model's polygons found on the device each iteration. Kernels:
// closest_point, icp_sums. Throws ErrorKind::input: no planar samples, no faces.
Registration register_to_model(device::Queue& queue, const PlanarSamples& samples, const PolygonModel& model,
                               const Pose& start, const IcpOptions& options = {});

// Distance from every measured node to the closest compatible face (NaN for nodes without a measured sample),
// world scale, metres. `normal_deg` < 0 ignores normals. Kernel: closest_point. Used for residual pictures,
// for the shares within 5 and 10 cm, and to see which planar samples a face explains.
std::vector<float> distance_to_model(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const PolygonModel& model,
                                     const Pose& world_from_scan, double normal_deg, int tile = 1024);

}  // namespace hybrid::stages
