#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "device/queue.hpp"
#include "geometry/pose.hpp"
#include "lib/random.h"
#include "shared/params_closest_sample.h"
#include "stages/registration/scan_surface.hpp"

namespace hybrid::testing {

// A scanner, or a wide pinhole, in a room of 16 x 12 x 3 m with a round column in it and rough walls, on a
// grid whose steps are uneven, every 30th node empty; queries within 10 cm of its samples from another frame,
// with normals within 20 degrees of theirs, some without.
struct ClosestSampleCase {
  static constexpr const char* kName = "closest_sample";
  struct Input {
    std::uint32_t lens = GRID_SPHERICAL;
    std::vector<double> rows, cols;  // elevation and azimuth, rad; of a pinhole z / x and -y / x
    bool wraps = true;
    std::vector<float> px, py, pz, qx, qy, qz;  // per node
    Pose grid_from_scan;
    std::vector<Pose> more_places;  // of the scan, asked about with the first; the reference has only this
    float gate = 0.15f, reach = 0.02f;
    double normal_deg = 45;
    std::vector<float> x, y, z, nx, ny, nz;

    bool is_pinhole() const { return lens == GRID_PINHOLE; }
    double row_of(const Vec3& p) const {
      return is_pinhole() ? p.z() / p.x() : std::atan2(p.z(), std::hypot(p.x(), p.y()));
    }
    double col_of(const Vec3& p) const { return is_pinhole() ? -p.y() / p.x() : std::atan2(p.y(), p.x()); }
    Vec3 ray(double row, double col) const {
      if (is_pinhole()) return Vec3(1, -col, row).normalized();
      return {std::cos(row) * std::cos(col), std::cos(row) * std::sin(col), std::sin(row)};
    }
  };
  struct Output {
    std::vector<float> distance, height, normal_x, normal_y, normal_z, clearance;
    // Of the reference alone: another sample is within rounding of the closest, the gate or the largest
    // angle, or the query on an edge between nodes; the window is larger than is searched node by node.
    std::vector<char> doubtful, strided;
  };
  static constexpr int kRows = 97, kCols = 251;
  // Coordinates up to 10 m as floats, ten roundings.
  static constexpr double kTolerance_m = 1e-5;

  // The nearest of the room's walls and the column along a ray from its middle, with its normal.
  static double cast(const Vec3& ray, Vec3& normal) {
    double range = INFINITY;
    const auto take = [&](double at, const Vec3& towards) {
      if (!(at > 0) || at >= range) return;
      range = at;
      normal = towards;
    };
    const Vec3 low(-7, -5, -1.6), high(9, 7, 1.4);
    for (int k = 0; k < 3; ++k)
      take((ray(k) > 0 ? high : low)(k) / ray(k), (ray(k) > 0 ? -1.0 : 1.0) * Vec3(Vec3::Unit(k)));
    const Vec2 middle(2, 1.5), flat = ray.head<2>();
    const double a = flat.squaredNorm(), b = flat.dot(middle), c = middle.squaredNorm() - 0.16;
    if (b > 0 && b * b > a * c) {
      const double at = (b - std::sqrt(b * b - a * c)) / a;
      const Vec2 n = (at * flat - middle).normalized();
      take(at, Vec3(n.x(), n.y(), 0));
    }
    return range;
  }

