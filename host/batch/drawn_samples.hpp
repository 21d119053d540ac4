#pragma once
#include "batch/registration/registration_unit.hpp"
#include "stages/rendering/curtains.hpp"
#include "stages/rendering/opening_contents.hpp"

namespace hybrid::batch {

// The registered scans as evidence of what is in sight.
std::vector<stages::SightScan> sight_scans(const std::vector<ScanProduct>& products,
                                           const std::vector<std::optional<ScanRegistration>>& registrations);

// The contour polygons of all registered scans in the world frame, faces named <scan>-<supercluster id>, and
// the faces that close what no scan has seen: sides of columns (column_backs.hpp, column_ends.hpp), named
// <scan>-column-<cylinder id>, what something hides of the polygons (shadow_faces.hpp), named
// <scan>-<supercluster id>-shadow, their far flanks (far_flanks.hpp), named <scan>-<supercluster id>-flank,
// and what stands in openings as in others of their design, named <scan>-<supercluster id>-alike, and the
// backs of frames there (opening_contents.hpp), named <scan>-<supercluster id>-back.
struct WorldContours {
  PolygonModel model;
  std::vector<std::uint32_t> scan;  // per face: index of its product
};
// The contour polygons alone.
WorldContours world_contours(const std::vector<ScanProduct>& products,
                             const std::vector<std::optional<ScanRegistration>>& registrations);

// Decides how the retained samples of every registered scan are drawn (METHOD 10); fills product.drawn and
// its counts.
// Not drawn: stray samples, those of no plane that another scan looks through (mixed pixels in the air, what
// has moved away), and those that lie on a contour polygon. Drawn only without the proxy: those that
// a proxy face stands for, as it stands for the discarded interior: planar ones within explain_m of a face,
// others within the noise. So nothing is drawn twice, and no sphere bulges out of the face it lies on. A
// sample of no plane where another scan has samples twice as close gives way to those; at their edge it
// stays, as small as they are. `openings` were cut from `model`, the edited proxy, which is empty where there
// is none. Returns the scene's contours; with `unseen_m` (RenderOptions) 0 all that no scan has seen is
// empty, and nothing closes it.
WorldContours choose_drawn_samples(device::Queue& queue, const StageOptions& options,
                                   const std::vector<std::optional<ScanRegistration>>& registrations,
                                   const std::vector<stages::GlazedOpening>& openings,
                                   const PolygonModel& model, std::vector<ScanProduct>& products);

}  // namespace hybrid::batch
