#include <algorithm>
#include <cmath>
#include <optional>

#include "stages/rendering/bake_atlas.hpp"
#include "stages/rendering/render_geometry.hpp"

namespace hybrid::stages {
namespace {

// The first look: about this many texels over both sides of all faces, as large on one face as on another,
// but none with fewer or more on its longer side than these; narrow faces have some across, too.
constexpr double kLook_texels = 4e6;
constexpr int kLeastLook = 16, kMostLook = 192, kAcross = 6;

double look_texel_m(const AtlasChart& chart, double common_m) {
  const double longer = std::max(chart.width_m, chart.height_m);
  return std::min(std::clamp(common_m, longer / (kMostLook - 2), longer / (kLeastLook - 2)),
                  std::min(chart.width_m, chart.height_m) / kAcross);
}

// The side of the first look's texels, by bisection.
double common_look_m(const std::vector<AtlasChart>& sides) {
  double low = 1e-6, high = 1e3;
  for (int round = 0; round < 50; ++round) {
    const double middle = std::sqrt(low * high);
    double texels = 0;
    for (const AtlasChart& side : sides) {
      const double texel = look_texel_m(side, middle);
      if (texel > 0) texels += side.width_m * side.height_m / (texel * texel);
    }
    (texels > kLook_texels ? low : high) = middle;
  }
  return high;
}

// Shadow rays ignore what they meet this near to a face at grazing angles (lib/photo_packet.h), so that
// within it of a face's outline a side may seem to be seen past the edge.
double seen_past_edges_m(const AtlasChart& chart, const RenderOptions& options) {
  constexpr double kGrazing = 5, kFaceTolerance_m = 1e-3;
  return kGrazing * (chart.contour ? options.surface_tolerance_m : kFaceTolerance_m);
}

// The mask without what lies within `rings` texels of its border, corners counted as neighbours.
std::vector<std::uint8_t> inner_mask(const AtlasChart& chart, const std::vector<std::uint8_t>& mask,
                                     int rings) {
  const auto cols = static_cast<std::size_t>(chart.cols), rows = static_cast<std::size_t>(chart.rows);
  const auto reach = static_cast<std::size_t>(rings), side = 2 * reach + 1;
  std::vector<std::uint32_t> sum((cols + 1) * (rows + 1), 0);  // of all texels above and to the left
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t col = 0; col < cols; ++col)
      sum[(row + 1) * (cols + 1) + col + 1] = mask[row * cols + col] + sum[row * (cols + 1) + col + 1] +
                                              sum[(row + 1) * (cols + 1) + col] - sum[row * (cols + 1) + col];
  std::vector<std::uint8_t> inner(mask.size(), 0);
  for (std::size_t row = reach; row + reach < rows; ++row)
    for (std::size_t col = reach; col + reach < cols; ++col) {
      const auto at = [&](std::size_t y, std::size_t x) { return sum[y * (cols + 1) + x]; };
      const std::size_t top = row - reach, left = col - reach;
      inner[row * cols + col] =
          at(top + side, left + side) - at(top, left + side) - at(top + side, left) + at(top, left) ==
          side * side;
    }
  return inner;
}

// Whether a back is seen, past its edges not counted: by more than a hundredth of what is left of it.
bool back_is_seen(const AtlasChart& chart, const std::vector<std::uint8_t>& mask,
                  const Renderer::BakedChart& look, const RenderOptions& options) {
  const int rings = static_cast<int>(std::ceil(seen_past_edges_m(chart, options) / chart.texel_m));
  if (2 * rings >= std::min(chart.cols, chart.rows)) return false;
  const auto inner = inner_mask(chart, mask, rings);
  std::size_t texels = 0, seen = 0;
  for (std::size_t i = 0; i < inner.size(); ++i)
    if (inner[i]) {
      ++texels;
      seen += look.coverage[i] > 0;
    }
  return 100 * seen > texels;
}

// What a pixel of the heaviest photograph covers at the texels that one sees, its finest quarter; nothing
// when none is seen.
std::optional<double> footprint_m(const AtlasChart& chart, const Renderer::BakedChart& look,
                                  const std::vector<Photograph>& photographs) {
  std::vector<double> footprints;
  for (std::size_t i = 0; i < look.best.size(); ++i) {
    if (look.best[i] < 0) continue;
    const Photograph& photograph = photographs[static_cast<std::size_t>(look.best[i])];
    const auto cols = static_cast<std::size_t>(chart.cols);
    const Vec3 point = chart.point(static_cast<double>(i % cols) + 0.5, static_cast<double>(i / cols) + 0.5);
    footprints.push_back((point - photograph.centre()).norm() *
                         static_cast<double>(pixel_angle_rad(photograph.camera)));
  }
  if (footprints.empty()) return std::nullopt;
  const auto quarter = footprints.begin() + static_cast<std::ptrdiff_t>(footprints.size() / 4);
  std::nth_element(footprints.begin(), quarter, footprints.end());
  return *quarter;
}

}  // namespace

const std::vector<OptionRow<AtlasOptions>>& atlas_option_table() {
  using O = AtlasOptions;
  static const std::vector<OptionRow<O>> table = {
      {"texel_m", "m", &O::texel_m, 0, 100,
       "side of a texel of the atlas; 0: as fine as the photographs show each face"},
      {"texels_per_pixel", "", &O::texels_per_pixel, 0.01, 16,
       "texel_m = 0: texels per pixel of the photographs, along a line"},
      {"atlas_page", "px", &O::page, 64, 16384, "largest side of an atlas page"},
      {"atlas_pages", "", &O::pages, 1, 1000, "most atlas pages; beyond them texels grow"},
      {"atlas_padding", "px", &O::padding, 0, 31, "texels around each chart that continue its border"},
  };
  return table;
}

Atlas plan_atlas(Renderer& renderer, const RenderScene& scene, const AtlasOptions& options) {
  Atlas atlas;
  atlas.padding = options.padding;
  std::vector<AtlasChart> sides;
  for (const bool contour : {false, true}) {
    const PolygonModel& model = contour ? scene.contours : scene.proxy;
    for (std::uint32_t face = 0; face < model.faces.size(); ++face)
      for (const bool back : {false, true}) sides.push_back(make_chart(model, face, contour, back));
  }
  const double look_m = common_look_m(sides);
  auto side = sides.begin();
  const int most = options.page - 2 * options.padding;
  for (const bool contour : {false, true}) {
    const PolygonModel& model = contour ? scene.contours : scene.proxy;
    for (std::uint32_t face = 0; face < model.faces.size(); ++face) {
      std::optional<AtlasChart> unseen;
      bool seen = false;
      for (const bool back : {false, true}) {
        AtlasChart chart = *side++;
        size_chart(chart, look_texel_m(chart, look_m), most);
        const auto mask = chart_mask(chart, model);
        const auto look = renderer.bake(chart, mask);
        const auto footprint = footprint_m(chart, look, scene.photographs);
        if (!footprint || (back && !back_is_seen(chart, mask, look, renderer.options()))) {
          if (!unseen) unseen = chart;
          continue;
        }
        seen = true;
        size_chart(chart, options.texel_m > 0 ? options.texel_m : *footprint / options.texels_per_pixel,
                   most);
        atlas.charts.push_back(chart);
      }
      if (seen) continue;
      atlas.charts.push_back(*unseen);
      ++atlas.unseen_faces;
    }
  }
  atlas.layout = place_charts(atlas.charts, options.page, options.pages, options.padding);
  return atlas;
}

}  // namespace hybrid::stages
