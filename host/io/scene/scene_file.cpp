#include "io/scene/scene_file.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <unordered_map>

#include "core/error.hpp"
#include "core/suggest.hpp"
#include "geometry/camera.hpp"
#include "io/read_scan.hpp"
#include "io/scene/implied_scene.hpp"
#include "io/scene/map_shift.hpp"
#include "io/scene/scene_path.hpp"
#include "io/scene/scene_table.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

SceneLandmark read_landmark(const SceneTable& table) {
  SceneLandmark result;
  result.line = table.line();
  result.scan = table.point("scan");
  result.pixel = table.index_pair("pixel");
  result.model = table.point("model");
  result.vertex = table.index("vertex");
  result.snap = table.flag("snap", true);
  if (result.scan.has_value() == result.pixel.has_value())
    table.fail_table("expected one of scan = [x, y, z] and pixel = [row, column], found {}",
                     result.scan ? "both" : "neither");
  if (result.model.has_value() == result.vertex.has_value())
    table.fail_table("expected one of model = [x, y, z] and vertex = index, found {}",
                     result.model ? "both" : "neither");
  return result;
}

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

DepthCamera read_depth_camera(const SceneTable& table, const fs::path& file) {
  if (!table.has("intrinsics"))
    table.fail_key("file", "a depth image ({}) needs intrinsics = [fx, fy, cx, cy] in pixels",
                   file.filename().string());
  const auto k = table.numbers("intrinsics", 4);
  DepthCamera camera{k[0], k[1], k[2], k[3]};
  if (!(camera.fx > 0) || !(camera.fy > 0))
    table.fail_key("intrinsics", "expected [fx, fy, cx, cy] with positive fx and fy, found {} and {}",
                   camera.fx, camera.fy);
  camera.scale = table.number("depth_scale").value_or(camera.scale);
  if (!(camera.scale > 0) || camera.scale > 1)
    table.fail_key("depth_scale",
                   "expected metres per unit, above 0 and at most 1 (0.001: millimetres), found {}",
                   camera.scale);
  return camera;
}

SceneTable::Names names_of_units() {
  SceneTable::Names names;
  for (const ScanUnit& unit : kScanUnits) names.push_back(unit.name);
  return names;
}

SceneScan read_scan(const SceneTable& table) {
  SceneScan result;
  result.line = table.line();
  result.id = table.folder_name("id").value_or("");
  result.file = table.required_path("file");
  result.index = table.index("index");
  if (lower_extension(result.file) == ".png") result.depth = read_depth_camera(table, result.file);
  for (std::string_view key : {"intrinsics", "depth_scale"})
    if (table.has(key) && !result.depth)
      table.fail_key(key, "belongs to depth images (.png), found file = {}; remove it",
                     result.file.filename().string());
  for (std::string_view key : {"index", "scanner", "axes", "unit"})
    if (table.has(key) && result.depth)
      table.fail_key(key, "a depth image is one scan, taken where its camera stood; remove the key");
  for (const SceneTable& landmark : table.tables("landmarks", {"scan", "pixel", "model", "vertex", "snap"}))
    result.landmarks.push_back(read_landmark(landmark));
  result.pose = table.pose("pose");
  result.fixed = table.flag("fixed", false);
  result.scanner = table.point("scanner");
  result.unit_m = metres_of_unit(table.choice("unit", names_of_units(), "m"));
  result.axes =
      result.depth
          ? ScanAxes::camera
          : scan_axes_of(table.choice("axes", {kScanAxesNames.begin(), kScanAxesNames.end()}, "z-up"));
  if (result.fixed && !result.pose)
    table.fail_key("fixed", "expected a pose that is to be final, found none");
  if (result.pose && !result.landmarks.empty())
    table.fail_key("pose", "expected either a pose or landmarks as the start, found both; remove one");
  return result;
}

