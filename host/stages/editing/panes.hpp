#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/polygon_model.hpp"
#include "geometry/pose.hpp"
#include "geometry/range_image.hpp"
#include "stages/editing/openings.hpp"

namespace hybrid::stages {

// A line of sight that passes a face within an opening: where, in the face's coordinates, and how far behind
// it returns.
struct PassedRay {
  Vec2 at;
  double depth_m;
};

// How far behind the face a pane of glass closes an opening of `area_m2`: a plane across it from which some
// beams return while others beside them go through, on most of the opening. Nothing where beams return in one
// part and pass in another: a door ajar.
std::optional<double> pane_depth(const std::vector<PassedRay>& rays, double area_m2);

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
