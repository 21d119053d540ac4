#pragma once
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/tiles.hpp"
#include "stages/planes/ray_plane.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {

// What became of a sample no region took.
enum SampleUse : std::uint8_t {
  kNotFree = 0,  // not measured, or a region's
  kFree = 1,
  kTaken = 2,   // by a small plane
  kBlocked = 3  // on a curved surface
};

// So many nodes from their samples floods, and what judges them, ask for the use of others.
inline constexpr int kUseReach = 2;

// Nearer to grazing a ray's sample is on no flood and no seed, as window_planes has it.
inline constexpr double kSeedCosine = 0.02;

// A window that lies on a plane: its upper left sample and its shape (params_window_planes.h), or kSparseSeed
// (sparse_seeds.hpp).
inline constexpr std::uint8_t kSparseSeed = 255;
struct WindowSeed {
  std::uint32_t sample = 0;
  std::uint8_t shape = 0;
  std::uint32_t member = 0;   // a sample of the window that lies on the plane
  std::uint64_t members = 0;  // of a sparse seed: its samples, a bit each, row by row
};

// Free samples from which a seed's flood sets out.
std::vector<std::uint32_t> seed_samples(const RangeImage& image, const std::vector<std::uint8_t>& use,
                                        const WindowSeed& seed);

// What a flood asks of a sample.
struct FloodSample {
  FloodSample() = default;
  explicit FloodSample(const Vec3& at) : point(at), range(at.norm()), inverse_range(1 / range) {}

  Vec3 point = Vec3::Zero();
  double range = 0, inverse_range = 0;
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
  // small included. Empty when the seed's free samples fix no plane.
  PlaneFlood flood(const WindowSeed& seed) const;
  // The largest part of a flood that hangs together by more than a sample's width, where that is most of it:
  // where another surface crosses the plane, the flood runs out along it, and the plane turns with it. Else
  // empty.
  PlaneFlood without_tongues(const PlaneFlood& flood) const;

 private:
  PlaneFlood through(std::vector<std::uint32_t> samples) const;

  const RangeImage& image_;
  const std::vector<std::uint8_t>& use_;
  RangeNoise noise_;
};

// The same within a part of an image, and fast: what seeds are worth.
class BlockFloods {
 public:
  BlockFloods(const RangeImage& image, const std::vector<std::uint8_t>& use, const RangeNoise& noise,
              const Tile& limits);
  // Within the limits: whether it is free and worth another flood: no large one covered it, nor so many small
  // ones that the next will hardly be larger. So the work per sample has a bound, however large `least` is.
  bool is_open(std::uint32_t sample) const;
  // Samples of the flood, which is large from `least` on.
  std::size_t flood(const WindowSeed& seed, std::size_t least);

 private:
  struct Field;
  std::uint32_t local(std::uint32_t sample) const;

  const RangeImage& image_;
  const std::vector<std::uint8_t>& use_;
  RangeNoise noise_;
  Tile limits_;
  int width_;
  std::vector<FloodSample> samples_;
  std::vector<std::uint32_t> marks_, marked_;
  std::vector<std::uint8_t> covered_;  // by how many floods, up to enough
};

}  // namespace hybrid::stages
