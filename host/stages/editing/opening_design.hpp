#pragma once
#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// Openings of which something hides a part, from whole ones of one design: builders repeat windows. Where an
// opening's border is seen in part only, the border of one that is seen all around, of any wall of the model,
// takes its place, if what was seen contradicts it no more and leaves it no play (border_like). Its pane and
// depths stay as its own rays say. Pieces of the same opening that lie within go.
void complete_by_design(const PolygonModel& model, const EvidenceCloud& cloud, const OpeningOptions& options,
                        Openings& found);

}  // namespace hybrid::stages
