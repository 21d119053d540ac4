// Skyline bottom-left packing (Jylanki, "A Thousand Ways to Pack the Bin", 2010).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "stages/rendering/atlas.hpp"

namespace hybrid::stages {
namespace {

// What is taken of a page: steps from left to right, each from `x` to the next one's, filled down to `y`.
class Skyline {
 public:
  explicit Skyline(int side) : side_(side), steps_{{0, 0}} {}

  // Puts a rectangle where its lower border ends highest, leftmost among equals; false when it fits nowhere.
  bool place(int width, int height, int& x, int& y) {
    if (width > side_ || height > side_) return false;
    std::size_t best = steps_.size();
    int best_y = side_;
    for (std::size_t i = 0; i < steps_.size() && steps_[i].x + width <= side_; ++i) {
      int top = 0;
      for (std::size_t k = i; k < steps_.size() && steps_[k].x < steps_[i].x + width; ++k)
        top = std::max(top, steps_[k].y);
      if (top + height <= side_ && top < best_y) {
        best_y = top;
        best = i;
      }
    }
    if (best == steps_.size()) return false;
    x = steps_[best].x;
    y = best_y;
    cover(best, x + width, best_y + height);
    return true;
  }

 private:
  struct Step {
    int x, y;
  };

  // The rectangle's lower border becomes a step; those under it go, the last one keeps what sticks out.
  void cover(std::size_t first, int right, int bottom) {
    std::size_t last = first;
    int under = 0;
    while (last < steps_.size() && steps_[last].x < right) under = steps_[last++].y;
    const bool flush = last < steps_.size() ? steps_[last].x == right : right == side_;
    const auto at = [&](std::size_t i) { return steps_.begin() + static_cast<std::ptrdiff_t>(i); };
    steps_[first].y = bottom;
    steps_.erase(at(first) + 1, at(last));
    if (!flush) steps_.insert(at(first) + 1, {right, under});
    if (first > 0 && steps_[first - 1].y == bottom) steps_.erase(at(first));
  }

  int side_;
  std::vector<Step> steps_;
};

// Pages that the charts take; 0 when one of them exceeds a page or more than `pages` would be needed.
int pack(std::vector<AtlasChart>& charts, int side, int pages, int padding) {
  std::vector<std::size_t> order(charts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return charts[a].rows != charts[b].rows ? charts[a].rows > charts[b].rows
                                            : charts[a].cols > charts[b].cols;
  });
  std::vector<Skyline> open;
  for (const std::size_t i : order) {
    AtlasChart& chart = charts[i];
    const int width = chart.cols + 2 * padding, height = chart.rows + 2 * padding;
    std::size_t page = 0;
    while (page < open.size() && !open[page].place(width, height, chart.x, chart.y)) ++page;
    if (page == open.size()) {
      if (static_cast<int>(page) == pages) return 0;
      open.emplace_back(side);
      if (!open.back().place(width, height, chart.x, chart.y)) return 0;
    }
    chart.page = static_cast<int>(page);
    chart.x += padding;
    chart.y += padding;
  }
  return static_cast<int>(open.size());
}

// Pages end where their last chart does, at a multiple of four (block-compressed textures want that).
void trim(const std::vector<AtlasChart>& charts, int padding, AtlasLayout& layout) {
  for (auto& size : layout.pages) size = {4, 4};
  for (const AtlasChart& chart : charts) {
    auto& size = layout.pages[static_cast<std::size_t>(chart.page)];
    size[0] = std::max(size[0], (chart.x + chart.cols + padding + 3) / 4 * 4);
    size[1] = std::max(size[1], (chart.y + chart.rows + padding + 3) / 4 * 4);
  }
}

}  // namespace

AtlasLayout place_charts(std::vector<AtlasChart>& charts, int page, int pages, int padding) {
  AtlasLayout layout;
  if (charts.empty()) return layout;
  constexpr double kStep = 1.05;
  for (;;) {
    int used = 0;
    for (int side = 64; used == 0 && side < page; side *= 2) used = pack(charts, side, 1, padding);
    if (used == 0) used = pack(charts, page, pages, padding);
    if (used > 0) {
      layout.pages.resize(static_cast<std::size_t>(used));
      trim(charts, padding, layout);
      return layout;
    }
    const bool smallest = std::all_of(charts.begin(), charts.end(),
                                      [](const AtlasChart& c) { return c.cols <= 3 && c.rows <= 3; });
    if (smallest)
      fail_input(
          "[export] atlas: expected the charts of {} faces to fit {} pages of {} x {} texels, but they do "
          "not "
          "even with a texel each; raise atlas_pages or atlas_page, or lower atlas_padding",
          charts.size(), pages, page, page);
    layout.enlarged *= kStep;
    for (AtlasChart& chart : charts) size_chart(chart, kStep * chart.texel_m, page - 2 * padding);
  }
}

}  // namespace hybrid::stages
