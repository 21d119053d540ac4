#include "stages/contours/contour_faces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "core/parallel_blocks.hpp"
#include "stages/contours/border_lines.hpp"
#include "stages/contours/contour_polygons.hpp"
#include "stages/contours/widened_rings.hpp"
#include "stages/scan/stray_samples.hpp"

namespace hybrid::stages {
namespace {

constexpr double kMinCosine = 0.02;             // of a ray and the plane it is intersected with
constexpr int kBlock = 16;                      // nodes, looked at together where no ring is near
constexpr std::int64_t kMargin_nm = 1'000'000;  // around them

struct Extent {
  int row0 = 0, row1 = -1, col0 = 0, col1 = -1;  // both ends included
  std::int64_t samples = 0, explained = 0;

  void add(const Extent& other) {
    if (other.samples == 0) return;
    if (samples == 0) {
      *this = other;
      return;
    }
    row0 = std::min(row0, other.row0);
    row1 = std::max(row1, other.row1);
    col0 = std::min(col0, other.col0);
    col1 = std::max(col1, other.col1);
    samples += other.samples;
    explained += other.explained;
  }
};

constexpr std::size_t kFaceRows = 64;  // of the image, looked at together

std::vector<Extent> find_extents(const RangeImage& image, const PlaneSegmentation& segmentation,
                                 const std::vector<std::uint8_t>& explained) {
  struct Extents : std::vector<Extent> {
    Extents& operator+=(const Extents& other) {
      resize(std::max(size(), other.size()));
      for (std::size_t k = 0; k < other.size(); ++k) (*this)[k].add(other[k]);
      return *this;
    }
  };
  const auto of_rows = [&](std::size_t begin, std::size_t end) {
    Extents extents;
    extents.resize(segmentation.superclusters.size());
    for (auto row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      for (int col = 0; col < image.cols; ++col) {
        const std::size_t i = image.index(row, col);
        const std::uint32_t label = segmentation.sample_label[i];
        if (label != 0 && image.mask[i] == kMeasured)
          extents[label - 1].add({row, row, col, col, 1, explained[i] != 0});
      }
    return extents;
  };
  return sum_blocks<Extents>(static_cast<std::size_t>(image.rows), of_rows, kFaceRows);
}

struct Judge {
  const RangeImage& image;
  const PlaneSegmentation& segmentation;
  const std::vector<std::uint8_t>& stray;
  double sigma_m;
  const ContourFaceOptions& options;

  Vec3 ray(int row, int col) const {
    const std::size_t i = image.index(row, col);
    if (image.mask[i] != kEmpty) return image.point(i).normalized();
    const double elevation = image.elevation_rad[static_cast<std::size_t>(row)];
    const double azimuth = image.azimuth_rad[static_cast<std::size_t>(col)];
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
  }

  // Where the node's ray meets the plane; nothing where it hardly does.
  std::optional<RingVertex> met_at(const Plane& plane, const PlaneCoordinates& coordinates, int row,
                                   int col) const {
    const Vec3 u = ray(row, col);
    const double cosine = plane.normal.dot(u);
    if (std::abs(cosine) < kMinCosine || plane.offset_m / cosine <= 0) return std::nullopt;
    return coordinates.vertex(plane.offset_m / cosine * u);
  }

  // Per node of the extent: whether its ray meets the plane inside the rings. Most blocks of nodes are far
  // from every ring and all in or all out.
  std::vector<std::uint8_t> met(const Supercluster& supercluster, const Extent& e,
                                const std::vector<FlatRing>& rings) const {
    const int width = e.col1 - e.col0 + 1, height = e.row1 - e.row0 + 1;
    std::vector<std::uint8_t> result(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    const Plane& plane = supercluster.plane;
    const PlaneCoordinates coordinates(plane);
    const InsideRings inside(rings);
    const auto one_by_one = [&](int r, int c) {
      const auto at = met_at(plane, coordinates, e.row0 + r, e.col0 + c);
      return at && inside(*at);
    };
    const auto block = [&](int r0, int c0) {
      const int r1 = std::min(r0 + kBlock, height), c1 = std::min(c0 + kBlock, width);
      const auto each = [&](const auto& in) {
        for (int r = r0; r < r1; ++r)
          for (int c = c0; c < c1; ++c)
            result[static_cast<std::size_t>(r) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(c)] = in(r, c);
      };
      std::optional<RingVertex> middle, low, high;
      for (const int r : {r0, (r0 + r1 - 1) / 2, r1 - 1})
        for (const int c : {c0, (c0 + c1 - 1) / 2, c1 - 1}) {
          middle = met_at(plane, coordinates, e.row0 + r, e.col0 + c);
          if (!middle) return each(one_by_one);
          if (!low) low = high = middle;
          low = RingVertex{std::min(low->x, middle->x), std::min(low->y, middle->y)};
          high = RingVertex{std::max(high->x, middle->x), std::max(high->y, middle->y)};
        }
      // What lies between the nine is no farther out than half of what they span.
      const std::int64_t margin = std::max(high->x - low->x, high->y - low->y) / 2 + kMargin_nm;
      if (inside.border_near({low->x - margin, low->y - margin}, {high->x + margin, high->y + margin}))
        return each(one_by_one);
      if (inside(*middle)) each([](int, int) { return true; });
    };
    const auto down = static_cast<std::size_t>((height + kBlock - 1) / kBlock);
    parallel_for(down, [&](std::size_t r) {
      for (int c = 0; c < width; c += kBlock) block(static_cast<int>(r) * kBlock, c);
    });
    return result;
  }

  bool behind(const Supercluster& supercluster, std::size_t i) const {
    if (image.mask[i] != kMeasured || stray[i] != kNotStray) return false;
    const Vec3 point = image.point(i);
    const double cosine = std::abs(supercluster.plane.normal.dot(point.normalized()));
    return -supercluster.plane.distance(point) >
           options.behind_sigmas * sigma_m * std::max(cosine, kMinCosine);
  }

  // Fills the evidence and, where it speaks for the polygon, marks the samples it covers.
  void weigh(const Supercluster& supercluster, const Extent& e, const std::vector<FlatRing>& rings,
             ContourFit& fit, std::vector<std::uint8_t>& covered) const {
    const std::vector<std::uint8_t> in = met(supercluster, e, rings);
    const int width = e.col1 - e.col0 + 1, height = e.row1 - e.row0 + 1;
    const auto beside = [&](int r, int c) {
      for (int y = std::max(r - 1, 0); y <= std::min(r + 1, height - 1); ++y)
        for (int x = std::max(c - 1, 0); x <= std::min(c + 1, width - 1); ++x)
          if (in[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)])
            return true;
      return false;
    };
    std::int64_t inside_members = 0, through = 0;
    std::vector<std::size_t> stands_for;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) {
        const std::size_t i = image.index(e.row0 + r, e.col0 + c);
        const bool met_here =
            in[static_cast<std::size_t>(r) * static_cast<std::size_t>(width) + static_cast<std::size_t>(c)] !=
            0;
        if (image.mask[i] == kMeasured && segmentation.sample_label[i] == supercluster.id) {
          inside_members += met_here;
          if (beside(r, c)) stands_for.push_back(i);
        } else if (met_here) {
          through += behind(supercluster, i);
        }
      }
    const auto met_members = static_cast<double>(stands_for.size());
    fit.coverage = met_members / static_cast<double>(std::max<std::int64_t>(e.samples, 1));
    fit.seen_through = static_cast<double>(through) /
                       static_cast<double>(std::max<std::int64_t>(inside_members + through, 1));
    fit.polygon = fit.coverage >= options.coverage && fit.seen_through <= options.seen_through;
    if (!fit.polygon) return;
    for (const std::size_t i : stands_for) covered[i] = 1;
  }
};

void append(const PolygonModel& from, std::uint32_t id, ContourFaces& to) {
  const auto shift = static_cast<std::uint32_t>(to.model.vertices.size());
  to.model.vertices.insert(to.model.vertices.end(), from.vertices.begin(), from.vertices.end());
  for (Face face : from.faces) {
    for (std::uint32_t& vertex : face.outer) vertex += shift;
    for (auto& hole : face.holes)
      for (std::uint32_t& vertex : hole) vertex += shift;
    to.model.faces.push_back(std::move(face));
    to.supercluster.push_back(id);
  }
}

PolygonModel moved(const Pose& world_from_scan, PolygonModel polygons) {
  for (Vec3& vertex : polygons.vertices) vertex = world_from_scan * vertex;
  return polygons;
}

}  // namespace

ContourFaces unexplained_contours(const RangeImage& image, const PlaneSegmentation& segmentation,
                                  const std::vector<Intersection>& intersections,
                                  const std::vector<std::uint8_t>& explained,
                                  const std::vector<std::uint8_t>& stray, double sigma_m,
                                  const ContourFaceOptions& options, const Pose& world_from_scan) {
  if (segmentation.sample_label.size() != image.count() || explained.size() != image.count() ||
      stray.size() != image.count())
    fail(ErrorKind::failed, "unexplained_contours: {} labels, {} and {} flags for an image of {} samples",
         segmentation.sample_label.size(), explained.size(), stray.size(), image.count());
  ContourFaces result;
  result.covered.assign(image.count(), 0);
  const auto extents = find_extents(image, segmentation, explained);
  const Judge judge{image, segmentation, stray, sigma_m, options};
  std::vector<std::size_t> unexplained;  // superclusters
  for (std::size_t k = 0; k < extents.size(); ++k) {
    if (extents[k].samples == 0) continue;
    ContourFit fit{segmentation.superclusters[k].id};
    fit.unexplained_share =
        1 - static_cast<double>(extents[k].explained) / static_cast<double>(extents[k].samples);
    if (fit.unexplained_share < options.unexplained_share) continue;
    unexplained.push_back(k);
    result.fits.push_back(fit);
  }
  std::vector<PolygonModel> polygons(unexplained.size());
  parallel_for(unexplained.size(), [&](std::size_t i) {  // each marks members of its own
    const Supercluster& supercluster = segmentation.superclusters[unexplained[i]];
    const auto rings = flat_rings(image, supercluster, options.straighten);
    const auto take = [&](const std::vector<FlatRing>& as) {
      polygons[i] = polygons_of(as);
      return !polygons[i].faces.empty() && can_be_triangulated(moved(world_from_scan, polygons[i]));
    };
    const auto lines = with_border_lines(image, supercluster, rings, options.border_rms, options.border_most);
    if (take(widened_rings(image, supercluster, intersections, options.widen, lines)) || take(rings))
      judge.weigh(supercluster, extents[unexplained[i]], rings, result.fits[i], result.covered);
  });
  for (std::size_t i = 0; i < polygons.size(); ++i)
    if (result.fits[i].polygon) append(polygons[i], result.fits[i].supercluster, result);
  return result;
}

void discard_covered(const std::vector<std::uint8_t>& covered, Decimation& decimation) {
  if (covered.size() != decimation.fate.size())
    fail(ErrorKind::failed, "discard_covered: {} flags for {} nodes", covered.size(), decimation.fate.size());
  decimation.discarded += static_cast<std::int64_t>(count_if_parallel(covered.size(), [&](std::size_t i) {
    if (decimation.fate[i] != kUnexplained || !covered[i]) return false;
    decimation.fate[i] = kDiscarded;
    return true;
  }));
}

}  // namespace hybrid::stages
