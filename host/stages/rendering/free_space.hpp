#pragma once
#include <cstdint>
#include <vector>

#include "stages/rendering/render.hpp"

namespace hybrid::stages {

// Which places a person could stand a camera at, as far as anyone has looked: 1 where a scanner or a
// photograph has the place and everything within `clearance_m` of it along the axes in sight, with proxy and
// scans in the way. A place outside the building, inside a wall or within arm's reach of one is 0. Kernel:
// rank_photos.
std::vector<std::uint8_t> in_free_space(Renderer& renderer, const RenderScene& scene,
                                        const std::vector<Vec3>& places, double clearance_m);

}  // namespace hybrid::stages
