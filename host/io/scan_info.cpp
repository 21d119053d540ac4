#include "io/scan_info.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/read_scan.hpp"
#include "io/text_cursor.hpp"

namespace hybrid::io {
namespace {

void add_return(ScanInfo& info, const Vec3& point) {
  const double range = point.norm();
  if (!std::isfinite(range) || range == 0) return;
  const bool first = info.returns++ == 0;
  info.min_m = first ? point : Vec3(info.min_m.cwiseMin(point));
  info.max_m = first ? point : Vec3(info.max_m.cwiseMax(point));
  info.min_range_m = first ? range : std::min(info.min_range_m, range);
  info.max_range_m = first ? range : std::max(info.max_range_m, range);
}

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

ScanInfo describe(const Scan& scan, const std::string& format) {
  ScanInfo info;
  info.format = format;
  info.name = scan.name;
  info.points = scan.points.size();
  if (scan.organised()) {
    info.grid_rows = scan.grid_rows;
    info.grid_cols = scan.grid_cols;
  }
  info.has_intensity = !scan.intensity.empty();
  info.has_colour = !scan.rgb.empty();
  info.world_from_scan = scan.world_from_scan;
  info.crs = scan.crs;
  info.notes = scan.notes;
  for (const auto& point : scan.points) add_return(info, scan.origin + Vec3(point[0], point[1], point[2]));
  return info;
}

std::vector<ScanInfo> read_scan_info(const std::filesystem::path& file, const ReadOptions& options) {
  std::string format = file.extension().string();
  for (char& c : format)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  const auto entries = list_scans(file, options);
  std::vector<ScanInfo> result;
  std::optional<Error> last;
  for (const ScanEntry& entry : entries) {
    try {
      result.push_back(describe(read_scan(file, entry), format.substr(1)));
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
