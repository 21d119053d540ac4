#pragma once
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/tiles.hpp"
#include "stages/ray_plane.hpp"

namespace hybrid::stages {

// What became of a sample no region took.
enum SampleUse : std::uint8_t {
  kNotFree = 0,  // not measured, or a region's
  kFree = 1,
  kTaken = 2,   // by a small plane
  kBlocked = 3  // on a curved surface
};

// A window that lies on a plane: its upper left sample and its shape (params_window_planes.h).
struct WindowSeed {
  std::uint32_t sample = 0;
  std::uint8_t shape = 0;
};

struct PlaneFlood {
  std::vector<std::uint32_t> samples;  // sorted
  RayPlane plane{Vec3::UnitX()};
};

// Floods planes over the free samples of an image.
class PlaneFlooder {
 public:
  PlaneFlooder(const RangeImage& image, const std::vector<std::uint8_t>& use, double sigma_m)
      : image_(image), use_(use), sigma_m_(sigma_m) {}

  // The free samples connected (8 neighbours, across the azimuth seam) to the window's that lie within three
  // sigmas of the plane through all of them, the uncertainty of the plane while it is small included. Samples
  // outside `limits` are not entered. Empty when the window's free samples fix no plane.
  PlaneFlood flood(const WindowSeed& seed, const Tile& limits) const;

 private:
  const RangeImage& image_;
  const std::vector<std::uint8_t>& use_;
  double sigma_m_;
};

}  // namespace hybrid::stages
