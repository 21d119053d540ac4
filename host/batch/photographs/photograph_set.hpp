#pragma once
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batch/photographs/e57_images.hpp"
#include "batch/photographs/kept_photographs.hpp"
#include "io/scene/scene_file.hpp"
#include "stages/registration/photograph_landmarks.hpp"

namespace hybrid::batch {

// The photographs of a scene: cameras in the model's frame, pixels decoded and checked against their cameras'
// sizes; as many decoded photographs as KeptPhotographs' budget holds are in memory.
struct PhotographSet {
  std::vector<Photograph> cameras;
  std::shared_ptr<KeptPhotographs> pixels = std::make_shared<KeptPhotographs>();
  std::vector<std::filesystem::path> files;
  // Photographs out of E57 files, whose cameras stand in the file's frame until place_photographs.
  std::vector<E57Anchor> anchors;  // one per camera, or none
  std::vector<E57Frame> frames;
  std::vector<std::string> placed_with;  // per camera, after place_photographs
  std::optional<stages::PhotographFit> landmarks;
  std::string frame_hint;             // io::CameraFile's, where the scene file says nothing of the frame
  std::vector<std::string> warnings;  // for the scene's
};

// Cameras of files are in the world then, but for place_by_landmarks. In salvage a picture that is not there,
// cannot be read, or has not its camera's size, is left out, with a warning; one at least must be good.
PhotographSet read_photographs(const io::SceneFile::Photographs& section, bool salvage = false,
                               std::size_t decoded_bytes = std::size_t{1} << 30);

// Cameras out of their own frame into the world, by the section's landmarks; does nothing without them. A
// warning where a pick is left out. Throws ErrorKind::input naming the landmark and its line: a photograph or
// vertex that is not there, and as stages::fit_photographs does.
void place_by_landmarks(const io::SceneFile::Photographs& section, const PolygonModel& model,
                        double snap_tolerance_m, PhotographSet& photographs);

// Cameras out of E57 files into the world: by world_from_photographs where the scene file has it, else with
// the scans (place_camera). Does nothing to other photographs.
void place_photographs(const io::SceneFile::Photographs& section, const std::vector<PlacedScan>& scans,
                       PhotographSet& photographs);

// Throws ErrorKind::input when no camera has this name, with the nearest.
std::size_t photograph_index(const std::vector<Photograph>& cameras, const std::string& name);

// Adds to summary.json what places them: `photographs` of E57 files, `photograph_landmarks` pick by pick.
void describe_photographs(const io::SceneFile::Photographs& section, const PhotographSet& photographs,
                          nlohmann::ordered_json& summary);

}  // namespace hybrid::batch
