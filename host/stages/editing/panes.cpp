#include "stages/editing/panes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/parallel.hpp"
#include "stages/scan/stray_samples.hpp"

namespace hybrid::stages {
namespace {

constexpr double kThick_m = 0.06;    // within which beams return from one pane
constexpr double kSheet_m = 0.012;   // of these, from its glass: some sigmas of noise
constexpr double kSheetShare = 0.5;  // of the most returns that lie so close
constexpr double kStep_m = 0.02;     // between depths that are tried
constexpr double kDeepest_m = 1.0;   // farther behind a wall than its glass is
constexpr double kRaysPerCell = 16;  // of the cells in which returns and passing beams are to be side by side
constexpr double kBars_m = 0.3;      // of tracery: wider cells do not tell bars from holes
constexpr double kMixedShare = 0.5;  // of the cells in which beams pass: more is most of them
constexpr double kLikelyShare = 0.25, kLikelyCount = 0.5;  // of these; of the most cells of any depth
constexpr double kSamePane_m = 0.10;    // apart, of one pane seen from both sides of its wall
constexpr double kLeastApart_m = 0.01;  // from there on its two sides are faces of their own

// Cells of an opening where some beams return from within kThick_m of a depth, some pass it, or both.
struct Mixture {
  int passing = 0, both = 0;
  double share() const { return passing > 0 ? static_cast<double>(both) / passing : 0; }
};

Mixture mixture_at(const std::vector<PassedRay>& rays, double cell_m, double depth_m) {
  std::map<std::pair<int, int>, int> cells;  // 1: some return, 2: some pass
  for (const PassedRay& ray : rays) {
    const Vec2 at = ray.at + std::min(depth_m, ray.depth_m) * ray.slope;
    int& cell =
        cells[{static_cast<int>(std::floor(at.x() / cell_m)), static_cast<int>(std::floor(at.y() / cell_m))}];
    if (std::abs(ray.depth_m - depth_m) <= kThick_m / 2) cell |= 1;
    if (ray.depth_m > depth_m + kThick_m) cell |= 2;
  }
  Mixture mixture;
  for (const auto& [place, kinds] : cells) {
    mixture.passing += (kinds & 2) != 0;
    mixture.both += kinds == 3;
  }
  return mixture;
}

// The glass of a pane about a depth: of the returns that lie closest together, the median, or of those deeper
// that are half as many: mullions, leads and reveals return from before the glass, little from just behind
// it.
double sheet_near(const std::vector<PassedRay>& rays, double depth_m) {
  std::vector<double> near;
  for (const PassedRay& ray : rays)
    if (ray.depth_m >= depth_m - kThick_m / 2 && ray.depth_m <= depth_m + 1.5 * kThick_m)
      near.push_back(ray.depth_m);
  std::sort(near.begin(), near.end());
  std::vector<std::size_t> first(near.size());  // of the returns within kSheet_m up to each
  std::size_t most = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    first[i] = i > 0 ? first[i - 1] : 0;
    while (near[i] - near[first[i]] > kSheet_m) ++first[i];
    most = std::max(most, i + 1 - first[i]);
  }
  const auto count = [&](std::size_t i) { return i + 1 - first[i]; };
  std::size_t best = near.size() - 1;
  while (static_cast<double>(count(best)) < kSheetShare * static_cast<double>(most)) --best;
  for (std::size_t i = best; i > 0 && near[best] - near[i - 1] < kSheet_m; --i)
    if (count(i - 1) > count(best)) best = i - 1;
  return near[(first[best] + best) / 2];
}

struct PaneShape {
  FaceFrame frame;
  Ring2 ring;
};

bool has_pane(const Opening& opening) {
  return opening.cut && opening.pane_m && (!opening.carried_from || opening.pane_from);
}

// The face's frame, moved to where glass closes the opening.
FaceFrame pane_frame(const PolygonModel& model, const Opening& opening, double pane_m) {
  FaceFrame frame = face_frame(model, model.faces[opening.face]);
  frame.origin -= pane_m * frame.plane.normal;
  frame.plane.offset_m -= pane_m;
  return frame;
}

Vec2 mean(const Ring2& ring) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& point : ring) sum += point;
  return sum / static_cast<double>(ring.size());
}

