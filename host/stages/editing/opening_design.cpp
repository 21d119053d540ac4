#include "stages/editing/opening_design.hpp"

#include <algorithm>
#include <cmath>

#include "core/parallel_uneven.hpp"
#include "stages/editing/opening_grid.hpp"
#include "stages/editing/opening_judgement.hpp"
#include "stages/editing/opening_shape.hpp"

namespace hybrid::stages {
namespace {

constexpr double kWhole = 0.95;         // of a border seen: it can stand for others
constexpr double kKnown = 0.4;          // that a piece must show
constexpr double kUpright = 0.035;      // vertical part of a wall's normal: 2 degrees
constexpr double kAlike = 0.02;         // of the area: designs no more different are one
constexpr double kAlikeCells = 2;       // and their sizes
constexpr double kAroundPiece_m = 0.5;  // samples beyond the largest place that a design can take

struct OpeningDesign {
  const Opening* opening;
  Vec2 size;
};

bool stands(const FaceFrame& frame) {
  return std::abs(frame.plane.normal.z()) < kUpright;
}

// One of each, those first that most lines of sight pass.
std::vector<OpeningDesign> designs_of(const PolygonModel& model, const OpeningOptions& options,
                                      const Openings& found) {
  std::vector<const Opening*> whole;
  for (const Opening& opening : found.openings)
    if (opening.border_seen >= kWhole && objection(found.faces[opening.face], opening, options).empty() &&
        stands(face_frame(model, model.faces[opening.face])))
      whole.push_back(&opening);
  std::stable_sort(whole.begin(), whole.end(),
                   [](const auto* a, const auto* b) { return a->rays > b->rays; });
  std::vector<OpeningDesign> designs;
  for (const Opening* opening : whole) {
    const Box2 box = box_of(opening->ring);
    const Vec2 size = box.high - box.low;
    const bool known = std::any_of(designs.begin(), designs.end(), [&](const OpeningDesign& design) {
      return (size - design.size).cwiseAbs().maxCoeff() < kAlikeCells * design.opening->cell_m &&
             std::abs(opening->area_m2 - design.opening->area_m2) < kAlike * design.opening->area_m2;
    });
    if (!known) designs.push_back({opening, size});
  }
  return designs;
}

// The piece with the border of the design that the samples contradict least; unchanged where none fits.
Opening completed(const PolygonModel& model, const FaceEvidence& face, const OpeningOptions& options,
                  const std::vector<EvidenceMark>& marks, const std::vector<OpeningDesign>& designs,
                  const Opening& piece) {
  double least = 0;
  Opening result = piece;
  for (const OpeningDesign& design : designs) {
    const auto near = marks_near(marks, piece.ring, design.size.maxCoeff() + kAroundPiece_m);
    const auto like = border_like(design.opening->ring, piece.ring, near, face.cell_m);
    if (!like || (result.completed_from && like->contradictions >= least)) continue;
    const bool new_to_it = std::any_of(like->ring.begin(), like->ring.end(), [&](const Vec2& p) {
      return distance_to_border(piece.ring, p) > face.cell_m;
    });
    if (!new_to_it || !try_hole(model, face.face, like->ring, face.cell_m).empty()) continue;
    least = like->contradictions;
    result.ring = like->ring;
    result.completed_from = design.opening->face;
    result.confidence = design.opening->confidence;
  }
  if (!result.completed_from) return piece;
  result.area_m2 = signed_area(result.ring);
  Opening counted = result;
  describe_depths(marks, counted);
  result.rays = counted.rays;
  result.against = counted.against;
  result.confidence *=
      lower_bound(static_cast<double>(result.rays), static_cast<double>(result.rays + result.against));
  const FaceFrame frame = face_frame(model, model.faces[face.face]);
  measure_border(face, distance_to_closed(face), flat_rings(frame, model, model.faces[face.face])[0], result);
  decide(model, face, options, result);
  return result;
}

}  // namespace

void complete_by_design(const PolygonModel& model, const EvidenceCloud& cloud, const OpeningOptions& options,
                        Openings& found) {
  const auto designs = designs_of(model, options, found);
  if (designs.empty()) return;
  std::vector<std::size_t> faces;
  const auto hidden_in_part = [](const Opening& opening) {
    return opening.border_seen < kWhole && opening.border_seen >= kKnown;
  };
  for (const Opening& opening : found.openings)
    if (hidden_in_part(opening) && (faces.empty() || faces.back() != opening.face) &&
        stands(face_frame(model, model.faces[opening.face])))
      faces.push_back(opening.face);
  std::vector<Opening> changed = found.openings;
  parallel_for_uneven(faces.size(), [&](std::size_t k) {
    const FaceEvidence& face = found.faces[faces[k]];
    const auto marks = classify(samples_of_face(cloud, face_frame(model, model.faces[face.face])), face);
    for (std::size_t i = 0; i < changed.size(); ++i)
      if (changed[i].face == face.face && hidden_in_part(found.openings[i]))
        changed[i] = completed(model, face, options, marks, designs, found.openings[i]);
  });
  std::vector<Opening> kept;  // `designs` point into `found`
  for (std::size_t i = 0; i < changed.size(); ++i) {
    bool piece = false;
    for (std::size_t k = 0; k < changed.size() && !piece; ++k)
      piece = k != i && changed[k].face == changed[i].face && changed[k].completed_from &&
              (!changed[i].completed_from || k < i) && lies_in_one(changed[i].ring, {changed[k]});
    if (!piece) kept.push_back(changed[i]);
  }
  found.openings = std::move(kept);
}

}  // namespace hybrid::stages
