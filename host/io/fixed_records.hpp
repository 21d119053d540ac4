#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/parallel.hpp"
#include "io/built_stream.hpp"
#include "io/input_file.hpp"

namespace hybrid::io {

// Records of the same number of bytes, one behind the other, read on all threads. Memory: a part of about a
// MiB, of one record at least, for some per thread.
class FixedRecords {
 public:
  // Of longer ones a part would take more memory than the scan: read their fields one by one.
  static constexpr std::uint64_t kLongest_bytes = 1 << 20;

  FixedRecords(const InputFile& input, std::uint64_t offset, std::uint64_t record_bytes)
      : input_(input), offset_(offset), record_bytes_(record_bytes) {}

  // Adds records [first, first + count) to a ScanBuilder or the like: to_sample(record) makes a ScanSample of
  // where it lies in memory.
  template <typename Builder, typename ToSample>
  void add(std::uint64_t first, std::uint64_t count, Builder& builder, const ToSample& to_sample) {
    const std::uint64_t per_part = std::max<std::uint64_t>(1, kPart_bytes / record_bytes_);
    parts_.resize(kPartsPerThread * static_cast<std::size_t>(thread_count()));
    std::vector<std::size_t> counts;
    for (const std::uint64_t end = first + count; first < end;) {
      counts.clear();
      std::uint64_t taken = 0;
      for (; first + taken < end && counts.size() < parts_.size(); taken += counts.back())
        counts.push_back(static_cast<std::size_t>(std::min(end - first - taken, per_part)));
      parallel_for(counts.size(), [&](std::size_t k) {
        parts_[k].resize(counts[k] * record_bytes_);
        input_.read(offset_ + (first + k * per_part) * record_bytes_, parts_[k]);
      });
      builder.add_parts(counts, [&](std::size_t k, std::size_t i) {
        return to_sample(parts_[k].data() + i * record_bytes_);
      });
      first += taken;
    }
  }

  // Over the first ones, or over all where their colours need it.
  template <typename ToSample>
  FirstPass first_pass(std::uint64_t count, ColourKind colour, const ToSample& to_sample) {
    FirstPass pass;
    pass.colour = colour;
    for (std::uint64_t done = 0; done < count && !pass.done(); done += kOriginSamples)
      add(done, std::min<std::uint64_t>(kOriginSamples, count - done), pass, to_sample);
    return pass;
  }

 private:
  static constexpr std::uint64_t kPart_bytes = 1 << 20;
  static constexpr std::size_t kPartsPerThread = 4;

  const InputFile& input_;
  std::uint64_t offset_, record_bytes_;
  std::vector<std::vector<char>> parts_;
};

}  // namespace hybrid::io
