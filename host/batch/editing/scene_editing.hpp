#pragma once
#include <map>

#include "batch/editing/edit_unit.hpp"
#include "stages/rendering/opening_contents.hpp"

namespace hybrid::batch {

// The edit stage of one run: does the edits as the run comes to them and writes what they made.
class SceneEditing {
 public:
  // Of the model as read.
  PolygonModel edit(const io::SceneFile& scene, const PolygonModel& model,
                    const std::vector<io::ObjFaceNames>& names);
  // Of a scan's range image, of the samples beside its grid, and of all where the scan is kept
  // (georeferenced ones).
  void edit_depths(const io::SceneFile& scene, const std::string& id, RangeImage& image, Scan& scan);
  // Of a registered scan and of its samples beside the grid.
  void clip(const io::SceneFile& scene, const ScanRegistration& registration, const ScanRemains& remains,
            ScanProduct& product);
  // After the last of them: warns of clips that dropped nothing.
  void finish_clips(const io::SceneFile& scene) const { warn_of_idle_clips(scene, dropped_); }
  // Looks for openings, where the options say so, and cuts them into the model; those that glass closes get
  // their panes, and samples seen through them are strays. Displacement maps of what is left of its faces.
  void openings(const stages::OpeningOptions& options, const stages::DisplacementOptions& displacement,
                std::vector<ScanProduct>& products,
                const std::vector<std::optional<ScanRegistration>>& registrations, PolygonModel& model);
  // Those that were cut and have glass, of the model that they were cut into.
  std::vector<stages::GlazedOpening> glazed_openings(const PolygonModel& model) const;

  // model/edited.obj and edited.png where the model was changed, model/openings.json and
  // model/openings/<face>.png where openings were looked for, model/displacement/<face>.exr,
  // scans/<id>/clipped.png and depth-edits.png; removes those of an earlier run.
  void write(device::Queue& queue, const std::filesystem::path& out, const std::vector<ScanProduct>& products,
             const PolygonModel& model) const;
  // For summary.json; null where nothing was edited.
  nlohmann::ordered_json figures() const;

 private:
  void write_openings(const std::filesystem::path& out) const;
  void write_displacements(const std::filesystem::path& out, const PolygonModel& model) const;

  PolygonModel before_, uncut_;  // as read; as edited before openings were cut
  bool changed_ = false;
  std::vector<std::optional<std::int64_t>> dropped_;  // per clip
  stages::OpeningOptions options_;
  stages::Openings found_;
  std::vector<stages::DisplacementMap> displacements_;
  std::map<std::string, Image8> reliefs_;
  nlohmann::ordered_json model_ = nlohmann::ordered_json::object(), scans_ = nlohmann::ordered_json::object();
};

}  // namespace hybrid::batch
