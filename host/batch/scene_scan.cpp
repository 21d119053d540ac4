#include "batch/scene_scan.hpp"

#include "core/error.hpp"
#include "core/log.hpp"
#include "io/grid_scan.hpp"
#include "io/read_scan.hpp"
#include "io/scan_frame.hpp"

namespace hybrid::batch {
namespace {

// In metres, its axes the scanner's, as far as the scene file says.
bool is_in_scanner_frame(const io::SceneScan& entry) {
  return !entry.scanner && entry.axes == io::ScanAxes::z_up && entry.unit_m == 1;
}

}  // namespace

std::vector<io::ScanEntry> list_scene_scans(const io::SceneScan& entry, bool salvage) {
  if (entry.depth) return std::vector<io::ScanEntry>(1);
  auto listed = io::list_scans(entry.file, {.salvage = salvage});
  if (entry.index) return {io::scan_at(entry.file, listed, static_cast<std::size_t>(*entry.index))};
  return listed;
}

std::vector<io::ScanEntry> list_scans_of(const io::SceneFile& scene, const io::SceneScan& entry,
                                         bool salvage) {
  auto listed = list_scene_scans(entry, salvage);
  if (listed.size() > 1 && !entry.landmarks.empty())
    fail_input(
        "{}:{}: expected the landmarks of one scan, found {} scans in {}; give each scan of the file a "
        "[[scan]] with its `index`, landmarks in the one they belong to",
        scene.path.string(), entry.line, listed.size(), entry.file.filename().string());
  return listed;
}

std::string given_name(const io::SceneScan& entry) {
  return entry.id.empty() ? entry.file.filename().string() : entry.id;
}

Scan read_scene_scan(const std::string& id, const io::SceneScan& entry, const io::ScanEntry& scan_entry) {
  Scan scan =
      entry.depth ? io::read_depth_image(entry.file, *entry.depth) : io::read_scan(entry.file, scan_entry);
  with_context(entry.file.string(), [&] {
    io::scale_lengths(scan, entry.unit_m);
    if (entry.scanner) io::place_scanner(scan, *entry.scanner);
    if (!entry.depth) io::turn_axes(scan, entry.axes);
  });
  if (const std::string doubt = io::doubt_of_scanner(scan); !doubt.empty())
    log::warning("scan {}: {}", id, doubt);
  return scan;
}

ProcessedScan make_planes(device::Queue& queue, const std::string& id, const io::SceneScan& entry,
                          const io::ScanEntry& scan_entry, const StageOptions& options, Progress& progress,
                          const EditImage& edit) {
  const auto named = [&](const auto& body) { return with_context(entry.file.string(), body); };
  if (!edit && is_in_scanner_frame(entry) && options.resample.min_range_m == 0)
    if (auto grid = io::read_grid_scan(entry.file, scan_entry))
      return named([&] { return process_scan(queue, id, *std::move(grid), options, progress); });
  Scan scan = read_scene_scan(id, entry, scan_entry);
  return named([&] { return process_scan(queue, id, std::move(scan), options, progress, edit); });
}

ScanNames::ScanNames(const io::SceneFile& scene) {
  for (const auto& entry : scene.scans)
    if (!entry.id.empty()) taken_.push_back(entry.id);
}

std::string ScanNames::next(const io::SceneScan& entry, int index, int count) {
  if (!entry.id.empty() && count == 1) return entry.id;  // taken by itself
  const std::filesystem::path named =
      entry.id.empty() ? entry.file : std::filesystem::path(entry.id + ".scan");
  taken_.push_back(io::default_scan_id(named, index, count, taken_));
  return taken_.back();
}

std::optional<std::vector<std::string>> scan_ids(const io::SceneFile& scene, bool salvage) {
  ScanNames names(scene);
  try {
    for (const auto& entry : scene.scans) {
      const auto count = static_cast<int>(list_scene_scans(entry, salvage).size());
      for (int i = 0; i < count; ++i) names.next(entry, i, count);
    }
  } catch (const Error&) {  // the scan's own unit tells
    return std::nullopt;
  }
  return names.taken();
}

}  // namespace hybrid::batch