// Whether a pane whose front looks along `normal` is a known one: seen from the same side of the wall, or
// from the other where both agree on its place.
bool is_known(const PaneShape& known, const Vec3& centre, const Vec3& normal) {
  const double before = known.frame.plane.distance(centre);
  const bool is_its_back = known.frame.plane.normal.dot(normal) < 0 && before <= -kLeastApart_m;
  return std::abs(before) < kSamePane_m && !is_its_back && inside(known.ring, known.frame.flat(centre));
}

std::vector<PaneShape> shapes_of(const PolygonModel& model, const std::vector<std::size_t>& faces) {
  std::vector<PaneShape> shapes;
  for (const std::size_t f : faces) {
    FaceFrame frame = face_frame(model, model.faces[f]);
    Ring2 ring = flat_rings(frame, model, model.faces[f])[0];
    shapes.push_back({std::move(frame), std::move(ring)});
  }
  return shapes;
}

struct SurePane {
  std::size_t opening;
  PaneShape shape;
};

std::vector<SurePane> sure_panes(const PolygonModel& model, const Openings& openings) {
  std::vector<SurePane> sure;
  for (std::size_t k = 0; k < openings.openings.size(); ++k)
    if (const Opening& opening = openings.openings[k]; has_pane(opening))
      sure.push_back({k, {pane_frame(model, opening, *opening.pane_m), opening.ring}});
  return sure;
}

// Whether a pane is seen from a wall's other side at `centre`, too, where the front of what is there looks
// along `normal`.
bool is_other_side(const PaneShape& pane, const Vec3& centre, const Vec3& normal) {
  return pane.frame.plane.normal.dot(normal) < 0 && inside(pane.ring, pane.frame.flat(centre));
}

// Of glass that scans show from both sides of a wall.
struct GlassThickness {
  std::size_t face, other_face;
  std::int64_t rays;  // of the side with fewer
  double thickness_m;
};

std::vector<GlassThickness> glass_thicknesses(const Openings& openings, const std::vector<SurePane>& sure) {
  std::vector<GlassThickness> known;
  for (const auto& [near, pane] : sure)
    for (const auto& [far, back] : sure) {
      const Vec3 centre = back.frame.world(mean(back.ring));
      const double thickness_m = -pane.frame.plane.distance(centre);
      if (!is_other_side(pane, centre, back.frame.plane.normal) || thickness_m < kLeastApart_m ||
          thickness_m > kSamePane_m)
        continue;
      const Opening &one = openings.openings[near], &other = openings.openings[far];
      known.push_back({one.face, other.face, std::min(one.rays, other.rays), thickness_m});
    }
  std::stable_sort(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.rays > b.rays; });
  return known;
}

bool behind(const PaneShape& pane, const Vec3& eye, const Vec3& point) {
  const double from = pane.frame.plane.distance(eye), to = pane.frame.plane.distance(point);
  if (from * to >= 0 || std::abs(to) <= kThick_m) return false;
  return inside(pane.ring, pane.frame.flat(eye + from / (from - to) * (point - eye)));
}

}  // namespace

PaneDepths pane_depths(const std::vector<PassedRay>& rays, double area_m2) {
  if (rays.empty()) return {};
  const double cell_m = std::sqrt(kRaysPerCell * area_m2 / static_cast<double>(rays.size()));
  const auto depth_of = [](int step) { return (step + 1) * kStep_m; };
  std::vector<Mixture> mixtures;
  for (int step = 0; depth_of(step) <= kDeepest_m; ++step)
    mixtures.push_back(mixture_at(rays, cell_m, depth_of(step)));
  const int most = std::max_element(mixtures.begin(), mixtures.end(), [](const Mixture& a, const Mixture& b) {
                     return a.both < b.both;
                   })->both;
  if (most == 0) return {};
  // Of the deepest run of sure steps the one with the most cells: tracery stands before its glass, and by the
  // rims of its holes beams return from it and pass as well. Where rays are too few to see the holes, what
  // most of them return from stands for both.
  const double least = cell_m <= kBars_m ? kLikelyCount * most : most;
  int sure = -1, likely = -1;
  bool goes_on = false;
  for (int step = 0; step < static_cast<int>(mixtures.size()); ++step) {
    const auto at = [&](int k) -> const Mixture& { return mixtures[static_cast<std::size_t>(k)]; };
    const bool enough = at(step).both >= kLikelyCount * most;
    const bool is_sure = at(step).both >= least && at(step).share() > kMixedShare;
    if (is_sure && !(goes_on && at(step).both <= at(sure).both)) sure = step;
    goes_on = is_sure;
    if (enough && at(step).share() > (likely < 0 ? kLikelyShare : at(likely).share())) likely = step;
  }
  PaneDepths depths;
  if (sure >= 0) depths.sure = sheet_near(rays, depth_of(sure));
  if (likely >= 0) depths.likely = sheet_near(rays, depth_of(likely));
  return depths;
}

