#include "io/scan_records.hpp"

#include <xxhash.h>

#include <algorithm>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "io/e57/e57_write_xml.hpp"

namespace hybrid::io {
namespace {

// The same samples have the same.
std::string identifier(const ScanStream& scan) {
  const auto [high, low] = scan.facts().hash;
  const std::string& name = scan.head().name;
  const XXH128_hash_t all = XXH3_128bits_withSeed(name.data(), name.size(), low ^ high);
  return fmt::format("{{{:08X}-{:04X}-{:04X}-{:04X}-{:012X}}}", all.high64 >> 32, all.high64 >> 16 & 0xffff,
                     all.high64 & 0xffff, all.low64 >> 48, all.low64 & 0xffff'ffff'ffff);
}

// XML has no other control characters, and E57 names are for people.
std::string printable(std::string text) {
  std::erase_if(text, [](char c) { return static_cast<unsigned char>(c) < 32; });
  return text;
}

}  // namespace

void ScanRecords::add(Kind kind, E57Field field) {
  kinds_.push_back(kind);
  description_.points.fields.push_back(std::move(field));
}

ScanRecords::ScanRecords(const ScanStream& stream) : scan_(stream) {
  const Scan& scan = stream.head();
  E57Scan& d = description_;
  d.guid = identifier(stream);
  d.name = printable(scan.name);
  d.world_from_scan = scan.world_from_scan;
  d.points.what = scan.name;
  d.points.count = stream.laid_out();
  const auto whole_field = [&](Kind kind, const char* name, std::int64_t maximum) {
    add(kind, {.name = name, .minimum = 0, .maximum = maximum});
  };
  const bool single = scan.origin.isZero() && !stream.has_exact();
  const auto type = single ? E57Type::single_real : E57Type::double_real;
  add(x, {.name = "cartesianX", .type = type});
  add(y, {.name = "cartesianY", .type = type});
  add(z, {.name = "cartesianZ", .type = type});
  if (stream.facts().no_returns > 0) whole_field(invalid, "cartesianInvalidState", 2);
  if (scan.organised()) {
    whole_field(row, "rowIndex", scan.grid_rows - 1);
    whole_field(column, "columnIndex", scan.grid_cols - 1);
    d.rows = E57Limits{0, static_cast<double>(scan.grid_rows - 1)};
    d.columns = E57Limits{0, static_cast<double>(scan.grid_cols - 1)};
    if (stream.facts().beside > 0 && stream.has_node())
      stream.for_each_block([&](const SampleBlock& block) {
        for (std::size_t i = 0; i < block.size(); ++i)
          if (block.node[i] != Scan::kNoNode) samples_.push_back(static_cast<std::uint32_t>(block.first + i));
        return true;
      });
  }
  if (stream.has_intensity()) {
    E57Field field{.name = "intensity", .type = E57Type::single_real};
    if (const auto& limits = scan.intensity_limits)
      d.intensity = E57Limits{static_cast<double>((*limits)[0]), static_cast<double>((*limits)[1])};
    add(intensity, field);
  }
  if (!stream.has_colour()) return;
  whole_field(red, "colorRed", 255);
  whole_field(green, "colorGreen", 255);
  whole_field(blue, "colorBlue", 255);
  d.colour.emplace().fill({0, 255});
}

std::int64_t ScanRecords::whole(Kind kind, const SampleBlock& block, std::size_t i) const {
  const Scan& scan = scan_.head();
  const auto rows = static_cast<std::uint64_t>(scan.grid_rows),
             cols = static_cast<std::uint64_t>(scan.grid_cols), sample = block.first + i;
  switch (kind) {
    case invalid:
      return counts_as_return(block.points[i]) ? 0 : 2;
    case row:
      return static_cast<std::int64_t>(!block.node.empty() ? block.node[i] / cols
                                       : scan.row_by_row   ? sample / cols
                                                           : sample % rows);
    case column:
      return static_cast<std::int64_t>(!block.node.empty() ? block.node[i] % cols
                                       : scan.row_by_row   ? sample % cols
                                                           : sample / rows);
    default:
      return block.rgb[i][static_cast<std::size_t>(kind - red)];
  }
}

double ScanRecords::real(Kind kind, const SampleBlock& block, std::size_t i) {
  if (kind == intensity) return static_cast<double>(block.intensity[i]);
  if (!counts_as_return(block.points[i])) return 0;
  return block.exact_point(i)[static_cast<int>(kind)];
}

void ScanRecords::read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
                       const std::function<void(const E57Records&)>& body) const {
  static_assert(ScanStream::kBlock % kRange == 0);
  for (std::uint64_t at = first, end = first + count; at < end; at += ScanStream::kBlock)
    read_block(fields, at, static_cast<std::size_t>(std::min<std::uint64_t>(ScanStream::kBlock, end - at)),
               body);
}

void ScanRecords::read_block(std::span<const std::size_t> fields, std::uint64_t first, std::size_t count,
                             const std::function<void(const E57Records&)>& body) const {
  const std::uint64_t from = samples_.empty() ? first : samples_[first],
                      last = samples_.empty() ? first + count - 1 : samples_[first + count - 1];
  const SampleBlock block = scan_.read(from, static_cast<std::size_t>(last - from + 1));
  parallel_for((count + kRange - 1) / kRange, [&](std::size_t range) {
    E57Records records{.first = first + range * kRange,
                       .integers = std::vector<std::span<const std::int64_t>>(fields.size()),
                       .reals = std::vector<std::span<const double>>(fields.size())};
    records.count = static_cast<std::size_t>(std::min<std::uint64_t>(kRange, first + count - records.first));
    std::vector<std::vector<std::int64_t>> integers(fields.size());
    std::vector<std::vector<double>> reals(fields.size());
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const bool is_whole = description_.points.fields.at(fields[k]).is_integer();
      const Kind kind = kinds_[fields[k]];
      for (std::size_t i = 0; i < records.count; ++i) {
        const std::uint64_t record = records.first + i, sample = samples_.empty() ? record : samples_[record];
        const auto at = static_cast<std::size_t>(sample - from);
        if (is_whole)
          integers[k].push_back(whole(kind, block, at));
        else
          reals[k].push_back(real(kind, block, at));
      }
      records.integers[k] = integers[k];
      records.reals[k] = reals[k];
    }
    body(records);
  });
}

ScanAsE57::ScanAsE57(const ScanStream& scan) : scan_(scan) {
  E57Contents contents;
  contents.library = "Hybrid";
  contents.coordinate_system = scan.head().crs;
  contents.scans.push_back(ScanRecords(scan).description());
  contents.guid = contents.scans[0].guid;
  describe(scan.head().name, write_e57_xml(contents, {}));
}

std::unique_ptr<E57RecordReader> ScanAsE57::open_stored(std::size_t) const {
  return std::make_unique<ScanRecords>(scan_);
}

std::vector<char> ScanAsE57::blob(std::size_t) const {
  return {};
}

}  // namespace hybrid::io
