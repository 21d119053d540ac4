#include "io/colmap.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "core/error.hpp"
#include "io/plain_text.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

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

// One line of a model file: takes its words off the front, with errors that name file, line and field.
class Record {
 public:
  Record(const fs::path& file, const LineReader& lines)
      : file_(file), line_(lines.number()), rest_(lines.line()) {}

  std::int64_t integer(std::string_view field) {
    const auto word = take(field);
    const auto value = to_integer(word);
    if (!value) fail_at(file_, line_, "{}: expected a whole number, found \"{}\"", field, excerpt(word));
    return *value;
  }
  double number(std::string_view field) {
    const auto word = take(field);
    const auto value = to_double(word);
    if (!value || !std::isfinite(*value))
      fail_at(file_, line_, "{}: expected a finite number, found \"{}\"", field, excerpt(word));
    return *value;
  }
  std::string_view word(std::string_view field) { return take(field); }
  std::string_view rest() const { return trim(rest_); }
  int line() const { return line_; }

 private:
  std::string_view take(std::string_view field) {
    const auto word = take_word(rest_);
    if (word.empty()) fail_at(file_, line_, "expected {}, found the end of the line: cut short?", field);
    return word;
  }

  const fs::path& file_;
  int line_;
  std::string_view rest_;
};

bool is_comment_or_blank(std::string_view line) {
  line = trim(line);
  return line.empty() || line.starts_with('#');
}

int image_size(Record& record, const fs::path& file, std::string_view field) {
  constexpr std::int64_t kLargest = 1 << 20;
  const std::int64_t size = record.integer(field);
  if (size < 1 || size > kLargest)
    fail_at(file, record.line(), "{}: expected 1 to {} pixels, found {}", field, kLargest, size);
  return static_cast<int>(size);
}

ColmapCamera read_camera(const fs::path& file, Record record) {
  ColmapCamera result;
  result.line = record.line();
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
  camera.width = image_size(record, file, "width");
  camera.height = image_size(record, file, "height");
  int index = 0;
  for (auto parameter : model->parameters)
    camera.*parameter =
        record.number(fmt::format("parameter {} of {} of {}", ++index, model->parameters.size(), name));
  if (!record.rest().empty())
    fail_at(file, record.line(), "expected {} parameters of {}, found more: \"{}\"", model->parameters.size(),
            name, excerpt(record.rest()));
  if (model->one_focal_length) camera.fy = camera.fx;
  if (!(camera.fx > 0 && camera.fy > 0))
    fail_at(file, record.line(), "focal length: expected more than 0 px, found {} and {}", camera.fx,
            camera.fy);
  return result;
}

Eigen::Quaterniond read_rotation(const fs::path& file, Record& record) {
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

Photograph read_image(const fs::path& file, Record record,
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

}  // namespace

std::vector<ColmapCamera> read_colmap_cameras(const fs::path& folder) {
  check_folder(folder);
  const fs::path file = folder / "cameras.txt";
  const std::string text = read_plain_text(file);
  LineReader lines(text);
  std::vector<ColmapCamera> cameras;
  std::unordered_set<std::int64_t> ids;
  while (lines.next()) {
    if (is_comment_or_blank(lines.line())) continue;
    cameras.push_back(read_camera(file, Record(file, lines)));
    if (!ids.insert(cameras.back().id).second)
      fail_at(file, lines.number(), "camera id {} occurs twice", cameras.back().id);
  }
  if (cameras.empty()) fail_at(file, std::max(1, lines.number()), "expected at least one camera, found none");
  return cameras;
}

std::vector<Photograph> read_colmap(const fs::path& folder) {
  std::unordered_map<std::int64_t, Camera> cameras;
  for (const ColmapCamera& camera : read_colmap_cameras(folder)) cameras.emplace(camera.id, camera.camera);
  const fs::path file = folder / "images.txt";
  const std::string text = read_plain_text(file);
  LineReader lines(text);
  std::vector<Photograph> photographs;
  std::unordered_set<std::int64_t> ids;
  std::unordered_set<std::string> names;
  while (lines.next()) {
    if (is_comment_or_blank(lines.line())) continue;
    photographs.push_back(read_image(file, Record(file, lines), cameras, ids));
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
  std::sort(photographs.begin(), photographs.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return photographs;
}

}  // namespace hybrid::io
