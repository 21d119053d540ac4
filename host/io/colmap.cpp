#include "io/colmap.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "core/error.hpp"
#include "io/text_record.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

struct ColmapCamera {
  std::int64_t id = 0;
  std::string model;
  Camera camera;
};

// The parameters of a camera model in file order.
struct Model {
  std::string_view name;
  std::vector<double Camera::*> parameters;
  bool one_focal_length = false;  // fx stands for both
};

const std::vector<Model>& models() {
  using C = Camera;
  static const std::vector<Model> kModels = {
      {"SIMPLE_PINHOLE", {&C::fx, &C::cx, &C::cy}, true},
      {"PINHOLE", {&C::fx, &C::fy, &C::cx, &C::cy}, false},
      {"SIMPLE_RADIAL", {&C::fx, &C::cx, &C::cy, &C::k1}, true},
      {"RADIAL", {&C::fx, &C::cx, &C::cy, &C::k1, &C::k2}, true},
      {"OPENCV", {&C::fx, &C::fy, &C::cx, &C::cy, &C::k1, &C::k2, &C::p1, &C::p2}, false},
  };
  return kModels;
}

bool is_comment_or_blank(std::string_view line) {
  line = trim(line);
  return line.empty() || line.starts_with('#');
}

ColmapCamera read_camera(const fs::path& file, TextRecord record) {
  ColmapCamera result;
  const std::string place = fmt::format("{}:{}", file.string(), record.line());
  result.id = record.integer("camera id");
  const std::string_view name = record.word("camera model");
  const auto model =
      std::find_if(models().begin(), models().end(), [&](const Model& m) { return m.name == name; });
  if (model == models().end()) {
    std::vector<std::string_view> names;
    for (const Model& m : models()) names.push_back(m.name);
    fail_at(file, record.line(),
            "camera model: expected one of {}, found {}; undistort the photographs "
            "(colmap image_undistorter) or estimate one of these",
            fmt::join(names, ", "), excerpt(name));
  }
  result.model = name;
  Camera& camera = result.camera;
  camera.width = checked_image_size(place, "width", record.integer("width"));
  camera.height = checked_image_size(place, "height", record.integer("height"));
  int index = 0;
  for (auto parameter : model->parameters)
    camera.*parameter =
        record.number(fmt::format("parameter {} of {} of {}", ++index, model->parameters.size(), name));
  if (!record.rest().empty())
    fail_at(file, record.line(), "expected {} parameters of {}, found more: \"{}\"", model->parameters.size(),
            name, excerpt(record.rest()));
  if (model->one_focal_length) camera.fy = camera.fx;
  check_focal_length(place, camera);
  return result;
}

Eigen::Quaterniond read_rotation(const fs::path& file, TextRecord& record) {
  const double w = record.number("QW"), x = record.number("QX"), y = record.number("QY"),
               z = record.number("QZ");
  const Eigen::Quaterniond rotation(w, x, y, z);
  constexpr double kTolerance = 0.01;  // decimal places were cut; more is another number altogether
  if (!(std::abs(rotation.norm() - 1) <= kTolerance))
    fail_at(file, record.line(), "QW QX QY QZ: expected a quaternion of length 1, found length {:.6g}",
            rotation.norm());
  return rotation.normalized();
}

// "X Y POINT3D_ID" repeated, or nothing. Only the form is checked: it tells a lost empty line from points.
void check_points(const fs::path& file, const LineReader& lines, std::string_view name) {
  std::string_view rest = lines.line();
  std::size_t count = 0;
  for (auto word = take_word(rest); !word.empty(); word = take_word(rest), ++count)
    if (!to_double(word))
      fail_at(file, lines.number(),
              "expected the 2D points of {} (X Y POINT3D_ID ..., or an empty line), found \"{}\"; every "
              "image takes two "
              "lines, was an empty one removed?",
              excerpt(name), excerpt(word));
  if (count % 3 != 0)
    fail_at(file, lines.number(),
            "expected the 2D points of {} in threes (X Y POINT3D_ID), found {} numbers: "
            "the line is cut short",
            excerpt(name), count);
}

