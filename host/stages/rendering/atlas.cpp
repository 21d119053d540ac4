#include "stages/rendering/atlas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hybrid::stages {
namespace {

constexpr double kUpright = 0.2;  // faces steeper than this (sine of the angle from the horizontal) are walls

struct Extent {
  double least_x, least_y, greatest_x, greatest_y;
  double area() const { return (greatest_x - least_x) * (greatest_y - least_y); }
};

Extent extent_along(const PolygonModel& model, const Face& face, const Vec3& across, const Vec3& down) {
  const double far = std::numeric_limits<double>::infinity();
  Extent extent{far, far, -far, -far};
  const Vec3 base = model.vertices[face.outer[0]];
  for (const std::uint32_t vertex : face.outer) {
    const Vec3 arm = model.vertices[vertex] - base;
    extent.least_x = std::min(extent.least_x, arm.dot(across));
    extent.least_y = std::min(extent.least_y, arm.dot(down));
    extent.greatest_x = std::max(extent.greatest_x, arm.dot(across));
    extent.greatest_y = std::max(extent.greatest_y, arm.dot(down));
  }
  return extent;
}

// To the right in the chart, whose picture shows the face from where `normal` points.
Vec3 across_of(const PolygonModel& model, const Face& face, const Vec3& normal) {
  const Vec3 level = Vec3::UnitZ().cross(normal);
  if (level.norm() > kUpright) return level.normalized();
  Vec3 best = Vec3::UnitX();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < face.outer.size(); ++i) {
    Vec3 edge = model.vertices[face.outer[(i + 1) % face.outer.size()]] - model.vertices[face.outer[i]];
    edge -= edge.dot(normal) * normal;
    if (!(edge.norm() > 0)) continue;
    edge.normalize();
    const double area = extent_along(model, face, edge, edge.cross(normal)).area();
    if (area < least * (1 - 1e-9)) {  // of equals the first
      least = area;
      best = edge;
    }
  }
  return best;
}

}  // namespace

AtlasChart make_chart(const PolygonModel& model, std::uint32_t face, bool contour, bool back) {
  const Face& polygon = model.faces[face];
  AtlasChart chart;
  chart.contour = contour;
  chart.face = face;
  chart.back = back;
  chart.normal = face_plane(model, polygon).normal;
  if (back) chart.normal = -chart.normal;
  chart.across = across_of(model, polygon, chart.normal);
  chart.down = chart.across.cross(chart.normal);  // right-handed seen from the front: down is y of a picture
  const Extent extent = extent_along(model, polygon, chart.across, chart.down);
  chart.width_m = extent.greatest_x - extent.least_x;
  chart.height_m = extent.greatest_y - extent.least_y;
  chart.origin =
      model.vertices[polygon.outer[0]] + extent.least_x * chart.across + extent.least_y * chart.down;
  return chart;
}

void size_chart(AtlasChart& chart, double texel_m, int most) {
  const auto middle = [&] {
    return (chart.texel_m > 0 ? 0.5 * chart.cols * chart.texel_m : 0.5 * chart.width_m) * chart.across +
           (chart.texel_m > 0 ? 0.5 * chart.rows * chart.texel_m : 0.5 * chart.height_m) * chart.down;
  };
  const Vec3 centre = chart.origin + middle();
  const double longest_m = std::max(chart.width_m, chart.height_m);
  chart.texel_m = std::max(texel_m, longest_m / std::max(1, most - 2));
  // At least half a texel is left on either side of the outline; a face narrower than a texel has the middle
  // one of three.
  const auto texels = [&](double length_m) {
    const double count = std::max(std::ceil(length_m / chart.texel_m - 1e-9), 1.0);
    return count > 1 ? std::min(static_cast<int>(count) + 1, most) : 3;
  };
  chart.cols = texels(chart.width_m);
  chart.rows = texels(chart.height_m);
  chart.origin = centre - middle();
}

std::vector<std::uint8_t> chart_mask(const AtlasChart& chart, const PolygonModel& model) {
  const auto cols = static_cast<std::size_t>(chart.cols), rows = static_cast<std::size_t>(chart.rows);
  std::vector<std::uint8_t> mask(cols * rows, 0);
  std::vector<std::vector<double>> crossings(rows);
  const Face& face = model.faces[chart.face];
  const auto cross_rows = [&](const std::vector<std::uint32_t>& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2 a = chart.position(model.vertices[ring[i]]);
      const Vec2 b = chart.position(model.vertices[ring[(i + 1) % ring.size()]]);
      const double low = std::min(a.y(), b.y()), high = std::max(a.y(), b.y());
      const auto first = static_cast<std::ptrdiff_t>(std::max(0.0, std::ceil(low - 0.5)));
      for (auto row = first; row < chart.rows && static_cast<double>(row) + 0.5 < high; ++row)
        crossings[static_cast<std::size_t>(row)].push_back(a.x() + (static_cast<double>(row) + 0.5 - a.y()) /
                                                                       (b.y() - a.y()) * (b.x() - a.x()));
    }
  };
  cross_rows(face.outer);
  for (const auto& hole : face.holes) cross_rows(hole);
  for (std::size_t row = 0; row < rows; ++row) {
    auto& at = crossings[row];
    std::sort(at.begin(), at.end());
    for (std::size_t k = 0; k + 1 < at.size(); k += 2) {
      const double first = std::max(0.0, std::ceil(at[k] - 0.5));
      for (auto col = static_cast<std::size_t>(first);
           col < cols && static_cast<double>(col) + 0.5 < at[k + 1]; ++col)
        mask[row * cols + col] = 1;
    }
  }
  return mask;
}

}  // namespace hybrid::stages
