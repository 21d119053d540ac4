#include "stages/contour_faces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/simple_rings.hpp"
#include "stages/stray_samples.hpp"

namespace hybrid::stages {
namespace {

constexpr double kLongestStretch = 3;  // of the sample spacing at grazing incidence
constexpr double kMinCosine = 0.02;    // of a ray and the plane it is intersected with

// --- Rings as polygons -------------------------------------------------------------------------------------

// Marks the vertices that Douglas and Peucker keep between first and last (indices modulo the ring's size).
void keep_corners(const FlatRing& ring, const std::vector<double>& tolerance_nm, std::size_t first,
                  std::size_t last, std::vector<bool>& kept) {
  const std::size_t n = ring.vertices.size();
  std::vector<std::pair<std::size_t, std::size_t>> spans{{first, last}};
  while (!spans.empty()) {
    const auto [begin, end] = spans.back();
    spans.pop_back();
    const RingVertex &a = ring.vertices[begin % n], &b = ring.vertices[end % n];
    const double ux = static_cast<double>(b.x - a.x), uy = static_cast<double>(b.y - a.y);
    const double length2 = ux * ux + uy * uy;
    double worst = 1;
    std::size_t at = 0;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const RingVertex& v = ring.vertices[i % n];
      double x = static_cast<double>(v.x - a.x), y = static_cast<double>(v.y - a.y);
      const double share = length2 > 0 ? std::clamp((x * ux + y * uy) / length2, 0.0, 1.0) : 0;
      x -= share * ux, y -= share * uy;
      const double off = std::sqrt(x * x + y * y) / tolerance_nm[i % n];
      if (off > worst) worst = off, at = i;
    }
    if (at == 0) continue;
    kept[at % n] = true;
    spans.push_back({begin, at});
    spans.push_back({at, end});
  }
}

// The ring without the vertices that lie within their tolerance of the line through those that stay.
FlatRing straightened(const FlatRing& ring, const std::vector<double>& tolerance_nm) {
  const auto& v = ring.vertices;
  const auto far2 = [&](std::size_t i) {
    const double x = static_cast<double>(v[i].x - v[0].x), y = static_cast<double>(v[i].y - v[0].y);
    return x * x + y * y;
  };
  std::size_t far = 0;
  for (std::size_t i = 1; i < v.size(); ++i)
    if (far2(i) > far2(far)) far = i;
  std::vector<bool> kept(v.size(), false);
  kept[0] = kept[far] = true;
  keep_corners(ring, tolerance_nm, 0, far, kept);
  keep_corners(ring, tolerance_nm, far, v.size(), kept);
  FlatRing result{{}, ring.outer};
  for (std::size_t i = 0; i < v.size(); ++i)
    if (kept[i]) result.vertices.push_back(v[i]);
  return result;
}

double spacing_nm(const RangeImage& image, const Plane& plane, const Vec3& point) {
  const double range = point.norm();
  const double cosine = std::max(std::abs(plane.normal.dot(point)) / range, 1 / kLongestStretch);
  return 1e9 * range * std::max(image.elevation_step_rad(), image.azimuth_step_rad()) / cosine;
}

// The contours with fewer vertices; as they are where that would make them cross.
std::vector<FlatRing> flat_rings(const RangeImage& image, const Supercluster& supercluster,
                                 double straighten) {
  const PlaneCoordinates coordinates(supercluster.plane);
  std::vector<FlatRing> rings, straight;
  for (const ContourRing& contour : supercluster.contours) {
    FlatRing ring{{}, contour.outer};
    std::vector<double> tolerance_nm;
    for (const Vec3& point : contour.points) {
      ring.vertices.push_back(coordinates.vertex(point));
      tolerance_nm.push_back(std::max(straighten * spacing_nm(image, supercluster.plane, point), 1.0));
    }
    if (ring.vertices.size() < 3) continue;
    FlatRing line = straightened(ring, tolerance_nm);
    const bool same_side = line.vertices.size() >= 3 && (signed_area2(line) > 0) == (signed_area2(ring) > 0);
    straight.push_back(same_side ? std::move(line) : ring);
    rings.push_back(std::move(ring));
  }
  return are_simple(straight) ? straight : rings;
}

// Crossing number; points on an edge fall to one side or the other.
bool inside(const FlatRing& ring, const RingVertex& p) {
  bool odd = false;
  const auto& v = ring.vertices;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    if ((v[i].y > p.y) == (v[j].y > p.y)) continue;
    const double x = static_cast<double>(v[j].x - v[i].x) *
                     (static_cast<double>(p.y - v[i].y) / static_cast<double>(v[j].y - v[i].y));
    odd ^= static_cast<double>(p.x - v[i].x) < x;
  }
  return odd;
}

bool inside(const std::vector<FlatRing>& rings, const RingVertex& p) {
  bool odd = false;
  for (const FlatRing& ring : rings) odd ^= inside(ring, p);
  return odd;
}

// The smallest outer ring around a hole: most of the hole's vertices are inside it (some may be its own).
std::optional<std::size_t> owner(const std::vector<FlatRing>& rings, const FlatRing& hole) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (!rings[i].outer || std::abs(signed_area2(rings[i])) <= std::abs(signed_area2(hole))) continue;
    const auto within = std::count_if(hole.vertices.begin(), hole.vertices.end(),
                                      [&](const RingVertex& v) { return inside(rings[i], v); });
    if (2 * within <= static_cast<std::ptrdiff_t>(hole.vertices.size())) continue;
    if (!best || std::abs(signed_area2(rings[i])) < std::abs(signed_area2(rings[*best]))) best = i;
  }
  return best;
}

