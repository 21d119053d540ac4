#pragma once
#include "rays/measure.hpp"

namespace hybrid::peers {

struct RayOptions {
  int rounds = 3;
  bool quick = false;
  std::string only;  // jobs whose size contains this
};

// A 1080p view of a furnished room of 204 triangles, alone and with 500,000 splats: primary rays, shadow
// rays, eight photographs of 12 megapixels.
void room_jobs(device::Queue& queue, const RayOptions& options, nlohmann::ordered_json& rows);

// Closest points on 180 triangles for a million queries, with a radius and without; the nearest of a million
// points sampled from the same triangles, by nanoflann.
void closest_jobs(device::Queue& queue, const RayOptions& options, nlohmann::ordered_json& rows);

}  // namespace hybrid::peers
