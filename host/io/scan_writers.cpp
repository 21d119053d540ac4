#include "io/scan_writers.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/intensity_map.hpp"
#include "io/las/las_crs.hpp"
#include "io/las/las_steps.hpp"
#include "io/text/text_cursor.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {
namespace {

constexpr std::size_t kCrsShown = 40;  // characters

// Whether an intensity is no whole number once it is mapped.
bool rounds(const ScanStream& scan, const IntensityMap& map) {
  if (!scan.has_intensity() || (map.identity() && scan.facts().whole)) return false;
  bool found = false;
  scan.for_each_block([&](const SampleBlock& block) {
    found = std::ranges::any_of(block.intensity,
                                [&](float value) { return map(value) != std::round(map(value)); });
    return !found;
  });
  return found;
}

}  // namespace

const std::vector<ScanWriter>& scan_writers() {
  static const std::vector<ScanWriter> writers = {
      {.extension = ".ptx",
       .name = "PTX",
       .several = true,
       .grid = true,
       .pose = true,
       .pose_scale = true,
       .no_returns = true,
       .intensity_limits = kPtxIntensity,
       .write = write_ptx},
      {.extension = ".pts",
       .name = "PTS",
       .several = true,
       .intensity_limits = kPtsIntensity,
       .whole_intensity = true,
       .write = write_pts},
      {.extension = ".xyz", .name = "XYZ", .write = write_xyz},
      {.extension = ".ply", .name = "PLY", .write = write_ply_scan},
      {.extension = ".pcd",
       .name = "PCD",
       .grid = true,
       .pose = true,
       .no_returns = true,
       .write = write_pcd},
      {.extension = ".las",
       .name = "LAS",
       .crs = true,
       .intensity_limits = kLasIntensity,
       .whole_intensity = true,
       .las_steps = true,
       .write = write_las},
      {.extension = ".e57",
       .name = "E57",
       .several = true,
       .grid = true,
       .pose = true,
       .crs = true,
       .no_returns = true,
       .write = write_e57},
      {.extension = ".exr",
       .name = "EXR",
       .grid = true,
       .pose = true,
       .crs = true,
       .no_returns = true,
       .write = write_exr_of_scan},
  };
  return writers;
}

const ScanWriter& writer_for(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  std::string known;
  for (const ScanWriter& writer : scan_writers()) {
    if (extension == writer.extension) return writer;
    known += (known.empty() ? "" : ", ") + std::string(writer.extension);
  }
  fail(ErrorKind::usage, "{}: expected a name that ends in one of {}, found {}", file.string(), known,
       extension.empty() ? "no extension" : extension);
}

WriteLosses losses_of(const ScanWriter& writer, const ScanStream& stream) {
  WriteLosses losses;
  const Scan& scan = stream.head();
  if (scan.organised() && !writer.grid)
    losses.dropped.push_back(fmt::format("grid ({} x {})", scan.grid_rows, scan.grid_cols));
  if (scan.range_grid)
    losses.dropped.push_back(
        fmt::format("angle tables, interpolated nodes ({})", scan.range_grid->interpolated.size()));
  if (const std::uint64_t beside = stream.count() - stream.laid_out(); beside > 0 && writer.grid)
    losses.dropped.push_back(fmt::format("samples beside the grid ({})", beside));
  if (scan.world_from_scan && !writer.pose) losses.dropped.emplace_back("pose");
  if (scan.world_from_scan && writer.pose && !writer.pose_scale && scan.world_from_scan->scale != 1)
    losses.dropped.push_back(fmt::format("the pose's scale ({})", scan.world_from_scan->scale));
  if (!scan.crs.empty() && !writer.crs) losses.dropped.emplace_back("coordinate system");
  if (!scan.crs.empty() && writer.las_steps && scan.crs_records.empty() && las_crs_records(scan.crs).empty())
    losses.dropped.push_back(
        fmt::format("coordinate system ({}: no EPSG:n and no WKT)", scan.crs.substr(0, kCrsShown)));
  if (!writer.no_returns)
    if (const std::uint64_t count = stream.count() - stream.facts().returns; count > 0)
      losses.dropped.push_back(fmt::format("no-returns ({})", count));
  const IntensityMap map = map_intensity(stream, writer.intensity_limits, writer.whole_intensity);
  if (!map.identity())
    losses.changed.push_back(fmt::format("intensity scaled from {}..{} to {}..{}", map.from[0], map.from[1],
                                         map.to[0], map.to[1]));
  if (writer.whole_intensity && rounds(stream, map))
    losses.changed.emplace_back("intensity rounded to whole numbers");
  if (writer.las_steps)
    if (const LasSteps& steps = stream.las_steps(); steps.rounding_m > 0)
      losses.changed.push_back(fmt::format("coordinates rounded to steps of {:.6g} m, by up to {:.2g} m",
                                           steps.scale.maxCoeff(), steps.rounding_m));
  return losses;
}

}  // namespace hybrid::io
