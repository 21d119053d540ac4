#include "stages/planes/free_islands.hpp"

#include <algorithm>

#include "core/disjoint_sets.hpp"
#include "core/parallel.hpp"
#include "stages/planes/plane_floods.hpp"

namespace hybrid::stages {
FreeIslands::FreeIslands(const RangeImage& image, const std::vector<std::uint8_t>& use)
    : cols_(image.cols), first_of_row_(static_cast<std::size_t>(image.rows) + 1) {
  constexpr std::uint32_t kReach = kUseReach;
  const auto rows = static_cast<std::size_t>(image.rows), cols = static_cast<std::size_t>(image.cols);
  std::vector<std::vector<Run>> of_row(rows);
  parallel_for(rows, [&](std::size_t row) {
    for (std::uint32_t col = 0; col < cols; ++col) {
      if (use[row * cols + col] != kFree) continue;
      auto& runs = of_row[row];
      if (runs.empty() || col > runs.back().end + kReach - 1)
        runs.push_back({col, col + 1, 0, 0});
      else
        runs.back().end = col + 1;
    }
  });
  for (std::size_t row = 0; row < rows; ++row) {
    runs_.insert(runs_.end(), of_row[row].begin(), of_row[row].end());
    first_of_row_[row + 1] = runs_.size();
  }
  for (Run& run : runs_) {
    run.number = numbers_;
    numbers_ += run.end - run.begin;
  }

  DisjointSets sets(runs_.size());
  const auto meet = [&](std::size_t a, std::size_t b, std::uint32_t shift) {
    return runs_[a].begin + shift < runs_[b].end + kReach && runs_[b].begin < runs_[a].end + shift + kReach;
  };
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t above = row - std::min<std::size_t>(row, kReach); above <= row; ++above) {
      std::size_t a = first_of_row_[row], b = first_of_row_[above];
      const std::size_t a_end = first_of_row_[row + 1], b_end = first_of_row_[above + 1];
      if (a == a_end || b == b_end) continue;
      if (image.wraps) {  // the first run of one row may go on as the other's last, across the seam
        const auto across = static_cast<std::uint32_t>(cols);
        if (meet(a, b_end - 1, across))
          sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b_end - 1));
        if (meet(b, a_end - 1, across))
          sets.join(static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(a_end - 1));
      }
      while (above < row && a < a_end && b < b_end) {
        if (meet(a, b, 0)) sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
        ++(runs_[a].end < runs_[b].end ? a : b);
      }
    }
  for (std::uint32_t k = 0; k < runs_.size(); ++k)
    runs_[k].island = sets.of(k) == k ? islands_++ : runs_[sets.of(k)].island;
}

const FreeIslands::Run& FreeIslands::run_of(std::uint32_t sample) const {
  const auto cols = static_cast<std::uint32_t>(cols_), row = sample / cols, col = sample % cols;
  const auto begin = runs_.begin() + static_cast<std::ptrdiff_t>(first_of_row_[row]),
             end = runs_.begin() + static_cast<std::ptrdiff_t>(first_of_row_[row + 1]);
  return *std::prev(
      std::upper_bound(begin, end, col, [](std::uint32_t at, const Run& run) { return at < run.begin; }));
}

}  // namespace hybrid::stages
