#include <fmt/format.h>

#include <cmath>

#include "cases/render_view_case.hpp"
#include "rays/embree_rays.hpp"
#include "rays/rays_jobs.hpp"

namespace hybrid::peers {
namespace {

using testing::BlendViewCase;
using testing::FurnishedRoom;

const std::string kEmbree = "Embree " RTC_VERSION_STRING;

Geometry geometry_of(const stages::Bvh& bvh) {
  Geometry geometry;
  for (const TriangleRecord& t : bvh.triangles) {
    for (const float* corner : {t.a, t.b, t.c})
      geometry.corners.insert(geometry.corners.end(), corner, corner + 3);
    geometry.ids.push_back(t.id);
  }
  for (const SphereRecord& s : bvh.spheres) {
    geometry.spheres.insert(geometry.spheres.end(), s.centre, s.centre + 3);
    geometry.spheres.push_back(s.radius);
  }
  return geometry;
}

Pinhole pinhole_of(const CameraRecord& camera) {
  Pinhole out{};
  std::copy(camera.rotation, camera.rotation + 9, out.rotation);
  std::copy(camera.centre, camera.centre + 3, out.centre);
  out.fx = camera.fx, out.fy = camera.fy, out.cx = camera.cx, out.cy = camera.cy, out.k1 = camera.k1;
  out.width = static_cast<int>(camera.width), out.height = static_cast<int>(camera.height);
  return out;
}

// Share of pixels whose distances agree to a millimetre, or that both say are empty.
std::string same_distance(const std::vector<float>& ours, const std::vector<float>& theirs) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < ours.size(); ++i)
    same += std::abs(ours[i] - theirs[i]) < 1e-3f || (std::isinf(ours[i]) && std::isinf(theirs[i]));
  return fmt::format("distance as ours on {:.3f} % of pixels",
                     100.0 * static_cast<double>(same) / static_cast<double>(ours.size()));
}

// Share of pixels seen by as many photographs, and how far the sums of weights are apart on those.
std::string same_blend(const std::vector<float>& ours, const std::vector<std::uint32_t>& ours_seen,
                       const std::vector<float>& theirs, const std::vector<std::uint32_t>& theirs_seen) {
  const std::size_t count = ours_seen.size();
  std::size_t same = 0;
  double apart = 0, rays = 0;
  for (std::size_t i = 0; i < count; ++i) {
    rays += theirs_seen[i];
    if (ours_seen[i] != theirs_seen[i]) continue;
    ++same;
    if (ours_seen[i] == 0) continue;
    const double weight = ours[BLEND_SUM_WEIGHT * count + i];
    apart += std::abs(theirs[8 * i + 3] - weight) / weight;
  }
  return fmt::format(
      "{:.2f} photographs a pixel; as many as ours on {:.2f} % of pixels, weights there {:.2f} % apart",
      rays / static_cast<double>(count), 100.0 * static_cast<double>(same) / static_cast<double>(count),
      100 * apart / static_cast<double>(same));
}

// One room: all three jobs.
void measure_room(device::Queue& queue, const RayOptions& options, std::size_t splats,
                  const std::string& size, nlohmann::ordered_json& rows) {
  const auto input = BlendViewCase::make(splats, 1);
  const FurnishedRoom& room = input.room;
  const EmbreeScene scene(geometry_of(room.bvh));
  const Pinhole view = pinhole_of(room.view);
  const double pixels = BlendViewCase::items(input);
  const auto geometry = stages::upload_bvh(queue, room.bvh, room.surfaces);

  auto tile = room.cast(queue, geometry);
  Surface single, packets;
  const auto same = [&](const Surface& theirs) {
    return same_distance(queue.read(tile.distance), theirs.distance);
  };
  measure("primary rays", size, pixels, options.rounds,
          {{"hybrid ray_cast",
            "hybrid",
            "on the device; point, normal and id written",
            true,
            [&] { return spent_on_device(queue, [&] { room.cast(queue, geometry, tile); }); },
            {}},
           {"Embree, 1 ray", kEmbree, "coherent flag; point, normal and id written", false,
            [&] { return spent_on([&] { scene.cast(view, RayMode::single, single); }); },
            [&] { return same(single); }},
           {"Embree, packets of 16", kEmbree, "coherent flag; point, normal and id written", false,
            [&] { return spent_on([&] { scene.cast(view, RayMode::packet16, packets); }); },
            [&] { return same(packets); }}},
          rows);

  EmbreeScene::Photographs photographs;
  for (const auto& camera : input.cameras) photographs.cameras.push_back(pinhole_of(camera));
  std::size_t free = 0;
  const auto shadows = [&](RayMode mode) {
    return spent_on([&] { free = scene.shadow(packets, photographs.cameras, mode); });
  };
  const auto share = [&] {
    return fmt::format("{:.1f} % free", 100.0 * static_cast<double>(free) / (8 * pixels));
  };
  measure("shadow rays alone, 8 a pixel", size, 8 * pixels, options.rounds,
          {{"Embree, 1 ray", kEmbree, "no kernel of ours does only this", false,
            [&] { return shadows(RayMode::single); }, share},
           {"Embree, packets of 16", kEmbree, "no kernel of ours does only this", false,
            [&] { return shadows(RayMode::packet16); }, share}},
          rows);

  const std::vector<float> linear(256, 0.5f);  // as the case has it
  photographs.pixels = input.pixels.data();
  photographs.low = input.low.data();
  photographs.linear = linear.data();
  std::copy(view.centre, view.centre + 3, photographs.eye);
  photographs.pixel_rad = 0.001f;
  photographs.feather_px = 32;
  std::vector<float> sums;
  std::vector<std::uint32_t> seen;
  BlendViewCase::Arrays at(queue, input);
  const auto blend = [&](RayMode mode) {
    sums.assign(8 * packets.count, 0);
    seen.assign(packets.count, 0);
    return spent_on([&] { scene.blend(packets, photographs, mode, sums, seen); });
  };
  const auto quality = [&] { return same_blend(queue.read(at.sums), queue.read(at.seen), sums, seen); };
  measure("8 photographs of 12 MP with shadow rays", size, pixels, options.rounds,
          {{"hybrid blend_photos",
            "hybrid",
            "on the device, all 8; two bands",
            true,
            [&] {
              BlendViewCase::clear(queue, at);
              return spent_on_device(queue, [&] { BlendViewCase::blend(queue, input, at); });
            },
            {}},
           {"Embree, 1 ray", kEmbree, "two bands, same weights", false,
            [&] { return blend(RayMode::single); }, quality},
           {"Embree, packets of 16", kEmbree, "two bands, same weights", false,
            [&] { return blend(RayMode::packet16); }, quality}},
          rows);
}

}  // namespace

void room_jobs(device::Queue& queue, const RayOptions& options, nlohmann::ordered_json& rows) {
  const auto measured = [&](std::size_t splats, const std::string& size) {
    if (size.find(options.only) != std::string::npos) measure_room(queue, options, splats, size, rows);
  };
  measured(0, "1080p, 204 triangles");
  measured(testing::RayCastViewCase::kMeshes, "1080p, 95 k triangles");
  if (!options.quick) measured(500'000, "1080p, 204 triangles and 500 k splats");
}

}  // namespace hybrid::peers
