#pragma once
#include <optional>
#include <string>
#include <vector>

#include "batch/registration/registration_unit.hpp"

namespace hybrid::batch {

// Faces of the model that the registered scans see from behind, and are not registered to: half a square
// metre and 30 % of a face at least.
struct TurnedFaces {
  std::vector<std::string> names;  // most seen first
  std::string warning;             // "" = none
};
TurnedFaces faces_seen_from_behind(const stages::ProxyModel& model, const StageOptions& options,
                                   const std::vector<std::optional<ScanRegistration>>& registrations);

}  // namespace hybrid::batch
