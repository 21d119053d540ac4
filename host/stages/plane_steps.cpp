#include "stages/plane_steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "stages/step_sharing.hpp"

namespace hybrid::stages {
namespace {

// Windows whose means are looked at, in cells.
struct Window {
  int rows, cols;
};
constexpr Window kWindows[] = {{2, 2}, {1, 6}, {6, 1}};
constexpr int kCellsPerSquare = 4;    // side by side; a cell has at least 2 x 2 samples
constexpr int kFewestInWindow = 8;    // samples of one plane
constexpr double kProposal = 3;       // standard deviations of a window's mean
constexpr double kSameHeight = 0.35;  // of a step: parts of one plane no farther apart are one

// The plane that has most of a cell's samples, and their mean height.
struct Cell {
  std::uint32_t label = 0;
  float sum = 0, weight = 0;  // of MeanHeight
  std::uint16_t count = 0;
  std::int8_t sign = 0;  // of the windows around it that leave the plane
};

struct CellGrid {
  int side, rows, cols;  // side in samples
  std::vector<Cell> cells;
  std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
};

CellGrid mean_heights(const RangeImage& image, const RangeNoise& noise, int side,
                      const std::vector<std::uint32_t>& labels, const std::vector<Plane>& planes,
                      const PlaneRegions& regions) {
  CellGrid grid{side, (image.rows + side - 1) / side, (image.cols + side - 1) / side, {}};
  grid.cells.resize(static_cast<std::size_t>(grid.rows) * static_cast<std::size_t>(grid.cols));
  parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t cell_row) {
    const int top = static_cast<int>(cell_row) * side, bottom = std::min(top + side, image.rows);
    for (int cell_col = 0; cell_col < grid.cols; ++cell_col) {
      const int left = cell_col * side, right = std::min(left + side, image.cols);
      std::array<std::pair<std::uint32_t, int>, 3> votes{};
      for (int row = top; row < bottom; ++row)
        for (int col = left; col < right; ++col) {
          const std::uint32_t label = labels[image.index(row, col)];
          if (label == 0 || regions.regions[label - 1].curved) continue;
          for (auto& vote : votes)
            if (vote.first == label || vote.first == 0) {
              vote = {label, vote.second + 1};
              break;
            }
        }
      const auto most = std::max_element(votes.begin(), votes.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      if (most->first == 0) continue;
      MeanHeight mean;
      for (int row = top; row < bottom; ++row)
        for (int col = left; col < right; ++col)
          if (const std::size_t i = image.index(row, col); labels[i] == most->first)
            mean.add(height_over(image, noise, planes[most->first - 1], i));
      if (mean.count == 0) continue;
      grid.cells[grid.index(static_cast<int>(cell_row), cell_col)] = {
          most->first, static_cast<float>(mean.sum), static_cast<float>(mean.weight),
          static_cast<std::uint16_t>(mean.count)};
    }
  });
  return grid;
}

// Standard deviations by which a window's samples of one plane leave it.
double window_sigmas(const CellGrid& grid, std::uint32_t label, int row, int col, const Window& window) {
  if (row < 0 || col < 0 || row + window.rows > grid.rows || col + window.cols > grid.cols) return 0;
  double sum = 0, weight = 0;
  int count = 0;
  for (int r = row; r < row + window.rows; ++r)
    for (int c = col; c < col + window.cols; ++c)
      if (const Cell& cell = grid.cells[grid.index(r, c)]; cell.label == label) {
        sum += cell.sum;
        weight += cell.weight;
        count += cell.count;
      }
  return count < kFewestInWindow ? 0 : sum / std::sqrt(weight);
}

// How much more the means of windows scatter than the noise of their samples explains, at least 1: real noise
// is correlated (quantised ranges, stripes), and real walls are wavy. The median over all windows, which
// steps on a part of the planes do not move.
double excess_scatter(const CellGrid& grid) {
  std::vector<double> sigmas;
  for (int row = 0; row + kWindows[0].rows <= grid.rows; row += kWindows[0].rows)
    for (int col = 0; col + kWindows[0].cols <= grid.cols; col += kWindows[0].cols) {
      const std::uint32_t label = grid.cells[grid.index(row, col)].label;
      if (label == 0) continue;
      if (const double value = std::abs(window_sigmas(grid, label, row, col, kWindows[0])); value > 0)
        sigmas.push_back(value);
    }
  if (sigmas.empty()) return 1;
  const auto middle = sigmas.begin() + std::ssize(sigmas) / 2;
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  constexpr double kMedianOfNormal = 0.6745;
  return std::max(1.0, *middle / kMedianOfNormal);
}

// Marks the cells that some window around them finds off their plane.
void mark_cells(CellGrid& grid, double excess) {
  parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t cell_row) {
    const int row = static_cast<int>(cell_row);
    for (int col = 0; col < grid.cols; ++col) {
      Cell& cell = grid.cells[grid.index(row, col)];
      if (cell.label == 0) continue;
      double most = 0;
      for (const Window& window : kWindows)
        for (int r = row - window.rows + 1; r <= row; ++r)
          for (int c = col - window.cols + 1; c <= col; ++c)
            if (const double sigmas = window_sigmas(grid, cell.label, r, c, window);
                std::abs(sigmas) > std::abs(most) && sigmas * double{cell.sum} > 0)
              most = sigmas;
      if (std::abs(most) >= kProposal * excess) cell.sign = most > 0 ? 1 : -1;
    }
  });
}

