#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "stages/editing/openings.hpp"

namespace hybrid::stages {

// A line of sight that passes a face within an opening: where, in the face's coordinates, how far behind
// it returns, and how far aside it goes with every metre that it goes behind the face.
struct PassedRay {
  Vec2 at;
  double depth_m;
  Vec2 slope = Vec2::Zero();
};

// How far behind the face a pane of glass closes an opening: a plane across it from which some beams return
// while others beside them, there and not at the face, go through: rays from many stations cross behind it.
struct PaneDepths {
  std::optional<double> sure;    // on most of the opening: not a door ajar, whose leaf is in one part of it
  std::optional<double> likely;  // on much of it, which another side of the wall has to confirm
};
PaneDepths pane_depths(const std::vector<PassedRay>& rays, double area_m2);

// Makes likely panes of openings that were cut sure ones where one that is sure from the wall's other side
// stands there. Sets `pane_m`.
void confirm_panes(const PolygonModel& model, Openings& openings);

// Gives openings that were cut and in which no scan has seen glass from this side of their wall (with those
// carried from its other side) that which is seen from its other side, as thick as between the same two faces
// it is in the opening that most rays show from both. Sets `pane_m` and `pane_from`.
void complete_panes(const PolygonModel& model, Openings& openings);

// Puts the panes of openings that were cut into the model, as faces of the opening's outline named
// "<face>-pane-1", "-2" ...: photographs show what is on the glass, not what is behind it. Of panes seen
// through both sides of a wall the one with more rays, unless the glass is a centimetre thick and more: then
// either side has its own. Returns the new faces' indices.
std::vector<std::size_t> add_panes(const Openings& openings, PolygonModel& model);

// Sets `stray` (per node) to kThroughGlass where a measured sample lies behind one of the faces `panes` on
// its ray: a mirror image, or seen through the glass as no photograph sees it.
void mark_through_glass(const RangeImage& image, const Pose& world_from_scan, const PolygonModel& model,
                        const std::vector<std::size_t>& panes, std::vector<std::uint8_t>& stray);

}  // namespace hybrid::stages
