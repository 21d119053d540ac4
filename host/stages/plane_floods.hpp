#pragma once
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/tiles.hpp"
#include "stages/noise_model.hpp"
#include "stages/ray_plane.hpp"

namespace hybrid::stages {

// What became of a sample no region took.
enum SampleUse : std::uint8_t {
  kNotFree = 0,  // not measured, or a region's
  kFree = 1,
  kTaken = 2,   // by a small plane
  kBlocked = 3  // on a curved surface
};

// A window that lies on a plane: its upper left sample and its shape (params_window_planes.h), or kSparseSeed
// (sparse_seeds.hpp).
inline constexpr std::uint8_t kSparseSeed = 255;
struct WindowSeed {
  std::uint32_t sample = 0;
  std::uint8_t shape = 0;
  std::uint32_t member = 0;  // a sample of the window that lies on the plane
};

struct PlaneFlood {
  std::vector<std::uint32_t> samples;  // sorted
  RayPlane plane{Vec3::UnitX()};
  double chi2 = 0;  // of the samples, along their rays
};

// Floods planes over the free samples of an image.
class PlaneFlooder {
 public:
  PlaneFlooder(const RangeImage& image, const std::vector<std::uint8_t>& use, const RangeNoise& noise)
      : image_(image), use_(use), noise_(noise) {}

  // The free samples connected (8 neighbours, 24 from a sparse seed, across the azimuth seam) to the seed's
  // that lie within three sigmas of the plane through all of them, the uncertainty of the plane while it is
  // small included. Samples outside `limits` are not entered. Empty when the seed's free samples fix no
  // plane.
  PlaneFlood flood(const WindowSeed& seed, const Tile& limits) const;
  // Its samples alone, in the order of the flood: a third of the work.
  std::vector<std::uint32_t> samples(const WindowSeed& seed, const Tile& limits) const;

 private:
  std::vector<std::uint32_t> seed_samples(const WindowSeed& seed) const;

  const RangeImage& image_;
  const std::vector<std::uint8_t>& use_;
  RangeNoise noise_;
};

}  // namespace hybrid::stages
