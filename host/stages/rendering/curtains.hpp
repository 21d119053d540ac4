#pragma once
#include <array>
#include <vector>

#include "stages/rendering/scan_sight.hpp"

namespace hybrid::stages {

struct CurtainOptions {
  double length_m = 0.1;      // how far a curtain hangs behind the outline it begins at
  double tolerance_m = 0.02;  // a scan that sees this far past a place says that it is empty
};

using Curtain = std::array<Vec3, 4>;  // a quadrilateral's corners in order, world frame

// Where a scan's near surface ends before a far one nobody knows how far the near thing reaches back: the
// scanner sees nothing of what is behind it. Curtains hang there, from each outline on along the scanner's
// rays, to the far surface or for length_m, and close the open backs of what is scanned from one side.
// What something nearer hides from there down, and is of no plane nor beside one (shadow_faces.hpp) and not
// seen to go on beside that, stands on the ground: a curtain hangs straight down from its lowest samples
// until a scan shows what is there, 1.5 m at most. What is of no plane, stands free from one outline to the
// other and is round, of 5 to 40 cm radius, is as deep as it is wide: a curtain hangs where its back is,
// unless a scan shows what is there. What a scan shows to be a column or a pipe is as wide beyond its ends,
// up to one and a half radii, where no scan says otherwise: a curtain goes all around there, tolerance_m
// inside. In the order of scans and nodes: same result for any number of threads.
std::vector<Curtain> hang_curtains(const std::vector<SightScan>& scans, const CurtainOptions& options = {});

}  // namespace hybrid::stages
