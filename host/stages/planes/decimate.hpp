#pragma once
#include "device/queue.hpp"
#include "geometry/range_image.hpp"
#include "geometry/superclusters.hpp"

namespace hybrid::stages {

// Why a sample is kept or dropped. Only measured samples are counted or kept; interpolated ones never become
// output.
enum SampleFate : std::uint8_t {
  kNoSample = 0,   // empty or interpolated node
  kDiscarded = 1,  // interior of a supercluster
  kBoundary = 2,   // on a supercluster's contour
  kNonPlanarSquare = 3,
  kSmallPlanarSquare = 4,  // locally planar square outside superclusters
  kOutlier = 5,            // in a supercluster's square, off its plane
  kUndersampledSquare = 6,
  kUnexplained = 7,  // planar interior that no proxy face explains (set by keep_unexplained)
};

struct Decimation {
  std::vector<std::uint8_t> fate;  // SampleFate per node
  std::int64_t measured = 0;       // nodes measured, plus the image's extra samples
  std::int64_t discarded = 0;
  double discarded_share() const {
    return measured ? static_cast<double>(discarded) / static_cast<double>(measured) : 0;
  }
};

struct DecimateOptions {
  // The paper keeps all samples of squares that are not members. True: their samples that label_samples gave
  // to a supercluster (beside edges, around clutter) are interior, too.
  bool discard_in_mixed_squares = false;
  int tile = 1024;
};

// METHOD 4's rule (the paper's): discard interior planar samples, keep all others. Kernel: decimate.
Decimation decimate(device::Queue& queue, const RangeImage& image, const PlaneSegmentation& segmentation,
                    const std::vector<std::uint8_t>& boundary, const DecimateOptions& options = {});

// METHOD 4's final scene: a discarded sample comes back (kUnexplained) unless explained[i] (one per node) is
// set.
void keep_unexplained(const std::vector<std::uint8_t>& explained, Decimation& decimation);

}  // namespace hybrid::stages
