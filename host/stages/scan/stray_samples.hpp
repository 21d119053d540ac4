#pragma once
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// Why a sample stands for no surface. Such samples are data and are kept, but they are not drawn.
enum Stray : std::uint8_t {
  kNotStray = 0,
  kBetweenSurfaces = 1,  // a mixed pixel: its beam hit two surfaces, its range is a mean of both
  kIsolated = 2,         // alone in the air
  kThroughGlass = 3,     // behind a pane on its ray: a mirror image or seen through it (panes.hpp)
};

// Defaults were chosen on hybrid-synth rooms of seeds 2 to 4, whose truth says which samples are mixed.
struct StrayOptions {
  double noise_sigmas = 4;     // ranges differ by more than this times sqrt(2) sigma: not by noise
  double plane_sigmas = 6;     // a neighbour this near the test plane, along its ray, is on it
  double steep = 5;            // range over arc between samples of one surface: incidence up to 79 degrees
  double gap = 2;              // range over arc by which a mixed sample is off both its surfaces: 63 degrees
  double planar_share = 0.41;  // of the neighbours on one plane: more than the 9 of 24 that two straight
                               // lines of samples have, a veil along an edge and the surface beside it
  double near_share = 0.125;   // of the neighbours: 3 of 24
  int least_neighbours = 8;    // of 24
  int tile = 1024;
};

// Per node one of Stray; the rule is in kernels/stray_samples.cl. Samples with a supercluster, nodes that are
// empty or interpolated: kNotStray. `sigma_m`: range noise. Kernel: stray_samples. Throws ErrorKind::failed
// when the labels are not the image's.
std::vector<std::uint8_t> find_stray_samples(device::Queue& queue, const RangeImage& image,
                                             const std::vector<std::uint32_t>& sample_label, double sigma_m,
                                             const StrayOptions& options = {});

}  // namespace hybrid::stages
