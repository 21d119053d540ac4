#include "stages/openings.hpp"

#include <algorithm>
#include <cmath>

#include "stages/edit_model.hpp"
#include "stages/opening_border.hpp"
#include "stages/opening_grid.hpp"

namespace hybrid::stages {
namespace {

constexpr double kBorderStep = 1;       // cells between places on a border that are asked for samples
constexpr double kBorderReach = 3;      // cells in which they are looked for
constexpr double kLeastBorder = 0.25;   // of a border seen: else where it opens is anybody's guess
constexpr double kAbsentShare = 0.5;    // of a face's area open: the face stands for nothing
constexpr double kOnOutline = 0.4;      // of a border: the face ends, or part of it lies elsewhere
constexpr double kPaneWindow_m = 0.06;  // returns from one plane behind the opening
constexpr double kPaneDepth_m = 1.0;    // deeper planes are other rooms
constexpr double kRecessShare = 0.7, kPaneShare = 0.05;

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

// Lower bound of a share at 95 % (Wilson 1927).
double lower_bound(double good, double all) {
  if (all <= 0) return 0;
  const double z = 1.96, p = good / all, d = 1 + z * z / all;
  return std::max(0.0,
                  (p + z * z / (2 * all) - z * std::sqrt(p * (1 - p) / all + z * z / (4 * all * all))) / d);
}

std::vector<EvidenceMark> marks_near(const std::vector<EvidenceMark>& marks, const Ring2& ring,
                                     double margin_m) {
  Vec2 low = ring[0], high = ring[0];
  for (const Vec2& p : ring) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  std::vector<EvidenceMark> near;
  for (const EvidenceMark& mark : marks) {
    const Vec2 at = mark.at.cast<double>();
    if ((at.array() >= low.array() - margin_m).all() && (at.array() <= high.array() + margin_m).all())
      near.push_back(mark);
  }
  return near;
}

void describe_depths(const std::vector<EvidenceMark>& marks, Opening& opening) {
  std::vector<double> depths;
  for (const EvidenceMark& mark : marks)
    if (mark.kind == CellEvidence::through && inside(opening.ring, mark.at.cast<double>()))
      depths.push_back(mark.depth_m);
    else if (mark.kind == CellEvidence::closed && inside(opening.ring, mark.at.cast<double>()))
      ++opening.against;
  opening.rays = static_cast<std::int64_t>(depths.size());
  if (depths.empty()) return;
  std::sort(depths.begin(), depths.end());
  opening.depth_m = depths[depths.size() / 2];
  std::size_t first = 0, most = 0;
  for (std::size_t i = 0; i < depths.size() && depths[i] <= kPaneDepth_m; ++i) {
    while (depths[i] - depths[first] > kPaneWindow_m) ++first;
    most = std::max(most, i + 1 - first);
  }
  const double pane = static_cast<double>(most) / static_cast<double>(depths.size());
  const auto far =
      static_cast<double>(depths.end() - std::upper_bound(depths.begin(), depths.end(), kPaneDepth_m)) /
      static_cast<double>(depths.size());
  opening.kind = pane >= kRecessShare ? "recess" : pane >= kPaneShare && far >= kPaneShare ? "glass" : "open";
}

// How much of the border has closed cells beside it, and how much is the face's outline.
void measure_border(const FaceEvidence& face, const std::vector<float>& to_closed, const Ring2& outline,
                    Opening& opening) {
  double length = 0, seen = 0, on_outline = 0;
  const double step = kBorderStep * face.cell_m;
  for (std::size_t i = 0; i < opening.ring.size(); ++i) {
    const Vec2 &a = opening.ring[i], &b = opening.ring[(i + 1) % opening.ring.size()];
    const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / step)));
    for (int k = 0; k < parts; ++k) {
      const Vec2 p = a + (k + 0.5) / parts * (b - a);
      const double share = (b - a).norm() / parts;
      length += share;
      if (distance_to_border(outline, p) < 2 * face.cell_m) {
        on_outline += share;
        continue;
      }
      const int col = std::clamp(static_cast<int>(p.x() / face.cell_m), 0, face.cols - 1);
      const int row = std::clamp(static_cast<int>(p.y() / face.cell_m), 0, face.rows - 1);
      if (to_closed[static_cast<std::size_t>(row) * static_cast<std::size_t>(face.cols) +
                    static_cast<std::size_t>(col)] <= kBorderReach)
        seen += share;
    }
  }
  opening.on_outline = on_outline / length;
  opening.border_seen = length > on_outline ? seen / (length - on_outline) : 0;
}

