#include "world/world.hpp"

namespace synth {

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
