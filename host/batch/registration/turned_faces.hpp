#pragma once
#include <optional>
#include <string>
#include <vector>

#include "batch/registration/registration_unit.hpp"

namespace hybrid::batch {

// Faces of the model that the registered scans see from behind: nothing is registered to them, and
// photographs do not show on that side. Their names, for a warning and the summary; empty when there are
// none.
std::vector<std::string> faces_seen_from_behind(
    const stages::ProxyModel& model, const StageOptions& options,
    const std::vector<std::optional<ScanRegistration>>& registrations);

}  // namespace hybrid::batch