Photograph read_image(const fs::path& file, TextRecord record,
                      const std::unordered_map<std::int64_t, Camera>& cameras,
                      std::unordered_set<std::int64_t>& ids) {
  const std::int64_t id = record.integer("image id");
  if (!ids.insert(id).second) fail_at(file, record.line(), "image id {} occurs twice", id);
  Photograph result;
  result.cam_from_world.rotation = read_rotation(file, record);
  const double x = record.number("TX"), y = record.number("TY"), z = record.number("TZ");
  result.cam_from_world.translation = {x, y, z};
  const std::int64_t camera = record.integer("camera id");
  const auto found = cameras.find(camera);
  if (found == cameras.end())
    fail_at(file, record.line(), "camera id: expected one of the {} cameras of cameras.txt, found {}",
            cameras.size(), camera);
  result.camera = found->second;
  result.name = record.rest();
  if (result.name.empty())
    fail_at(file, record.line(), "expected the image's name, found the end of the line: cut short?");
  return result;
}

void check_folder(const fs::path& folder) {
  std::error_code code;
  if (!fs::exists(folder, code)) fail_input("{}: no such folder; check the path", folder.string());
  if (!fs::is_directory(folder, code))
    fail_input("{}: expected the folder of a COLMAP text model, found a file", folder.string());
  if (!fs::exists(folder / "cameras.txt", code) && fs::exists(folder / "cameras.bin", code))
    fail_input(
        "{}: expected a COLMAP text model (cameras.txt, images.txt), found a binary one; convert it: "
        "colmap model_converter --output_type TXT",
        folder.string());
}

std::vector<ColmapCamera> read_colmap_cameras(const fs::path& file) {
  const std::string text = read_plain_text(file);
  LineReader lines(text);
  std::vector<ColmapCamera> cameras;
  std::unordered_set<std::int64_t> ids;
  while (lines.next()) {
    if (is_comment_or_blank(lines.line())) continue;
    cameras.push_back(read_camera(file, TextRecord(file, lines)));
    if (!ids.insert(cameras.back().id).second)
      fail_at(file, lines.number(), "camera id {} occurs twice", cameras.back().id);
  }
  if (cameras.empty()) fail_at(file, std::max(1, lines.number()), "expected at least one camera, found none");
  return cameras;
}

std::vector<Photograph> read_images(const fs::path& file,
                                    const std::unordered_map<std::int64_t, Camera>& cameras) {
  const std::string text = read_plain_text(file);
  LineReader lines(text);
  std::vector<Photograph> photographs;
  std::unordered_set<std::int64_t> ids;
  std::unordered_set<std::string> names;
  while (lines.next()) {
    if (is_comment_or_blank(lines.line())) continue;
    photographs.push_back(read_image(file, TextRecord(file, lines), cameras, ids));
    const std::string& name = photographs.back().name;
    if (!names.insert(name).second)
      fail_at(file, lines.number(), "image name {} occurs twice", excerpt(name));
    // Editors that trim files take the last image's empty line away; a line without its end was cut.
    const bool whole = lines.terminated();
    if (lines.next())
      check_points(file, lines, name);
    else if (!whole)
      fail_at(file, lines.number(),
              "expected a second line for image {}, found the end of the file: cut short?", excerpt(name));
  }
  if (photographs.empty())
    fail_at(file, std::max(1, lines.number()), "expected at least one image, found none");
  return photographs;
}

}  // namespace

CameraFile read_colmap(const fs::path& folder) {
  check_folder(folder);
  CameraFile result;
  std::unordered_map<std::int64_t, Camera> by_id;
  for (const ColmapCamera& camera : read_colmap_cameras(folder / "cameras.txt")) {
    by_id.emplace(camera.id, camera.camera);
    result.cameras.push_back({std::to_string(camera.id), camera.model, camera.camera});
  }
  result.photographs = read_images(folder / "images.txt", by_id);
  sort_photographs(folder / "images.txt", result.photographs);
  return result;
}

}  // namespace hybrid::io
