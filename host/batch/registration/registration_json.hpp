#pragma once
#include <nlohmann/json.hpp>

#include "batch/registration/registration_unit.hpp"

namespace hybrid::batch {

// pose.json of SCENE.md.
nlohmann::ordered_json pose_json(const ScanProduct& product, const ScanRegistration& registration);
// The registration's figures for summary.json.
nlohmann::ordered_json registration_figures(const ScanRegistration& registration);

}  // namespace hybrid::batch
