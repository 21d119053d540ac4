#include "batch/photographs/e57_images.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "core/error.hpp"
#include "core/log.hpp"
#include "io/e57/e57_photographs.hpp"
#include "io/output.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::batch {
namespace fs = std::filesystem;
namespace {

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code code;
  return a == b || fs::equivalent(a, b, code);
}

E57Frame frame_of(const fs::path& file, const io::E57File& opened) {
  E57Frame frame{file, {}};
  for (const io::E57Scan& scan : opened.contents().scans)
    frame.file_from_scan.push_back(scan.world_from_scan.value_or(Pose()));
  return frame;
}

void read_file(const fs::path& file, bool salvage, E57PhotographSet& set) {
  const io::E57File opened(file, {.salvage = salvage});
  const io::E57Photographs found = io::e57_photographs(opened.contents());
  for (const std::string& note : found.notes) set.warnings.push_back(file.string() + ": " + note);
  for (const io::E57Photograph& one : found.photographs) {
    try {
      std::vector<std::string> damage;
      set.pixels.push_back(io::read_e57_photograph(opened, one, damage));
      for (const std::string& note : damage)
        set.warnings.push_back(io::place_of(opened, one.image) + ": " + note);
    } catch (const Error& error) {
      if (!salvage || error.kind() != ErrorKind::input) throw;
      set.warnings.push_back(fmt::format("{}: left out", error.what()));
      continue;
    }
    set.cameras.push_back(one.photograph);
    set.anchors.push_back({file, one.scan, one.photograph.cam_from_world.inverse()});
  }
  set.frames.push_back(frame_of(file, opened));
}

// Images of two files may have one name.
void make_unique(E57PhotographSet& set) {
  std::map<std::string, int> uses;
  for (const Photograph& camera : set.cameras) ++uses[camera.name];
  std::set<std::string> taken;
  for (std::size_t i = 0; i < set.cameras.size(); ++i) {
    std::string& name = set.cameras[i].name;
    if (uses[name] > 1) name = set.anchors[i].file.stem().string() + "-" + name;
    const std::string wanted = name;
    for (int number = 2; !taken.insert(name).second; ++number) name = fmt::format("{}-{}", wanted, number);
  }
}

// The world's frame in the file's, from one of its scans.
std::optional<Pose> world_from_file(const E57Frame& frame, const PlacedScan& scan) {
  if (!same_file(scan.file, frame.file) || scan.index >= frame.file_from_scan.size()) return {};
  return scan.world_from_scan * frame.file_from_scan[scan.index].inverse();
}

}  // namespace

E57PhotographSet read_e57_photographs(const std::vector<fs::path>& files, bool salvage) {
  E57PhotographSet set;
  for (const fs::path& file : files) read_file(file, salvage, set);
  if (set.cameras.empty())
    fail_input(
        "{}: expected images with a camera (pinhole, spherical or cylindrical), found none; hybrid info "
        "tells what it holds",
        files.front().string());
  make_unique(set);
  return set;
}

PlacedCamera place_camera(const E57Anchor& anchor, const std::vector<E57Frame>& frames,
                          const std::vector<PlacedScan>& scans) {
  const auto frame = std::find_if(frames.begin(), frames.end(),
                                  [&](const E57Frame& one) { return one.file == anchor.file; });
  std::optional<Pose> found;
  std::string with = "file frame";
  for (const PlacedScan& scan : scans) {
    const bool its_own = anchor.scan && scan.index == *anchor.scan;
    if (found && !its_own) continue;
    if (const auto pose = world_from_file(*frame, scan)) {
      found = pose;
      with = "scan " + scan.id;
      if (its_own) break;
    }
  }
  Pose world_from_cam = found.value_or(Pose()) * anchor.file_from_cam;
  world_from_cam.scale = 1;  // the centre moves with a scale, the picture does not change
  return {world_from_cam.inverse(), with};
}

// The picture of an image that is for people alone.
std::optional<io::E57Representation> reference_of(const io::E57Image& image) {
  if (image.projection == io::E57Projection::visual_reference)
    return io::E57Representation{.png = image.png, .picture = image.picture};
  for (const io::E57Representation& other : image.others)
    if (other.projection == io::E57Projection::visual_reference) return other;
  return {};
}

void write_references(const fs::path& folder, const fs::path& file, std::size_t scan, bool salvage) {
  if (io::lower_case(file.extension().string()) != ".e57") return;
  const io::E57File opened(file, {.salvage = salvage});
  const io::E57Contents& contents = opened.contents();
  std::set<std::string> taken;
  for (std::size_t i = 0; i < contents.images.size(); ++i) {
    const io::E57Image& image = contents.images[i];
    const auto reference = reference_of(image);
    if (!reference || reference->picture.length == 0) continue;
    std::size_t owner = 0;
    for (std::size_t k = 0; k < contents.scans.size(); ++k)
      if (!image.scan_guid.empty() && contents.scans[k].guid == image.scan_guid) owner = k;
    if (owner != scan) continue;
    std::string name = io::safe_name(image.name, fmt::format("image-{}", i));
    const std::string extension = io::lower_case(fs::path(name).extension().string());
    if (extension == ".jpg" || extension == ".jpeg" || extension == ".png")
      name.resize(name.size() - extension.size());
    std::string unique = name;
    for (int number = 2; !taken.insert(unique).second; ++number) unique = fmt::format("{}-{}", name, number);
    try {
      const std::vector<char> bytes = opened.read_blob(reference->picture, io::place_of(opened, i));
      io::write_text(folder / ("reference-" + unique + (reference->png ? ".png" : ".jpg")),
                     std::string(bytes.begin(), bytes.end()));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      log::warning("{}: its picture is not extracted", error.what());
    }
  }
}

}  // namespace hybrid::batch
