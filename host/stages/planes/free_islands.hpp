#pragma once
#include <cstdint>
#include <vector>

#include "geometry/range_image.hpp"

namespace hybrid::stages {

// Free samples (SampleUse) in islands that no flood leaves: any two of different ones are more than kUseReach
// nodes apart along rows or columns. What becomes of one island's samples is nothing to another's.
class FreeIslands {
 public:
  FreeIslands(const RangeImage& image, const std::vector<std::uint8_t>& use);

  // Of a free sample, from 0 to less than count().
  std::uint32_t island(std::uint32_t sample) const { return run_of(sample).island; }
  std::uint32_t count() const { return islands_; }
  // Of a free sample, from 0 to less than numbers(): all have different ones.
  std::uint32_t number(std::uint32_t sample) const {
    const Run& run = run_of(sample);
    return run.number + (sample % static_cast<std::uint32_t>(cols_) - run.begin);
  }
  std::uint32_t numbers() const { return numbers_; }

 private:
  // Of a row: free samples, the gaps between which are shorter than the reach. Columns, the end excluded.
  struct Run {
    std::uint32_t begin, end, number, island;
  };
  const Run& run_of(std::uint32_t sample) const;

  int cols_;
  std::vector<std::size_t> first_of_row_;  // and the end
  std::vector<Run> runs_;
  std::uint32_t islands_ = 0, numbers_ = 0;
};

}  // namespace hybrid::stages
