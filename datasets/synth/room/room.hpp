#pragma once
#include <string>
#include <vector>

#include "geometry/shapes.hpp"
#include "world/world.hpp"

namespace synth {

// A furnished room of about 12 x 8 x 4 m, its box as proxy, two scanners, six photographs.
World build_room(const Options&);

// The parts of build_room; recesses: door, north window, east window.
void hang_decor(World& room, const std::vector<Recess>& recesses);  // after the mesh is complete
void place_viewpoints(World& room, const Options&);
void add_box_proxy(World& room);

}  // namespace synth
