#include "stages/editing/opening_judgement.hpp"

#include <algorithm>
#include <cmath>

#include "stages/editing/edit_model.hpp"
#include "stages/editing/panes.hpp"

namespace hybrid::stages {
namespace {

constexpr double kBorderStep = 1;       // cells between places on a border that are asked for samples
constexpr double kBorderReach = 3;      // cells in which they are looked for
constexpr double kOnOutline = 0.4;      // of a border: the face ends, or part of it lies elsewhere
constexpr double kPaneWindow_m = 0.06;  // returns from one plane behind the opening
constexpr double kPaneDepth_m = 1.0;    // deeper planes are other rooms
constexpr double kRecessShare = 0.7, kPaneShare = 0.05;

}  // namespace

double lower_bound(double good, double all) {
  if (all <= 0) return 0;
  const double z = 1.96, p = good / all, d = 1 + z * z / all;
  return std::max(0.0,
                  (p + z * z / (2 * all) - z * std::sqrt(p * (1 - p) / all + z * z / (4 * all * all))) / d);
}

void describe_depths(const std::vector<EvidenceMark>& marks, Opening& opening) {
  std::vector<double> depths;
  std::vector<PassedRay> passed;
  opening.against = 0;
  for (const EvidenceMark& mark : marks)
    if (mark.kind == CellEvidence::through && inside(opening.ring, mark.at.cast<double>())) {
      depths.push_back(mark.depth_m);
      passed.push_back({mark.at.cast<double>(), depths.back(), mark.slope.cast<double>()});
    } else if (mark.kind == CellEvidence::closed && inside(opening.ring, mark.at.cast<double>()))
      ++opening.against;
  opening.rays = static_cast<std::int64_t>(depths.size());
  if (depths.empty()) return;
  const PaneDepths panes = pane_depths(passed, opening.area_m2);
  opening.pane_m = panes.sure;
  opening.likely_pane_m = panes.likely;
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

std::string try_hole(const PolygonModel& model, std::size_t face, const Ring2& ring, double slack_m) {
  try {
    PolygonModel one{model.vertices, {model.faces[face]}};
    cut_hole(one, 0, ring, slack_m);
    return can_be_triangulated(one) ? "" : "the face cannot be triangulated with it";
  } catch (const Error& error) {
    return error.what();
  }
}

bool lies_in_one(const Ring2& area, const std::vector<Opening>& openings) {
  return std::any_of(openings.begin(), openings.end(), [&](const Opening& opening) {
    const auto within =
        std::count_if(area.begin(), area.end(), [&](const Vec2& p) { return inside(opening.ring, p); });
    return 2 * static_cast<std::size_t>(within) > area.size();
  });
}

bool overlaps_one(const Ring2& ring, const std::vector<Opening>& openings) {
  const auto middle = [](const Ring2& of) {
    const Box2 box = box_of(of);
    return Vec2(0.5 * (box.low + box.high));
  };
  return std::any_of(openings.begin(), openings.end(), [&](const Opening& opening) {
    return inside(opening.ring, middle(ring)) || inside(ring, middle(opening.ring));
  });
}

void decide(const PolygonModel& model, const FaceEvidence& face, const OpeningOptions& options,
            Opening& opening) {
  opening.why_not = objection(face, opening, options);
  if (opening.why_not.empty()) opening.why_not = try_hole(model, face.face, opening.ring, face.cell_m);
  opening.cut = opening.why_not.empty() && options.openings == "cut";
  if (opening.why_not.empty() && !opening.cut) opening.why_not = "openings = \"report\"";
}

}  // namespace hybrid::stages
