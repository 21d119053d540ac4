#pragma once
#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

struct DisplacementOptions {
  bool displacement = false;          // write a map per face
  double displacement_texel_m = 0;    // 0: as the samples are spaced, 5 mm at the finest
  double displacement_reach_m = 0.3;  // samples farther off the face are no part of its relief
};
const std::vector<OptionRow<DisplacementOptions>>& displacement_option_table();

// METHOD 9: the scans' relief over a face (Debevec, Taylor and Malik 1996 call it the face's displacement
// map). Row 0 is the top, seen from the front.
struct DisplacementMap {
  std::size_t face = 0;
  int cols = 0, rows = 0;
  double texel_m = 0;
  std::vector<float> height_m;  // over the face, towards its front; median of the texel's samples; NaN: none
  std::vector<std::uint32_t> samples;  // per texel
  // World point of (column, row, height), of pixel centres: 4 x 4, row-major.
  std::array<double, 16> world_from_texel{};
  double measured_m2 = 0;
};

// One per face on which samples lie, from scanners before it.
std::vector<DisplacementMap> displacement_maps(const PolygonModel& model,
                                               const std::vector<OpeningScan>& scans,
                                               const DisplacementOptions& options);

}  // namespace hybrid::stages
