#include "stages/planes/sample_labels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "core/parallel_blocks.hpp"
#include "geometry/tiles.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kParts = 16;     // of a tile, compared side by side
constexpr float kLabelCosine = 0.05f;  // c of the inlier test: steeper weights let grazing rays reach too far

// Offsets of the 5 x 5 neighbourhood, the nearest first, ties row by row.
std::vector<std::array<int, 2>> neighbourhood() {
  std::vector<std::array<int, 2>> offsets;
  for (int row = -2; row <= 2; ++row)
    for (int col = -2; col <= 2; ++col) offsets.push_back({row, col});
  std::stable_sort(offsets.begin(), offsets.end(), [](const auto& a, const auto& b) {
    return a[0] * a[0] + a[1] * a[1] < b[0] * b[0] + b[1] * b[1];
  });
  return offsets;
}

std::vector<LabelPlane> label_planes(const std::vector<Plane>& planes) {
  std::vector<LabelPlane> result(planes.size());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (int k = 0; k < 3; ++k) result[i].normal[k] = static_cast<float>(planes[i].normal[k]);
    result[i].offset = static_cast<float>(planes[i].offset_m);
    result[i].label = static_cast<std::uint32_t>(i + 1);
  }
  return result;
}

// Counts what a row's labels lose and gain.
void take_row(const std::uint32_t* after, std::uint32_t* before, std::size_t cols,
              std::vector<std::int64_t>& moved) {
  for (std::size_t col = 0; col < cols; ++col) {
    if (before[col] == after[col]) continue;
    moved[before[col]] += 1;
    moved[after[col]] += 1;
    before[col] = after[col];
  }
}

}  // namespace

LabelContest find_candidates(const SquarePlanes& squares, const SquareGrid& grid, const PlaneRegions& regions,
                             const SquarePresence& presence) {
  const auto offsets = neighbourhood();
  // Entries of square i: first[i] to first[i + 1].
  std::vector<std::uint32_t> first(grid.count() + 1);
  for (const auto& entry : presence) first[entry.first + 1] += 1;
  std::partial_sum(first.begin(), first.end(), first.begin());
  LabelContest contest;
  contest.candidates.assign(grid.count() * LABEL_CANDIDATES, 0);
  contest.own_plane.assign(grid.count(), {0, 0, 0, 0});
  parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t row) {
    for (int col = 0; col < grid.cols; ++col) {
      const std::size_t square = row * static_cast<std::size_t>(grid.cols) + static_cast<std::size_t>(col);
      std::uint32_t* list = &contest.candidates[square * LABEL_CANDIDATES];
      int count = 0;
      const auto compete = [&](std::uint32_t id) {
        if (id != 0 && count < LABEL_CANDIDATES && std::find(list, list + count, id) == list + count)
          list[count++] = id;
      };
      for (const auto& offset : offsets) {
        const std::int64_t at = grid.at(static_cast<int>(row) + offset[0], col + offset[1]);
        if (at == SquareGrid::kNone) continue;
        const auto other = static_cast<std::size_t>(at);
        compete(regions.of_square[other]);
        if (std::abs(offset[0]) <= 1 && std::abs(offset[1]) <= 1)
          for (std::uint32_t k = first[other]; k < first[other + 1]; ++k) compete(presence[k].second);
      }
      const SquareRecord& record = squares.squares[square];
      if (record.state == SQUARE_PLANAR && regions.of_square[square] == 0 &&
          first[square] == first[square + 1])
        contest.own_plane[square] = {record.normal[0], record.normal[1], record.normal[2], record.offset};
    }
  });
  return contest;
}

std::vector<std::int64_t> label_samples(device::Queue& queue, const RangeImage& image,
                                        const SquarePlanes& squares, const SquareGrid& grid,
                                        const LabelContest& contest, const std::vector<Plane>& planes,
                                        const SuperclusterOptions& options,
                                        std::vector<std::uint32_t>& labels) {
  const auto candidates = queue.array(contest.candidates);
  const auto own_plane = queue.array(contest.own_plane);
  const auto plane_table = queue.array(label_planes(planes));
  const auto tiles = make_tiles(image.rows, image.cols, options.tile, squares.square);
  std::size_t largest = 0;
  for (const Tile& tile : tiles)
    largest = std::max(largest, static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.cols));
  auto x = queue.array<float>(largest), y = queue.array<float>(largest), z = queue.array<float>(largest);
  auto tile_labels = queue.array<std::uint32_t>(largest);

  std::vector<std::uint32_t> found(largest);
  std::vector<std::vector<std::int64_t>> moved(kParts, std::vector<std::int64_t>(planes.size() + 1));
  const auto width = static_cast<std::size_t>(image.cols);
  for (const Tile& tile : tiles) {
    const device::Rect rect{static_cast<std::size_t>(tile.row), static_cast<std::size_t>(tile.col),
                            static_cast<std::size_t>(tile.rows), static_cast<std::size_t>(tile.cols)};
    queue.write_rect(x, image.x.data(), width, rect);
    queue.write_rect(y, image.y.data(), width, rect);
    queue.write_rect(z, image.z.data(), width, rect);
    LabelParams params{};
    params.first_row = static_cast<std::uint32_t>(tile.row);
    params.first_col = static_cast<std::uint32_t>(tile.col);
    params.rows = static_cast<std::uint32_t>(tile.rows);
    params.cols = static_cast<std::uint32_t>(tile.cols);
    params.square = static_cast<std::uint32_t>(squares.square);
    params.square_cols = static_cast<std::uint32_t>(grid.cols);
    params.noise_m = static_cast<float>(options.label_sigmas * squares.sigma_m);
    params.waviness_m = static_cast<float>(options.waviness_m);
    params.min_cosine = kLabelCosine;
    queue.launch("label_samples", queue.kernel("label_samples"),
                 device::grid(LABEL_SQUARES_ACROSS(params), params.rows), params, x, y, z, candidates,
                 own_plane, plane_table, tile_labels);
    queue.read_rect(tile_labels, found.data(), rect.cols, {0, 0, rect.rows, rect.cols});
    const std::size_t rows = (rect.rows + kParts - 1) / kParts;
    for_blocks(rect.rows, rows, [&](std::size_t part, std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        take_row(&found[row * rect.cols], &labels[(rect.row + row) * width + rect.col], rect.cols,
                 moved[part]);
    });
  }
  std::vector<std::int64_t> of_all(planes.size() + 1);
  for (const auto& part : moved)
    for (std::size_t label = 0; label < of_all.size(); ++label) of_all[label] += part[label];
  return of_all;
}

}  // namespace hybrid::stages
