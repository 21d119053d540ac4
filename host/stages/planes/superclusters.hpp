#pragma once
#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"
#include "stages/planes/square_planes.hpp"

namespace hybrid::stages {

struct SuperclusterOptions {
  double angle_deg = 3;        // alpha0: largest angle between neighbouring normals, floor
  double angle_sigmas = 3;     // k sigma_n
  double distance_factor = 2;  // beta of METHOD 3
  double offset_sigmas = 3;    // out-of-plane test
  int min_squares = 20;
  int min_plane_samples = 48;      // of planes recovered from what no such supercluster took
  int min_cylinder_samples = 200;  // of the smallest column or pipe (cylinders.hpp); 0: none is looked for
  double label_sigmas = 3.5;       // a sample belongs to a plane within this many sigmas of range noise
  double waviness_m = 0.005;       // ... plus this: how far real walls stray from a plane, along the normal
  double most_waviness_m = 0;      // ... doubled up to this while planes interleave
  double min_curvature = 0.15;     // 1/m: regions that bend more, significantly, are no planes
  double max_crease_share = 0.35;  // of a region's rim, bending away to the next planar squares: a facet
  int tile = 1024;
};
const std::vector<OptionRow<SuperclusterOptions>>& supercluster_option_table();

// METHOD 3: joins neighbouring locally planar squares (across the azimuth seam when the image wraps), drops
// curved regions, merges planes broken by an occluder, refits one plane per supercluster by least squares
// over its measured member samples and labels the samples, those at square borders and in mixed squares
// included (interpolated nodes get labels too, but are neither counted nor fitted). Contours are left empty
// (trace_contours fills them). Cylinders are found among what is left (cylinders.hpp). While planes
// interleave (kMostInterleaved), which shows that walls stray farther than `waviness`, all is done again with
// twice that, up to `most_waviness`. Ids from 1, largest sample count first, ties by the first square. Throws
// ErrorKind::failed when image and squares do not fit together. Kernels: square_links, label_samples.
PlaneSegmentation grow_superclusters(device::Queue& queue, const RangeImage& image,
                                     const SquarePlanes& squares, const SuperclusterOptions& options = {});

}  // namespace hybrid::stages
