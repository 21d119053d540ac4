#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "archive/manifest.hpp"
#include "archive/outcome.hpp"
#include "archive/store.hpp"
#include "device/queue.hpp"

namespace hybrid::archive {

// What a unit made in its folder: nothing failed, or some of its scans and views.
struct UnitResult {
  nlohmann::ordered_json failures = nlohmann::ordered_json::array();  // {"unit", "error"} each
};

// Each writes its unit's files into `work` and throws what the unit as a whole cannot do without.
UnitResult run_planes_unit(device::Queue& queue, const Unit& unit, const std::filesystem::path& work);
UnitResult run_scene_unit(device::Queue& queue, const Store& store, const Manifest& manifest,
                          const Unit& unit, Outcomes& outcomes, const std::filesystem::path& work);
UnitResult run_report_unit(const Store& store, const Manifest& manifest, const Unit& unit, Outcomes& outcomes,
                           const std::filesystem::path& work);

// Runs the unit in `work`, a folder of Store::begin_object, and commits its object under `key`. Its inputs
// are checked before and after to be those of the plan. A process that holds more than `keep_bytes` in the
// end gives back to the system what it has freed. Throws Error; then the folder is the caller's to remove.
void run_unit(device::Queue& queue, const Store& store, const Manifest& manifest, const Unit& unit,
              Outcomes& outcomes, const std::string& key, const std::filesystem::path& work,
              std::uint64_t keep_bytes);

}  // namespace hybrid::archive
