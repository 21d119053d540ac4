#include "io/colmap.hpp"
#include "io/obj.hpp"
#include "io/reader_rows.hpp"
#include "io/scene_file.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

// The faces stand first, so that every vertex that is cut off is missed.
ReaderRow obj_row() {
  ReaderRow row{.name = "obj", .file = "lid.obj"};
  row.good = fixed_file(
      "# box lid\no lid\nf 1/1/1 2//1 3/1 4\ng rim\nf 5 6 \\\n 7 8\n"
      "v 0 0 0\nv 1.5 0 0\nv 1.5 1 0\nv 0 1 0\nv 0 0 1\nv 1.5 0 1\nv 1.5 1 1\nv 0 1 1\n");
  row.read = [](const fs::path& file) {
    const PolygonModel model = io::read_obj(file);
    std::string text;
    for (const Vec3& v : model.vertices) text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
    for (const Face& face : model.faces) {
      tell(text, face.name, face.outer);
      for (const auto& hole : face.holes) tell(text, "hole", hole);
    }
    return text;
  };
  row.text = true;
  row.counts_too_high = {{"7 8\n", "7 9\n"}, {"7 8\n", "7 -1\n"}};
  row.absurd_sizes = {
      {"7 8\n", "7 4294967296\n"}, {"7 8\n", "7 99999999999999999999\n"}, {"1.5 0 0", "1e999 0 0"}};
  row.non_finite = {{"1.5 0 0", "nan 0 0"}, {"1.5 0 0", "-inf 0 0"}};
  return row;
}

// COLMAP text.

const std::string kCameras =
    "1 OPENCV 1296 1936 2435.38 2435.38 648.25 968.25 -0.0336422 0.0012345 0.00012345 0.0001\n";
const std::string kImages =
    "1 0.983789 0.00113517 0.176825 -0.0298644 -7.60712 0.428157 2.75243 1 folder/a long name with "
    "blanks.jpg\n\n";

ReaderRow colmap_cameras_row() {
  ReaderRow row{.name = "colmap_cameras", .file = "cameras.txt", .good = fixed_file(kCameras)};
  row.read = [](const fs::path& file) {
    std::string text;
    for (const io::ColmapCamera& camera : io::read_colmap_cameras(file.parent_path()))
      text += fmt::format("{} {} {} {} {} {} {}\n", camera.id, camera.model, camera.camera.width,
                          camera.camera.height, camera.camera.fx, camera.camera.k1, camera.camera.p2);
    return text;
  };
  row.free_name = false;
  row.text = true;
  row.counts_too_high = {{" OPENCV ", " FULL_OPENCV "}};
  row.counts_too_low = {{" OPENCV ", " RADIAL "}};
  row.absurd_sizes = {{"1296 1936", "2000000000 2000000000"}, {"1296 1936", "-1296 1936"}};
  row.non_finite = {{"968.25", "nan"}, {"0.0001\n", "inf\n"}};
  return row;
}

ReaderRow colmap_images_row() {
  ReaderRow row{.name = "colmap_images", .file = "images.txt"};
  row.good = [](const fs::path& folder) {
    write_file_beside(folder / "cameras.txt", kCameras);
    return kImages;
  };
  row.read = [](const fs::path& file) {
    std::string text;
    for (const Photograph& photograph : io::read_colmap(file.parent_path())) {
      tell(text, photograph.name, photograph.cam_from_world.rotation.coeffs());
      tell(text, "at", photograph.cam_from_world.translation);
    }
    return text;
  };
  row.free_name = false;
  row.text = true;
  row.counts_too_high = {{" 1 folder", " 2 folder"}, {"jpg\n\n", "jpg\n1 2\n"}};
  row.non_finite = {{"-7.60712", "nan"}, {"0.983789", "inf"}};
  return row;
}

ReaderRow scene_row() {
  ReaderRow row{.name = "scene", .file = "church hall.toml"};
  row.good = fixed_file(
      "scan = [\n  { id = \"west\", file = \"west.ply\", index = 0, landmarks = [\n"
      "    { scan = [1.0, 2.0, 3.0], model = [0.5, 0.25, 0.125] },\n    { pixel = [10, 20], vertex = 3 },\n  "
      "] "
      "},\n  { id = \"east\", file = \"east.ply\" },\n]\n");
  row.read = [](const fs::path& file) {
    std::string text;
    for (const auto& scan : io::read_scene_file(file).scans)
      text += fmt::format("{} {} {}\n", scan.id, scan.file.string(), scan.landmarks.size());
    return text;
  };
  row.text = true;
  row.lone_cr = false;  // not in TOML
  row.counts_too_high = {{"[10, 20]", "[10, 20, 30]"}};
  row.counts_too_low = {{"[1.0, 2.0, 3.0]", "[1.0, 2.0]"}};
  row.absurd_sizes = {{"vertex = 3", "vertex = 99999999999999999999"}, {"index = 0", "index = -1"}};
  row.non_finite = {{"0.125", "nan"}, {"1.0", "inf"}};
  return row;
}

}  // namespace

std::vector<ReaderRow> text_reader_rows() {
  return {obj_row(), colmap_cameras_row(), colmap_images_row(), scene_row()};
}

}  // namespace hybrid::testing
