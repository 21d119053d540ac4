#include "io/e57/table_reader.hpp"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "io/e57/bit_decoder.hpp"
#include "io/e57/streams.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kMostWithoutBytes = 1 << 16;  // records that take no room in the file
constexpr std::uint64_t kPadding_bytes = 8;           // writers fill up the last word of a stream
constexpr std::uint64_t kMostBlock_records = 1 << 20;
constexpr std::uint64_t kMostBlock_bytes = 32 << 20;
constexpr std::uint64_t kMostLoaded_bytes = 128 << 20;

bool has_stream(const E57Field& field) {
  return field.bits() > 0;
}

std::uint64_t bits(const E57Field& field) {
  return static_cast<std::uint64_t>(field.bits());
}

// Values that so many bytes hold, safe from overflow.
std::uint64_t values_in(std::uint64_t bytes, std::uint64_t width) {
  return bytes / width * 8 + bytes % width * 8 / width;
}

}  // namespace

// The groups that hold what a block of records needs, in memory.
struct E57TableReader::Loaded {
  std::vector<char> bytes;
  std::vector<StreamParts> parts;  // per asked field
};

E57TableReader::E57TableReader(const PagedFile& file, const E57Table& table) : file_(file), table_(table) {
  groups_ = find_packets(file, table, notes_);
  bound_count();
}

void E57TableReader::bound_count() {
  count_ = table_.count;
  const auto where = fmt::format("{}: byte {}: {}", file_.name(), table_.offset, table_.what);
  const E57Field* shortest = nullptr;
  bool any_stream = false;
  for (std::size_t s = 0; s < table_.fields.size(); ++s) {
    const E57Field& field = table_.fields[s];
    if (!has_stream(field)) continue;
    any_stream = true;
    const std::uint64_t held = values_in(groups_.total(s), bits(field));
    if (held < count_) {
      count_ = held;
      shortest = &field;
    }
  }
  if (!any_stream && count_ > kMostWithoutBytes)
    fail_input("{}: expected at most {} points without a stored byte, found {}; export the file again", where,
               kMostWithoutBytes, count_);
  if (shortest) {
    const auto problem =
        fmt::format("expected {} points, found {} in the stream of {}", table_.count, count_, shortest->name);
    if (!file_.salvage())
      fail_input("{}: {}; the file is cut short or its count is wrong: copy it again or use --salvage", where,
                 problem);
    notes_.push_back(fmt::format(
        "byte {}: {}: {} points ({:.1f} %) are lost", table_.offset, problem, table_.count - count_,
        100 * static_cast<double>(table_.count - count_) / static_cast<double>(table_.count)));
    return;
  }
  for (std::size_t s = 0; s < table_.fields.size(); ++s) {
    const E57Field& field = table_.fields[s];
    const std::uint64_t held = has_stream(field) ? values_in(groups_.total(s), bits(field)) : 0;
    if (held <= count_ ||
        values_in(groups_.total(s) - std::min(kPadding_bytes, groups_.total(s)), bits(field)) <= count_)
      continue;
    const auto problem =
        fmt::format("expected {} points, found {} in the stream of {}", count_, held, field.name);
    if (!file_.salvage())
      fail_input("{}: {}; its count is wrong: export it again or use --salvage", where, problem);
    notes_.push_back(fmt::format("byte {}: {}: those beyond the count are left out", table_.offset, problem));
    return;
  }
}

