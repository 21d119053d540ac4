#pragma once
#include <cstdint>
#include <optional>

#include "geometry/image.hpp"
#include "geometry/range_image.hpp"
#include "geometry/shoulder.hpp"
#include "geometry/superclusters.hpp"
#include "stages/scan/node_lookup.hpp"

namespace hybrid::stages {

// A supercluster seen head on, at one scale: pixel (x, y) is at origin + pixel_m * (x * right - y * up).
struct Orthophoto {
  Vec3 origin, right,
      up;  // scan frame, metres; of a wall `up` is as near to the scan's Z as the plane allows
  double pixel_m = 0;
  Image8 picture;  // RGB
};

// What samples look like: their colour, else their intensity between the scan's 1st and 99th percentile, what
// is above brought back (Shoulder), else their distance to the plane, three of its rms to black or white.
class SampleLook {
 public:
  explicit SampleLook(const RangeImage& image);
  std::array<std::uint8_t, 3> operator()(std::size_t node, const Supercluster& plane) const;
  const NodeLookup& lookup() const { return lookup_; }

 private:
  const RangeImage& image_;
  NodeLookup lookup_;
  float darkest_ = 0, brightest_ = 1;
  Shoulder shoulder_;
};

// The supercluster's samples on its plane, dark grey where it has none (holes, what stands before it); a
// pixel is as large as the ground that a sample stands for, larger where the longer side would exceed
// most_pixels. Nothing of a supercluster without contours.
std::optional<Orthophoto> make_orthophoto(const RangeImage& image, const PlaneSegmentation& segmentation,
                                          const Supercluster& plane, const SampleLook& look,
                                          int most_pixels = 1024);

}  // namespace hybrid::stages
