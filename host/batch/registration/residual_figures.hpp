#pragma once
#include "batch/registration/registration_unit.hpp"

namespace hybrid::batch {

// "residuals" of a scan's registration in summary.json: how far its planar samples lie from the model's
// faces, or from other scans, under its final pose (stages::ResidualHistogram).
nlohmann::ordered_json residual_figures(const RegisteredNodes& found);

}  // namespace hybrid::batch
