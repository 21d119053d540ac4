#pragma once
#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// Adds the openings of a wall's other side where a face has none of its own, or none to be cut: no scan sees
// the face from its front, or something stands before it. Where a parallel face that looks the other way, at
// most 1.5 m away, has an opening, enough lines of sight through it pass this face too, and the reveals
// between them stand at right angles to the wall, it has the same border here. What samples on this face
// contradict costs confidence.
void carry_openings(const PolygonModel& model, const EvidenceCloud& cloud, const OpeningOptions& options,
                    Openings& found);

}  // namespace hybrid::stages
