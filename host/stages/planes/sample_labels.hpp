#pragma once
#include <vector>

#include "shared/params_label_samples.h"
#include "stages/planes/small_planes.hpp"

namespace hybrid::stages {

// Which planes compete for the samples of each square.
struct LabelContest {
  std::vector<std::uint32_t> candidates;        // LABEL_CANDIDATES per square: region + 1; 0 ends the list
  std::vector<std::array<float, 4>> own_plane;  // per square: a planar square of no region, else 0
};

// The regions of the 5 x 5 squares around each square and those present in the 3 x 3, the nearest first.
LabelContest find_candidates(const SquarePlanes& squares, const SquareGrid& grid, const PlaneRegions& regions,
                             const SquarePresence& presence);

// Region + 1 per sample by kernel label_samples, curved regions included, in place of what `labels` has (one
// per sample); planes are per region. How many samples each region gained or lost, per region + 1.
std::vector<std::int64_t> label_samples(device::Queue& queue, const RangeImage& image,
                                        const SquarePlanes& squares, const SquareGrid& grid,
                                        const LabelContest& contest, const std::vector<Plane>& planes,
                                        const SuperclusterOptions& options,
                                        std::vector<std::uint32_t>& labels);

// Least squares over each region's measured samples, weighted 1 / max(|n.u|, c)^2 because range noise is
// along the ray (METHOD 2). Regions with fewer than 3 samples keep their plane.
void refit_planes(const RangeImage& image, int square, const std::vector<std::uint32_t>& labels,
                  std::vector<Plane>& planes);

// Of a large image the first round sees every third row: what it leaves is little to the last one.
enum class PolishRounds { first, last, both };

// The last word on each plane: least squares along the rays over its labelled samples, each weighted by its
// own noise and by Tukey's biweight, so that strangers among them (relief, the foot of a step, mixed samples)
// have little say, and those beside other labels together no more than a few (who has them depends on where
// the planes were thought to be); starts from the plane given. Planes whose samples fix no plane stay, and
// all but those labelled `only` where there are such.
void polish_planes(const RangeImage& image, int square, const std::vector<std::uint32_t>& labels,
                   const RangeNoise& noise, std::vector<Plane>& planes,
                   PolishRounds rounds = PolishRounds::both, const std::vector<std::uint32_t>& only = {});

// Samples, centroid, rms and area of each region over its measured samples; `id` and `squares` are left
// alone.
std::vector<Supercluster> measure_planes(const RangeImage& image, int square,
                                         const std::vector<std::uint32_t>& labels,
                                         const std::vector<Plane>& planes);

}  // namespace hybrid::stages
