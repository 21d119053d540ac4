#pragma once
#include <filesystem>

#include "batch/registration/scan_to_scan.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::batch {

// What a person needs to choose one of the places where scan `i`, which has no pose, may stand (its
// registration's `places`), in <folder>/sheet/: places.png, from above, every place on what is known beside
// it, with the columns of scan.png that look there; places.toml, each as the pose that the scene file takes.
// `model` may be null. Nothing without places.
void write_place_sheet(const std::filesystem::path& folder, std::size_t i,
                       const std::vector<ScanProduct>& products, const Registrations& registrations,
                       const ScanRegistration& abstained, const PolygonModel* model,
                       const io::SceneScan& entry);

// The picture by itself: 3 channels, the panels of all places side by side, at most two in a row.
Image8 place_sheet(std::size_t i, const std::vector<ScanProduct>& products,
                   const Registrations& registrations, const std::vector<PossiblePlace>& places,
                   const PolygonModel* model);

}  // namespace hybrid::batch
