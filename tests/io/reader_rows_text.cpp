#include "io/models/obj.hpp"
#include "io/reader_rows.hpp"
#include "io/scene/scene_file.hpp"

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
  return {obj_row(), scene_row()};
}

}  // namespace hybrid::testing
