#include "stages/editing/opening_carry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/editing/opening_judgement.hpp"

namespace hybrid::stages {
namespace {

constexpr double kThinnest_m = 0.02, kThickest_m = 1.5;  // a wall
constexpr double kParallelFacesDeg = 2;                  // of its two faces
constexpr double kAcrossDeg = 6;                         // a straight reveal is so near a right angle
constexpr double kBeside_m = 0.05;                       // of the border: a straight reveal's samples
constexpr double kSplayed = 0.25;                        // of the straight reveals' area: oblique at most
constexpr double kBesideOpening_m = 0.4;                 // rays beside the opening that speak against it

// What stands between the two faces of a wall within an opening's bounding box.
struct Reveals {
  double straight = 0, oblique = 0;  // area
};

Reveals reveals_of(const EvidenceCloud& cloud, const FaceFrame& near, const Ring2& ring, double thickness_m) {
  const auto [low, high] = box_of(ring);
  Reveals reveals;
  for (const EvidencePoint& point : cloud.points) {
    if (point.area_m2 <= 0) continue;
    const Vec3 world = cloud.origin + point.point.cast<double>();
    const double behind = -near.plane.distance(world);
    if (behind < kThinnest_m || behind > thickness_m) continue;
    const Vec2 foot = near.flat(world);
    if ((foot.array() < low.array() - kBeside_m).any() || (foot.array() > high.array() + kBeside_m).any())
      continue;
    const double sine = std::abs(point.normal.cast<double>().dot(near.plane.normal));
    if (sine > std::cos(2 * kAcrossDeg * std::numbers::pi / 180)) continue;  // panes, tracery
    if (sine > std::sin(kAcrossDeg * std::numbers::pi / 180))
      reveals.oblique += point.area_m2;
    else if (distance_to_border(ring, foot) < kBeside_m)
      reveals.straight += point.area_m2;
  }
  return reveals;
}

// The opening of a wall's seen side on its unseen side, without its evidence there.
Opening carried(const Opening& seen, const FaceFrame& from, const FaceFrame& to, const FaceEvidence& face) {
  Opening opening;
  opening.face = face.face;
  opening.carried_from = seen.face;
  opening.cell_m = face.cell_m;
  for (const Vec2& p : seen.ring) opening.ring.push_back(to.flat(from.world(p)));
  if (signed_area(opening.ring) < 0) std::reverse(opening.ring.begin(), opening.ring.end());
  opening.area_m2 = signed_area(opening.ring);
  return opening;
}

// Its rays, and what speaks against it, counted from its face's marks.
void count_evidence(const std::vector<EvidenceMark>& marks, const Opening& seen, Opening& opening) {
  describe_depths(marks, opening);
  opening.against += std::count_if(marks.begin(), marks.end(), [&](const EvidenceMark& mark) {
    const Vec2 at = mark.at.cast<double>();
    return mark.kind == CellEvidence::through && !inside(opening.ring, at) &&
           distance_to_border(opening.ring, at) < kBesideOpening_m &&
           distance_to_border(opening.ring, at) > opening.cell_m;
  });
  opening.confidence = seen.confidence * lower_bound(static_cast<double>(opening.rays),
                                                     static_cast<double>(opening.rays + opening.against));
}

bool leads_through(const FaceFrame& seen, const FaceFrame& unseen) {
  const double thickness = -seen.plane.distance(unseen.world(0.5 * unseen.size));
  return seen.plane.normal.dot(unseen.plane.normal) < -std::cos(kParallelFacesDeg * std::numbers::pi / 180) &&
         thickness > kThinnest_m && thickness < kThickest_m;
}

}  // namespace

void carry_openings(const PolygonModel& model, const EvidenceCloud& cloud, const OpeningOptions& options,
                    Openings& found) {
  std::vector<Opening> result;
  for (const FaceEvidence& face : found.faces) {
    if (face.cells.empty()) continue;
    const FaceFrame to = face_frame(model, model.faces[face.face]);
    std::vector<EvidenceMark> marks;
    std::vector<Opening> own;
    std::copy_if(found.openings.begin(), found.openings.end(), std::back_inserter(own),
                 [&](const Opening& opening) {
                   return opening.face == face.face && objection(face, opening, options).empty();
                 });
    for (const Opening& seen : found.openings) {
      const FaceFrame from = face_frame(model, model.faces[seen.face]);
      if (!objection(found.faces[seen.face], seen, options).empty() || !leads_through(from, to)) continue;
      Opening opening = carried(seen, from, to, face);
      if (overlaps_one(opening.ring, own)) continue;
      if (marks.empty()) marks = classify(samples_of_face(cloud, to), face);
      count_evidence(marks, seen, opening);
      if (opening.rays < options.opening_rays) continue;
      const Reveals reveals =
          reveals_of(cloud, from, seen.ring, -from.plane.distance(to.world(0.5 * to.size)));
      if (!(reveals.straight > 0) || reveals.oblique > kSplayed * reveals.straight) continue;
      decide(model, face, options, opening);
      result.push_back(std::move(opening));
    }
  }
  std::erase_if(found.openings, [&](const Opening& opening) {
    return !objection(found.faces[opening.face], opening, options).empty() &&
           std::any_of(result.begin(), result.end(), [&](const Opening& carried) {
             return carried.face == opening.face && overlaps_one(opening.ring, {carried});
           });
  });
  found.openings.insert(found.openings.end(), result.begin(), result.end());
}

}  // namespace hybrid::stages
