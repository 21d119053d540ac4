#pragma once
#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// The ring with its corners found: long edges straight, those near the face's axes parallel to them, each
// moved to where it parts what passed from what did not with the fewest samples on the wrong side. Corners
// that sampling rounded off are restored. `ring` unchanged where the result would meet itself.
Ring2 straightened_border(const Ring2& ring, const std::vector<EvidenceMark>& marks, double cell_m);

}  // namespace hybrid::stages
