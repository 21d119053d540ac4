#pragma once
#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/square_planes.hpp"

namespace hybrid::stages {

struct SuperclusterOptions {
  double angle_deg = 3;        // alpha0: largest angle between neighbouring normals, floor
  double angle_sigmas = 3;     // k sigma_n
  double distance_factor = 2;  // beta of METHOD 3
  double offset_sigmas = 3;    // out-of-plane test
  int min_squares = 20;
  int tile = 1024;
};
const std::vector<OptionRow<SuperclusterOptions>>& supercluster_option_table();

// METHOD 3: joins neighbouring locally planar squares (across the azimuth seam when the image wraps), refits
// one plane per supercluster by least squares over its member samples and labels the samples. Contours are
// left empty (trace_contours fills them). Ids from 1, largest sample count first. Kernels: square_links,
// label_samples.
PlaneSegmentation grow_superclusters(device::Queue& queue, const RangeImage& image,
                                     const SquarePlanes& squares, const SuperclusterOptions& options = {});

}  // namespace hybrid::stages
