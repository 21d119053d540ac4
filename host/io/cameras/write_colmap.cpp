#include "io/cameras/write_colmap.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/output.hpp"
#include "io/output_file.hpp"

namespace hybrid::io {
namespace {

std::array<double, 15> numbers(const Camera& c) {
  return {static_cast<double>(c.width),
          static_cast<double>(c.height),
          c.fx,
          c.fy,
          c.cx,
          c.cy,
          c.k1,
          c.k2,
          c.p1,
          c.p2,
          c.k3,
          c.k4,
          c.k5,
          c.k6,
          static_cast<double>(c.lens)};
}

std::string camera_line(std::size_t id, const Camera& c) {
  std::string line = fmt::format("{} {{}} {} {} {} {} {} {}", id, c.width, c.height, c.fx, c.fy, c.cx, c.cy);
  const auto add = [&](std::initializer_list<double> values) {
    for (const double value : values) line += fmt::format(" {}", value);
  };
  const char* model = "PINHOLE";
  const bool rational = c.k3 != 0 || c.k4 != 0 || c.k5 != 0 || c.k6 != 0;
  if (c.lens == Lens::fisheye) {
    model = "OPENCV_FISHEYE";
    add({c.k1, c.k2, c.k3, c.k4});
  } else if (rational) {
    model = "FULL_OPENCV";
    add({c.k1, c.k2, c.p1, c.p2, c.k3, c.k4, c.k5, c.k6});
  } else if (c.k1 != 0 || c.k2 != 0 || c.p1 != 0 || c.p2 != 0) {
    model = "OPENCV";
    add({c.k1, c.k2, c.p1, c.p2});
  }
  return line.replace(line.find("{}"), 2, model) + "\n";
}

void write_points(const std::filesystem::path& file, const std::vector<ColmapPoint>& points) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    std::string text = fmt::format(
        "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n# Number of points: {}\n",
        points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& p = points[i];
      fmt::format_to(std::back_inserter(text), "{} {:.5f} {:.5f} {:.5f} {} {} {} 0\n", i + 1, p.position.x(),
                     p.position.y(), p.position.z(), p.rgb[0], p.rgb[1], p.rgb[2]);
      if (text.size() < (1u << 20)) continue;
      out.write(text.data(), text.size());
      text.clear();
    }
    out.write(text.data(), text.size());
    out.close();
  });
}

}  // namespace

std::vector<std::size_t> number_cameras(const std::vector<Photograph>& photographs) {
  std::vector<std::array<double, 15>> found;
  std::vector<std::size_t> index;
  for (const Photograph& photograph : photographs) {
    const auto camera = numbers(photograph.camera);
    const auto at = std::find(found.begin(), found.end(), camera);
    index.push_back(static_cast<std::size_t>(at - found.begin()));
    if (at == found.end()) found.push_back(camera);
  }
  return index;
}

std::vector<std::string> write_colmap(const std::filesystem::path& folder,
                                      const std::vector<Photograph>& photographs,
                                      const std::vector<ColmapPoint>& points) {
  const std::vector<std::size_t> camera_of = number_cameras(photographs);
  std::string cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  std::string images =
      "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n";
  std::vector<std::string> left_out;
  std::vector<bool> written(photographs.size(), false);  // by camera
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const Photograph& photograph = photographs[i];
    if (photograph.camera.panorama()) {
      left_out.push_back(photograph.name);
      continue;
    }
    if (!written[camera_of[i]]) cameras += camera_line(camera_of[i] + 1, photograph.camera);
    written[camera_of[i]] = true;
    const auto& q = photograph.cam_from_world.rotation;
    const Vec3& t = photograph.cam_from_world.translation;
    images += fmt::format("{} {} {} {} {} {} {} {} {} {}\n\n", i + 1, q.w(), q.x(), q.y(), q.z(), t.x(),
                          t.y(), t.z(), camera_of[i] + 1, photograph.name);
  }
  write_text(folder / "cameras.txt", cameras);
  write_text(folder / "images.txt", images);
  write_points(folder / "points3D.txt", points);
  return left_out;
}

}  // namespace hybrid::io
