// Solids drawn along a path or around an axis.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "geometry/build.hpp"
#include "geometry/solids.hpp"

namespace synth {
namespace {

// Points of a grid whose cells become two triangles each. Normals of cells that bend by less than 50 degrees
// are smoothed at the points they share.
struct Skin {
  int rows, columns;  // of points; columns wrap around
  std::vector<Vec3> points;
  std::vector<Vec2> coordinates;
  bool closed_rows = false;

  const Vec3& at(int row, int column) const {
    return points[static_cast<std::size_t>((row % rows) * columns + column % columns)];
  }
  Vec3 cell_normal(int row, int column) const {
    return (at(row + 1, column + 1) - at(row, column)).cross(at(row + 1, column) - at(row, column + 1));
  }
  int cell_rows() const { return closed_rows ? rows : rows - 1; }

  Vec3 smooth(int row, int column, const Vec3& own) const {
    Vec3 sum = Vec3::Zero();
    for (int r = row - 1; r <= row; ++r) {
      if (!closed_rows && (r < 0 || r >= rows - 1)) continue;
      for (int c = column - 1; c <= column; ++c) {
        const Vec3 normal = cell_normal((r + rows) % rows, (c + columns) % columns);
        if (normal.squaredNorm() > 0 && normal.normalized().dot(own) > 0.64) sum += normal.normalized();
      }
    }
    return sum.squaredNorm() > 0 ? sum.normalized() : own;
  }

  // `surface` tells each cell's, by row and column.
  template <typename SurfaceOfCell>
  void append(Mesh& mesh, const SurfaceOfCell& surface) const {
    for (int r = 0; r < cell_rows(); ++r) {
      for (int c = 0; c < columns; ++c) {
        const Vec3 normal = cell_normal(r, c);
        if (normal.squaredNorm() == 0) continue;
        const Vec3 own = normal.normalized();
        const std::uint32_t s = surface(r, c);
        const bool flat = mesh.surfaces[s].plane_id != 0;
        const auto corner = [&](int row, int column) {
          Vec2 place = coordinates[static_cast<std::size_t>((row % rows) * columns + column % columns)];
          if (column == columns) place.x() += width;
          if (row == rows) place.y() += length;
          return add_vertex(mesh, at(row, column), flat ? own : smooth(row % rows, column % columns, own),
                            place);
        };
        const auto a = corner(r, c), b = corner(r, c + 1), d = corner(r + 1, c + 1), e = corner(r + 1, c);
        if (at(r, c) != at(r, c + 1)) add_triangle(mesh, s, a, b, d);
        if (at(r + 1, c) != at(r + 1, c + 1)) add_triangle(mesh, s, a, d, e);
      }
    }
  }
  double width = 0, length = 0;  // once around, and along closed rows, in texture coordinates
};

// What is flat of a moulding is a plane of the truth: the faces parallel to its drawing, which run along the
// whole path, and those of long straight pieces of the path. The rest is bent.
struct MouldingFaces {
  static constexpr double kLongPiece_m = 0.25;

  Mesh& mesh;
  const std::string& name;
  Material material;
  const Skin& skin;
  std::uint32_t bent;
  std::map<std::pair<int, int>, std::uint32_t> planes;  // by row (-1: all) and column

