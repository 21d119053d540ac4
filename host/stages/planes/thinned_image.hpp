#pragma once
#include <cstddef>

#include "geometry/range_image.hpp"

namespace hybrid::stages {

// A range image whose rows and columns lie far enough from each other that neighbours say where a plane is:
// of a denser one every `stride`th row and column, at most 8 (points and mask only).
class ThinnedImage {
 public:
  explicit ThinnedImage(const RangeImage& whole);

  int stride() const { return stride_; }
  const RangeImage& image() const { return stride_ > 1 ? thinned_ : whole_; }
  // Of the image's sample, in the whole one.
  std::size_t whole_index(std::size_t sample) const;

 private:
  const RangeImage& whole_;
  int stride_;
  RangeImage thinned_;
};

}  // namespace hybrid::stages
