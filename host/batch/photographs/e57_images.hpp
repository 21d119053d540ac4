#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"

namespace hybrid::batch {

// Where a photograph out of an E57 file stands before its place in the world is known.
struct E57Anchor {
  std::filesystem::path file;
  std::optional<std::size_t> scan;  // index in the file of the scan that it was taken with
  Pose file_from_cam;
};

// An E57 file's scans as the file places them.
struct E57Frame {
  std::filesystem::path file;
  std::vector<Pose> file_from_scan;
};

struct E57PhotographSet {
  std::vector<Photograph> cameras;  // the world of their poses is the file's frame
  std::vector<Image8> pixels;
  std::vector<E57Anchor> anchors;  // one per camera
  std::vector<E57Frame> frames;    // one per file
  std::vector<std::string> warnings;
};
// The photographs of all files, in file order. A name that occurs twice gets the file's stem in front. In
// salvage a picture that cannot be read is left out, with a warning. Throws ErrorKind::input naming file,
// image and byte, and when there is no photograph at all.
E57PhotographSet read_e57_photographs(const std::vector<std::filesystem::path>& files, bool salvage);

// A scan of the scene whose pose in the world is known.
struct PlacedScan {
  std::filesystem::path file;
  std::size_t index = 0;  // in the file
  std::string id;
  Pose world_from_scan;
};
// cam_from_world of one photograph, and what decided it, for the summary. An image goes with the scan that it
// was taken with, as registration placed it: what was fixed to the scanner stays so. Without such a scan it
// goes with the first placed scan of its file; without any, the file's frame is the world's.
struct PlacedCamera {
  Pose cam_from_world;
  std::string with;  // "scan west", or "file frame"
};
PlacedCamera place_camera(const E57Anchor& anchor, const std::vector<E57Frame>& frames,
                          const std::vector<PlacedScan>& scans);

// Writes the visual references (images without a camera) that belong to one scan of an E57 file, bytes as
// they are, to folder/reference-<name>.jpg or .png; those of no scan belong to the first. Other files than
// E57 have none. A picture that cannot be read is a warning: no result depends on it.
void write_references(const std::filesystem::path& folder, const std::filesystem::path& file,
                      std::size_t scan, bool salvage);

}  // namespace hybrid::batch
