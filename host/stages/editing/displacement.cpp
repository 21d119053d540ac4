#include "stages/editing/displacement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFinestTexel_m = 0.005;
constexpr double kMostTexels = 6.4e7;

double spacing_of(const FaceSamples& samples) {
  std::vector<float> spacings;
  for (const FaceSample& s : samples.samples) spacings.push_back(s.spacing_m);
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

DisplacementMap empty_map(const FaceFrame& frame, std::size_t face, double texel_m) {
  DisplacementMap map;
  map.face = face;
  map.texel_m = texel_m;
  map.cols = std::max(1, static_cast<int>(std::ceil(frame.size.x() / texel_m)));
  map.rows = std::max(1, static_cast<int>(std::ceil(frame.size.y() / texel_m)));
  const std::size_t count = static_cast<std::size_t>(map.cols) * static_cast<std::size_t>(map.rows);
  map.height_m.assign(count, std::numeric_limits<float>::quiet_NaN());
  map.samples.assign(count, 0);
  const Vec3 first = frame.world({0.5 * texel_m, (map.rows - 0.5) * texel_m});
  const Vec3 columns[4] = {texel_m * frame.u, -texel_m * frame.v, frame.plane.normal, first};
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t r = 0; r < 3; ++r) map.world_from_texel[4 * r + c] = columns[c](static_cast<int>(r));
  map.world_from_texel[15] = 1;
  return map;
}

// (texel, height) of the samples on the face's relief, by texel and height.
std::vector<std::pair<std::uint32_t, float>> texel_heights(const FaceSamples& samples,
                                                           const std::vector<Ring2>& rings, double reach_m,
                                                           const DisplacementMap& map) {
  std::vector<std::pair<std::uint32_t, float>> found;
  for (const FaceSample& s : samples.samples) {
    if (samples.scanner_height_m[s.scan] <= 0 || std::abs(s.height_m) > reach_m) continue;
    const int col = static_cast<int>(s.u / map.texel_m);
    const int row = map.rows - 1 - static_cast<int>(s.v / map.texel_m);
    if (s.u < 0 || s.v < 0 || col >= map.cols || row < 0 || !on_face(rings, Vec2(s.u, s.v))) continue;
    found.emplace_back(static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(map.cols) +
                           static_cast<std::uint32_t>(col),
                       s.height_m);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

const std::vector<OptionRow<DisplacementOptions>>& displacement_option_table() {
  using O = DisplacementOptions;
  static const std::vector<OptionRow<O>> table = {
      {"displacement", "", &O::displacement, 0, 0, "write the scans' relief over each face as an image"},
      {"displacement_texel_m", "m", &O::displacement_texel_m, 0, 10,
       "side of a texel; 0: as the samples are spaced"},
      {"displacement_reach_m", "m", &O::displacement_reach_m, 0.001, 0.5,
       "samples farther off a face are no part of its relief"},
  };
  return table;
}

std::vector<DisplacementMap> displacement_maps(const PolygonModel& model,
                                               const std::vector<OpeningScan>& scans,
                                               const DisplacementOptions& options) {
  std::vector<DisplacementMap> maps;
  const EvidenceCloud cloud = gather_points(model, scans);
  for (std::size_t f = 0; f < model.faces.size(); ++f) {
    const FaceFrame frame = face_frame(model, model.faces[f]);
    const FaceSamples samples = samples_of_face(cloud, frame);
    if (samples.samples.empty()) continue;
    double texel_m = options.displacement_texel_m;
    if (texel_m == 0)
      texel_m = std::max({kFinestTexel_m, spacing_of(samples), std::sqrt(frame.size.prod() / kMostTexels)});
    if (frame.size.prod() / (texel_m * texel_m) > kMostTexels)
      fail_input(
          "displacement_texel_m: face {} of {:.1f} x {:.1f} m needs {:.1e} texels of {} m, expected at most "
          "{:.1e}; make them larger",
          model.faces[f].name, frame.size.x(), frame.size.y(), frame.size.prod() / (texel_m * texel_m),
          texel_m, kMostTexels);
    DisplacementMap map = empty_map(frame, f, texel_m);
    const auto heights =
        texel_heights(samples, flat_rings(frame, model, model.faces[f]), options.displacement_reach_m, map);
    for (std::size_t first = 0, end = 0; first < heights.size(); first = end) {
      while (end < heights.size() && heights[end].first == heights[first].first) ++end;
      map.height_m[heights[first].first] = heights[first + (end - first - 1) / 2].second;
      map.samples[heights[first].first] = static_cast<std::uint32_t>(end - first);
      map.measured_m2 += texel_m * texel_m;
    }
    if (!heights.empty()) maps.push_back(std::move(map));
  }
  return maps;
}

}  // namespace hybrid::stages
