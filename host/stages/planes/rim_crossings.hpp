#pragma once
#include <optional>
#include <vector>

#include "geometry/range_image.hpp"
#include "stages/planes/plane_regions.hpp"

namespace hybrid::stages {

// From the last sample of a plane along a row or column to the surface beyond, all along the rays.
struct RimCrossing {
  int gap = 0;             // nodes between them
  std::size_t beyond = 0;  // the first sample there
  bool to_plane = false;   // it is another plane's; else two neighbours that go on like a surface
  // By how much the sample beyond lies behind this plane; the surface beyond, where this sample is, behind
  // it.
  double behind_here_m = 0, behind_there_m = 0;

  bool is_crease() const { return !(behind_here_m * behind_there_m > 0); }  // they meet in between
  double jump_m() const;  // positive: the surface beyond is behind; 0 at a crease
};

// Looks at the rims of labelled regions. Keeps references to what it is given.
class RimCrossings {
 public:
  // labels: region + 1 per sample, planes per region.
  RimCrossings(const RangeImage& image, const std::vector<Plane>& planes, const PlaneRegions& regions,
               const std::vector<std::uint32_t>& labels)
      : image_(image), planes_(planes), regions_(regions), labels_(labels) {}

  // A measured sample of a region that is no curved one.
  bool on_plane(std::size_t i) const {
    return labels_[i] != 0 && image_.mask[i] == kMeasured && !regions_.regions[labels_[i] - 1].curved;
  }
  // All four neighbours have the node's label: as most do.
  bool is_inside(int row, int col) const {
    if (row == 0 || row + 1 == image_.rows || col == 0 || col + 1 == image_.cols) return false;
    const std::uint32_t* at = &labels_[image_.index(row, col)];
    return at[-1] == *at && at[1] == *at && at[-image_.cols] == *at && at[image_.cols] == *at;
  }
  const Plane& plane(std::size_t i) const { return planes_[labels_[i] - 1]; }
  std::optional<std::size_t> node(int row, int col) const {
    col = image_.wrapped(col);
    if (row < 0 || row >= image_.rows || col < 0 || col >= image_.cols) return std::nullopt;
    return image_.index(row, col);
  }
  // Measured minus predicted range; nothing where the ray misses the plane.
  std::optional<double> behind_m(const Plane& plane, std::size_t i) const;
  // Cosine of the incidence of a sample on its own plane.
  double cosine(std::size_t i) const;
  // From a node to its neighbour, at the sample's range.
  double spacing_m(std::size_t i, int col_step) const;

  // From sample i (on_plane) at a node in one of the four directions; nothing where the label goes on, or
  // comes again, or no surface is met within kMostGap nodes.
  std::optional<RimCrossing> cross(int row, int col, int row_step, int col_step) const;
  static constexpr int kMostGap = 12, kMostReach = kMostGap + 2;  // nodes; the farthest that is looked at

 private:
  const RangeImage& image_;
  const std::vector<Plane>& planes_;
  const PlaneRegions& regions_;
  const std::vector<std::uint32_t>& labels_;
};

}  // namespace hybrid::stages
