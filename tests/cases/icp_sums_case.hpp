#pragma once
#include <cmath>
#include <vector>

#include "device/queue.hpp"
#include "geometry/pose.hpp"
#include "lib/random.h"
#include "shared/params_closest_point.h"
#include "shared/params_icp_sums.h"

namespace hybrid::testing {

// Pairs of a 20 m room with errors of centimetres, some without a partner.
struct IcpSumsCase {
  static constexpr const char* kName = "icp_sums";
  static constexpr std::size_t kBlock = 256;
  struct Input {
    bool point = false;
    bool normals = false;  // near_x near_y near_z are the pairs' normals
    int lanes = 0;         // 0 = the device's choice
    Pose local_from_scan;
    float cutoff = 0.05f;
    Vec3 centre_scan{1, 2, 0.5}, centre_local{-3, 1, 0.25};
    std::vector<float> x, y, z, area, error, near_x, near_y, near_z;
    std::vector<std::uint32_t> triangle;
    std::vector<ProxyTriangle> triangles;

    int sums() const { return point ? ICP_POINT_SUMS : ICP_PLANE_SUMS; }
  };
  // [blocks][sums]; the reference gives the sums of the absolute terms too, which rounding is relative to.
  struct Output {
    std::vector<double> partial, magnitude;
  };

  static Input make(std::size_t size, std::uint32_t seed) {
    Input in;
    in.local_from_scan.rotation = Eigen::AngleAxisd(0.8, Vec3(0.2, -0.1, 1).normalized());
    in.local_from_scan.translation = Vec3(1.5, -2, 0.25);
    in.local_from_scan.scale = 1.1;
    auto uniform = [&](std::size_t i, std::uint32_t draw) {
      return static_cast<float>(random_bits(seed, static_cast<std::uint32_t>(i), draw) / 2147483648.0 - 1);
    };
    for (std::size_t t = 0; t < 50; ++t) {
      const Vec3 n = Vec3(uniform(t, 20), uniform(t, 21), uniform(t, 22)).normalized();
      ProxyTriangle record{};
      for (int a = 0; a < 3; ++a) record.normal[a] = static_cast<float>(n(a));
      in.triangles.push_back(record);
    }
    for (std::size_t i = 0; i < size; ++i) {
      const bool missing = random_below(seed, static_cast<std::uint32_t>(i), 9, 20) == 0;
      in.x.push_back(missing ? NAN : 10 * uniform(i, 0));
      in.y.push_back(6 * uniform(i, 1));
      in.z.push_back(3 * uniform(i, 2));
      in.area.push_back(0.02f + 0.01f * uniform(i, 3));
      in.error.push_back(missing ? NAN : 0.07f * uniform(i, 4));
      in.near_x.push_back(missing ? NAN : 10 * uniform(i, 5));
      in.near_y.push_back(missing ? NAN : 6 * uniform(i, 6));
      in.near_z.push_back(missing ? NAN : 3 * uniform(i, 7));
      in.triangle.push_back(missing ? NO_TRIANGLE : random_below(seed, static_cast<std::uint32_t>(i), 8, 50));
    }
    return in;
  }

  static Output run(device::Queue& queue, const Input& in) {
    const std::size_t count = in.x.size(), blocks = (count + kBlock - 1) / kBlock;
    IcpSumsParams params{};
    const Mat3 linear = in.local_from_scan.scale * in.local_from_scan.rotation.toRotationMatrix();
    for (int k = 0; k < 9; ++k) params.linear[k] = static_cast<float>(linear(k / 3, k % 3));
    for (int k = 0; k < 3; ++k) {
      params.centre_scan[k] = static_cast<float>(in.centre_scan(k));
      params.centre_local[k] = static_cast<float>(in.centre_local(k));
    }
    params.cutoff = in.cutoff;
    params.samples = static_cast<std::uint32_t>(count);
    auto x = queue.array(in.x), y = queue.array(in.y), z = queue.array(in.z), area = queue.array(in.area);
    auto error = queue.array(in.error), near_x = queue.array(in.near_x), near_y = queue.array(in.near_y),
         near_z = queue.array(in.near_z);
    auto triangle = queue.array(in.triangle);
    auto triangles = queue.array(in.triangles);
    auto partial = queue.array<float>(blocks * static_cast<std::size_t>(in.sums()));
    const device::Defines defines{{"VW", in.lanes ? in.lanes : queue.vector_width()},
                                  {"BLOCK", static_cast<int>(kBlock)},
                                  {"POINT", in.point ? 1 : 0},
                                  {"NORMALS", in.normals ? 1 : 0}};
    queue.launch(kName, queue.kernel(kName, defines), device::grid(blocks), params, x, y, z, area, error,
                 triangle, near_x, near_y, near_z, triangles, partial);
    const auto read = queue.read(partial);
    return {{read.begin(), read.end()}, {}};
  }
  static Output reference(const Input& input);  // reference/icp_sums.cpp

  // 256 terms added one after the other, each rounded: at most 256 x 6e-8, plus the terms' own.
  static constexpr double kTolerance = 2e-5;
  static double items(const Input& input) { return static_cast<double>(input.x.size()); }
  static double bytes(const Input& input) { return (input.point ? 32 : 36) * items(input); }
  static double flops(const Input& input) { return (input.point ? 60 : 110) * items(input); }
};

// The sums of the paper's step, for the bench.
struct IcpSumsPointCase : IcpSumsCase {
  static Input make(std::size_t size, std::uint32_t seed) {
    Input in = IcpSumsCase::make(size, seed);
    in.point = true;
    return in;
  }
};

// The plane step over the samples of another scan, which come with their normals.
struct IcpSumsNormalsCase : IcpSumsCase {
  static Input make(std::size_t size, std::uint32_t seed) {
    Input in = IcpSumsCase::make(size, seed);
    in.normals = true;
    for (std::size_t i = 0; i < size; ++i) {
      const Vec3f n = Vec3f(in.near_x[i], in.near_y[i], in.near_z[i]).normalized();
      in.near_x[i] = n.x(), in.near_y[i] = n.y(), in.near_z[i] = n.z();
    }
    return in;
  }
};

}  // namespace hybrid::testing
