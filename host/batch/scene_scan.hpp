#pragma once
#include <string>
#include <vector>

#include "batch/scan_unit.hpp"
#include "io/scene/scan_entry.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::batch {

// The scans that a [[scan]] stands for: one of a depth image, else those of its file or the one of its index.
// Throws as io::list_scans() and io::scan_at().
std::vector<io::ScanEntry> list_scene_scans(const io::SceneScan& entry, bool salvage);
// The same of one of the scene's, whose landmarks must be those of one scan. Throws ErrorKind::input beside.
std::vector<io::ScanEntry> list_scans_of(const io::SceneFile& scene, const io::SceneScan& entry,
                                         bool salvage);
// What an entry goes by before its scans are known: its id or its file's name.
std::string given_name(const io::SceneScan& entry);
// One of them, its scanner placed as the scene file says; warns where that is doubtful.
Scan read_scene_scan(const std::string& id, const io::SceneScan& entry, const io::ScanEntry& scan_entry);

// Reads a scan of a scene and runs the planes stages on it.
ProcessedScan make_planes(device::Queue& queue, const std::string& id, const io::SceneScan& entry,
                          const io::ScanEntry& scan_entry, const StageOptions& options, Progress& progress,
                          const EditImage& edit = {});

// Gives every scan of a scene its id, in the order of the scene file and of the scans in each file. An id
// that the scene file gives is not free for a scan that is named after its file.
class ScanNames {
 public:
  explicit ScanNames(const io::SceneFile& scene);
  // Of scan `index` of the `count` that the entry stands for.
  std::string next(const io::SceneScan& entry, int index, int count);
  // All that are given or reserved by now.
  const std::vector<std::string>& taken() const { return taken_; }

 private:
  std::vector<std::string> taken_;
};

// The ids of all scans of a scene, known before any is read; nothing where a file cannot be listed.
std::optional<std::vector<std::string>> scan_ids(const io::SceneFile& scene, bool salvage);

}  // namespace hybrid::batch
