#pragma once
#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// Openings of which something hides a part, from whole ones of one design: builders repeat windows. Where an
// opening's border is seen in part only, the border of one that is seen all around, of any wall of the model,
// takes its place, if what was seen contradicts it no more and leaves it no play (border_like). Its pane and
// depths are as its own rays say; a pane that they do not tell is the whole one's if some return from there.
// Pieces of the same opening that lie within go. Where nearly all of the border is hidden (FaceEvidence::
// pieces), one opening of the same face, at its level, has to be the only one that fits.
void complete_by_design(const PolygonModel& model, const EvidenceCloud& cloud, const OpeningOptions& options,
                        Openings& found);

}  // namespace hybrid::stages
