#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "shared/records.h"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

struct SquarePlaneOptions {
  int square = 5;                 // side n in samples, 3..16
  int hypotheses = 32;            // K test planes per square
  double sigma_m = 0;             // range noise along the ray; 0 = estimated from the scan
  double threshold_sigmas = 3;    // k of t(r) = k sigma_range(r) + threshold_m
  double threshold_m = 0.002;     // constant part of the inlier threshold
  double min_valid_share = 0.7;   // below: undersampled
  double min_inlier_share = 0.8;  // below: non-planar
  double min_cosine = 0.05;       // c_min: noise along rays nearer to grazing than this counts as at this
  // "paper" | "msac". On a 10 MP room with 2 mm of noise 95 % of the 5 x 5 squares' normals were within 57
  // deg by msac and 78 deg by the paper's score (8 x 8: 24 and 71), which more test planes make worse.
  std::string score = "msac";
  std::string fit = "ransac";  // "ransac" | "eigen", the paper's rejected baseline
  int seed = 1;
  int tile = 1024;
};
const std::vector<OptionRow<SquarePlaneOptions>>& square_plane_option_table();

struct SquarePlanes {
  int square = 5;
  int rows = 0, cols = 0;  // in squares: whole squares and the partial ones at the right and bottom edge
  double sigma_m = 0;      // used
  RangeNoise noise;        // what the squares show; sigma_m everywhere when that was given
  std::vector<SquareRecord> squares;  // rows x cols
};

// METHOD 2 (paper 2.1): RANSAC per square on the device, refit on the inliers. Kernel: square_planes.
// Measured and interpolated samples count as valid. sigma_m = 0: estimate_range_noise() (range_noise.hpp).
SquarePlanes fit_square_planes(device::Queue& queue, const RangeImage& image,
                               const SquarePlaneOptions& options = {});

// The table the kernel draws its test planes from: SQUARE_TRIPLETS triplets of a square of `side` x `side`
// samples, packed a | b << 8 | c << 16, of wide triangles on the grid, which noise tilts least.
std::vector<std::uint32_t> sample_triplets(int side, std::uint32_t seed);

}  // namespace hybrid::stages
