#pragma once
#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// Evidence collected on a face's grid; sets face.cells, cols, rows, cell_m. `spacing_m`: of the samples.
void fill_grid(const std::vector<EvidenceMark>& marks, const std::vector<Ring2>& rings,
               const FaceFrame& frame, double spacing_m, FaceEvidence& face);

// A connected area of a face's grid that lines of sight pass through, as a ring in face coordinates along the
// line half-way between what passes and what does not.
struct OpenArea {
  Ring2 ring;
  bool wide = false;  // holds a circle of 5 cm radius
};
// Those of at least `least_m2` and all wide ones, largest first.
std::vector<OpenArea> open_areas(const FaceEvidence& face, const std::vector<Ring2>& rings, double least_m2);

// Distance in cells from every cell to the nearest one that is set; infinite without any. Exact (Felzenszwalb
// and Huttenlocher 2012).
std::vector<float> distance_to_set(const std::vector<std::uint8_t>& set, int cols, int rows);

// To every cell's nearest one with samples on the face or just before it.
std::vector<float> distance_to_closed(const FaceEvidence& face);

}  // namespace hybrid::stages
