#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "batch/scan_unit.hpp"

namespace hybrid::batch {

// scans/<id>/planes/<supercluster id>.png: each supercluster of at least 100 samples seen head on, its
// contours drawn (outer red, inner blue), and planes/index.json: file, scale and frame of each. Pictures of
// an older run are removed.
void write_orthophotos(const std::filesystem::path& folder, const ScanProduct& product);

}  // namespace hybrid::batch