void confirm_panes(const PolygonModel& model, Openings& openings) {
  const std::vector<SurePane> sure = sure_panes(model, openings);
  for (Opening& opening : openings.openings) {
    if (!opening.cut || opening.carried_from || opening.pane_m || !opening.likely_pane_m) continue;
    const FaceFrame frame = pane_frame(model, opening, *opening.likely_pane_m);
    const Vec3 centre = frame.world(mean(opening.ring));
    if (std::any_of(sure.begin(), sure.end(), [&](const SurePane& pane) {
          return is_other_side(pane.shape, centre, frame.plane.normal) &&
                 std::abs(pane.shape.frame.plane.distance(centre)) < kSamePane_m;
        }))
      opening.pane_m = opening.likely_pane_m;
  }
}

void complete_panes(const PolygonModel& model, Openings& openings) {
  const std::vector<SurePane> sure = sure_panes(model, openings);
  const std::vector<GlassThickness> known = glass_thicknesses(openings, sure);
  for (Opening& opening : openings.openings) {
    if (!opening.cut || has_pane(opening)) continue;
    const FaceFrame wall = face_frame(model, model.faces[opening.face]);
    const Vec3 centre = wall.world(mean(opening.ring));
    for (const auto& [seen, pane] : sure) {
      const std::size_t face = openings.openings[seen].face;
      const auto glass = std::find_if(known.begin(), known.end(), [&](const GlassThickness& one) {
        return one.face == face && one.other_face == opening.face;
      });
      if (glass == known.end() || !is_other_side(pane, centre, wall.plane.normal)) continue;
      const double pane_m = -wall.plane.distance(pane.frame.world(mean(pane.ring))) - glass->thickness_m;
      if (pane_m <= 0) continue;
      opening.pane_m = pane_m;
      opening.pane_from = face;
      break;
    }
  }
}

std::vector<std::size_t> add_panes(const Openings& openings, PolygonModel& model) {
  std::vector<const Opening*> order;
  for (const Opening& opening : openings.openings)
    if (has_pane(opening)) order.push_back(&opening);
  std::stable_sort(order.begin(), order.end(),
                   [](const Opening* a, const Opening* b) { return a->rays > b->rays; });
  std::vector<std::size_t> added;
  std::vector<PaneShape> shapes;
  std::map<std::size_t, int> of_face;  // panes
  for (const Opening* opening : order) {
    const FaceFrame frame = pane_frame(model, *opening, *opening->pane_m);
    const Vec3 centre = frame.world(mean(opening->ring));
    if (std::any_of(shapes.begin(), shapes.end(),
                    [&](const PaneShape& known) { return is_known(known, centre, frame.plane.normal); }))
      continue;
    Face face;
    face.name = fmt::format("{}-pane-{}", model.faces[opening->face].name, ++of_face[opening->face]);
    for (const Vec2& point : opening->ring) {
      face.outer.push_back(static_cast<std::uint32_t>(model.vertices.size()));
      model.vertices.push_back(frame.world(point));
    }
    model.faces.push_back(std::move(face));
    added.push_back(model.faces.size() - 1);
    shapes.push_back(shapes_of(model, {added.back()})[0]);
  }
  return added;
}

void mark_through_glass(const RangeImage& image, const Pose& world_from_scan, const PolygonModel& model,
                        const std::vector<std::size_t>& panes, std::vector<std::uint8_t>& stray) {
  const std::vector<PaneShape> shapes = shapes_of(model, panes);
  parallel_for(
      image.count(),
      [&](std::size_t i) {
        if (image.mask[i] != kMeasured || stray[i] != kNotStray) return;
        const Vec3 point = world_from_scan * image.point(i);
        if (std::any_of(shapes.begin(), shapes.end(), [&](const PaneShape& pane) {
              return behind(pane, world_from_scan.translation, point);
            }))
          stray[i] = kThroughGlass;
      },
      1 << 14);
}

}  // namespace hybrid::stages
