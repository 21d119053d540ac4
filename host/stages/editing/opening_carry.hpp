#pragma once
#include <vector>

#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// Openings of faces that no scan sees from their front, from those of the wall's other side: where a parallel
// face that looks the other way, at most 1.5 m away, has an opening, enough lines of sight through it pass
// this face too, and the reveals between them stand at right angles to the wall, it has the same border here.
// `found`: faces and openings so far.
std::vector<Opening> carried_openings(const PolygonModel& model, const EvidenceCloud& cloud,
                                      const OpeningOptions& options, const Openings& found);

}  // namespace hybrid::stages
