#include "world/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace synth {

void keep_only_scan(World& world, const std::string& id) {
  const auto found = std::find_if(world.scanners.begin(), world.scanners.end(),
                                  [&](const ScannerPose& pose) { return pose.id == id; });
  if (found == world.scanners.end()) {
    std::string known;
    for (const ScannerPose& pose : world.scanners) known += (known.empty() ? "" : ", ") + pose.id;
    throw std::invalid_argument(fmt::format("--only-scan {}: expected one of {}", id, known));
  }
  world.first_scanner = static_cast<std::uint64_t>(found - world.scanners.begin());
  world.scanners = {*found};
  world.photographs.clear();
  world.views.clear();
}

void remove_distortion(World& world) {
  for (Camera& camera : world.photographs) camera.k1 = camera.k2 = 0;
}

void hang(World& world, const std::string& surface, const Decor& decor) {
  world.decor_of_surface.resize(world.mesh.surfaces.size());
  for (std::size_t i = 0; i < world.mesh.surfaces.size(); ++i)
    if (world.mesh.surfaces[i].name == surface) world.decor_of_surface[i].push_back(decor);
}

void note_clutter(World& world, const std::string& name, const std::string& kind, std::size_t first_vertex) {
  Clutter entry{name, kind, Vec3::Constant(1e9), Vec3::Constant(-1e9)};
  for (std::size_t i = first_vertex; i < world.mesh.vertices.size(); ++i) {
    entry.low = entry.low.cwiseMin(world.mesh.vertices[i].cast<double>());
    entry.high = entry.high.cwiseMax(world.mesh.vertices[i].cast<double>());
  }
  world.clutter.push_back(entry);
}

}  // namespace synth
