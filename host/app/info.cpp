#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "io/cameras/read_cameras.hpp"
#include "io/e57/e57_photographs.hpp"
#include "io/models/model_info.hpp"
#include "io/models/obj.hpp"
#include "io/scan_info.hpp"

namespace hybrid::app {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int kSomeFailed = 3;

Json json_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Json scan_json(const io::ScanInfo& scan) {
  Json json = {{"format", scan.format}, {"name", scan.name}, {"structure", scan.structure}};
  if (!scan.problem.empty()) {
    json.update({{"points", scan.points}, {"damage", scan.problem}});
    return json;
  }
  json.update({{"points", scan.points},
               {"returns", scan.returns},
               {"rows", scan.grid_rows},
               {"cols", scan.grid_cols},
               {"minimum_m", json_of(scan.min_m)},
               {"maximum_m", json_of(scan.max_m)},
               {"range_m", {scan.min_range_m, scan.max_range_m}},
               {"intensity", scan.has_intensity},
               {"colour", scan.has_colour},
               {"unit", scan.unit.empty() ? Json() : Json(scan.unit)},
               {"crs", scan.crs.empty() ? Json() : Json(scan.crs)},
               {"notes", scan.notes}});
  json["world_from_scan"] = scan.world_from_scan ? Json(row_major(*scan.world_from_scan)) : Json();
  return json;
}

Json model_json(const io::ModelInfo& model) {
  Json faces = Json::array();
  for (const auto& face : model.faces) {
    faces.push_back({{"name", face.name},
                     {"vertices", face.vertices},
                     {"holes", face.holes},
                     {"area_m2", face.area_m2},
                     {"off_plane_m", face.off_plane_m}});
    if (!face.problem.empty()) faces.back()["problem"] = face.problem;
  }
  return {{"vertices", model.vertices},
          {"area_m2", model.area_m2},
          {"minimum_m", json_of(model.minimum)},
          {"maximum_m", json_of(model.maximum)},
          {"faces", faces}};
}

// The numbers of a calibration that are not zero, by name.
Json calibration_json(const io::CalibratedCamera& calibrated) {
  const Camera& c = calibrated.camera;
  Json json = {{"id", calibrated.id},
               {"model", calibrated.model},
               {"size", {c.width, c.height}},
               {"focal_length_px", {c.fx, c.fy}},
               {"principal_point_px", {c.cx, c.cy}}};
  const std::pair<const char*, double> distortion[] = {{"k1", c.k1}, {"k2", c.k2}, {"k3", c.k3},
                                                       {"k4", c.k4}, {"k5", c.k5}, {"k6", c.k6},
                                                       {"p1", c.p1}, {"p2", c.p2}};
  for (const auto& [name, value] : distortion)
    if (value != 0) json[name] = value;
  return json;
}

Json cameras_json(const io::CameraSource& source) {
  const io::CameraFile file = io::read_cameras(source);
  Json cameras = Json::array(), photographs = Json::array();
  for (const auto& camera : file.cameras) cameras.push_back(calibration_json(camera));
  for (const auto& photograph : file.photographs)
    photographs.push_back({{"name", photograph.name},
                           {"width", photograph.camera.width},
                           {"height", photograph.camera.height},
                           {"centre", json_of(photograph.centre())}});
  const io::CentreBox box = io::box_of_centres(file.photographs);
  return {{"format", io::name_of(source.format)}, {"cameras", cameras},
          {"photographs", photographs},           {"minimum", json_of(box.minimum)},
          {"maximum", json_of(box.maximum)},      {"notes", file.notes}};
}

bool holds_scans(const fs::path& file, bool salvage) {
  return !io::E57File(file, {.salvage = salvage}).contents().scans.empty();
}

// Every image of an E57 file, photograph or not.
Json images_json(const fs::path& file, bool salvage) {
  const io::E57File opened(file, {.salvage = salvage});
  const auto& contents = opened.contents();
  const auto found = io::e57_photographs(contents);
  Json images = Json::array();
  for (std::size_t i = 0; i < contents.images.size(); ++i) {
    const io::E57Image& image = contents.images[i];
    images.push_back(
        {{"name", image.name},
         {"type", io::name_of(image.projection)},
         {"picture", image.png ? "PNG" : "JPEG"},
         {"bytes", image.picture.length},
         {"size", {image.width, image.height}},
         {"mask", image.mask.has_value()},
         {"world_from_image", image.world_from_image ? Json(row_major(*image.world_from_image)) : Json()},
         {"scan", Json()},
         {"photograph", Json()}});
    for (std::size_t k = 0; k < contents.scans.size(); ++k)
      if (!image.scan_guid.empty() && contents.scans[k].guid == image.scan_guid) images.back()["scan"] = k;
    for (const auto& one : found.photographs)
      if (one.image == i) images.back()["photograph"] = one.photograph.name;
    if (!image.scan_guid.empty() && images.back()["scan"].is_null())
      images.back()["scan_guid"] = image.scan_guid;
    for (const io::E57Representation& other : image.others)
      images.back()["also"].push_back({{"type", io::name_of(other.projection)},
                                       {"picture", other.png ? "PNG" : "JPEG"},
                                       {"bytes", other.picture.length},
                                       {"size", {other.width, other.height}},
                                       {"mask", other.mask.has_value()}});
    images.back()["notes"] = image.notes;
  }
  if (images.empty()) return Json::object();
  return {{"images", images}, {"image_notes", found.notes}};
}

// What the file is follows from its name: a camera folder, a model, else a scan.
Json describe(const fs::path& file, bool salvage) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  Json json = {{"file", file.string()}};
  if (const auto cameras = io::find_cameras(file)) {
    json["cameras"] = cameras_json(*cameras);
  } else if (fs::is_directory(file)) {
    fail_input(
        "{}: a folder without cameras (cameras.txt, cameras.bin, *.camera, transforms.json, bundle.out)",
        file.string());
  } else if (extension == ".obj") {
    json["model"] = model_json(io::describe_model(io::read_obj(file)));
  } else {
    json["scans"] = Json::array();
    const Json images = extension == ".e57" ? images_json(file, salvage) : Json::object();
    if (images.empty() || holds_scans(file, salvage))  // photographs may come in a file of their own
      for (const auto& scan : io::read_scan_info(file, {.salvage = salvage}))
        json["scans"].push_back(scan_json(scan));
    json.update(images);
  }
  return json;
}

