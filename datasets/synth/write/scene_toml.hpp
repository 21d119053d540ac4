#pragma once
#include <filesystem>
#include <vector>

#include "room/room.hpp"

namespace synth {

struct Landmark {
  Vec3 point_in_scan, model_vertex;
};

void write_scene_toml(const std::filesystem::path&, const RoomOptions&, const std::vector<ScannerPose>&,
                      const std::vector<std::vector<Landmark>>& landmarks_of_scan, const std::vector<View>&);

}  // namespace synth
