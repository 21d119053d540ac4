#include "stages/contours/contours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nanoflann.hpp>
#include <unordered_map>

#include "core/parallel_blocks.hpp"
#include "geometry/angles.hpp"
#include "stages/contours/contour_mask.hpp"
#include "stages/contours/contour_rings.hpp"
#include "stages/contours/simple_rings.hpp"

namespace hybrid::stages {
namespace {

// Samples by their measured direction, the azimuth unwrapped to that of their column.
struct Directions {
  std::vector<std::array<double, 2>> angles;
  std::vector<std::uint64_t> samples;

  std::size_t kdtree_get_point_count() const { return angles.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return angles[i][axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Directions>, Directions, 2>;

// Measured members inside the cleaned mask of each label, with a node beside them that is none, within kBand
// nodes of the mask's edge. A contour point is half a node off the edge, so no other member is nearer to it
// than kBand - 1/2 nodes; one of these is, unless dropouts emptied the band there.
constexpr int kBand = 3;
constexpr std::size_t kRows = 32;               // looked at together
constexpr std::uint32_t kOutside = 0xffffffff;  // no label

// All nodes up to `reach` rows and columns away have this node's label.
template <typename Label>
bool within(const RangeImage& image, const Label& label_of, int row, int col, int reach) {
  if (row < reach || row + reach >= image.rows) return false;
  const std::uint32_t label = label_of(image.index(row, col));
  const bool inside = col >= reach && col + reach < image.cols;
  if (!inside && !image.wraps) return false;
  for (int r = row - reach; r <= row + reach; ++r)
    for (int c = col - reach; c <= col + reach; ++c) {
      const int at = inside ? c : (c % image.cols + image.cols) % image.cols;
      if (label_of(image.index(r, at)) != label) return false;
    }
  return true;
}

template <typename Member>
std::vector<std::vector<std::uint64_t>> rim_samples(const RangeImage& image, const Member& member,
                                                    const std::vector<std::uint32_t>& mask,
                                                    std::size_t label_count) {
  const auto cleaned = [&](std::size_t i) { return mask[i]; };
  const auto cols = static_cast<std::size_t>(image.cols);
  std::vector<std::vector<std::uint64_t>> rows(static_cast<std::size_t>(image.rows));
  for_blocks(rows.size(), kRows, [&](std::size_t, std::size_t begin, std::size_t end) {
    // The labels of three rows, with a column more on each side.
    std::array<std::vector<std::uint32_t>, 3> lines;
    const auto fill = [&](int row) {
      auto& line = lines[static_cast<std::size_t>(row + 3) % 3];
      line.assign(cols + 2, kOutside);
      if (row < 0 || row >= image.rows) return;
      for (std::size_t col = 0; col < cols; ++col) line[col + 1] = member(image.index(row, 0) + col);
      if (!image.wraps) return;
      line[0] = line[cols];
      line[cols + 1] = line[1];
    };
    fill(static_cast<int>(begin) - 1);
    fill(static_cast<int>(begin));
    for (std::size_t r = begin; r < end; ++r) {
      fill(static_cast<int>(r) + 1);
      const std::uint32_t *above = lines[(r + 2) % 3].data(), *at = lines[r % 3].data(),
                          *below = lines[(r + 1) % 3].data();
      for (std::size_t col = 0; col < cols; ++col) {
        const std::uint32_t label = at[col + 1];
        if (label == 0) continue;
        bool surrounded = at[col] == label && at[col + 2] == label;
        for (std::size_t c = col; c < col + 3; ++c) surrounded &= above[c] == label && below[c] == label;
        if (!surrounded && !within(image, cleaned, static_cast<int>(r), static_cast<int>(col), kBand))
          rows[r].push_back(image.index(static_cast<int>(r), static_cast<int>(col)));
      }
    }
  });
  std::vector<std::vector<std::uint64_t>> of_label(label_count);
  for (const auto& row : rows)
    for (const std::uint64_t sample : row) of_label[member(sample) - 1].push_back(sample);
  return of_label;
}

Directions directions(const RangeImage& image, const std::vector<std::uint64_t>& samples) {
  Directions result;
  result.samples = samples;
  for (const std::uint64_t i : samples) {
    const Vec3 p = image.point(i);
    const double column = image.azimuth_rad[i % static_cast<std::uint64_t>(image.cols)];
    const double azimuth = std::atan2(p.y(), p.x());
    result.angles.push_back({azimuth + kTurn * std::round((column - azimuth) / kTurn),
                             std::atan2(p.z(), std::hypot(p.x(), p.y()))});
  }
  return result;
}

class NearestMember {
 public:
  NearestMember(const RangeImage& image, const std::vector<std::uint64_t>& samples)
      : wraps_(image.wraps), directions_(directions(image, samples)), tree_(2, directions_, {10}) {
    // Measured directions stray from their column's by half a step.
    low_ = image.azimuth_rad.front() - image.azimuth_step_rad();
    high_ = image.azimuth_rad.back() + image.azimuth_step_rad();
  }
  std::uint64_t find(const std::array<double, 2>& angles) const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    query(angles, best, least);
    // The other side of the seam, where it is within reach.
    const double reach = std::sqrt(least);
    if (wraps_ && angles[0] - reach < high_ - kTurn) query({angles[0] + kTurn, angles[1]}, best, least);
    if (wraps_ && angles[0] + reach > low_ + kTurn) query({angles[0] - kTurn, angles[1]}, best, least);
    return directions_.samples[best];
  }

 private:
  void query(const std::array<double, 2>& angles, std::size_t& best, double& least) const {
    std::uint32_t index = 0;
    double distance = 0;
    if (tree_.knnSearch(angles.data(), 1, &index, &distance) == 1 && distance < least) {
      best = index;
      least = distance;
    }
  }
  bool wraps_;
  double low_ = 0, high_ = 0;
  Directions directions_;
  Tree tree_;
};

// Cuts a closed walk over samples at every sample it visits twice: loops without repeated samples. A part one
// sample wide is a walk there and back, which leaves loops of two.
std::vector<std::vector<std::uint64_t>> split_loops(const std::vector<std::uint64_t>& walk) {
  std::vector<std::vector<std::uint64_t>> loops;
  std::vector<std::uint64_t> path;
  std::unordered_map<std::uint64_t, std::size_t> place;
  for (const std::uint64_t sample : walk) {
    if (const auto seen = place.find(sample); seen != place.end()) {
      const std::size_t from = seen->second;
      loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(from), path.end());
      for (std::size_t i = from + 1; i < path.size(); ++i) place.erase(path[i]);
      path.resize(from + 1);
    } else {
      place[sample] = path.size();
      path.push_back(sample);
    }
  }
  loops.push_back(std::move(path));
  return loops;
}

// Where the sample's own ray meets the plane; false when it meets it too obliquely.
bool project(const Plane& plane, const Vec3& sample, double min_cosine, Vec3& point) {
  const Vec3 ray = sample.normalized();
  const double cosine = plane.normal.dot(ray);
  if (std::abs(cosine) < min_cosine || plane.offset_m / cosine <= 0) return false;
  point = plane.offset_m / cosine * ray;
  return true;
}

std::vector<ContourRing> rings_of(const RangeImage& image, const Plane& plane, const ContourCells& cells,
                                  const LabelCells& label, const std::vector<std::uint64_t>& rim,
                                  const ContourOptions& options, std::vector<std::uint8_t>& boundary) {
  if (rim.empty()) return {};
  const NearestMember nearest(image, rim);
  const PlaneCoordinates coordinates(plane);
  std::vector<FlatRing> rings;
  for (const AngleRing& angles : trace_rings(image, cells, label)) {
    std::vector<std::uint64_t> walk;
    for (const auto& at : angles) walk.push_back(nearest.find(at));
    for (const std::uint64_t sample : walk) boundary[sample] = 1;
    for (const auto& loop : split_loops(walk)) {
      if (loop.size() < static_cast<std::size_t>(options.least_ring)) continue;
      FlatRing ring;
      Vec3 point;
      for (const std::uint64_t sample : loop)
        if (project(plane, image.point(sample), options.min_cosine, point))
          ring.vertices.push_back(coordinates.vertex(point));
      ring.outer = signed_area2(ring) > 0;
      if (ring.vertices.size() >= 3) rings.push_back(std::move(ring));
    }
  }
  make_simple(rings);
  std::stable_sort(rings.begin(), rings.end(), [](const FlatRing& a, const FlatRing& b) {
    return std::abs(signed_area2(a)) > std::abs(signed_area2(b));
  });
  std::vector<ContourRing> result;
  for (const FlatRing& ring : rings) {
    result.push_back({{}, ring.outer});
    for (const RingVertex& vertex : ring.vertices) result.back().points.push_back(vertex.point);
  }
  return result;
}

}  // namespace

std::vector<std::uint8_t> trace_contours(device::Queue& queue, const RangeImage& image,
                                         PlaneSegmentation& segmentation, const ContourOptions& options) {
  if (segmentation.sample_label.size() != image.count())
    fail(ErrorKind::failed, "trace_contours: {} sample labels for an image of {} samples",
         segmentation.sample_label.size(), image.count());
  std::vector<std::uint8_t> boundary(image.count(), 0);
  if (image.count() == 0) return boundary;
  const std::size_t count = segmentation.superclusters.size();
  std::vector<std::uint32_t>& labels = segmentation.sample_label;  // the masks', until they are restored
  const auto changes = clean_labels(image, labels, options.least_patch);
  std::vector<bool> changed(image.count(), false);
  for (auto change = changes.rbegin(); change != changes.rend(); ++change)
    for (std::size_t i = change->begin; i < change->end; ++i) {
      changed[i] = labels[i] != change->before;
      boundary[i] = changed[i] && change->before != 0 && image.mask[i] == kMeasured;
    }
  // The label of a measured sample that the mask keeps.
  const auto member = [&](std::size_t i) {
    return image.mask[i] == kMeasured && !changed[i] ? labels[i] : 0;
  };
  const ContourCells cells = find_contour_cells(queue, image, labels, count, options.tile);
  const auto rims = rim_samples(image, member, labels, count);
  restore_labels(changes, labels);
  parallel_for(count, [&](std::size_t i) {
    Supercluster& supercluster = segmentation.superclusters[i];
    supercluster.contours =
        rings_of(image, supercluster.plane, cells, cells.of_label[i], rims[i], options, boundary);
  });
  return boundary;
}

}  // namespace hybrid::stages
