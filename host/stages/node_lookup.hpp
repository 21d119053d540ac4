#pragma once
#include <array>
#include <vector>

#include "geometry/range_image.hpp"

namespace hybrid::stages {

// Which node of a range image looks at a point. The image must outlive it.
class NodeLookup {
 public:
  // Not of an image without nodes.
  explicit NodeLookup(const RangeImage& image);

  struct Node {
    int row, col;
    bool within;  // the ray is no farther than one step outside the image's rows and columns
  };
  // The node whose ray is nearest to the direction of `point` (scan frame); straight above and below, any of
  // its row. Of an image that does not go all around, the nearest at its border.
  Node towards(const Vec3& point) const;

 private:
  // Increasing or decreasing angles, most of them evenly apart.
  class Axis {
   public:
    explicit Axis(const std::vector<double>& angles);
    int nearest(double angle) const;
    double low() const { return low_; }
    double high() const { return high_; }
    double step() const { return step_; }  // mean, positive

   private:
    const std::vector<double>& angles_;
    double low_, high_, step_;
    double sign_;  // -1: decreasing
  };

  bool wraps_;
  Axis rows_, cols_;
};

}  // namespace hybrid::stages
