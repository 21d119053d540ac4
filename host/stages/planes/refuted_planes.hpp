#pragma once
#include <cstdint>
#include <vector>

#include "geometry/plane.hpp"
#include "stages/planes/plane_regions.hpp"
#include "stages/planes/small_planes.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

struct RefutedLimits {
  std::int64_t least_samples = 48;
  double min_curvature = 0.15;  // 1/m
};

// Forgets small planes that the labels show to be none, so that their samples may go to others: other planes
// left it too few samples, or they are relief, or bend more than min_curvature. Floods take what lies within
// the noise, labels what lies within the waviness as well; on a plane that adds little, on a curved surface
// most. Labels: index + 1 into planes and regions. True when there were any.
bool drop_refuted_planes(const RangeImage& image, const RangeNoise& noise, const std::vector<Plane>& planes,
                         const std::vector<std::uint32_t>& labels, const RefutedLimits& limits,
                         PlaneRegions& regions, SquarePresence& presence);

}  // namespace hybrid::stages