// The same as "key / key: value" lines; lists of plain values on one line.
void print_text(const Json& value, const std::string& name, std::string& text) {
  const bool nested =
      value.is_object() || (value.is_array() && std::any_of(value.begin(), value.end(), [](const auto& item) {
                              return item.is_structured();
                            }));
  if (!nested) {
    text +=
        fmt::format("{}: {}\n", name, value.is_string() ? value.get<std::string>() : json_text(value, -1));
    return;
  }
  for (const auto& [key, inner] : value.items())
    print_text(inner, name.empty() ? key : name + " / " + key, text);
}

bool is_damaged(const Json& described) {
  if (!described.contains("scans")) return false;
  const auto& scans = described["scans"];
  return std::any_of(scans.begin(), scans.end(), [](const auto& scan) { return scan.contains("damage"); });
}

// One that cannot be read does not stop the others.
Json describe_all(const std::vector<fs::path>& files, bool salvage, int& exit_code) {
  Json all = Json::array();
  std::size_t refused = 0;
  int code = 0;
  for (const fs::path& file : files) {
    try {
      all.push_back(describe(file, salvage));
      if (is_damaged(all.back())) exit_code = kSomeFailed;
    } catch (const Error& error) {
      if (files.size() == 1 || ends_the_run(error.kind())) throw;
      log::error("{}", error.what());
      all.push_back({{"file", file.string()}, {"error", error.what()}});
      code = hybrid::exit_code(error.kind());
      ++refused;
    }
  }
  if (refused > 0) exit_code = refused == files.size() ? code : kSomeFailed;
  return all;
}

}  // namespace

void add_info(CLI::App& program, int& exit_code) {
  auto* command =
      program.add_subcommand("info", "what is in scan files, models (.obj) or files or folders of cameras");
  auto common = std::make_shared<CommonOptions>();
  auto files = std::make_shared<std::vector<fs::path>>();
  command->add_option("files", *files, "the files or folders; of several --json prints an array")->required();
  auto salvage = std::make_shared<bool>(false);
  add_salvage_option(*command, *salvage);
  add_common_options(*command, *common);
  command->callback([=, &exit_code] {
    apply(*common);
    const Json all = describe_all(*files, *salvage, exit_code);
    if (common->json) {
      std::cout << json_text(all.size() == 1 ? all[0] : all) << "\n";
      return;
    }
    std::string text;
    for (const Json& json : all) {
      if (!text.empty()) text += "\n";
      print_text(json, "", text);
    }
    std::cout << text;
  });
}

}  // namespace hybrid::app
