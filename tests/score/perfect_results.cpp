#include "perfect_results.hpp"

#include <cmath>
#include <limits>

#include "score/measure/bleeding.hpp"
#include "score/measure/true_mesh.hpp"
#include "score/read/model_files.hpp"

namespace score_tests {
namespace {

using namespace score;

// Samples lie column by column, rising in each: a column ends where the elevation falls.
std::vector<std::pair<int, int>> column_and_rank(const std::vector<Eigen::Vector3f>& points) {
  std::vector<std::pair<int, int>> places;
  float last = 2;
  int column = -1, rank = 0;
  for (const auto& point : points) {
    const float sine = point.z() / point.norm();
    rank = sine > last ? rank + 1 : 0;
    column += rank == 0;
    last = sine;
    places.emplace_back(column, rank);
  }
  return places;
}

LabelledGrid make_grid(const std::vector<Eigen::Vector3f>& points, const TrueSamples& truth) {
  const auto places = column_and_rank(points);
  LabelledGrid grid;
  for (const auto& [column, rank] : places) {
    grid.cols = std::max(grid.cols, column + 1);
    grid.rows = std::max(grid.rows, rank + 1);
  }
  grid.wraps = true;
  const std::size_t nodes = static_cast<std::size_t>(grid.rows) * static_cast<std::size_t>(grid.cols);
  grid.source.assign(nodes, kNoSource);
  grid.label.assign(nodes, 0);
  grid.point.assign(nodes, Eigen::Vector3f::Zero());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t node = grid.index(grid.rows - 1 - places[i].second, places[i].first);
    grid.source[node] = static_cast<std::uint32_t>(i);
    grid.point[node] = points[i];
    grid.label[node] = truth.kind[i] == kPlanar ? truth.plane[i] : 0;
  }
  return grid;
}

// Andrew's monotone chain.
std::vector<Vec3> hull(std::vector<Vec3> points, const Vec3& normal) {
  const auto [u, v] = axes_across(normal);
  const auto flat = [u = u, v = v](const Vec3& p) { return Vec2(u.dot(p), v.dot(p)); };
  std::sort(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) {
    const Vec2 fa = flat(a), fb = flat(b);
    return fa.x() != fb.x() ? fa.x() < fb.x() : fa.y() < fb.y();
  });
  if (points.size() < 2) return points;
  std::vector<Vec3> ring;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = ring.size();
    for (const Vec3& point : points) {
      const auto turns_right = [&] {
        const Vec2 a = flat(ring[ring.size() - 2]), b = flat(ring.back()), c = flat(point);
        return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x() <= 0;
      };
      while (ring.size() >= start + 2 && turns_right()) ring.pop_back();
      ring.push_back(point);
    }
    ring.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return ring;
}

PerfectScan perfect_scan(const SceneTruth& truth, const TrueScan& scan) {
  const TrueSamples samples = read_true_samples(scan);
  const auto points = read_ply(truth.folder / "scans" / (scan.id + ".ply")).vertices;
  PerfectScan result;
  result.id = scan.id;
  result.world_from_scan = scan.world_from_scan;
  result.grid = make_grid(points, samples);
  std::map<std::uint32_t, std::vector<Vec3>> true_points;
  for (std::size_t i = 0; i < result.grid.source.size(); ++i) {
    const bool measured = result.grid.source[i] != kNoSource;
    result.range_m.push_back(measured ? result.grid.point[i].norm()
                                      : std::numeric_limits<float>::quiet_NaN());
    if (!measured) continue;
    const std::uint32_t label = result.grid.label[i];
    if (label == 0)
      result.kept.push_back(result.grid.point[i]);
    else
      true_points[label].push_back(result.grid.point[i].cast<double>().normalized() *
                                   samples.range_m[result.grid.source[i]]);
  }
  const Mat3 scan_from_world = scan.world_from_scan.rotation.transpose();
  for (const auto& [id, list] : true_points) {
    const Plane& world = truth.planes.at(id).in_world;
    const Plane plane{scan_from_world * world.normal,
                      world.offset_m - world.normal.dot(scan.world_from_scan.translation)};
    result.planes[id] = {plane, {hull(list, plane.normal)}};
  }
  return result;
}

float light_of(float encoded) {
  const double s = encoded / 255.0;
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

PerfectView perfect_view(const TrueView& view, const std::vector<Camera>& photographs, const TrueMesh& mesh) {
  PerfectView result{view.camera.name, {}};
  ViewResult& image = result.image;
  image.linear = read_picture(view.picture);
  for (float& value : image.linear.rgb) value = light_of(value);
  const std::size_t pixels = image.linear.pixels();
  image.id.assign(pixels, 1);
  image.coverage.assign(pixels, 0);
  image.best.assign(pixels, kNoPhotograph);
  image.depth_m.assign(pixels, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto width = static_cast<std::size_t>(image.linear.width);
    const auto hit = mesh.first_hit(view.camera.eye, view.camera.ray(static_cast<double>(i % width) + 0.5,
                                                                     static_cast<double>(i / width) + 0.5));
    if (hit)
      image.depth_m[i] =
          static_cast<float>(view.camera.world_from_camera.col(2).dot(hit->point - view.camera.eye));
    for (std::size_t j = 0; hit && j < photographs.size(); ++j)
      if (mesh.sees(photographs[j], *hit) && image.coverage[i]++ == 0)
        image.best[i] = static_cast<std::uint32_t>(j);
    if (image.coverage[i] == 0)
      for (std::size_t k = 0; k < 3; ++k) image.linear.rgb[3 * i + k] = k == 0 ? 1.0f : 0.0f;
  }
  return result;
}

// Each face with the openings on it joined in by bridges to its first corner.
std::vector<Ring> cut(const std::vector<Ring>& faces, const std::vector<TrueOpening>& openings) {
  std::vector<Ring> result;
  for (const Ring& face : faces) {
    const Vec3 normal = (face[1] - face[0]).cross(face[2] - face[0]).normalized();
    Ring ring = face;
    for (const TrueOpening& opening : openings) {
      const bool on_face = std::all_of(opening.ring.begin(), opening.ring.end(), [&](const Vec3& corner) {
        return std::abs(normal.dot(corner - face[0])) < 0.01;
      });
      if (!on_face) continue;
      ring.push_back(face[0]);
      ring.insert(ring.end(), opening.ring.begin(), opening.ring.end());
      ring.push_back(opening.ring[0]);
    }
    result.push_back(ring);
  }
  return result;
}

}  // namespace

Results perfect_results(const SceneTruth& truth) {
  Results results;
  for (const TrueScan& scan : truth.scans) results.scans.push_back(perfect_scan(truth, scan));
  const TrueMesh mesh(read_ply(truth.folder / "detail.ply"));
  for (const TrueView& view : truth.views) results.views.push_back(perfect_view(view, truth.cameras, mesh));
  results.polygons = cut(read_obj_polygons(truth.folder / "proxy.obj"), truth.openings);
  for (const TrueOpening& opening : truth.openings) results.reported.push_back(opening.ring);
  return results;
}

}  // namespace score_tests
