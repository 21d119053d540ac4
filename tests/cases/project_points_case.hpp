#pragma once
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "device/queue.hpp"
#include "geometry/camera.hpp"
#include "shared/params_project_points.h"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::testing {

struct NamedCamera {
  std::string name;
  Camera camera;
};

inline Camera panorama(Lens lens, int width, int height, double fx, double fy, double cy) {
  Camera camera{width, height, fx, fy, 0.5 * width, cy};
  camera.lens = lens;
  return camera;
}

// Every camera model with distortion of the size that real lenses have; the last ones are far from a
// pinhole, or panoramas.
inline std::vector<NamedCamera> camera_models() {
  constexpr auto kFisheye = Lens::fisheye;
  return {
      {"SIMPLE_PINHOLE", {1296, 1936, 2435, 2435, 648, 968}},
      {"PINHOLE", {640, 480, 500, 520, 310.5, 247.25}},
      {"SIMPLE_RADIAL", {1296, 1936, 2435.38, 2435.38, 648, 968, -0.0336422}},
      {"RADIAL", {1000, 800, 700, 700, 500, 400, -0.25, 0.08}},
      {"OPENCV", {1000, 800, 700, 690, 505, 395, -0.28, 0.11, 0.0012, -0.0023}},
      {"FULL_OPENCV", {1000, 800, 700, 690, 505, 395, -0.2, 0.1, 0.001, -0.002, 0.02, 0.1, 0.05, 0.01}},
      // A wide lens as OpenCV's rational model fits it: 120 degrees from side to side.
      {"FULL_OPENCV wide", {1920, 1200, 960, 958, 955, 610, 7.8, 4.5, 2e-4, -1e-4, 0.23, 8.1, 7.1, 1.2}},
      {"SIMPLE_RADIAL_FISHEYE", {1000, 800, 450, 450, 500, 400, 0.02, 0, 0, 0, 0, 0, 0, 0, kFisheye}},
      {"RADIAL_FISHEYE", {1000, 800, 450, 450, 500, 400, 0.03, -0.01, 0, 0, 0, 0, 0, 0, kFisheye}},
      {"OPENCV_FISHEYE", {1000, 800, 450, 445, 505, 395, -0.02, 0.01, 0, 0, -0.004, 0.0006, 0, 0, kFisheye}},
      {"spherical, full", panorama(Lens::spherical, 2048, 1024, 2048 / (2 * M_PI), 1024 / M_PI, 512)},
      {"spherical, 120 x 60 degrees", panorama(Lens::spherical, 1200, 600, 1800 / M_PI, 1800 / M_PI, 300)},
      {"cylindrical, full", panorama(Lens::cylindrical, 3000, 700, 3000 / (2 * M_PI), 477, 300.5)},
      {"cylindrical, 270 degrees", panorama(Lens::cylindrical, 900, 500, 600 / M_PI, 200, 250)},
  };
}

// Points before and behind one camera, in its image and beside it. In `make` the seed picks the model.
struct ProjectPointsCase {
  static constexpr const char* kName = "project_points";
  struct Input {
    Photograph photograph;
    std::vector<float> points;  // x y z, metres
  };
  struct Output {
    std::vector<float> pixels, rays;  // 2 and 3 per point; NaN where not seen
  };
  // A coordinate 10 m away is rounded by 5e-7 m, which is 6e-4 px at 2 m and 2435 px of focal length, and a
  // projection takes about ten roundings; Newton's method stops below 3e-8 of the focal length.
  static constexpr double kTolerance_px = 5e-3;

  static Input make(std::size_t size, std::uint32_t seed) {
    const auto models = camera_models();
    Input input;
    input.photograph.camera = models[seed % models.size()].camera;
    input.photograph.cam_from_world.rotation =
        Eigen::Quaterniond(0.9, 0.1 + 0.01 * seed, -0.3, 0.2).normalized();
    input.photograph.cam_from_world.translation = Vec3(0.5, -0.25, 1);
    const Pose world_from_cam = input.photograph.cam_from_world.inverse();
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> side(-1.3, 1.3), depth(2, 9);
    for (std::size_t i = 0; i < size; ++i) {
      const double z = i % 13 == 12 ? -depth(random) : depth(random);
      const Vec3 point = world_from_cam * Vec3(side(random) * z, side(random) * z, z);
      for (int k = 0; k < 3; ++k) input.points.push_back(i % 17 == 16 ? NAN : static_cast<float>(point[k]));
    }
    return input;
  }
  static Output run(device::Queue& queue, const Input& input) {
    const std::size_t count = input.points.size() / 3;
    const auto points = queue.array(input.points);
    auto pixels = queue.array<float>(2 * count), rays = queue.array<float>(3 * count);
    ProjectPointsParams params{};
    params.camera = stages::camera_record(input.photograph, Vec3::Zero());
    params.count = static_cast<std::uint32_t>(count);
    const auto width = static_cast<std::size_t>(queue.vector_width());
    queue.launch(kName, queue.kernel(kName, {{"VW", queue.vector_width()}}),
                 device::grid((count + width - 1) / width), params, points, pixels, rays);
    return {queue.read(pixels), queue.read(rays)};
  }
  static Output reference(const Input& input);  // reference/project_points.cpp

  static double items(const Input& input) { return static_cast<double>(input.points.size()) / 3; }
  static double bytes(const Input& input) { return 32 * items(input); }
  static double flops(const Input& input) { return 300 * items(input); }
};

}  // namespace hybrid::testing
