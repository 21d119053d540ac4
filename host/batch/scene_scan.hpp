#pragma once
#include <string>
#include <vector>

#include "batch/scan_unit.hpp"
#include "io/scan_entry.hpp"
#include "io/scene_file.hpp"

namespace hybrid::batch {

// Reads a scan of a scene, places its scanner as the scene file says, and runs the planes stages on it.
ProcessedScan make_planes(device::Queue& queue, const std::string& id, const io::SceneScan& entry,
                          const io::ScanEntry& scan_entry, const StageOptions& options, Progress& progress);

// Gives every scan of a scene its id, in the order of the scene file and of the scans in each file. An id
// that the scene file gives is not free for a scan that is named after its file.
class ScanNames {
 public:
  explicit ScanNames(const io::SceneFile& scene);
  // Of scan `index` of the `count` that the entry stands for.
  std::string next(const io::SceneScan& entry, int index, int count);

 private:
  std::vector<std::string> taken_;
};

}  // namespace hybrid::batch
