#include "cases/blend_photos_case.hpp"

#include "geometry/colour.hpp"
#include "reference/photo_sight.hpp"

namespace hybrid::testing {
namespace {

constexpr std::size_t kGaussians = 3;  // for as many bands and one more

void add_noise(BlendPhotosCase::Photo& photo, std::mt19937& random) {
  const Camera& camera = photo.photograph.camera;
  const auto bytes = static_cast<std::size_t>(4 * camera.width * camera.height);
  for (std::size_t i = 0; i < bytes; ++i) photo.pixels.push_back(static_cast<std::uint8_t>(random() % 256));
  for (std::size_t i = 0; i < kGaussians * bytes; ++i)
    photo.low.push_back(static_cast<float>(random() % 256) / 256);
}

}  // namespace

BlendPhotosCase::Input BlendPhotosCase::make(std::size_t size, std::uint32_t seed) {
  Input input;
  input.scene = RayScene::make(40, 60, seed);
  input.eye = {1, -8, 2};
  input.cols = static_cast<std::uint32_t>(size > 1000 ? 101 : size);
  input.rows = static_cast<std::uint32_t>(size > 1000 ? size / 101 : 1);
  for (const double gain : kChannelGains)
    for (int i = 0; i < 256; ++i)
      input.linear.push_back(static_cast<float>(gain * linear_from_srgb(i / 255.0)));

  std::mt19937 random(seed + 1);
  std::uniform_real_distribution<float> place(-4, 4), part(-1, 1);
  for (const Vec3& eye : {Vec3(0, -9, 1), Vec3(7, -6, 0), Vec3(-5, -7, -3)}) {
    Photo photo{look_at(eye, Vec3::Zero(), {0, 0, 1}, 50, 60, 44), {}, {}, input.photos.size() == 2};
    photo.photograph.camera.k1 = -0.1, photo.photograph.camera.k2 = 0.02;
    photo.photograph.camera.p1 = 0.003, photo.photograph.camera.p2 = -0.002;
    add_noise(photo, random);
    for (int i = 0; photo.masked && i < 60 * 44; ++i)
      photo.pixels[static_cast<std::size_t>(4 * i + 3)] = (i % 60) / 15 == 1 || i / 60 < 4 ? 0 : 255;
    input.photos.push_back(std::move(photo));
  }
  for (const Lens lens : {Lens::spherical, Lens::cylindrical}) {
    const bool full = lens == Lens::spherical;
    Photo photo{
        look_at({full ? -1.0 : 1.0, -2, 0.5}, {3, 4, 1}, {0, 0.2, 1}, 50, full ? 80 : 60, 40), {}, {}};
    Camera& camera = photo.photograph.camera;
    camera.lens = lens;
    camera.fx = full ? 40 / M_PI : 20;
    camera.fy = full ? 40 / M_PI : 15;
    add_noise(photo, random);
    input.photos.push_back(std::move(photo));
  }

  const std::size_t count = input.count();
  input.surface.assign(SURFACE_PLANES * count, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 13 == 12) continue;
    const Vec3f normal = Vec3f(part(random), -std::abs(part(random)) - 0.01f, part(random)).normalized();
    const float radius = i % 3 == 0   ? 0.0f
                         : i % 3 == 1 ? 0.03f
                                      : -0.01f;  // face, splat, splat without normal
    for (std::size_t k = 0; k < 3; ++k) {
      input.surface[(SURFACE_X + k) * count + i] = place(random);
      input.surface[(SURFACE_NORMAL_X + k) * count + i] = normal[static_cast<int>(k)];
    }
    input.surface[SURFACE_RADIUS * count + i] = radius;
  }
  return input;
}

BlendPhotosCase::Output BlendPhotosCase::reference(const Input& input) {
  const std::size_t count = input.count();
  Output out{std::vector<float>(input.planes() * count, 0), std::vector<std::uint32_t>(count, 0),
             std::vector<std::int32_t>(count, -1)};
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<WeighedLight> lights;
    for (std::size_t j = 0; j < input.photos.size(); ++j)
      if (const auto sight = photo_sight(input, j, i))
        lights.push_back({static_cast<std::int32_t>(j), sight->feather / (sight->angle + input.pixel_rad),
                          photo_light(input.photos[j], sight->pixel),
                          photo_bands(input.photos[j], sight->pixel, input.mix)});
    out.seen[i] = static_cast<std::uint32_t>(lights.size());
    write_sums(lights, input.mix, count, i, out.sums, out.best);
  }
  return out;
}

}  // namespace hybrid::testing
