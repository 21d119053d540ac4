#include "stages/editing/openings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/parallel_uneven.hpp"
#include "stages/editing/opening_border.hpp"
#include "stages/editing/opening_carry.hpp"
#include "stages/editing/opening_design.hpp"
#include "stages/editing/opening_grid.hpp"
#include "stages/editing/opening_judgement.hpp"
#include "stages/editing/opening_shape.hpp"

namespace hybrid::stages {
namespace {

constexpr double kAround_m = 1.2;      // of an opening: samples that tell its border
constexpr double kLeastBorder = 0.25;  // of a border seen: else where it opens is anybody's guess
constexpr double kAbsentShare = 0.5;   // of a face's area open: the face stands for nothing

// 3 sigma of pose and proxy: how far behind the face the surface may seem to be by their errors alone.
double error_m(const FaceEvidence& face, const FaceFrame& frame, const std::vector<OpeningScan>& scans) {
  double worst = 0;
  const Vec3 centre = frame.world(0.5 * frame.size);
  for (const OpeningScan& scan : scans) {
    // d(height) = normal . (rotation x arm + translation); the covariance is about the world's origin.
    Eigen::Matrix<double, 6, 1> gradient;
    gradient << centre.cross(frame.plane.normal), frame.plane.normal;
    Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(scan.covariance.data());
    const double variance = gradient.dot(covariance * gradient);
    if (variance < 1) worst = std::max(worst, variance);  // beyond: a degenerate direction, not an error
  }
  return 3 * std::sqrt(worst + face.spread_m * face.spread_m);
}

double median_spacing(const FaceSamples& samples) {
  std::vector<float> spacings;
  for (const FaceSample& s : samples.samples) spacings.push_back(s.spacing_m);
  if (spacings.empty()) return 0;
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

std::vector<Opening> openings_of(const PolygonModel& model, const FaceFrame& frame,
                                 const std::vector<Ring2>& rings, const FaceSamples& samples,
                                 const OpeningOptions& options, FaceEvidence& face) {
  const auto marks = classify(samples, face);
  fill_grid(marks, rings, frame, median_spacing(samples), face);
  const auto to_closed = distance_to_closed(face);
  std::vector<Opening> found;
  double open_m2 = 0;
  for (const auto& [area, wide] : open_areas(face, rings, options.opening_area_m2)) {
    if (lies_in_one(area, found)) continue;  // a piece of one whose middle is hidden
    if (!wide) {
      face.pieces.push_back(area);
      continue;
    }
    const auto near = marks_near(marks, area, std::max(4 * face.cell_m, kAround_m));
    Opening opening;
    opening.face = face.face;
    opening.cell_m = face.cell_m;
    opening.ring = area;
    measure_border(face, to_closed, rings[0], opening);
    open_m2 += opening.border_seen < kLeastBorder ? signed_area(area) : 0;
    if (opening.border_seen < kLeastBorder) {
      face.pieces.push_back(area);
      continue;
    }
    const auto regular = regular_border(area, near, face.cell_m);
    opening.ring = regular ? *regular : straightened_border(area, near, face.cell_m);
    if (regular && !try_hole(model, face.face, opening.ring, face.cell_m).empty())
      opening.ring = straightened_border(area, near, face.cell_m);
    if (!try_hole(model, face.face, opening.ring, face.cell_m).empty())
      opening.ring = simplified(area, 0.5 * face.cell_m);
    opening.area_m2 = signed_area(opening.ring);
    open_m2 += opening.area_m2;
    describe_depths(near, opening);
    for (std::optional<double>* pane : {&opening.pane_m, &opening.likely_pane_m})
      if (*pane) **pane -= face.offset_m;  // from the surface's distance to the face's
    if (opening.area_m2 < options.opening_area_m2 || opening.rays < options.opening_rays) continue;
    measure_border(face, to_closed, rings[0], opening);
    if (opening.border_seen < kLeastBorder) continue;
    opening.confidence =
        lower_bound(static_cast<double>(opening.rays), static_cast<double>(opening.rays + opening.against)) *
        opening.border_seen;
    found.push_back(std::move(opening));
  }
  if (open_m2 > kAbsentShare * std::abs(signed_area(rings[0]))) face.status = "absent";
  for (Opening& opening : found) decide(model, face, options, opening);
  return found;
}

}  // namespace

const std::vector<OptionRow<OpeningOptions>>& opening_option_table() {
  using O = OpeningOptions;
  static const std::vector<OptionRow<O>> table = {
      {"openings",
       "",
       &O::openings,
       0,
       0,
       "openings found from lines of sight: not looked for, reported, or cut into the proxy",
       {"off", "report", "cut"}},
      {"opening_depth_m", "m", &O::opening_depth_m, 0.01, 10,
       "returns at least this far behind a face passed through it"},
      {"opening_area_m2", "m2", &O::opening_area_m2, 0.001, 1000, "smaller openings are not reported"},
      {"opening_rays", "", &O::opening_rays, 10, 1e9,
       "openings that fewer lines of sight pass are not reported"},
      {"opening_confidence", "", &O::opening_confidence, 0, 1, "less confident openings are not cut"},
      {"opening_displaced_m", "m", &O::opening_displaced_m, 0.01, 0.5,
       "a face this far off its surface is reported, never cut"},
  };
  return table;
}

Openings find_openings(const PolygonModel& model, const std::vector<OpeningScan>& scans,
                       const OpeningOptions& options) {
  Openings result;
  const EvidenceCloud cloud = gather_points(model, scans);
  result.faces.resize(model.faces.size());
  std::vector<std::vector<Opening>> of_face(model.faces.size());
  parallel_for_uneven(model.faces.size(), [&](std::size_t f) {
    const FaceFrame frame = face_frame(model, model.faces[f]);
    const auto rings = flat_rings(frame, model, model.faces[f]);
    FaceEvidence& face = result.faces[f];
    face.face = f;
    const FaceSamples samples = samples_of_face(cloud, frame);
    measure_surface(samples, rings, options.opening_displaced_m, face);
    face.depth_m = std::max(options.opening_depth_m, error_m(face, frame, scans));
    if (!samples.samples.empty()) of_face[f] = openings_of(model, frame, rings, samples, options, face);
  });
  for (auto& found : of_face) std::move(found.begin(), found.end(), std::back_inserter(result.openings));
  complete_by_design(model, cloud, options, result);
  carry_openings(model, cloud, options, result);
  std::stable_sort(result.openings.begin(), result.openings.end(), [](const Opening& a, const Opening& b) {
    return a.face != b.face ? a.face < b.face : a.area_m2 > b.area_m2;
  });
  return result;
}

}  // namespace hybrid::stages