// False when that takes more memory than allowed, because the streams of one record lie far apart.
bool E57TableReader::load(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t end,
                          Loaded& loaded) const {
  std::vector<char> needed(groups_.count(), 0);
  for (const std::size_t s : fields) {
    const std::uint64_t width = bits(table_.fields[s]);
    if (width == 0) continue;
    const std::uint64_t from = first * width / 8, to = (end * width + 7) / 8;
    for (std::size_t group = 0; group < groups_.count(); ++group)
      if (groups_.before(group, s) < to && groups_.before(group + 1, s) > from) needed[group] = 1;
  }
  struct Piece {
    std::size_t group;
    std::uint64_t at;  // in loaded.bytes
    std::vector<StreamParts> parts;
    std::vector<std::uint64_t> bad_pages;
    std::exception_ptr failure;
  };
  std::vector<Piece> pieces;
  std::uint64_t total = 0;
  for (std::size_t group = 0; group < groups_.count(); ++group)
    if (needed[group]) {
      pieces.push_back({group, total, std::vector<StreamParts>(fields.size()), {}, {}});
      total += groups_.end[group] - groups_.begin[group];
    }
  if (total > kMostLoaded_bytes) return false;
  loaded.bytes.resize(total + kBitSlack_bytes);
  parallel_for(pieces.size(), [&](std::size_t i) {
    Piece& piece = pieces[i];
    try {
      const std::uint64_t begin = groups_.begin[piece.group];
      const std::span<char> to(&loaded.bytes[piece.at], groups_.end[piece.group] - begin);
      file_.read(begin, to, file_.salvage() ? &piece.bad_pages : nullptr);
      add_parts(groups_, piece.group, to.data(), fields, piece.bad_pages, piece.parts);
    } catch (...) {
      piece.failure = std::current_exception();
    }
  });
  loaded.parts.assign(fields.size(), {});
  for (Piece& piece : pieces) {
    if (piece.failure) std::rethrow_exception(piece.failure);  // the first in the file, whoever met it first
    bad_pages_.insert(piece.bad_pages.begin(), piece.bad_pages.end());
    for (std::size_t k = 0; k < fields.size(); ++k)
      loaded.parts[k].insert(loaded.parts[k].end(), piece.parts[k].begin(), piece.parts[k].end());
  }
  return true;
}

void E57TableReader::read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
                          const std::function<void(const E57Records&)>& body) const {
  std::uint64_t record_bits = 1;
  for (const std::size_t s : fields) {
    const E57Field& field = table_.fields.at(s);
    if (field.type == E57Type::text)
      fail_input("{}: {}: expected a field of numbers, found text in {}; leave it out", file_.name(),
                 table_.what, field.name);
    record_bits += bits(field);
  }
  std::uint64_t block =
      std::clamp<std::uint64_t>(kMostBlock_bytes * 8 / record_bits, kRange, kMostBlock_records) / kRange *
      kRange;
  Loaded loaded;
  const std::uint64_t end = first + count;
  for (std::uint64_t at = first; at < end;) {
    const std::uint64_t block_end = std::min(at + block, end);
    if (!load(fields, at, block_end, loaded)) {
      if (block == kRange)
        fail_input(
            "{}: {}: expected the values of a point near each other, found them over {} MiB apart; export "
            "the file again",
            file_.name(), table_.what, kMostLoaded_bytes >> 20);
      block = std::max<std::uint64_t>(block / 2 / kRange * kRange, kRange);
      continue;
    }
    parallel_for((block_end - at + kRange - 1) / kRange, [&](std::size_t i) {
      thread_local std::vector<std::int64_t> integers;
      thread_local std::vector<double> reals;
      integers.resize(fields.size() * kRange);
      reals.resize(fields.size() * kRange);
      E57Records records{.first = at + i * kRange,
                         .integers = std::vector<std::span<const std::int64_t>>(fields.size()),
                         .reals = std::vector<std::span<const double>>(fields.size())};
      records.count = static_cast<std::size_t>(std::min<std::uint64_t>(kRange, block_end - records.first));
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const E57Field& field = table_.fields[fields[k]];
        if (field.is_integer()) {
          const std::span<std::int64_t> to(&integers[k * kRange], records.count);
          decode(field, loaded.parts[k], records.first, to, records.lost);
          records.integers[k] = to;
        } else {
          const std::span<double> to(&reals[k * kRange], records.count);
          decode(field, loaded.parts[k], records.first, to, records.lost);
          records.reals[k] = to;
        }
      }
      std::ranges::sort(records.lost, {}, &E57Records::Lost::first);
      body(records);
    });
    at = block_end;
  }
}

}  // namespace hybrid::io