ScenePhotographPick read_photograph_pick(const SceneTable& table) {
  ScenePhotographPick result;
  result.line = table.line();
  result.photograph = table.text("photograph").value_or("");
  result.point = table.point("point");
  if (result.photograph.empty() != result.point.has_value())
    table.fail_table("expected one of photograph = \"name\" and point = [x, y, z], found {}",
                     result.point ? "both" : "neither");
  if (table.has("pixel")) {
    if (result.point) table.fail_key("pixel", "expected the photograph that it is in, found a point");
    const auto numbers = table.numbers("pixel", 2);
    result.pixel = {numbers[0], numbers[1]};
  }
  result.model = table.point("model");
  result.vertex = table.index("vertex");
  if (result.model.has_value() == result.vertex.has_value())
    table.fail_table("expected one of model = [x, y, z] and vertex = index, found {}",
                     result.model ? "both" : "neither");
  // No photograph is taken at a corner.
  result.snap = table.flag("snap", result.pixel || result.point);
  return result;
}

// Formats of one file may be given by its folder.
fs::path camera_path(CameraFormat format, const fs::path& given) {
  const char* name = format == CameraFormat::nerfstudio ? "transforms.json" : "bundle.out";
  std::error_code code;
  const bool one_file = format == CameraFormat::nerfstudio || format == CameraFormat::bundler;
  return one_file && fs::is_directory(given, code) ? given / name : given;
}

SceneFile::Photographs read_photographs(const SceneTable& table) {
  constexpr std::array kFormats{CameraFormat::colmap, CameraFormat::strecha, CameraFormat::bundler,
                                CameraFormat::nerfstudio, CameraFormat::e57};
  std::vector<std::string_view> given;
  SceneFile::Photographs result;
  for (CameraFormat format : kFormats) {
    if (!table.has(name_of(format))) continue;
    given.push_back(name_of(format));
    result.cameras.format = format;
  }
  if (given.size() != 1)
    table.fail_table("expected exactly one of colmap, strecha, bundler, nerfstudio, e57, found {}",
                     given.empty() ? "none" : fmt::format("{}", fmt::join(given, ", ")));
  result.world_from_photographs = table.pose("world_from_photographs");
  if (result.cameras.format == CameraFormat::e57) {
    if (table.has("images"))
      table.fail_key("images", "the photographs lie in the E57 file itself; remove the key");
    if (table.has("landmarks"))
      table.fail_key("landmarks",
                     "photographs in E57 files go with their scans; remove the key, or place them by "
                     "world_from_photographs");
    result.e57_files = table.paths("e57");
    result.cameras.path = result.e57_files.front();
    return result;
  }
  result.cameras.path = camera_path(result.cameras.format, table.required_path(given.front()));
  for (const SceneTable& pick :
       table.tables("landmarks", {"photograph", "pixel", "point", "model", "vertex", "snap"}))
    result.landmarks.push_back(read_photograph_pick(pick));
  if (result.world_from_photographs && !result.landmarks.empty())
    table.fail_key("landmarks", "expected either these or world_from_photographs, found both; remove one");
  // Nerfstudio's names start at its own file's folder.
  result.images = result.cameras.format == CameraFormat::nerfstudio && !table.has("images")
                      ? result.cameras.path.parent_path()
                      : table.required_path("images");
  return result;
}

SceneOptions read_options(const SceneTable& root, std::string_view section) {
  SceneOptions result;
  const auto table = root.table(section, {});
  if (!table) return result;
  const auto& edits = scene_edit_keys();
  for (const std::string& key : table->keys()) {
    if (section == "edit" && std::find(edits.begin(), edits.end(), key) != edits.end()) continue;
    if (section == "edit" && table->holds_tables(key))
      table->fail_key(key, "{}", unknown_name("key", key, edits));
    result[key] = {table->line_of(key), table->option(key)};
  }
  return result;
}

std::array<int, 2> read_view_size(const SceneTable& table, std::array<int, 2> fallback) {
  constexpr int kLargest = 32768;
  const auto size = table.index_pair("size").value_or(fallback);
  for (int side : size)
    if (side < 1 || side > kLargest)
      table.fail_key("size", "expected width and height from 1 to {} pixels, found {} x {}", kLargest,
                     size[0], size[1]);
  return size;
}

