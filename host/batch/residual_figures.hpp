#pragma once
#include <filesystem>

#include "batch/registration_unit.hpp"

namespace hybrid::batch {

// "residuals" of a scan's registration in summary.json: how far its planar samples lie from the model's faces
// after ICP (stages::ResidualHistogram).
nlohmann::ordered_json residual_figures(const ScanProduct& product, const ScanRegistration& registration);

// scans/<id>/residual.png, at most 2048 pixels a side: a picture to look at, the distances' colours as
// stages::residual_picture() says.
void write_residual_picture(const std::filesystem::path& folder, const ScanProduct& product,
                            const ScanRegistration& registration);

}  // namespace hybrid::batch