  std::uint32_t surface(int row, int column) {
    const auto normal = [&](int r) { return skin.cell_normal(r, column).normalized(); };
    const int rows = skin.cell_rows();
    const Vec3 own = normal(row);
    const bool all = rows > 1 && (own - normal(0)).norm() < 1e-9 && (own - normal(rows / 2)).norm() < 1e-9 &&
                     (own - normal(rows - 1)).norm() < 1e-9;
    const double length = std::min((skin.at(row + 1, column) - skin.at(row, column)).norm(),
                                   (skin.at(row + 1, column + 1) - skin.at(row, column + 1)).norm());
    if (!all && length < kLongPiece_m) return bent;
    const auto [place, added] = planes.insert({{all ? -1 : row, column}, 0});
    if (added)
      place->second = add_flat_free_surface(mesh, fmt::format("{}-face-{}", name, planes.size()), material,
                                            skin.at(row, column), own);
    return place->second;
  }
};

}  // namespace

void add_turned(Mesh& mesh, const std::string& name, Material material, const Vec3& foot,
                const std::vector<Vec2>& profile, int slices) {
  const std::size_t first = mesh.triangles.size();
  double widest = 0;
  for (const Vec2& p : profile) widest = std::max(widest, p.x());
  Skin skin{static_cast<int>(profile.size()), slices, {}, {}};
  skin.width = 2 * std::numbers::pi * widest;
  double run = 0;
  for (std::size_t k = 0; k < profile.size(); ++k) {
    if (k > 0) run += (profile[k] - profile[k - 1]).norm();
    for (int slice = 0; slice < slices; ++slice) {
      const double angle = 2 * std::numbers::pi * slice / slices;
      const double radius = profile[k].x();
      skin.points.push_back(foot + Vec3(radius == 0 ? 0 : radius * std::cos(angle),
                                        radius == 0 ? 0 : radius * std::sin(angle), profile[k].y()));
      skin.coordinates.push_back({angle * widest, run});
    }
  }
  const std::uint32_t surface = add_free_surface(mesh, name, material);
  skin.append(mesh, [&](int, int) { return surface; });
  check_closed(mesh, first);
}

void add_moulding(Mesh& mesh, const std::string& name, Material material, const Frame& frame,
                  const std::vector<Vec2>& path, bool closed, const std::vector<Vec2>& profile) {
  const std::size_t first = mesh.triangles.size();
  const auto sides = static_cast<int>(profile.size()), steps = static_cast<int>(path.size());
  const std::vector<Vec2> outwards = mitres(path, closed);
  Skin skin{steps, sides, {}, {}};
  skin.closed_rows = closed;
  double run = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (k > 0) run += (path[k] - path[k - 1]).norm();
    double around = 0;
    for (std::size_t p = profile.size(); p-- > 0;) {  // the other way round: cells then face out
      skin.points.push_back(frame.at(path[k] + profile[p].x() * outwards[k], profile[p].y()));
      skin.coordinates.push_back({run, around});
      around += (profile[(p + profile.size() - 1) % profile.size()] - profile[p]).norm();
    }
  }
  if (closed) skin.length = 0;
  MouldingFaces faces{mesh, name, material, skin, add_free_surface(mesh, name, material), {}};
  skin.append(mesh, [&](int row, int column) { return faces.surface(row, column); });
  if (!closed) {
    const auto end = [&](int row, bool last) {
      const Vec3 normal =
          (last ? 1.0 : -1.0) * (skin.at(last ? row : 1, 0) - skin.at(last ? row - 1 : 0, 0)).normalized();
      for (int c = 1; c + 1 < sides; ++c) {
        const auto a = add_vertex(mesh, skin.at(row, 0), normal, {0, 0}),
                   b = add_vertex(mesh, skin.at(row, c), normal, {0.1, 0}),
                   d = add_vertex(mesh, skin.at(row, c + 1), normal, {0, 0.1});
        if (last)
          add_triangle(mesh, faces.bent, a, b, d);
        else
          add_triangle(mesh, faces.bent, a, d, b);
      }
    };
    end(0, false);
    end(steps - 1, true);
  }
  check_closed(mesh, first);
}

void add_tube(Mesh& mesh, const std::string& name, Material material, const std::vector<Vec3>& path,
              bool closed, double radius_m, int sides) {
  const std::size_t first = mesh.triangles.size(), n = path.size();
  Skin skin{static_cast<int>(n), sides, {}, {}};
  skin.closed_rows = closed;
  const Vec3 chord = path[n / 2] - path[0];
  const Vec3 reference = std::abs(chord.normalized().z()) < 0.8 ? Vec3::UnitZ() : Vec3::UnitX();
  // A closed path lies in a plane: its normal serves as reference all the way round.
  const Vec3 across =
      closed ? (path[n / 3] - path[0]).cross(path[2 * n / 3] - path[0]).normalized() : reference;
  double run = 0;
  for (std::size_t k = 0; k < n; ++k) {
    if (k > 0) run += (path[k] - path[k - 1]).norm();
    const Vec3 before = path[closed ? (k + n - 1) % n : (k == 0 ? 0 : k - 1)],
               after = path[closed ? (k + 1) % n : std::min(n - 1, k + 1)];
    const Vec3 along = (after - before).normalized();
    const Vec3 side = along.cross(across).normalized(), up = side.cross(along);
    for (int c = 0; c < sides; ++c) {
      const double angle = 2 * std::numbers::pi * c / sides;
      // Rising angles turn from `side` towards -up: seen along the path the ring runs so that cells face out.
      skin.points.push_back(path[k] + radius_m * (std::cos(angle) * side - std::sin(angle) * up));
      skin.coordinates.push_back({angle * radius_m, run});
    }
  }
  skin.width = 2 * std::numbers::pi * radius_m;
  MouldingFaces faces{mesh, name, material, skin, add_free_surface(mesh, name, material), {}};
  skin.append(mesh, [&](int row, int column) { return faces.surface(row, column); });
  if (!closed) {
    for (const bool last : {false, true}) {
      const int row = last ? skin.rows - 1 : 0;
      const Vec3 normal = (last ? path[n - 1] - path[n - 2] : path[0] - path[1]).normalized();
      for (int c = 1; c + 1 < sides; ++c) {
        const auto a = add_vertex(mesh, skin.at(row, 0), normal, {0, 0}),
                   b = add_vertex(mesh, skin.at(row, c), normal, {0, 0}),
                   d = add_vertex(mesh, skin.at(row, c + 1), normal, {0, 0});
        if (last)
          add_triangle(mesh, faces.bent, a, b, d);
        else
          add_triangle(mesh, faces.bent, a, d, b);
      }
    }
  }
  check_closed(mesh, first);
}

}  // namespace synth
