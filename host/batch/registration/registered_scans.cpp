#include "batch/registration/registered_scans.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "batch/export/export_points.hpp"
#include "core/error.hpp"
#include "core/log.hpp"
#include "io/scan_writers.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

const std::set<std::string> kFormats = {"e57", "las", "pcd", "ply", "pts", "ptx"};

// A float has steps of 8 micrometres there: finer than any scanner, coarser than what registration claims.
constexpr double kFineFloats_m = 100;

fs::path file_of(const fs::path& folder, const std::string& format) {
  return folder / ("registered." + format);
}

void remove_others(const fs::path& folder, const std::set<std::string>& formats) {
  std::error_code ignored;
  for (const auto& format : kFormats)
    if (!formats.count(format)) fs::remove(file_of(folder, format), ignored);
}

}  // namespace

std::set<std::string> registered_formats(const std::string& write) {
  std::set<std::string> formats;
  std::string word;
  for (const char c : write + ",") {
    if (c != ',' && c != ' ') {
      word += c;
      continue;
    }
    if (kFormats.count(word))
      formats.insert(word);
    else if (!word.empty())
      fail_input("write: expected some of {}, separated by blanks or commas, found \"{}\"",
                 fmt::join(kFormats, ", "), word);
    word.clear();
  }
  return formats;
}

Scan moved_into_world(Scan scan, const Pose& world_from_scan, const io::SceneFile& scene) {
  Pose pose = world_from_scan;
  pose.translation += scene.shift;
  const Vec3 old_origin = scan.origin;
  const Vec3 centre = pose * old_origin;
  scan.origin =
      centre.norm() > kFineFloats_m ? Vec3(centre.array().round()) : Vec3::Zero();  // scans surround it
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (auto& p : scan.points) {
    const bool finite = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
    if (!finite) {
      p = {kNan, kNan, kNan};
      continue;
    }
    const Vec3 moved = pose * (old_origin + Vec3(p[0], p[1], p[2])) - scan.origin;
    for (int axis = 0; axis < 3; ++axis) p[static_cast<std::size_t>(axis)] = static_cast<float>(moved[axis]);
  }
  scan.world_from_scan.reset();
  scan.range_grid.reset();
  scan.grid_rows = scan.grid_cols = 0;
  scan.node.clear();
  scan.crs = scene.crs;
  scan.crs_records.clear();
  return scan;
}

Json write_registered_scan(const fs::path& folder, const std::set<std::string>& formats,
                           const std::function<Scan()>& read, const Pose& world_from_scan,
                           const io::SceneFile& scene) {
  remove_others(folder, formats);
  Json files = Json::array();
  for (const auto& format : formats) {
    const fs::path file = file_of(folder, format);
    const io::ScanWriter& writer = io::writer_for(file);
    Scan read_scan = read();
    if (writer.pose)
      set_registered_pose(read_scan, world_from_scan, scene);
    else
      read_scan = moved_into_world(std::move(read_scan), world_from_scan, scene);
    auto scan = std::make_unique<io::ScanInMemory>(std::move(read_scan));
    const auto losses = io::losses_of(writer, *scan);
    const std::uint64_t samples = writer.no_returns ? scan->count() : scan->facts().returns;
    for (const auto& change : losses.changed) log::info("{}: {}", file.filename().string(), change);
    writer.write(file, [&] { return std::move(scan); });
    files.push_back({{"file", file.filename().string()},
                     {"bytes", fs::file_size(file)},
                     {"samples", samples},
                     {"dropped", losses.dropped},
                     {"changed", losses.changed}});
  }
  return files;
}

void remove_registered_scan(const fs::path& folder) {
  remove_others(folder, {});
}

}  // namespace hybrid::batch