// Touching marked cells of one plane.
std::vector<StepProposal> find_proposals(const CellGrid& grid, std::int64_t least) {
  std::vector<StepProposal> proposals;
  std::vector<bool> seen(grid.cells.size());
  std::vector<std::size_t> group;
  for (std::size_t start = 0; start < grid.cells.size(); ++start) {
    const int sign = grid.cells[start].sign;
    if (sign == 0 || seen[start]) continue;
    StepProposal proposal{grid.cells[start].label, {}, grid.rows, grid.cols, 0, 0};
    group.assign(1, start);
    seen[start] = true;
    for (std::size_t next = 0; next < group.size(); ++next) {
      const int row = static_cast<int>(group[next]) / grid.cols,
                col = static_cast<int>(group[next]) % grid.cols;
      const Cell& cell = grid.cells[group[next]];
      proposal.mean.add(MeanHeight{cell.sum, cell.weight, cell.count});
      proposal.top = std::min(proposal.top, row);
      proposal.left = std::min(proposal.left, col);
      proposal.bottom = std::max(proposal.bottom, row + 1);
      proposal.right = std::max(proposal.right, col + 1);
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid.rows - 1); ++r)
        for (int c = std::max(col - 1, 0); c <= std::min(col + 1, grid.cols - 1); ++c) {
          const std::size_t other = grid.index(r, c);
          if (seen[other] || grid.cells[other].label != proposal.label || grid.cells[other].sign != sign)
            continue;
          seen[other] = true;
          group.push_back(other);
        }
    }
    if (2 * proposal.mean.count < least) continue;
    for (int* edge : {&proposal.top, &proposal.left, &proposal.bottom, &proposal.right}) *edge *= grid.side;
    proposals.push_back(proposal);
  }
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const StepProposal& a, const StepProposal& b) { return a.label < b.label; });
  return proposals;
}

}  // namespace

bool split_steps(const RangeImage& image, const SquareGrid& grid, int square, const RangeNoise& noise,
                 std::int64_t least, std::vector<std::uint32_t>& labels, std::vector<Plane>& planes,
                 PlaneRegions& regions) {
  CellGrid cells = mean_heights(image, noise, std::max(square / kCellsPerSquare, 2), labels, planes, regions);
  const double excess = excess_scatter(cells);
  mark_cells(cells, excess);
  const auto is_free = [&](std::size_t i) {
    return image.mask[i] == kMeasured && (labels[i] == 0 || regions.regions[labels[i] - 1].curved);
  };
  struct Part {
    std::uint32_t of, id;
    MeanHeight height;
  };
  std::vector<Part> parts;
  bool changed = false;
  for (const StepProposal& proposal : find_proposals(cells, least)) {
    const Plane plane = planes[proposal.label - 1];
    StepSharing sharing(image, noise, labels, plane, proposal, excess);
    const StepVerdict verdict = sharing.share(is_free, least);
    if (verdict == StepVerdict::none) continue;
    changed = true;
    if (verdict == StepVerdict::curved) {
      sharing.for_each_of_part([&](std::size_t i) { labels[i] = 0; });
      continue;
    }
    // One part may be broken by an occluder, or by windows between which nothing stood out.
    const MeanHeight height = sharing.height();
    auto part = std::find_if(parts.begin(), parts.end(), [&](const Part& other) {
      return other.of == proposal.label &&
             std::abs(height.value_m() - other.height.value_m()) < kSameHeight * std::abs(sharing.step_m());
    });
    if (part == parts.end()) {
      regions.regions.emplace_back().small = true;
      planes.push_back({plane.normal, plane.offset_m + height.value_m()});
      part = parts.insert(part, {proposal.label, static_cast<std::uint32_t>(planes.size()), {}});
    }
    part->height.add(height);
    auto& of_part = regions.regions[part->id - 1].squares;
    sharing.for_each_of_part([&](std::size_t i) {
      labels[i] = part->id;
      const int row = static_cast<int>(i) / image.cols, col = static_cast<int>(i) % image.cols;
      of_part.push_back(static_cast<std::uint32_t>(grid.at(row / square, col / square)));
    });
    std::sort(of_part.begin(), of_part.end());
    of_part.erase(std::unique(of_part.begin(), of_part.end()), of_part.end());
  }
  return changed;
}

}  // namespace hybrid::stages
