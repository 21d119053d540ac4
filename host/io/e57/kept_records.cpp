#include "io/e57/kept_records.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "io/e57/scan_notes.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kKeptBlock_records = 1 << 18, kBlock_values = 1 << 22;

}  // namespace

KeptRanges find_kept(const E57RecordReader& reader, std::span<const std::size_t> fields) {
  KeptRanges kept;
  std::uint64_t done = 0;  // all before are known
  const auto keep_to = [&](std::uint64_t end) {
    if (end <= done) return;
    const bool follows = !kept.ranges.empty() && kept.ranges.back().end == done;
    if (!follows) kept.ranges.push_back({done, end, kept.count});
    kept.ranges.back().end = end;
    kept.count += end - done;
    done = end;
  };
  std::vector<std::vector<E57Records::Lost>> lost(kKeptBlock_records / E57RecordReader::kRange);
  for (std::uint64_t at = 0; at < reader.count(); at += kKeptBlock_records) {
    check_interrupted();
    const std::uint64_t end = std::min(at + kKeptBlock_records, reader.count());
    reader.read(fields, at, end - at, [&](const E57Records& records) {
      lost[(records.first - at) / E57RecordReader::kRange] = records.lost;
    });
    for (auto& of_range : lost) {
      for (const auto& one : of_range) {  // those of several fields overlap
        keep_to(one.first);
        kept.lost += one.end - std::clamp(done, one.first, one.end);
        done = std::max(done, one.end);
      }
      of_range.clear();
    }
    keep_to(end);
  }
  kept.notes = reader.notes();
  add_damage_notes(reader, kept.lost, "left out", kept.notes);
  return kept;
}

// Kept records [first, first + count), column by column.
struct KeptRecords::Block {
  std::uint64_t first = 0, count = 0;
  std::vector<std::vector<std::int64_t>> integers;
  std::vector<std::vector<double>> reals;
};

KeptRecords::KeptRecords(std::unique_ptr<E57RecordReader> reader, const E57Table& table,
                         const KeptRanges& kept)
    : reader_(std::move(reader)), table_(table), kept_(kept) {
  notes_ = kept_.notes;
}

KeptRecords::At KeptRecords::range_of(std::uint64_t kept) const {
  return std::ranges::upper_bound(kept_.ranges, kept, {}, &KeptRanges::Range::kept_first) - 1;
}

void KeptRecords::fill(Block& block, const E57Records& records) const {
  const std::uint64_t end = records.first + records.count;
  auto range = std::ranges::upper_bound(kept_.ranges, records.first, {}, &KeptRanges::Range::end);
  for (; range != kept_.ranges.end() && range->first < end; ++range) {
    // Of the table, and within the block.
    const std::uint64_t begin = std::max(
        {range->first, records.first,
         block.first < range->kept_first ? range->first : range->first + (block.first - range->kept_first)});
    const std::uint64_t block_end = block.first + block.count;
    if (block_end <= range->kept_first) break;
    const std::uint64_t stop = std::min({range->end, end, range->first + (block_end - range->kept_first)});
    if (stop <= begin) continue;
    const std::uint64_t to = range->kept_first + (begin - range->first) - block.first;
    for (std::size_t k = 0; k < block.integers.size(); ++k) {
      const auto copy = [&](const auto& from, auto& column) {
        if (!from.empty())
          std::ranges::copy(from.subspan(begin - records.first, stop - begin),
                            column.begin() + static_cast<std::ptrdiff_t>(to));
      };
      copy(records.integers[k], block.integers[k]);
      copy(records.reals[k], block.reals[k]);
    }
  }
}

void KeptRecords::read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
                       const std::function<void(const E57Records&)>& body) const {
  if (kept_.lost == 0) {
    reader_->read(fields, first, count, body);
    return;
  }
  Block block{.first = first,
              .count = 0,
              .integers = std::vector<std::vector<std::int64_t>>(fields.size()),
              .reals = std::vector<std::vector<double>>(fields.size())};
  const std::uint64_t most =
      std::clamp<std::uint64_t>(kBlock_values / std::max<std::size_t>(fields.size(), 1), kRange,
                                kKeptBlock_records) /
      kRange * kRange;
  for (const std::uint64_t end = first + count; block.first < end; block.first += block.count) {
    block.count = std::min(most, end - block.first);
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const bool integer = table_.fields.at(fields[k]).is_integer();
      block.integers[k].resize(integer ? block.count : 0);
      block.reals[k].resize(integer ? 0 : block.count);
    }
    const auto place = [&](std::uint64_t kept) {
      const At range = range_of(kept);
      return range->first + (kept - range->kept_first);
    };
    const std::uint64_t begin = place(block.first), stop = place(block.first + block.count - 1) + 1;
    reader_->read(fields, begin, stop - begin, [&](const E57Records& records) { fill(block, records); });
    parallel_for((block.count + kRange - 1) / kRange, [&](std::size_t i) {
      const std::size_t at = i * kRange, size = std::min<std::size_t>(kRange, block.count - at);
      E57Records records{.first = block.first + at, .count = size};
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const auto part = [&](const auto& column) {
          return std::span(column).subspan(column.empty() ? 0 : at, column.empty() ? 0 : size);
        };
        records.integers.emplace_back(part(block.integers[k]));
        records.reals.emplace_back(part(block.reals[k]));
      }
      body(records);
    });
  }
}

}  // namespace hybrid::io
