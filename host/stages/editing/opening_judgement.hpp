#pragma once
#include <string>

#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// Lower bound of a share at 95 % (Wilson 1927).
double lower_bound(double good, double all);

// Rays, samples against it, median depth and kind from the marks inside its ring.
void describe_depths(const std::vector<EvidenceMark>& marks, Opening& opening);

// How much of the border has closed cells beside it, and how much is the face's outline. `to_closed`: cells
// from each cell of the grid to the nearest closed one.
void measure_border(const FaceEvidence& face, const std::vector<float>& to_closed, const Ring2& outline,
                    Opening& opening);

// Why an opening is not to be cut; "" when it is.
std::string objection(const FaceEvidence& face, const Opening& opening, const OpeningOptions& options);

// Whether most of an area lies in one of the openings, which are of its face.
bool lies_in_one(const Ring2& area, const std::vector<Opening>& openings);

// Whether it has a place with one of the openings, which are of its face: the middle of either lies in the
// other.
bool overlaps_one(const Ring2& ring, const std::vector<Opening>& openings);

// Sets `cut`, or why not: an objection, or a hole that the face does not take.
void decide(const PolygonModel& model, const FaceEvidence& face, const OpeningOptions& options,
            Opening& opening);

// The ring as a hole that the model takes, or why not.
std::string try_hole(const PolygonModel& model, std::size_t face, const Ring2& ring, double slack_m);

}  // namespace hybrid::stages
