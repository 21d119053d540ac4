#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "batch/registration/registration_unit.hpp"
#include "batch/render_unit.hpp"
#include "batch/stage_options.hpp"

namespace hybrid::batch {

// What an export is made of; everything must outlive the SceneExport.
struct ExportInputs {
  const io::SceneFile& scene;
  const PolygonModel& model;  // may have no faces
  const PhotographSet& photographs;
  const std::vector<ScanProduct>& products;
  const std::vector<std::optional<ScanRegistration>>& registrations;
  const WorldContours& contours;
  const std::vector<ScanRemains>& remains;
  std::function<std::optional<Scan>(std::size_t)> read_scan;  // a product's input, in the scanner's frame
  const StageOptions& options;
};

// Writes DIR/export/ (METHOD 11), format by format. What cannot be made for want of faces, photographs or
// registered scans is left out and said in `notes` and the log. What several formats share is made once, when
// first needed. Files of an earlier export that this one does not write are removed at the end.
class SceneExport {
 public:
  SceneExport(device::Queue& queue, const ExportInputs& inputs, const std::filesystem::path& out);
  ~SceneExport();

  // In the order in which they are made.
  std::vector<std::string> formats() const;
  // Throws what the writers throw; the other formats can still be written.
  void write(const std::string& format);
  // Writes export/index.json, which lists the files; returns the figures for summary.json.
  nlohmann::ordered_json finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hybrid::batch