void read_view_camera(const fs::path& file, const SceneTable& table, SceneView& view) {
  const bool photograph = table.has("photograph"), free = table.has("eye") || table.has("target");
  if (photograph == free)
    table.fail_table("expected either photograph or eye and target, found {}",
                     photograph ? "both" : "neither");
  if (photograph) {
    view.photograph = table.required_text("photograph");
    for (std::string_view key : {"up", "fov_deg", "size", "projection"})
      if (table.has(key)) table.fail_key(key, "belongs to eye and target; the photograph has its own camera");
    return;
  }
  for (std::string_view key : {"eye", "target"})
    if (!table.has(key)) table.fail_table("expected eye and target, found no {}", key);
  view.eye = *table.point("eye");
  view.target = *table.point("target");
  view.up = table.point("up").value_or(view.up);
  read_view_projection(table, view);
  // Its checks of the numbers' sense, made here where the line is known.
  with_context(fmt::format("{}:{}", file.string(), view.line), [&] { camera_of(view); });
}

SceneView read_view(const fs::path& file, const SceneTable& table) {
  SceneView result;
  result.line = table.line();
  table.required_text("name");
  result.name = *table.folder_name("name");
  read_view_options(table, result);
  read_view_camera(file, table, result);
  return result;
}

// Line of the first use of each name; a second use is an error at `line`.
void check_unique(const SceneTable& table, std::string_view key, const std::string& name,
                  std::unordered_map<std::string, int>& lines) {
  if (name.empty()) return;
  const auto [first, is_new] = lines.emplace(name, table.line_of(key));
  if (!is_new)
    table.fail_key(key, "expected a name of its own, found \"{}\" again (line {})", name, first->second);
}

// A view through a photograph that it leaves out writes <name>-pair.png, too.
void check_pairs(const std::vector<SceneView>& views, const std::unordered_map<std::string, int>& lines,
                 const SceneFile& scene) {
  for (const SceneView& view : views) {
    if (view.photograph.empty() || !view.texture ||
        std::find(view.leave_out.begin(), view.leave_out.end(), view.photograph) == view.leave_out.end())
      continue;
    if (const auto other = lines.find(view.name + "-pair"); other != lines.end())
      fail_at(
          scene.path, other->second,
          "name: \"{}\" is what the view \"{}\" (line {}), which leaves out its own photograph, calls its "
          "comparison with it; choose another name",
          other->first, view.name, view.line);
  }
}

void read_scene_table(const SceneTable& root, SceneFile& scene) {
  scene.name = scene.path.stem().string();
  const auto table = root.table("scene", {"name", "levelled", "crs", "shift", "truth"});
  if (!table) return;
  scene.name = table->text("name").value_or(scene.name);
  scene.levelled = table->flag("levelled", false);
  scene.crs = table->text("crs").value_or("");
  scene.shift = table->point("shift").value_or(scene.shift);
  scene.truth = table->path("truth");
}

void read_model(const SceneTable& root, SceneFile& scene) {
  const auto table = root.table("model", {"file", "unit", "up"});
  if (!table) return;
  SceneFile::Model& model = *(scene.model = SceneFile::Model{});
  model.file = table->required_path("file");
  model.unit = table->choice("unit", {"m", "mm", "arbitrary"}, model.unit);
  model.up = table->choice("up", {"z", "y"}, model.up);
  const auto scale = scene.registration.find("scale");
  if (model.unit == "arbitrary" &&
      (scale == scene.registration.end() || scale->second.value != OptionValue(std::string("free"))))
    table->fail_key("unit", "\"arbitrary\" needs [register] scale = \"free\"");
}

