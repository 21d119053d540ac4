#include "stages/rendering/bake_atlas.hpp"

#include <algorithm>

#include "core/parallel.hpp"
#include "geometry/colour.hpp"

namespace hybrid::stages {
namespace {

// A chart with its padding, while its colours run on.
struct Patch {
  int cols = 0, rows = 0;
  std::vector<float> colour;        // RGB
  std::vector<std::uint8_t> known;  // 1: has a colour
  std::vector<std::uint8_t> seen;   // 1: of a photograph
  std::size_t index(int col, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};

Patch padded(const AtlasChart& chart, const Renderer::BakedChart& baked,
             const std::vector<std::uint8_t>& mask, int padding, const Shoulder& shoulder) {
  Patch patch{chart.cols + 2 * padding, chart.rows + 2 * padding, {}, {}, {}};
  const std::size_t count = static_cast<std::size_t>(patch.cols) * static_cast<std::size_t>(patch.rows);
  patch.colour.assign(3 * count, 0.0f);
  patch.known.assign(count, 0);
  patch.seen.assign(count, 0);
  parallel_for(static_cast<std::size_t>(chart.rows), [&](std::size_t row) {
    const std::size_t from = row * static_cast<std::size_t>(chart.cols);
    const std::size_t to = patch.index(padding, static_cast<int>(row) + padding);
    std::copy_n(baked.colour.begin() + static_cast<std::ptrdiff_t>(3 * from), 3 * chart.cols,
                patch.colour.begin() + static_cast<std::ptrdiff_t>(3 * to));
    std::copy_n(mask.begin() + static_cast<std::ptrdiff_t>(from), chart.cols,
                patch.known.begin() + static_cast<std::ptrdiff_t>(to));
    std::transform(baked.coverage.begin() + static_cast<std::ptrdiff_t>(from),
                   baked.coverage.begin() + static_cast<std::ptrdiff_t>(from) + chart.cols,
                   patch.seen.begin() + static_cast<std::ptrdiff_t>(to),
                   [](std::uint32_t photographs) { return static_cast<std::uint8_t>(photographs > 0); });
    for (std::size_t i = to; i < to + static_cast<std::size_t>(chart.cols); ++i)
      if (patch.seen[i]) shoulder.apply(patch.colour.data() + 3 * i);
  });
  return patch;
}

// Every texel beside known ones takes their mean, ring by ring, so that lookups and mip levels at the face's
// border find the face's colours; what is farther away takes the mean of all that is seen.
void run_on(Patch& patch, int rings) {
  std::array<double, 3> sum{};
  double weight = 0;
  for (std::size_t i = 0; i < patch.known.size(); ++i) {
    if (!patch.seen[i]) continue;
    for (std::size_t k = 0; k < 3; ++k) sum[k] += static_cast<double>(patch.colour[3 * i + k]);
    weight += 1;
  }
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<std::uint8_t> known =
        patch.known;  // texels that become known now wait for the next ring
    parallel_for(static_cast<std::size_t>(patch.rows), [&](std::size_t at) {
      const int row = static_cast<int>(at);
      for (int col = 0; col < patch.cols; ++col) {
        const std::size_t i = patch.index(col, row);
        if (known[i]) continue;
        std::array<float, 3> mean{};
        float neighbours = 0;
        for (int y = std::max(0, row - 1); y <= std::min(patch.rows - 1, row + 1); ++y)
          for (int x = std::max(0, col - 1); x <= std::min(patch.cols - 1, col + 1); ++x) {
            const std::size_t j = patch.index(x, y);
            if (!known[j]) continue;
            for (std::size_t k = 0; k < 3; ++k) mean[k] += patch.colour[3 * j + k];
            neighbours += 1;
          }
        if (neighbours == 0) continue;
        for (std::size_t k = 0; k < 3; ++k) patch.colour[3 * i + k] = mean[k] / neighbours;
        patch.known[i] = 1;
      }
    });
  }
  if (weight == 0) {  // all is red
    sum = {1, 0, 0};
    weight = 1;
  }
  for (std::size_t i = 0; i < patch.known.size(); ++i)
    for (std::size_t k = 0; k < 3 && !patch.known[i]; ++k)
      patch.colour[3 * i + k] = static_cast<float>(sum[k] / weight);
}

void draw_colours(const AtlasChart& chart, const Patch& patch, int padding, Image8& page) {
  parallel_for(static_cast<std::size_t>(patch.rows), [&](std::size_t row) {
    std::uint8_t* to = page.at(chart.x - padding, chart.y - padding + static_cast<int>(row));
    const float* from = patch.colour.data() + 3 * patch.index(0, static_cast<int>(row));
    for (int i = 0; i < 3 * patch.cols; ++i) to[i] = srgb_byte_from_linear(static_cast<double>(from[i]));
  });
}

void draw_coverage(const AtlasChart& chart, const Renderer::BakedChart& baked,
                   const std::vector<std::uint8_t>& mask, AtlasPage& page) {
  for (int row = 0; row < chart.rows; ++row)
    for (int col = 0; col < chart.cols; ++col) {
      const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(chart.cols) +
                            static_cast<std::size_t>(col);
      if (!mask[i]) continue;
      ++page.texels;
      page.seen += baked.coverage[i] > 0;
      const auto grey = static_cast<std::uint8_t>(60 + 15 * std::min(baked.coverage[i], 12u));
      const std::array<std::uint8_t, 3> rgb =
          baked.coverage[i] > 0 ? std::array{grey, grey, grey} : std::array<std::uint8_t, 3>{255, 0, 0};
      std::copy(rgb.begin(), rgb.end(), page.coverage.at(chart.x + col, chart.y + row));
    }
}

}  // namespace

AtlasPage bake_page(Renderer& renderer, const RenderScene& scene, const Atlas& atlas, int page) {
  const auto [width, height] = atlas.layout.pages[static_cast<std::size_t>(page)];
  AtlasPage out;
  out.colour = Image8(width, height, 3);
  out.coverage = Image8(width, height, 3);
  for (const AtlasChart& chart : atlas.charts) {
    if (chart.page != page) continue;
    const auto mask = chart_mask(chart, chart.contour ? scene.contours : scene.proxy);
    const auto baked = renderer.bake(chart, mask);
    Patch patch = padded(chart, baked, mask, atlas.padding, renderer.common_shoulder());
    run_on(patch, std::max(1, atlas.padding));
    draw_colours(chart, patch, atlas.padding, out.colour);
    draw_coverage(chart, baked, mask, out);
  }
  return out;
}

}  // namespace hybrid::stages
