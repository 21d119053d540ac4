#pragma once
#include <nlohmann/json.hpp>

#include "stages/registration/automatic.hpp"

namespace hybrid::batch {

// Key `planar_area`: shares of it.
nlohmann::ordered_json planar_area_json(const stages::SightShares& shares);

// The automatic alignment's part of pose.json and summary.json: reason when it abstained, margin, shares of
// the planar area under the best pose, the closest rivals in words. `best_world_from_scan` of an abstained
// one is a guess, for people only.
nlohmann::ordered_json automatic_json(const stages::AutomaticAlignment& alignment);

}  // namespace hybrid::batch
