#pragma once
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "geometry/colour.hpp"
#include "reference/shadow.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::testing {

// A room of 6 x 5 x 3 m with boxes in it, painted by a function of position, and photographs of it computed
// ray by ray in double on the host: what rendering must give back is known everywhere.
struct RoomScene {
  stages::RenderScene scene;
  std::vector<TriangleRecord> triangles;  // of the proxy, without origin

  // An axis-aligned box of six faces; `inside`: their fronts look inwards.
  void add_box(const Vec3& low, const Vec3& high, bool inside) {
    const auto base = static_cast<std::uint32_t>(scene.proxy.vertices.size());
    for (std::uint32_t i = 0; i < 8; ++i)
      scene.proxy.vertices.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                                        i & 4 ? high.z() : low.z());
    const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& quad : quads) {
      std::vector<std::uint32_t> ring;
      for (std::uint32_t v : quad) ring.push_back(base + v);
      if (inside) std::reverse(ring.begin(), ring.end());
      scene.proxy.faces.push_back({"face-" + std::to_string(scene.proxy.faces.size()), ring, {}});
    }
    refresh();
  }

  void refresh() {
    triangles.clear();
    for (const Triangle& t : triangulate(scene.proxy)) {
      TriangleRecord record{};
      for (int k = 0; k < 3; ++k) {
        record.a[k] = static_cast<float>(scene.proxy.vertices[t.vertices[0]][k]);
        record.b[k] = static_cast<float>(scene.proxy.vertices[t.vertices[1]][k]);
        record.c[k] = static_cast<float>(scene.proxy.vertices[t.vertices[2]][k]);
      }
      record.id = 1 + t.face;
      triangles.push_back(record);
    }
  }

  // The nearest face along a ray: 1 + face, 0 = none, and the distance.
  std::pair<std::uint32_t, double> hit(const Vec3& origin, const Vec3& direction) const {
    std::pair<std::uint32_t, double> nearest{0, std::numeric_limits<double>::infinity()};
    for (const auto& t : triangles)
      if (const double d = triangle_distance(origin, direction, t); d < nearest.second) nearest = {t.id, d};
    return nearest;
  }

  // Linear light of the paint: a strong colour per face, waved slowly enough for the photographs to resolve.
  static Vec3 paint(std::uint32_t id, const Vec3& p) {
    const auto pastel = pastel_srgb(7 * id);
    const double wave =
        0.75 + 0.25 * std::sin(5 * p.x() + 1) * std::cos(4 * p.y()) * std::sin(6 * p.z() + 0.5);
    return wave * Vec3(pastel[0] * pastel[0], pastel[1] * pastel[1], pastel[2] * pastel[2]);
  }

  // What a perfect renderer shows.
  ImageF true_view(const Photograph& view) const {
    ImageF image(view.camera.width, view.camera.height, 3);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Vec3 direction =
            view.cam_from_world.rotation.conjugate() * view.camera.ray(Vec2(x + 0.5, y + 0.5));
        const auto [id, distance] = hit(view.centre(), direction);
        if (id == 0) continue;
        const Vec3 light = paint(id, view.centre() + distance * direction);
        for (int k = 0; k < 3; ++k) image.at(x, y)[k] = static_cast<float>(light[k]);
      }
    return image;
  }

  static Image8 encode(const ImageF& linear) {
    Image8 image(linear.width, linear.height, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      image.pixels[i] =
          static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(std::min(linear.pixels[i], 1.0f))));
    return image;
  }

  void add_photograph(const Vec3& eye, const Vec3& target, int width, int height) {
    Photograph photograph = look_at(eye, target, {0, 0, 1}, 65, width, height);
    photograph.name = "photo-" + std::to_string(scene.photographs.size());
    photograph.camera.k1 = -0.08, photograph.camera.k2 = 0.01, photograph.camera.p1 = 0.001;
    scene.photographs.push_back(photograph);
    scene.photograph_pixels.push_back(encode(true_view(photograph)));
  }

  static RoomScene make(int photographs, int width, int height) {
    RoomScene room;
    room.add_box({0, 0, 0}, {6, 5, 3}, true);
    room.add_box({2, 2, 0}, {3, 3, 1.2}, false);
    room.add_box({4.2, 1, 0}, {4.6, 3.5, 2}, false);
    const Vec3 eyes[] = {{0.6, 0.5, 1.6}, {0.5, 4.4, 1.8}, {3.6, 0.4, 1.5}, {3.5, 4.6, 2.2},
                         {1.5, 0.5, 2.4}, {5.5, 0.5, 1.2}, {5.4, 4.5, 2.0}, {0.4, 2.5, 1.0}};
    const Vec3 targets[] = {{3, 3, 1},     {3, 1, 1},   {2, 4, 1},     {3, 0.5, 0.8},
                            {3, 4.5, 0.5}, {5, 4.5, 1}, {4.5, 0, 0.5}, {5, 2.2, 1.2}};
    for (std::size_t i = 0; i < static_cast<std::size_t>(photographs); ++i)
      room.add_photograph(eyes[i % 8] + Vec3(0, 0, 0.1 * static_cast<double>(i / 8)), targets[i % 8], width,
                          height);
    return room;
  }
};

}  // namespace hybrid::testing
