#pragma once
#include <nlohmann/json.hpp>

#include "stages/registration/face_offsets.hpp"

namespace hybrid::batch {

// How the scan lies against every face it sees, largest first (at most 200), and what no scan can show.
// `jointly`: the pose was solved with the offsets.
nlohmann::ordered_json face_offsets_json(const stages::FaceOffsets& offsets, bool jointly);

}  // namespace hybrid::batch
