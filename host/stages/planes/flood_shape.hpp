#pragma once
#include <functional>

#include "stages/planes/plane_floods.hpp"
#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

// Whether what a flood covers is a plane of its own or part of a curved surface: three tests that
// recover_small_planes() asks one after the other.

// Moments, plane and axes of the flood's samples; no squares.
PlaneRegion region_of_flood(const RangeImage& image, const PlaneFlood& flood);

// The flood bends (bending.hpp): all of it where its scatter is more than the noise explains, else
// also without its rim.
bool flood_bends(const RangeImage& image, const PlaneFlood& flood, const PlaneRegion& region,
                 double min_curvature, bool scattered);

// Fewer than four samples wide, a flood cannot show that it bends; but a curved surface goes on smoothly
// (less than 45 degrees out of the plane, not over a gap) beyond its rim, where a jamb or a leg ends in a
// step or an edge. True when that holds for more than `share` of the samples.
bool is_strip_of_smooth_surface(const RangeImage& image, const PlaneFlood& flood, double sigma_m,
                                double share);

// A sample of a curved surface (kBlocked) lies within two rows and columns of `sample`, less than 45 degrees
// out of the plane and not over a gap, on a part of that surface that is turned against the plane by less
// than that (`blocked_normal`: of the part a blocked sample is on): the surface may go on as this plane.
bool meets_curved_surface(const RangeImage& image, const std::vector<std::uint8_t>& use, const Plane& plane,
                          double sigma_m, std::uint32_t sample,
                          const std::function<Vec3(std::uint32_t)>& blocked_normal);

}  // namespace hybrid::stages
