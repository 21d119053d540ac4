#pragma once
#include "trace/tracer.hpp"
#include "world/world.hpp"

namespace synth {

struct Landmark {
  Vec3 point_in_scan, model_vertex;
};

// Corners of the proxy the scanner sees, spread as widely as can be, picked in the scan with a hand's error
// (1 cm per axis). The model side is the proxy's own vertex, wrong as it may be. None when fewer than three
// are seen: others have to carry that scan.
std::vector<Landmark> pick_landmarks(const World&, const Tracer&, const ScannerPose&, std::uint64_t seed,
                                     std::uint64_t scan_index);

}  // namespace synth