  static Input make(std::size_t size, std::uint32_t seed, std::uint32_t lens = GRID_SPHERICAL) {
    constexpr double kPi = std::numbers::pi;
    Input in;
    in.lens = lens;
    in.wraps = !in.is_pinhole();
    const double top = in.is_pinhole() ? 0.85 : 0.48 * kPi, high = in.is_pinhole() ? 1.7 : 0.83 * kPi,
                 left = in.is_pinhole() ? -1.2 : 0.3, wide = in.is_pinhole() ? 2.4 : 2 * kPi;
    const auto u = [&](std::size_t i, std::uint32_t draw) {
      return random_bits(seed, static_cast<std::uint32_t>(i), draw) / 4294967296.0;
    };
    for (int r = 0; r < kRows; ++r)
      in.rows.push_back(top - high * (r + 0.2 * u(static_cast<std::size_t>(r), 20)) / kRows);
    for (int c = 0; c < kCols; ++c)
      in.cols.push_back(left + wide * (c + 0.2 * u(static_cast<std::size_t>(c), 21)) / kCols);
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kCols; ++c) {
        const Vec3 ray = in.ray(in.rows[static_cast<std::size_t>(r)], in.cols[static_cast<std::size_t>(c)]);
        Vec3 n = Vec3::Zero();
        const auto i = static_cast<std::size_t>(r * kCols + c);
        const Vec3 p = (cast(ray, n) + 0.02 * (u(i, 22) - 0.5)) * ray;
        const bool missing = random_below(seed, static_cast<std::uint32_t>(i), 23, 30) == 0;
        for (auto [to, value] : {std::pair{&in.px, p.x()},
                                 {&in.py, p.y()},
                                 {&in.pz, p.z()},
                                 {&in.qx, n.x()},
                                 {&in.qy, n.y()},
                                 {&in.qz, n.z()}})
          to->push_back(missing ? NAN : static_cast<float>(value));
      }
    in.grid_from_scan.rotation = Eigen::AngleAxisd(0.8, Vec3(0.2, -0.1, 1).normalized());
    in.grid_from_scan.translation = Vec3(1.5, -2, 0.25);
    const Pose scan_from_grid = in.grid_from_scan.inverse();
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t node = random_below(seed, static_cast<std::uint32_t>(i), 1, kRows * kCols);
      const Vec3 noise = 0.1 * Vec3(2 * u(i, 2) - 1, 2 * u(i, 3) - 1, 2 * u(i, 4) - 1);
      const Vec3 lean = 0.3 * Vec3(u(i, 5) - 0.5, u(i, 6) - 0.5, u(i, 7) - 0.5);
      const Vec3 p = scan_from_grid * (Vec3(in.px[node], in.py[node], in.pz[node]) + noise);
      const Vec3 n = scan_from_grid.rotate((Vec3(in.qx[node], in.qy[node], in.qz[node]) + lean).normalized());
      const bool none = random_below(seed, static_cast<std::uint32_t>(i), 8, 50) == 0;
      for (auto [to, value] : {std::pair{&in.x, p.x()}, {&in.y, p.y()}, {&in.z, p.z()}})
        to->push_back(static_cast<float>(value));
      for (auto [to, value] : {std::pair{&in.nx, n.x()}, {&in.ny, n.y()}, {&in.nz, n.z()}})
        to->push_back(none ? NAN : static_cast<float>(value));
    }
    return in;
  }

  static Output run(device::Queue& queue, const Input& in) {
    const std::size_t count = in.x.size();
    ClosestSampleParams params{};
    SamplePlaces places{};
    places.each[0] = stages::sample_place(in.grid_from_scan);
    const std::size_t all_places = 1 + in.more_places.size();
    for (std::size_t k = 1; k < all_places; ++k) places.each[k] = stages::sample_place(in.more_places[k - 1]);
    params.gate = in.gate;
    params.reach = in.reach;
    params.min_facing = static_cast<float>(std::cos(in.normal_deg * std::numbers::pi / 180));
    params.rows = static_cast<std::uint32_t>(in.rows.size());
    params.cols = static_cast<std::uint32_t>(in.cols.size());
    params.row_step = static_cast<float>((in.rows.front() - in.rows.back()) / (params.rows - 1));
    params.col_step = static_cast<float>((in.cols.back() - in.cols.front()) / (params.cols - 1));
    params.wraps = in.wraps;
    params.lens = in.lens;
    params.queries = static_cast<std::uint32_t>(count);
    std::vector<float> ranges, points, normals;
    for (std::size_t k = 0; k < in.px.size(); ++k) {
      ranges.push_back(std::hypot(in.px[k], in.py[k], in.pz[k]));
      for (const float value : {in.px[k], in.py[k], in.pz[k]}) points.push_back(value);
      for (const float value : {in.qx[k], in.qy[k], in.qz[k]}) normals.push_back(value);
    }
    const auto row_edges = stages::row_edges(in.rows, in.lens),
               col_edges = stages::col_edges(in.cols, in.lens);
    const auto row_bins = stages::edge_bins(row_edges, -1), col_bins = stages::edge_bins(col_edges, 1);
    params.row_bins = row_bins.per_unit;
    params.col_bins = col_bins.per_unit;
    stages::SampleAnswers out(queue, count, all_places);
    queue.launch(kName, queue.kernel(kName), device::grid(count, all_places), params, places,
                 queue.array(in.x), queue.array(in.y), queue.array(in.z), queue.array(in.nx),
                 queue.array(in.ny), queue.array(in.nz), queue.array(ranges), queue.array(points),
                 queue.array(normals),
                 queue.array(stages::block_ranges(ranges, static_cast<int>(in.rows.size()),
                                                  static_cast<int>(in.cols.size()))),
                 queue.array(row_edges), queue.array(col_edges), queue.array(row_bins.starts),
                 queue.array(col_bins.starts), out.distance, out.height, out.normal_x, out.normal_y,
                 out.normal_z, out.clearance);
    return {queue.read(out.distance),
            queue.read(out.height),
            queue.read(out.normal_x),
            queue.read(out.normal_y),
            queue.read(out.normal_z),
            queue.read(out.clearance),
            {},
            {}};
  }
  static Output reference(const Input& input);  // reference/closest_sample.cpp

  static double items(const Input& input) { return static_cast<double>(input.x.size()); }
  static double bytes(const Input& input) { return (48 + 25 * 16) * items(input); }
  static double flops(const Input& input) { return 25 * 9 * items(input); }
};

}  // namespace hybrid::testing