std::vector<std::uint32_t> append_vertices(const FlatRing& ring, PolygonModel& model) {
  std::vector<std::uint32_t> indices;
  for (const RingVertex& vertex : ring.vertices) {
    indices.push_back(static_cast<std::uint32_t>(model.vertices.size()));
    model.vertices.push_back(vertex.point);
  }
  return indices;
}

// One face per outer ring; empty when they cannot be triangulated.
PolygonModel polygons_of(const std::vector<FlatRing>& rings) {
  PolygonModel model;
  std::vector<std::size_t> face_of(rings.size());
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (!rings[i].outer) continue;
    face_of[i] = model.faces.size();
    model.faces.push_back({"", append_vertices(rings[i], model), {}});
  }
  for (const FlatRing& ring : rings)
    if (!ring.outer)
      if (const auto i = owner(rings, ring))
        model.faces[face_of[*i]].holes.push_back(append_vertices(ring, model));
  try {
    triangulate(model);
  } catch (const Error&) {
    return {};  // its samples stay
  }
  return model;
}

// --- Evidence ----------------------------------------------------------------------------------------------

struct Extent {
  int row0 = 0, row1 = -1, col0 = 0, col1 = -1;  // both ends included
  std::int64_t samples = 0, explained = 0;
};

std::vector<Extent> find_extents(const RangeImage& image, const PlaneSegmentation& segmentation,
                                 const std::vector<std::uint8_t>& explained) {
  std::vector<Extent> extents(segmentation.superclusters.size());
  for (int row = 0; row < image.rows; ++row)
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      const std::uint32_t label = segmentation.sample_label[i];
      if (label == 0 || image.mask[i] != kMeasured) continue;
      Extent& e = extents[label - 1];
      if (e.samples == 0) e.row0 = row, e.col0 = e.col1 = col;
      e.row1 = row;
      e.col0 = std::min(e.col0, col);
      e.col1 = std::max(e.col1, col);
      ++e.samples;
      e.explained += explained[i] != 0;
    }
  return extents;
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

  // Per node of the extent: whether its ray meets the plane inside the rings.
  std::vector<std::uint8_t> met(const Supercluster& supercluster, const Extent& e,
                                const std::vector<FlatRing>& rings) const {
    const auto width = static_cast<std::size_t>(e.col1 - e.col0 + 1);
    const auto height = static_cast<std::size_t>(e.row1 - e.row0 + 1);
    std::vector<std::uint8_t> result(width * height, 0);
    const PlaneCoordinates coordinates(supercluster.plane);
    parallel_for(height, [&](std::size_t r) {
      for (std::size_t c = 0; c < width; ++c) {
        const Vec3 u = ray(e.row0 + static_cast<int>(r), e.col0 + static_cast<int>(c));
        const double cosine = supercluster.plane.normal.dot(u);
        if (std::abs(cosine) < kMinCosine || supercluster.plane.offset_m / cosine <= 0) continue;
        const Vec3 point = supercluster.plane.offset_m / cosine * u;
        result[r * width + c] = inside(rings, coordinates.vertex(point));
      }
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

}  // namespace

ContourFaces unexplained_contours(const RangeImage& image, const PlaneSegmentation& segmentation,
                                  const std::vector<std::uint8_t>& explained,
                                  const std::vector<std::uint8_t>& stray, double sigma_m,
                                  const ContourFaceOptions& options) {
  if (segmentation.sample_label.size() != image.count() || explained.size() != image.count() ||
      stray.size() != image.count())
    fail(ErrorKind::failed, "unexplained_contours: {} labels, {} and {} flags for an image of {} samples",
         segmentation.sample_label.size(), explained.size(), stray.size(), image.count());
  ContourFaces result;
  result.covered.assign(image.count(), 0);
  const auto extents = find_extents(image, segmentation, explained);
  const Judge judge{image, segmentation, stray, sigma_m, options};
  for (std::size_t k = 0; k < extents.size(); ++k) {
    const Supercluster& supercluster = segmentation.superclusters[k];
    if (extents[k].samples == 0) continue;
    ContourFit fit{supercluster.id};
    fit.unexplained_share =
        1 - static_cast<double>(extents[k].explained) / static_cast<double>(extents[k].samples);
    if (fit.unexplained_share < options.unexplained_share) continue;
    const auto rings = flat_rings(image, supercluster, options.straighten);
    const PolygonModel polygons = polygons_of(rings);
    if (!polygons.faces.empty()) judge.weigh(supercluster, extents[k], rings, fit, result.covered);
    if (fit.polygon) append(polygons, supercluster.id, result);
    result.fits.push_back(fit);
  }
  return result;
}

void discard_covered(const std::vector<std::uint8_t>& covered, Decimation& decimation) {
  if (covered.size() != decimation.fate.size())
    fail(ErrorKind::failed, "discard_covered: {} flags for {} nodes", covered.size(), decimation.fate.size());
  for (std::size_t i = 0; i < covered.size(); ++i)
    if (decimation.fate[i] == kUnexplained && covered[i]) {
      decimation.fate[i] = kDiscarded;
      decimation.discarded += 1;
    }
}

}  // namespace hybrid::stages
