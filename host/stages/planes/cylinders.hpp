#pragma once
#include <vector>

#include "geometry/cylinder.hpp"
#include "geometry/superclusters.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::stages {

inline constexpr double kVaultGoesOn_m = 1;  // beyond the ends that were seen of it

// Columns and pipes among what lies on no plane, seen from outside, and barrel vaults, seen from inside:
// round about an axis in any direction, with a constant taper (an entasis' tangent). Squares around a square,
// in contact, whose normals turn about one direction suggest one; it takes the squares and then the samples
// that go on with it, and is fitted to these again. What is narrower than a few squares shows itself on
// strips of them. What is kept has `min_cylinder_samples` samples, shows an arc of at least 70 degrees that
// stands out of its scatter, is longer than one and a half radii (of what is seen from inside a sixth of one,
// which arches are), and is not seen through: along it no more than one ray in twenty ends behind it. Ids
// from 1, most samples first. `segmentation` of the same image and squares; no label of a plane is changed.
// Deterministic, no device.
std::vector<Cylinder> find_cylinders(const RangeImage& image, const SquarePlanes& squares,
                                     const PlaneSegmentation& segmentation,
                                     const SuperclusterOptions& options = {});

// How far a sample may lie from a cylinder that it is on: by the noise there, and unevenness in proportion to
// the radius, up to the waviness of planes.
double cylinder_reach_m(const Cylinder& cylinder, const Vec3& point, const RangeNoise& noise,
                        const SuperclusterOptions& options);
double cylinder_unevenness_m(const Cylinder& cylinder,
                             const SuperclusterOptions& options);  // of this, the latter

}  // namespace hybrid::stages
