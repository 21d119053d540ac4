#pragma once
#include <nlohmann/json.hpp>

#include "batch/scan_unit.hpp"

namespace hybrid::batch {

nlohmann::ordered_json json_of(const Vec3& v);  // [x, y, z]

// planes.json of SCENE.md.
nlohmann::ordered_json planes_json(const ScanProduct& product);

// intersections.obj: a line per segment, in the group planes-<id>-<id>.
std::string intersections_obj(const ScanProduct& product);

// The figures of one scan for summary.json: samples, grid, squares by class, superclusters, decimation.
nlohmann::ordered_json scan_figures(const ScanProduct& product);

}  // namespace hybrid::batch