// Why an opening is not to be cut; "" when it is.
std::string objection(const FaceEvidence& face, const Opening& opening, const OpeningOptions& options) {
  if (face.status == "displaced")
    return fmt::format("the face lies {:.3f} m off its surface; move it there", std::abs(face.offset_m));
  if (face.status == "absent") return "most of the face is open: it stands for no surface";
  if (opening.on_outline > kOnOutline)
    return "much of its border is the face's outline: the face is too large, or part of it lies elsewhere";
  if (opening.confidence < options.opening_confidence)
    return fmt::format("confidence {:.2f} is below {}", opening.confidence, options.opening_confidence);
  return "";
}

// The ring as a hole that the model takes, or why not.
std::string try_hole(const PolygonModel& model, std::size_t face, const Ring2& ring, double slack_m) {
  try {
    PolygonModel one{model.vertices, {model.faces[face]}};
    cut_hole(one, 0, ring, slack_m);
    return can_be_triangulated(one) ? "" : "the face cannot be triangulated with it";
  } catch (const Error& error) {
    return error.what();
  }
}

std::vector<Opening> openings_of(const PolygonModel& model, const FaceFrame& frame,
                                 const std::vector<Ring2>& rings, const FaceSamples& samples,
                                 const OpeningOptions& options, FaceEvidence& face) {
  const auto marks = classify(samples, face);
  fill_grid(marks, rings, frame, median_spacing(samples), face);
  std::vector<std::uint8_t> closed(face.cells.size());
  std::transform(face.cells.begin(), face.cells.end(), closed.begin(), [](CellEvidence e) {
    return static_cast<std::uint8_t>(e == CellEvidence::closed || e == CellEvidence::attached);
  });
  const auto to_closed = distance_to_set(closed, face.cols, face.rows);
  std::vector<Opening> found;
  double open_m2 = 0;
  for (const Ring2& area : open_areas(face, rings)) {
    const auto near = marks_near(marks, area, 4 * face.cell_m);
    Opening opening;
    opening.face = face.face;
    opening.cell_m = face.cell_m;
    opening.ring = straightened_border(area, near, face.cell_m);
    if (!try_hole(model, face.face, opening.ring, face.cell_m).empty())
      opening.ring = simplified(area, 0.5 * face.cell_m);
    opening.area_m2 = signed_area(opening.ring);
    open_m2 += opening.area_m2;
    describe_depths(near, opening);
    if (opening.area_m2 < options.opening_area_m2 || opening.rays < options.opening_rays) continue;
    measure_border(face, to_closed, rings[0], opening);
    if (opening.border_seen < kLeastBorder) continue;
    opening.confidence =
        lower_bound(static_cast<double>(opening.rays), static_cast<double>(opening.rays + opening.against)) *
        opening.border_seen;
    found.push_back(std::move(opening));
  }
  if (open_m2 > kAbsentShare * std::abs(signed_area(rings[0]))) face.status = "absent";
  for (Opening& opening : found) {
    opening.why_not = objection(face, opening, options);
    if (opening.why_not.empty()) opening.why_not = try_hole(model, face.face, opening.ring, face.cell_m);
    opening.cut = opening.why_not.empty() && options.openings == "cut";
    if (opening.why_not.empty() && !opening.cut) opening.why_not = "openings = \"report\"";
  }
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
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const FaceFrame frame = face_frame(model, model.faces[f]);
    const auto rings = flat_rings(frame, model, model.faces[f]);
    FaceEvidence face;
    face.face = f;
    const FaceSamples samples = samples_of_face(cloud, frame);
    measure_surface(samples, rings, options.opening_displaced_m, face);
    face.depth_m = std::max(options.opening_depth_m, error_m(face, frame, scans));
    if (!samples.samples.empty()) {
      auto found = openings_of(model, frame, rings, samples, options, face);
      std::stable_sort(found.begin(), found.end(),
                       [](const Opening& a, const Opening& b) { return a.area_m2 > b.area_m2; });
      result.openings.insert(result.openings.end(), found.begin(), found.end());
    }
    result.faces.push_back(std::move(face));
  }
  return result;
}

}  // namespace hybrid::stages
