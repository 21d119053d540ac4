#include "io/scan_info.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "io/read_scan.hpp"
#include "io/stream_scan.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

ScanInfo describe_unread(const ScanEntry& entry, const std::string& format, const std::string& problem) {
  ScanInfo info;
  info.format = format;
  info.name = entry.name;
  info.points = entry.samples;
  info.grid_rows = entry.grid_rows;
  info.grid_cols = entry.grid_cols;
  info.problem = problem;
  return info;
}

}  // namespace

ScanInfo describe(const ScanStream& stream, const std::string& format) {
  const Scan& scan = stream.head();
  const SampleFacts& facts = stream.facts();
  ScanInfo info;
  info.format = format;
  info.name = scan.name;
  info.points = stream.count();
  if (scan.organised()) {
    info.grid_rows = scan.grid_rows;
    info.grid_cols = scan.grid_cols;
  }
  info.has_intensity = stream.has_intensity();
  info.has_colour = stream.has_colour();
  info.world_from_scan = scan.world_from_scan;
  info.crs = scan.crs;
  info.notes = scan.notes;
  info.returns = facts.seen;
  if (facts.seen == 0) return info;
  info.min_m = facts.least_seen_m;
  info.max_m = facts.greatest_seen_m;
  info.min_range_m = facts.least_range_m;
  info.max_range_m = facts.greatest_range_m;
  return info;
}

std::vector<ScanInfo> read_scan_info(const std::filesystem::path& file, const ReadOptions& options) {
  std::string format = file.extension().string();
  for (char& c : format)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  auto entries = list_scans(file, options);
  std::vector<ScanInfo> result;
  std::optional<Error> last;
  for (ScanEntry& entry : entries) {
    entry.kept_bytes = 0;
    try {
      result.push_back(describe(*stream_scan(file, entry), format.substr(1)));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      last = error;
      result.push_back(describe_unread(entry, format.substr(1), error.what()));
    }
    result.back().structure = entry.structure;
    result.back().unit = entry.unit;
  }
  const bool none =
      std::none_of(result.begin(), result.end(), [](const auto& i) { return i.problem.empty(); });
  if (last && none) throw Error(*last);
  return result;
}

}  // namespace hybrid::io
