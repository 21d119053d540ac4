#include "io/scan_info.hpp"

#include <algorithm>
#include <cmath>

#include "io/range_exr.hpp"
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

ScanInfo describe_range_image(const std::filesystem::path& file) {
  const RangeImage image = read_range_exr(file);
  ScanInfo info;
  info.format = "EXR";
  info.name = file.stem().string();
  info.points = image.count();
  info.grid_rows = image.rows;
  info.grid_cols = image.cols;
  info.has_intensity = !image.intensity.empty();
  info.has_colour = !image.rgb.empty();
  for (std::size_t i = 0; i < image.count(); ++i)
    if (image.mask[i] == kMeasured) add_return(info, image.point(i));
  for (const auto& [name, value] : read_range_exr_attributes(file)) info.notes.push_back(name + ": " + value);
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
  info.notes = scan.notes;
  for (const auto& point : scan.points) add_return(info, scan.origin + Vec3(point[0], point[1], point[2]));
  return info;
}

std::vector<ScanInfo> read_scan_info(const std::filesystem::path& file) {
  std::string format = file.extension().string();
  for (char& c : format)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  if (format == ".EXR") return {describe_range_image(file)};
  std::vector<ScanInfo> result;
  for (const ScanEntry& entry : list_scans(file))
    result.push_back(describe(read_scan(file, entry), format.substr(1)));
  return result;
}

}  // namespace hybrid::io