SceneFile read_scene(const fs::path& file, const toml::table& document) {
  const SceneTable root(file, "", document,
                        {"scene", "scan", "model", "photographs", "planes", "register", "edit", "render",
                         "export", "view", "path"});
  SceneFile scene;
  scene.path = file;
  read_scene_table(root, scene);
  std::unordered_map<std::string, int> ids, names;
  for (const SceneTable& table :
       root.tables("scan", {"id", "file", "index", "landmarks", "pose", "fixed", "scanner", "axes", "unit",
                            "intrinsics", "depth_scale"})) {
    scene.scans.push_back(read_scan(table));
    check_unique(table, "id", scene.scans.back().id, ids);
  }
  scene.planes = read_options(root, "planes");
  scene.registration = read_options(root, "register");
  scene.edit = read_options(root, "edit");
  if (const auto table = root.table("edit", {})) scene.edits = read_scene_edits(*table);
  scene.render = read_options(root, "render");
  scene.exporting = read_options(root, "export");
  scene.has_export = root.has("export");
  read_model(root, scene);
  if (const auto table = root.table("photographs", {"colmap", "strecha", "bundler", "nerfstudio", "e57",
                                                    "images", "world_from_photographs", "landmarks"}))
    scene.photographs = read_photographs(*table);
  for (const SceneTable& table :
       root.tables("view", {"name", "photograph", "eye", "target", "up", "fov_deg", "projection", "size",
                            "show", "texture", "cameras", "leave_out"})) {
    scene.views.push_back(read_view(file, table));
    check_unique(table, "name", scene.views.back().name, names);
  }
  for (const SceneTable& table : root.tables("path", scene_path_keys())) {
    const std::vector<SceneView> frames = read_scene_path(file, table);
    check_unique(table, "name", frames.front().path, names);
    scene.views.insert(scene.views.end(), frames.begin(), frames.end());
  }
  check_pairs(scene.views, names, scene);
  if (scene.model) scene.model->shift = scene.shift;
  if (scene.photographs) scene.photographs->shift = scene.shift;
  take_off_shift(scene);
  if (scene.scans.empty() && !scene.model)
    fail_at(file, 1, "expected at least one [[scan]] or a [model], found neither");
  return scene;
}

}  // namespace

void read_view_options(const SceneTable& table, SceneView& view) {
  view.size = read_view_size(table, view.size);
  view.show = table.choice("show", {"proxy", "scan", "both"}, view.show);
  view.texture = table.flag("texture", view.texture);
  view.cameras = table.flag("cameras", view.cameras);
  view.leave_out = table.texts("leave_out");
}

void read_view_projection(const SceneTable& table, SceneView& view) {
  view.panorama =
      table.choice("projection", {"perspective", "equirectangular"}, "perspective") == "equirectangular";
  if (!view.panorama) {
    view.fov_deg = table.number("fov_deg").value_or(view.fov_deg);
    return;
  }
  if (table.has("fov_deg"))
    table.fail_key("fov_deg", "belongs to projection = \"perspective\"; a panorama shows all directions");
  if (!table.has("size")) view.size = {2048, 1024};
}

Photograph camera_of(const SceneView& view) {
  const auto [width, height] = view.size;
  return view.panorama ? look_around(view.eye, view.target, view.up, width, height)
                       : look_at(view.eye, view.target, view.up, view.fov_deg, width, height);
}

SceneFile read_scene_file(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored) || has_scan_extension(file)) return read_scene_of(file);
  const std::string text = read_plain_text(file);
  try {
    const toml::table document = toml::parse(text, file.string());
    return read_scene(file, document);
  } catch (const toml::parse_error& error) {
    fail_input("{}:{}:{}: no valid TOML: {}", file.string(), error.source().begin.line,
               error.source().begin.column, error.description());
  }
}

std::string default_scan_id(const fs::path& file, int index, int count,
                            const std::vector<std::string>& taken) {
  std::string id = file.stem().string();
  // Every scan's range image has this name: its folder tells which one it is.
  if (file.filename() == "range.exr" && file.has_parent_path()) id = file.parent_path().filename().string();
  if (id.empty() || id == "." || id == "..") id = "scan";
  if (count > 1) id += fmt::format("-{}", index);
  std::string unique = id;
  for (int number = 2; std::find(taken.begin(), taken.end(), unique) != taken.end(); ++number)
    unique = fmt::format("{}-{}", id, number);
  return unique;
}

}  // namespace hybrid::io
