#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/rendering/render.hpp"
#include "stages/scan/sample_surface.hpp"

namespace hybrid::stages {
namespace {

constexpr double kOneSurface = 0.9;   // cosine between the normals of two samples of no plane
constexpr double kFarthestApart = 4;  // of their distance, in steps of the grid
constexpr int kWidestGap = 4;         // steps between a gap's sides; of what lies on no plane 2

class SplatMaker {
 public:
  SplatMaker(const RangeImage& image, const PlaneSegmentation& segmentation,
             const std::vector<std::uint8_t>& drawn, const Pose& world_from_scan, std::uint32_t scan_index,
             int every, const std::vector<RadiusLimit>& limits)
      : image_(image),
        segmentation_(segmentation),
        surfaces_(image, segmentation),
        drawn_(drawn),
        world_from_scan_(world_from_scan),
        scan_index_(scan_index),
        every_(every),
        limits_(limits) {}

  std::vector<Splat> samples(int row) const {
    std::vector<Splat> splats;
    for (int col = 0; col < image_.cols; col += every_)
      if (const std::size_t i = image_.index(row, col); is_drawn(i))
        splats.push_back(splat(image_.point(i), surface_at(row, col), drawn_[i]));
    return splats;
  }

  std::vector<Splat> gaps(int row) const {
    std::vector<Splat> splats;
    for (int col = 0; col < image_.cols; ++col)
      if (image_.mask[image_.index(row, col)] != kMeasured)
        if (const auto gap = between(row, col)) splats.push_back(*gap);
    return splats;
  }

 private:
  bool is_drawn(std::size_t i) const { return drawn_[i] != kNotDrawn && image_.mask[i] == kMeasured; }

  SampleSurface surface_at(int row, int col) const {
    SampleSurface surface = surfaces_.at(row, col);
    const std::size_t node = image_.index(row, col);
    const auto limit =
        std::ranges::lower_bound(limits_, node, {}, [](const RadiusLimit& of) { return of.node; });
    if (limit != limits_.end() && limit->node == node)
      surface.radius_m = std::min(surface.radius_m, static_cast<double>(limit->radius_m));
    return surface;
  }

  Splat splat(const Vec3& point, const SampleSurface& surface, std::uint8_t drawn) const {
    const Vec3f centre = (world_from_scan_ * point).cast<float>();
    const Vec3f normal = world_from_scan_.rotate(surface.normal).cast<float>();
    return {{centre.x(), centre.y(), centre.z()},
            static_cast<float>(surface.radius_m * every_ * world_from_scan_.scale),
            {normal.x(), normal.y(), normal.z()},
            scan_index_,
            drawn == kDrawnOffFaces};
  }

  // At a node without a sample: between two drawn ones of one surface on either side of it.
  std::optional<Splat> between(int row, int col) const {
    if (const auto found = between(row, col, 1, 0, image_.elevation_step_rad())) return found;
    return between(row, col, 0, 1, image_.azimuth_step_rad());
  }

  std::optional<Splat> between(int row, int col, int down, int across, double step_rad) const {
    const auto before = next_drawn(row, col, -down, -across), after = next_drawn(row, col, down, across);
    if (!before || !after || drawn_[before->node] != drawn_[after->node]) return std::nullopt;
    const Vec3 one = image_.point(before->node), other = image_.point(after->node);
    SampleSurface surface = surface_at(before->row, before->col);
    const SampleSurface beside = surface_at(after->row, after->col);
    const std::uint32_t plane = label(before->node);
    const int apart = before->steps + after->steps;
    if (plane != label(after->node) || apart > (plane != 0 ? kWidestGap : 2)) return std::nullopt;
    if (plane == 0 && (!(surface.normal.dot(beside.normal) > kOneSurface) ||
                       (one - other).norm() > kFarthestApart * apart * step_rad * one.norm()))
      return std::nullopt;
    surface.radius_m = std::max(surface.radius_m, beside.radius_m);
    const double share = static_cast<double>(before->steps) / apart;
    return splat(one + share * (other - one), surface, drawn_[before->node]);
  }

  struct DrawnNode {
    std::size_t node;
    int row, col, steps;
  };

  std::optional<DrawnNode> next_drawn(int row, int col, int down, int across) const {
    for (int steps = 1; steps < kWidestGap; ++steps) {
      const int r = row + steps * down;
      int c = col + steps * across;
      c = image_.wrapped(c);
      if (r < 0 || c < 0 || r >= image_.rows || c >= image_.cols) return std::nullopt;
      const std::size_t i = image_.index(r, c);
      if (is_drawn(i)) return DrawnNode{i, r, c, steps};
      if (image_.mask[i] == kMeasured) return std::nullopt;
    }
    return std::nullopt;
  }

  std::uint32_t label(std::size_t i) const {
    return segmentation_.sample_label.empty() ? 0 : segmentation_.sample_label[i];
  }

  const RangeImage& image_;
  const PlaneSegmentation& segmentation_;
  const SampleSurfaces surfaces_;
  const std::vector<std::uint8_t>& drawn_;
  const Pose& world_from_scan_;
  std::uint32_t scan_index_;
  int every_;
  const std::vector<RadiusLimit>& limits_;
};

}  // namespace

std::vector<Splat> make_splats(const RangeImage& image, const PlaneSegmentation& segmentation,
                               const std::vector<std::uint8_t>& drawn, const Pose& world_from_scan,
                               std::uint32_t scan_index, int every, const std::vector<RadiusLimit>& limits) {
  if (drawn.size() != image.count())
    fail(ErrorKind::failed, "make_splats: expected a flag for each of {} nodes, found {}", image.count(),
         drawn.size());
  const SplatMaker maker(image, segmentation, drawn, world_from_scan, scan_index, every, limits);
  // Samples first.
  const auto taken = static_cast<std::size_t>((image.rows + every - 1) / every);
  std::vector<std::vector<Splat>> rows(taken + (every == 1 ? taken : 0));
  parallel_for(rows.size(), [&](std::size_t k) {
    rows[k] =
        k < taken ? maker.samples(every * static_cast<int>(k)) : maker.gaps(static_cast<int>(k - taken));
  });
  std::vector<std::size_t> begin(rows.size() + 1, 0);
  for (std::size_t row = 0; row < rows.size(); ++row) begin[row + 1] = begin[row] + rows[row].size();
  std::vector<Splat> splats(begin.back());
  parallel_for(rows.size(), [&](std::size_t row) {
    std::copy(rows[row].begin(), rows[row].end(), splats.begin() + static_cast<std::ptrdiff_t>(begin[row]));
    rows[row] = {};
  });
  return splats;
}

}  // namespace hybrid::stages
