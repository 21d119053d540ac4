#include "reference/photo_sight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/colour.hpp"
#include "reference/shadow.hpp"

namespace hybrid::testing {
namespace {

// A full panorama's left and right borders are neighbours.
bool closes(const Camera& camera) {
  const bool panorama = camera.lens == Lens::spherical || camera.lens == Lens::cylindrical;
  return panorama && std::abs(camera.width / camera.fx - 2 * M_PI) < 1e-3;
}

// Distance to the nearest line where a photograph ends. A full sphere ends nowhere.
double border_distance(const Camera& camera, const Vec2& pixel) {
  double border = std::numeric_limits<double>::infinity();
  if (!closes(camera)) border = std::min(pixel.x(), camera.width - pixel.x());
  const bool poles = camera.lens == Lens::spherical && std::abs(camera.height / camera.fy - M_PI) < 1e-3;
  if (!poles) border = std::min({border, pixel.y(), camera.height - pixel.y()});
  return border;
}

// value(x, y) gives a pixel.
template <typename Value>
Vec3 sample(const Camera& camera, const Vec2& position, const Value& value) {
  const Vec2 p = position - Vec2(0.5, 0.5);
  const auto column = [&](int x) {
    return closes(camera) ? (x + camera.width) % camera.width : std::clamp(x, 0, camera.width - 1);
  };
  const auto row = [&](int y) { return std::clamp(y, 0, camera.height - 1); };
  const double left = std::floor(p.x()), top = std::floor(p.y()), u = p.x() - left, v = p.y() - top;
  const int x = column(static_cast<int>(left)), x1 = column(static_cast<int>(left) + 1);
  const int y = row(static_cast<int>(top)), y1 = row(static_cast<int>(top) + 1);
  return (1 - v) * ((1 - u) * value(x, y) + u * value(x1, y)) +
         v * ((1 - u) * value(x, y1) + u * value(x1, y1));
}

}  // namespace

std::optional<PhotoSight> photo_sight(const BlendPhotosCase::Input& input, std::size_t photo, std::size_t i) {
  const auto plane = [&](std::size_t p) { return double{input.surface[p * input.count() + i]}; };
  const Vec3 point(plane(SURFACE_X), plane(SURFACE_Y), plane(SURFACE_Z));
  const Vec3 normal(plane(SURFACE_NORMAL_X), plane(SURFACE_NORMAL_Y), plane(SURFACE_NORMAL_Z));
  const double radius = plane(SURFACE_RADIUS);
  const Photograph& photograph = input.photos[photo].photograph;
  const Camera& camera = photograph.camera;
  if (!point.allFinite()) return {};
  const auto pixel = camera.project(photograph.cam_from_world * point);
  if (!pixel) return {};
  const Vec3 centre = photograph.centre(), eye(input.eye[0], input.eye[1], input.eye[2]);
  const Vec3 to_eye = (eye - point).normalized(), direction = (point - centre).normalized();
  PhotoSight sight;
  sight.pixel = *pixel;
  sight.distance = (point - centre).norm();
  sight.eye_distance = (eye - point).norm();
  sight.facing = radius < 0 ? 1 : -normal.dot(direction);
  sight.eye_facing = radius < 0 ? 1 : normal.dot(to_eye);
  sight.angle = std::atan2(to_eye.cross(-direction).norm(), to_eye.dot(-direction));
  const double border = border_distance(camera, *pixel);
  sight.feather = input.feather_px > 0 ? std::clamp(border / input.feather_px, 1e-6, 1.0) : 1;
  const bool is_sample = radius > double{SURFACE_POLYGON_RADIUS};
  if (sight.facing <= (is_sample ? input.least_facing_sample : input.least_facing)) return {};
  // A position is the photograph's when no pixel with a share in it is masked.
  const BlendPhotosCase::Photo& photo_input = input.photos[photo];
  if (photo_input.masked) {
    const auto masked = [&](int x, int y) {
      return Vec3::Constant(photo_input.pixels[4 * static_cast<std::size_t>(y * camera.width + x) + 3] ? 0
                                                                                                       : 1);
    };
    if (sample(camera, *pixel, masked).x() > 0) return {};
  }

  const double stretch = 1 / std::max(sight.facing, 0.2);
  const double clear_of_faces = (radius == 0 ? input.face_tolerance_m : input.tolerance_m) * stretch;
  const double clear_of_spheres = std::max<double>(input.tolerance_m, 2 * std::abs(radius)) * stretch;
  for (const auto& t : input.scene.triangles)
    if (triangle_distance(centre, direction, t) < sight.distance - clear_of_faces) return {};
  for (const auto& s : input.scene.spheres)
    if (sphere_distance(centre, direction, s) < sight.distance - clear_of_spheres - 2 * s.radius) return {};
  return sight;
}

Vec3 photo_light(const BlendPhotosCase::Photo& photo, const Vec2& position) {
  const Camera& camera = photo.photograph.camera;
  return sample(camera, position, [&](int x, int y) {
    const std::uint8_t* bytes = photo.pixels.data() + 4 * (y * camera.width + x);
    return Vec3(kChannelGains[0] * linear_from_srgb(bytes[0] / 255.0),
                kChannelGains[1] * linear_from_srgb(bytes[1] / 255.0),
                kChannelGains[2] * linear_from_srgb(bytes[2] / 255.0));
  });
}

Vec3 photo_low(const BlendPhotosCase::Photo& photo, const Vec2& position, std::size_t gaussian) {
  const Camera& camera = photo.photograph.camera;
  const std::size_t first = gaussian * photo.pixels.size();
  return sample(camera, position, [&](int x, int y) {
    const float* value = photo.low.data() + first + 4 * static_cast<std::size_t>(y * camera.width + x);
    return Vec3(value[0], value[1], value[2]);
  });
}

std::vector<Vec3> photo_bands(const BlendPhotosCase::Photo& photo, const Vec2& position,
                              const BlendMode& mix) {
  std::vector<Vec3> smooth{photo_light(photo, position)}, bands;
  for (std::size_t k = 0; k + 1 < mix.bands; ++k) smooth.push_back(photo_low(photo, position, k));
  for (std::size_t k = 0; k + 1 < mix.bands; ++k) bands.push_back(smooth[k] - smooth[k + 1]);
  bands.push_back(smooth.back());
  return bands;
}

void write_sums(const std::vector<WeighedLight>& lights, const BlendMode& mix, std::size_t count,
                std::size_t i, std::vector<float>& sums, std::vector<std::int32_t>& best) {
  if (lights.empty()) return;
  const bool split = mix.mode == BLEND_BANDS;
  const auto heaviest =
      std::max_element(lights.begin(), lights.end(), [](auto& a, auto& b) { return a.weight < b.weight; });
  const auto write = [&](std::size_t plane, double value) {
    sums[plane * count + i] = static_cast<float>(value);
  };
  const auto write_colour = [&](std::size_t plane, const Vec3& colour, double share) {
    for (int k = 0; k < 3; ++k) write(plane + static_cast<std::size_t>(k), colour[k]);
    write(plane + 3, share);
  };
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  for (const auto& light : lights) {
    sum += light.weight * (split ? light.bands.back() : light.light);
    weight += light.weight;
  }
  write_colour(BLEND_SUM_R, sum, weight);
  for (std::size_t band = 0; split && band + 1 < mix.bands; ++band) {
    Vec3 mixed = Vec3::Zero();
    double shares = 0;
    for (const auto& light : lights) {
      const double share = std::pow(light.weight / heaviest->weight, mix.power[band]);
      mixed += share * light.bands[band];
      shares += share;
    }
    write_colour(band == 0 ? BLEND_BEST_R : BLEND_PLANES + BLEND_BAND_PLANES * (band - 1), mixed, shares);
  }
  if (!split) write_colour(BLEND_BEST_R, heaviest->light, 1);
  write(BLEND_BEST_WEIGHT, heaviest->weight);
  best[i] = heaviest->photograph;
}

}  // namespace hybrid::testing
