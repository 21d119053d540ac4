#include "stages/planes/plane_steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/parallel.hpp"
#include "geometry/tiles.hpp"
#include "stages/planes/step_lines.hpp"
#include "stages/planes/step_sharing.hpp"

namespace hybrid::stages {
namespace {

// Windows whose means are looked at, in cells.
struct Window {
  int rows, cols;
};
constexpr Window kWindows[] = {{2, 2}, {1, 6}, {6, 1}};
constexpr int kCellsPerSquare = 4;          // side by side; a cell has at least 2 x 2 samples
constexpr int kFewestInWindow = 8;          // samples of one plane
constexpr std::int64_t kFewestByLine = 48;  // samples of a part
constexpr double kProposal = 3;             // standard deviations of a window's mean
constexpr double kMostOfPlane = 0.6;  // of its samples are parts: more are bands, of quantised ranges say
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

// The label that most samples of a cell have, of planes alone; 0 = none.
std::uint32_t label_of_cell(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                            const PlaneRegions& regions, const Tile& cell) {
  std::array<std::pair<std::uint32_t, int>, 3> votes{};
  for (int row = cell.row; row < cell.row + cell.rows; ++row)
    for (int col = cell.col; col < cell.col + cell.cols; ++col) {
      const std::uint32_t label = labels[image.index(row, col)];
      if (label == 0) continue;
      for (auto& vote : votes)
        if (vote.first == label || vote.first == 0) {
          vote = {label, vote.second + 1};
          break;
        }
    }
  const auto most = std::max_element(votes.begin(), votes.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most->first == 0 || regions.regions[most->first - 1].curved ? 0 : most->first;
}

CellGrid mean_heights(const RangeImage& image, const RangeNoise& noise, int side,
                      const std::vector<std::uint32_t>& labels, const std::vector<Plane>& planes,
                      const PlaneRegions& regions) {
  CellGrid grid{side, (image.rows + side - 1) / side, (image.cols + side - 1) / side, {}};
  grid.cells.resize(static_cast<std::size_t>(grid.rows) * static_cast<std::size_t>(grid.cols));
  parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t cell_row) {
    const int top = static_cast<int>(cell_row) * side;
    for (int cell_col = 0; cell_col < grid.cols; ++cell_col) {
      const int left = cell_col * side;
      const Tile tile{top, left, std::min(side, image.rows - top), std::min(side, image.cols - left)};
      Cell cell;
      cell.label = label_of_cell(image, labels, regions, tile);
      if (cell.label == 0) continue;
      const Plane& plane = planes[cell.label - 1];
      double sum = 0, weight = 0;  // one for all samples of a cell: noise varies little within
      for (int row = top; row < top + tile.rows; ++row)
        for (int col = left; col < left + tile.cols; ++col) {
          const std::size_t i = image.index(row, col);
          if (labels[i] != cell.label || image.mask[i] != kMeasured) continue;
          if (weight == 0) weight = height_over(image, noise, plane, i).weight;
          sum += plane.distance(image.point(i));
          cell.count += 1;
        }
      if (weight == 0) continue;
      cell.sum = static_cast<float>(weight * sum);
      cell.weight = static_cast<float>(weight * cell.count);
      grid.cells[grid.index(static_cast<int>(cell_row), cell_col)] = cell;
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

// window_sigmas of every window of one shape, by its upper left cell, where all its cells have one label, as
// most have; NaN elsewhere.
std::vector<double> sigmas_of_one_label(const CellGrid& grid, const Window& window) {
  std::vector<double> sigmas(grid.cells.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_for(static_cast<std::size_t>(std::max(grid.rows - window.rows + 1, 0)),
               [&](std::size_t window_row) {
                 const int row = static_cast<int>(window_row);
                 for (int col = 0; col + window.cols <= grid.cols; ++col) {
                   const std::uint32_t label = grid.cells[grid.index(row, col)].label;
                   bool one = label != 0;
                   for (int r = row; r < row + window.rows; ++r)
                     for (int c = col; c < col + window.cols; ++c)
                       one &= grid.cells[grid.index(r, c)].label == label;
                   if (one) sigmas[grid.index(row, col)] = window_sigmas(grid, label, row, col, window);
                 }
               });
  return sigmas;
}

// Marks the cells that some window around them finds off their plane.
void mark_cells(CellGrid& grid, double excess) {
  std::array<std::vector<double>, std::size(kWindows)> known;
  for (std::size_t k = 0; k < known.size(); ++k) known[k] = sigmas_of_one_label(grid, kWindows[k]);
  parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t cell_row) {
    const int row = static_cast<int>(cell_row);
    for (int col = 0; col < grid.cols; ++col) {
      Cell& cell = grid.cells[grid.index(row, col)];
      if (cell.label == 0) continue;
      double most = 0;
      for (std::size_t k = 0; k < known.size(); ++k)
        for (int r = std::max(row - kWindows[k].rows + 1, 0); r <= row; ++r)
          for (int c = std::max(col - kWindows[k].cols + 1, 0); c <= col; ++c) {
            double sigmas = known[k][grid.index(r, c)];
            if (std::isnan(sigmas)) sigmas = window_sigmas(grid, cell.label, r, c, kWindows[k]);
            if (std::abs(sigmas) > std::abs(most) && sigmas * double{cell.sum} > 0) most = sigmas;
          }
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
    StepProposal proposal{grid.cells[start].label, {}, grid.rows, grid.cols, 0, 0, {}};
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
    if (4 * proposal.mean.count < least) continue;
    for (int* edge : {&proposal.top, &proposal.left, &proposal.bottom, &proposal.right}) *edge *= grid.side;
    proposals.push_back(proposal);
  }
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const StepProposal& a, const StepProposal& b) { return a.label < b.label; });
  return proposals;
}

std::vector<PlaneExtent> plane_extents(const CellGrid& grid) {
  std::map<std::uint32_t, PlaneExtent> extents;
  for (int row = 0; row < grid.rows; ++row)
    for (int col = 0; col < grid.cols; ++col) {
      const Cell& cell = grid.cells[grid.index(row, col)];
      if (cell.label == 0) continue;
      PlaneExtent& extent =
          extents.try_emplace(cell.label, PlaneExtent{cell.label, 0, row, col, row, col}).first->second;
      extent.samples += cell.count;
      extent.left = std::min(extent.left, col);
      extent.bottom = std::max(extent.bottom, row + 1);
      extent.right = std::max(extent.right, col + 1);
    }
  std::vector<PlaneExtent> all;
  for (auto& [label, extent] : extents) {
    for (int* edge : {&extent.top, &extent.left, &extent.bottom, &extent.right}) *edge *= grid.side;
    all.push_back(extent);
  }
  return all;
}

// What became of a proposal.
struct Part {
  StepVerdict verdict = StepVerdict::none;
  std::vector<std::uint32_t> samples;
  MeanHeight height;
  double step_m = 0;
};

std::vector<Part> share_out(const RangeImage& image, const RangeNoise& noise,
                            const std::vector<std::uint32_t>& labels, const std::vector<Plane>& planes,
                            const PlaneRegions& regions, const std::vector<StepProposal>& proposals,
                            double excess, std::int64_t least) {
  const auto is_free = [&](std::size_t i) { return is_on_no_plane(image, labels, regions, i); };
  std::vector<Part> parts(proposals.size());
  parallel_for(proposals.size(), [&](std::size_t k) {
    const StepProposal& proposal = proposals[k];
    StepSharing sharing(image, noise, labels, planes[proposal.label - 1], proposal, excess);
    Part& part = parts[k];
    part.verdict = sharing.share(is_free, least);
    if (part.verdict == StepVerdict::none) return;
    part.height = sharing.height();
    part.step_m = sharing.step_m();
    sharing.for_each_of_part([&](std::size_t i) { part.samples.push_back(static_cast<std::uint32_t>(i)); });
  });
  return parts;
}

}  // namespace

StepChanges split_steps(const RangeImage& image, const SquareGrid& grid, int square, const RangeNoise& noise,
                        const StepLimits& limits, std::vector<std::uint32_t>& labels,
                        std::vector<Plane>& planes, PlaneRegions& regions) {
  CellGrid cells = mean_heights(image, noise, std::max(square / kCellsPerSquare, 2), labels, planes, regions);
  const double excess = excess_scatter(cells);
  mark_cells(cells, excess);
  // What a line tells of a small plane is told of all of it; windows tell of the others.
  const auto least = std::max(limits.least_samples, kFewestByLine);
  auto proposals = propose_by_lines(image, noise, labels, planes, plane_extents(cells), excess, least);
  auto parts = share_out(image, noise, labels, planes, regions, proposals, excess, least);
  std::set<std::uint32_t> parted;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (parts[k].verdict == StepVerdict::step) parted.insert(proposals[k].label);
  auto by_windows = find_proposals(cells, limits.least_samples);
  std::erase_if(by_windows, [&](const StepProposal& proposal) { return parted.contains(proposal.label); });
  for (Part& part :
       share_out(image, noise, labels, planes, regions, by_windows, excess, limits.least_samples))
    parts.push_back(std::move(part));
  proposals.insert(proposals.end(), by_windows.begin(), by_windows.end());

  // Samples of each plane, and of its parts, which may overlap.
  std::map<std::uint32_t, std::int64_t> of_plane;
  for (const Cell& cell : cells.cells)
    if (cell.label != 0) of_plane[cell.label] += cell.count;
  std::map<std::uint32_t, std::vector<std::uint32_t>> of_parts;
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (parts[k].verdict == StepVerdict::step) {
      auto& samples = of_parts[proposals[k].label];
      samples.insert(samples.end(), parts[k].samples.begin(), parts[k].samples.end());
    }
  for (auto& [label, samples] : of_parts) {
    std::sort(samples.begin(), samples.end());
    samples.erase(std::unique(samples.begin(), samples.end()), samples.end());
  }
  const auto is_banded = [&](std::uint32_t label) {
    return static_cast<double>(of_parts[label].size()) > kMostOfPlane * static_cast<double>(of_plane[label]);
  };

  struct Level {
    std::uint32_t of, id;
    MeanHeight height;
  };
  std::vector<Level> levels;
  std::vector<std::uint32_t> changed;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const std::uint32_t label = proposals[k].label;
    const Part& part = parts[k];
    if (part.verdict == StepVerdict::step &&
        (std::abs(part.step_m) < kLeastOfWaviness * limits.waviness_m || is_banded(label)))
      continue;
    // Proposals may share samples: the first takes them.
    std::vector<std::uint32_t> samples;
    for (const std::uint32_t i : part.samples)
      if (labels[i] == label) samples.push_back(i);
    if (samples.empty()) continue;
    if (part.verdict == StepVerdict::curved) {
      changed.push_back(label);
      for (const std::uint32_t i : samples) labels[i] = 0;
      continue;
    }
    // One part may be broken by an occluder, or by windows between which nothing stood out.
    auto level = std::find_if(levels.begin(), levels.end(), [&](const Level& other) {
      return other.of == label &&
             std::abs(part.height.value_m() - other.height.value_m()) < kSameHeight * std::abs(part.step_m);
    });
    if (level == levels.end()) {
      if (std::ssize(samples) < limits.least_samples) continue;
      regions.regions.emplace_back().small = true;
      planes.push_back({planes[label - 1].normal, planes[label - 1].offset_m + part.height.value_m()});
      level = levels.insert(level, {label, static_cast<std::uint32_t>(planes.size()), {}});
      changed.push_back(level->id);
    }
    changed.push_back(label);
    level->height.add(part.height);
    auto& of_part = regions.regions[level->id - 1].squares;
    for (const std::uint32_t i : samples) {
      labels[i] = level->id;
      const int row = static_cast<int>(i) / image.cols, col = static_cast<int>(i) % image.cols;
      of_part.push_back(static_cast<std::uint32_t>(grid.at(row / square, col / square)));
    }
    std::sort(of_part.begin(), of_part.end());
    of_part.erase(std::unique(of_part.begin(), of_part.end()), of_part.end());
  }
  return {std::move(changed), excess};
}

}  // namespace hybrid::stages
