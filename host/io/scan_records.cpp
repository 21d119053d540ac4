#include "io/scan_records.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "io/e57/e57_write_xml.hpp"
#include "io/sample_text.hpp"

namespace hybrid::io {
namespace {

bool counts(const std::array<float, 3>& point) {
  return is_return(point) && (point[0] != 0 || point[1] != 0 || point[2] != 0);
}

// The same samples have the same.
std::string identifier(const Scan& scan) {
  const XXH128_hash_t points =
      scan.exact.empty() ? XXH3_128bits(scan.points.data(), scan.points.size() * sizeof scan.points[0])
                         : XXH3_128bits(scan.exact.data(), scan.exact.size() * sizeof scan.exact[0]);
  const XXH128_hash_t all =
      XXH3_128bits_withSeed(scan.name.data(), scan.name.size(), points.low64 ^ points.high64);
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

ScanRecords::ScanRecords(const Scan& scan) : scan_(scan) {
  E57Scan& d = description_;
  d.guid = identifier(scan);
  d.name = printable(scan.name);
  d.world_from_scan = scan.world_from_scan;
  d.points.what = scan.name;
  d.points.count = scan.points.size();
  const auto whole_field = [&](Kind kind, const char* name, std::int64_t maximum) {
    add(kind, {.name = name, .minimum = 0, .maximum = maximum});
  };
  const bool single = scan.origin.isZero() && scan.exact.empty();
  const auto type = single ? E57Type::single_real : E57Type::double_real;
  add(x, {.name = "cartesianX", .type = type});
  add(y, {.name = "cartesianY", .type = type});
  add(z, {.name = "cartesianZ", .type = type});
  if (!std::ranges::all_of(scan.points, counts)) whole_field(invalid, "cartesianInvalidState", 2);
  if (scan.organised()) {
    whole_field(row, "rowIndex", scan.grid_rows - 1);
    whole_field(column, "columnIndex", scan.grid_cols - 1);
    d.rows = E57Limits{0, static_cast<double>(scan.grid_rows - 1)};
    d.columns = E57Limits{0, static_cast<double>(scan.grid_cols - 1)};
    d.points.count = laid_out(scan);
    for (std::size_t i = 0; i < scan.node.size(); ++i)
      if (scan.node[i] != Scan::kNoNode) samples_.push_back(static_cast<std::uint32_t>(i));
  }
  if (!scan.intensity.empty()) {
    E57Field field{.name = "intensity", .type = E57Type::single_real};
    if (const auto& limits = scan.intensity_limits)
      d.intensity = E57Limits{static_cast<double>((*limits)[0]), static_cast<double>((*limits)[1])};
    add(intensity, field);
  }
  if (scan.rgb.empty()) return;
  whole_field(red, "colorRed", 255);
  whole_field(green, "colorGreen", 255);
  whole_field(blue, "colorBlue", 255);
  d.colour.emplace().fill({0, 255});
}

std::int64_t ScanRecords::whole(Kind kind, std::size_t sample) const {
  const auto rows = static_cast<std::size_t>(scan_.grid_rows),
             cols = static_cast<std::size_t>(scan_.grid_cols);
  switch (kind) {
    case invalid:
      return counts(scan_.points[sample]) ? 0 : 2;
    case row:
      return static_cast<std::int64_t>(!scan_.node.empty() ? scan_.node[sample] / cols
                                       : scan_.row_by_row  ? sample / cols
                                                           : sample % rows);
    case column:
      return static_cast<std::int64_t>(!scan_.node.empty() ? scan_.node[sample] % cols
                                       : scan_.row_by_row  ? sample % cols
                                                           : sample / rows);
    default:
      return scan_.rgb[sample][static_cast<std::size_t>(kind - red)];
  }
}

double ScanRecords::real(Kind kind, std::size_t sample) const {
  if (kind == intensity) return static_cast<double>(scan_.intensity[sample]);
  const auto& point = scan_.points[sample];
  if (!counts(point)) return 0;
  return scan_.exact_point(sample)[static_cast<int>(kind)];
}

void ScanRecords::read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
                       const std::function<void(const E57Records&)>& body) const {
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
        const std::size_t record = records.first + i, sample = samples_.empty() ? record : samples_[record];
        if (is_whole)
          integers[k].push_back(whole(kind, sample));
        else
          reals[k].push_back(real(kind, sample));
      }
      records.integers[k] = integers[k];
      records.reals[k] = reals[k];
    }
    body(records);
  });
}

ScanAsE57::ScanAsE57(const Scan& scan) : scan_(scan) {
  E57Contents contents;
  contents.library = "Hybrid";
  contents.coordinate_system = scan.crs;
  contents.scans.push_back(ScanRecords(scan).description());
  contents.guid = contents.scans[0].guid;
  describe(scan.name, write_e57_xml(contents, {}));
}

std::unique_ptr<E57RecordReader> ScanAsE57::open(std::size_t) const {
  return std::make_unique<ScanRecords>(scan_);
}

std::vector<char> ScanAsE57::blob(std::size_t) const {
  return {};
}

}  // namespace hybrid::io
