#pragma once
#include <array>
#include <vector>

#include "geometry/range_image.hpp"

namespace hybrid::stages {

// Which node of a range image looks at a point. The image must outlive it.
class NodeLookup {
 public:
  // Of an image without nodes nothing may be asked.
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
    double sign() const { return sign_; }
    std::vector<double> middles() const;  // between an angle and the next

   private:
    const std::vector<double>& angles_;
    double low_, high_, step_;
    double sign_;  // -1: decreasing
  };

  friend class NodeWalk;
  bool wraps_;
  Axis rows_, cols_;
  // Between a row and the next, a column and the next: the tangent of the elevation, the direction. Empty
  // where rows look beyond the zenith.
  std::vector<double> row_ends_;
  std::vector<Vec2> col_ends_;
};

// Looks up points that come one beside the other: what towards() says, from the last node on, where a step or
// two lead there: a tenth of the time. The lookup must outlive it.
class NodeWalk {
 public:
  explicit NodeWalk(const NodeLookup& lookup) : lookup_(lookup) {}
  NodeLookup::Node towards(const Vec3& point);

 private:
  bool walk(const Vec3& point);

  const NodeLookup& lookup_;
  NodeLookup::Node last_{0, 0, false};
};

}  // namespace hybrid::stages
