#include "stages/editing/opening_design.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

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
constexpr double kPaneNear_m = 0.03;    // of a whole one's pane: returns from its glass
constexpr double kPaneReturns = 0.05;   // of the rays, that say that glass is there
constexpr double kAroundPiece_m = 0.5;  // samples beyond the largest place that a design can take

struct OpeningDesign {
  const Opening* opening;
  Vec2 size;
};

bool stands(const FaceFrame& frame) {
  return std::abs(frame.plane.normal.z()) < kUpright;
}

// Whether enough of the rays that pass within a border return from one depth for a pane to be there.
bool returns_from(const std::vector<EvidenceMark>& marks, const Ring2& ring, double depth_m) {
  std::int64_t passed = 0, near = 0;
  for (const EvidenceMark& mark : marks) {
    if (!mark.passes() || !inside(ring, mark.at.cast<double>())) continue;
    ++passed;
    near += std::abs(static_cast<double>(mark.depth_m) - depth_m) < kPaneNear_m;
  }
  return static_cast<double>(near) > kPaneReturns * static_cast<double>(passed);
}

// One of each, of all walls or of one face, those first that most lines of sight pass.
std::vector<OpeningDesign> designs_of(const PolygonModel& model, const OpeningOptions& options,
                                      const Openings& found, std::optional<std::size_t> face = {}) {
  std::vector<const Opening*> whole;
  for (const Opening& opening : found.openings)
    if (opening.border_seen >= kWhole && (!face || opening.face == *face) &&
        objection(found.faces[opening.face], opening, options).empty() &&
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

// Gives an opening the border of a whole one, and its glass if some rays return from that as well.
void take_after(const PolygonModel& model, const FaceEvidence& face, const OpeningOptions& options,
                const std::vector<EvidenceMark>& marks, const Opening& whole, const Ring2& ring,
                Opening& opening) {
  opening.ring = ring;
  opening.area_m2 = signed_area(ring);
  opening.completed_from = whole.face;
  Opening counted = opening;
  describe_depths(marks, counted);
  opening.rays = counted.rays;
  opening.against = counted.against;
  opening.depth_m = counted.depth_m;
  opening.kind = counted.kind;
  opening.confidence = whole.confidence * lower_bound(static_cast<double>(opening.rays),
                                                      static_cast<double>(opening.rays + opening.against));
  if (!opening.pane_m && whole.pane_m && returns_from(marks, ring, *whole.pane_m + face.offset_m))
    opening.pane_m = whole.pane_m;
  const FaceFrame frame = face_frame(model, model.faces[face.face]);
  measure_border(face, distance_to_closed(face), flat_rings(frame, model, model.faces[face.face])[0],
                 opening);
  decide(model, face, options, opening);
}

// The piece with the border of the design that the samples contradict least; unchanged where none fits.
Opening completed(const PolygonModel& model, const FaceEvidence& face, const OpeningOptions& options,
                  const std::vector<EvidenceMark>& marks, const std::vector<OpeningDesign>& designs,
                  const Opening& piece) {
  const OpeningDesign* best = nullptr;
  LikeBorder least;
  for (const OpeningDesign& design : designs) {
    const auto near = marks_near(marks, piece.ring, design.size.maxCoeff() + kAroundPiece_m);
    const auto like = border_like(design.opening->ring, piece.ring, near, face.cell_m);
    if (!like || (best && like->contradictions >= least.contradictions)) continue;
    const bool new_to_it = std::any_of(like->ring.begin(), like->ring.end(), [&](const Vec2& p) {
      return distance_to_border(piece.ring, p) > face.cell_m;
    });
    if (!new_to_it || !try_hole(model, face.face, like->ring, face.cell_m).empty()) continue;
    best = &design;
    least = *like;
  }
  Opening result = piece;
  if (best) take_after(model, face, options, marks, *best->opening, least.ring, result);
  return result;
}

// Of a piece whose border is hidden but for a little: one of the row of whole openings of its face, at their
// level. Nothing where what was seen fits two that differ, or none.
std::optional<Opening> of_its_row(const PolygonModel& model, const FaceEvidence& face,
                                  const OpeningOptions& options, const std::vector<EvidenceMark>& marks,
                                  const std::vector<OpeningDesign>& designs, const Ring2& piece) {
  const OpeningDesign* only = nullptr;
  Ring2 ring;
  for (const OpeningDesign& design : designs) {
    const auto near = marks_near(marks, piece, design.size.maxCoeff() + kAroundPiece_m);
    const auto like = border_like(design.opening->ring, piece, near, face.cell_m, Moves::sideways);
    if (!like || !try_hole(model, face.face, like->ring, face.cell_m).empty()) continue;
    if (only) return std::nullopt;
    only = &design;
    ring = like->ring;
  }
  if (!only) return std::nullopt;
  const auto passed = std::count_if(marks.begin(), marks.end(), [&](const EvidenceMark& mark) {
    return mark.passes() && inside(ring, mark.at.cast<double>());
  });
  if (passed < options.opening_rays) return std::nullopt;
  Opening result;
  result.face = face.face;
  result.cell_m = face.cell_m;
  take_after(model, face, options, marks, *only->opening, ring, result);
  return result;
}

// Those of pieces without an opening of their own, each once.
std::vector<Opening> of_rows(const PolygonModel& model, const OpeningOptions& options,
                             const std::vector<EvidenceMark>& marks, const Openings& found,
                             const FaceEvidence& face) {
  const auto designs = designs_of(model, options, found, face.face);
  std::vector<Opening> known, added;
  std::copy_if(found.openings.begin(), found.openings.end(), std::back_inserter(known),
               [&](const Opening& opening) { return opening.face == face.face; });
  for (const Ring2& piece : face.pieces) {
    auto opening = of_its_row(model, face, options, marks, designs, piece);
    if (!opening || overlaps_one(opening->ring, known)) continue;
    known.push_back(*opening);
    added.push_back(*opening);
  }
  return added;
}

}  // namespace

void complete_by_design(const PolygonModel& model, const EvidenceCloud& cloud, const OpeningOptions& options,
                        Openings& found) {
  const auto designs = designs_of(model, options, found);
  if (designs.empty()) return;
  const auto hidden_in_part = [](const Opening& opening) {
    return opening.border_seen < kWhole && opening.border_seen >= kKnown;
  };
  std::vector<std::size_t> faces;
  for (const FaceEvidence& face : found.faces)
    if (stands(face_frame(model, model.faces[face.face])) &&
        (!face.pieces.empty() ||
         std::any_of(found.openings.begin(), found.openings.end(), [&](const Opening& opening) {
           return opening.face == face.face && hidden_in_part(opening);
         })))
      faces.push_back(face.face);
  std::vector<Opening> changed = found.openings;
  std::vector<std::vector<Opening>> added(faces.size());
  parallel_for_uneven(faces.size(), [&](std::size_t k) {
    const FaceEvidence& face = found.faces[faces[k]];
    const auto marks = classify(samples_of_face(cloud, face_frame(model, model.faces[face.face])), face);
    for (std::size_t i = 0; i < changed.size(); ++i)
      if (changed[i].face == face.face && hidden_in_part(found.openings[i]))
        changed[i] = completed(model, face, options, marks, designs, found.openings[i]);
    added[k] = of_rows(model, options, marks, found, face);
  });
  for (auto& of_face : added) std::move(of_face.begin(), of_face.end(), std::back_inserter(changed));
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
