#include "io/cameras/nerfstudio.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "geometry/angles.hpp"
#include "io/picture.hpp"
#include "io/text/plain_text.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

// A frame's keys, then the file's: what stands in a frame is its own.
class Frame {
 public:
  Frame(std::string place, const nlohmann::json& frame, const nlohmann::json& file)
      : place_(std::move(place)), frame_(frame), file_(file) {}

  const std::string& place() const { return place_; }
  const nlohmann::json* find(const char* key) const {
    for (const nlohmann::json* json : {&frame_, &file_})
      if (const auto at = json->find(key); at != json->end() && !at->is_null()) return &*at;
    return nullptr;
  }
  std::optional<double> number(const char* key) const {
    const nlohmann::json* json = find(key);
    if (!json) return std::nullopt;
    const double value = json->is_number() ? json->get<double>() : std::nan("");
    if (!std::isfinite(value))
      fail_input("{}: {}: expected a finite number, found {}", place_, key, excerpt(json->dump()));
    return value;
  }
  std::string text(const char* key, const std::string& fallback) const {
    const nlohmann::json* json = find(key);
    if (!json) return fallback;
    if (!json->is_string())
      fail_input("{}: {}: expected a string, found {}", place_, key, excerpt(json->dump()));
    return json->get<std::string>();
  }

 private:
  std::string place_;
  const nlohmann::json& frame_;
  const nlohmann::json& file_;
};

struct Model {
  std::string_view name;
  std::vector<std::pair<const char*, double Camera::*>> distortion;
  Lens lens = Lens::brown;
};

const std::vector<Model>& models() {
  using C = Camera;
  static const std::vector<Model> kModels = {
      {"OPENCV", {{"k1", &C::k1}, {"k2", &C::k2}, {"k3", &C::k3}, {"p1", &C::p1}, {"p2", &C::p2}}},
      {"PINHOLE", {}},
      {"SIMPLE_PINHOLE", {}},
      {"SIMPLE_RADIAL", {{"k1", &C::k1}}},
      {"RADIAL", {{"k1", &C::k1}, {"k2", &C::k2}}},
      {"EQUIRECTANGULAR", {}, Lens::spherical},
      {"OPENCV_FISHEYE", {{"k1", &C::k1}, {"k2", &C::k2}, {"k3", &C::k3}, {"k4", &C::k4}}, Lens::fisheye},
  };
  return kModels;
}

const Model& model_of(const Frame& frame) {
  const nlohmann::json* fisheye = frame.find("is_fisheye");  // instant-ngp's way to say so
  const bool is_fisheye = fisheye && fisheye->is_boolean() && fisheye->get<bool>();
  const std::string name = frame.text("camera_model", is_fisheye ? "OPENCV_FISHEYE" : "OPENCV");
  for (const Model& model : models())
    if (model.name == name) return model;
  fail_input(
      "{}: camera_model: expected OPENCV, PINHOLE, SIMPLE_PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV_FISHEYE or "
      "EQUIRECTANGULAR, found {}; undistort the photographs",
      frame.place(), excerpt(name));
}

// Every distortion that the file gives must be one that the model has, or 0.
void read_distortion(const Frame& frame, const Model& model, Camera& camera) {
  camera.lens = model.lens;
  for (const char* key : {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"}) {
    const double value = frame.number(key).value_or(0);
    const auto known = std::find_if(model.distortion.begin(), model.distortion.end(),
                                    [&](const auto& term) { return std::string_view(term.first) == key; });
    if (known != model.distortion.end())
      camera.*known->second = value;
    else if (value != 0)
      fail_input("{}: {}: expected 0 with camera_model {}, found {}; undistort the photographs",
                 frame.place(), key, model.name, value);
  }
}

int image_side(const Frame& frame, const char* key) {
  const double value = frame.number(key).value_or(0);
  if (value == 0) return 0;
  if (value != std::floor(value) || !(std::abs(value) < 1e15))
    fail_input("{}: {}: expected a whole number of pixels, found {}", frame.place(), key, value);
  return checked_image_size(frame.place(), key, static_cast<std::int64_t>(value));
}

void read_size(const Frame& frame, const fs::path& picture, Camera& camera) {
  camera.width = image_side(frame, "w");
  camera.height = image_side(frame, "h");
  if ((camera.width > 0 && camera.height > 0) || picture.empty()) return;
  const PictureSize size = picture_size(picture);
  camera.width = size.width, camera.height = size.height;
}

double focal_length(const Frame& frame, const char* focal, const char* angle, int side, double fallback) {
  if (const auto given = frame.number(focal)) return *given;
  const auto radians = frame.number(angle);
  if (!radians) return fallback;
  if (!(*radians > 0 && *radians < 3.1))
    fail_input("{}: {}: expected an angle of more than 0, below 3.1 rad, found {}", frame.place(), angle,
               *radians);
  // Of a size that is not known, the focal length is not known either: 1 stands for it.
  return side == 0 ? 1 : 0.5 * side / std::tan(0.5 * *radians);
}

Camera read_intrinsics(const Frame& frame, const fs::path& picture) {
  Camera camera;
  read_size(frame, picture, camera);
  camera.fx = focal_length(frame, "fl_x", "camera_angle_x", camera.width, std::nan(""));
  if (std::isnan(camera.fx))
    fail_input("{}: expected fl_x (pixels) or camera_angle_x (radians), found neither", frame.place());
  camera.fy = focal_length(frame, "fl_y", "camera_angle_y", camera.height, camera.fx);
  camera.cx = frame.number("cx").value_or(0.5 * camera.width);
  camera.cy = frame.number("cy").value_or(0.5 * camera.height);
  check_focal_length(frame.place(), camera);
  return camera;
}

// A full panorama: what the file says of focal length and middle is not its.
Camera read_panorama(const Frame& frame, const fs::path& picture) {
  Camera camera;
  read_size(frame, picture, camera);
  camera.lens = Lens::spherical;
  camera.fx = camera.width / kTurn;
  camera.fy = 2 * camera.height / kTurn;
  camera.cx = 0.5 * camera.width;
  camera.cy = 0.5 * camera.height;
  return camera;
}

// What takes the cameras back into the frame that they had before the file was written, as text.
std::string hint_of_frame(const nlohmann::json& json) {
  const auto applied = json.find("applied_transform");
  if (applied == json.end()) return "";
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t col = 0; col < 4; ++col) {
      const bool is_there = applied->is_array() && applied->size() >= 3 && (*applied)[row].is_array() &&
                            (*applied)[row].size() == 4 && (*applied)[row][col].is_number();
      if (!is_there) return "";
      transform(static_cast<int>(row), static_cast<int>(col)) = (*applied)[row][col].get<double>();
    }
  const Mat3 turn = transform.topLeftCorner<3, 3>();
  if (!(turn.transpose() * turn).isIdentity(kRotationTolerance) || turn.determinant() < 0 ||
      transform.isIdentity())
    return "";
  const Eigen::Matrix4d back = transform.inverse();
  std::string numbers;
  for (int i = 0; i < 16; ++i) numbers += fmt::format("{}{:g}", i == 0 ? "" : ", ", back(i / 4, i % 4) + 0.0);
  return fmt::format(
      "; transforms.json has an applied_transform: a model in the frame from before it (COLMAP's) takes "
      "world_from_photographs = [{}]",
      numbers);
}

// cam_from_world from world_from_camera in OpenGL's axes, 4 x 4 or 3 x 4.
Pose read_pose(const Frame& frame, const nlohmann::json& json) {
  const auto matrix = json.find("transform_matrix");
  const std::string place = frame.place() + ": transform_matrix";
  if (matrix == json.end() || !matrix->is_array() || matrix->size() < 3 || matrix->size() > 4)
    fail_input("{}: expected 4 rows of 4 numbers, found {}", place,
               matrix == json.end() ? "none" : excerpt(matrix->dump()));
  Eigen::Matrix4d values = Eigen::Matrix4d::Identity();
  for (std::size_t row = 0; row < matrix->size(); ++row) {
    const nlohmann::json& numbers = (*matrix)[row];
    if (!numbers.is_array() || numbers.size() != 4)
      fail_input("{}: row {}: expected 4 numbers, found {}", place, row + 1, excerpt(numbers.dump()));
    for (std::size_t col = 0; col < 4; ++col) {
      const double value = numbers[col].is_number() ? numbers[col].get<double>() : std::nan("");
      if (!std::isfinite(value))
        fail_input("{}: row {}: expected finite numbers, found {}", place, row + 1,
                   excerpt(numbers[col].dump()));
      values(static_cast<int>(row), static_cast<int>(col)) = value;
    }
  }
  if (values.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    fail_input("{}: expected the last row 0 0 0 1, found {} {} {} {}", place, values(3, 0), values(3, 1),
               values(3, 2), values(3, 3));
  const Vec3 flip(1, -1, -1);
  const Mat3 world_from_cam = values.topLeftCorner<3, 3>() * flip.asDiagonal();
  Pose pose;
  pose.rotation = checked_rotation(place, world_from_cam).conjugate();
  pose.translation = -(pose.rotation * Vec3(values.topRightCorner<3, 1>()));
  return pose;
}

std::string photograph_name(const Frame& frame) {
  fs::path name = fs::path(frame.text("file_path", "")).lexically_normal();
  if (name.empty() || name == ".") fail_input("{}: expected a file_path, found none", frame.place());
  if (name.extension().empty()) name += ".png";
  return name.generic_string();
}

nlohmann::json parse(const fs::path& file) {
  const std::string text = read_plain_text(file);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const std::string what = error.what();  // "[json.exception...] parse error at line 3, column 5: ..."
    const auto line =
        1 + std::count(text.begin(),
                       text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size())), '\n');
    fail_at(file, static_cast<int>(line), "no valid JSON: {}",
            excerpt(what.substr(std::min(what.size(), what.find("] ") + 2))));
  } catch (const nlohmann::json::exception& error) {
    // A number that no double holds: known by its text, not its place.
    fail_input("{}: expected numbers of usual size: {}", file.string(), error.what());
  }
}

}  // namespace

CameraFile read_nerfstudio(const fs::path& file, const fs::path& images) {
  const nlohmann::json json = parse(file);
  const auto frames = json.is_object() ? json.find("frames") : json.end();
  if (!json.is_object() || frames == json.end() || !frames->is_array() || frames->empty())
    fail_at(file, 1, "expected an object with a list of frames, found none");
  CameraFile result;
  result.frame_hint = hint_of_frame(json);
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const std::string place = fmt::format("{}: frames[{}]", file.string(), i);
    if (!(*frames)[i].is_object())
      fail_input("{}: expected an object, found {}", place, excerpt((*frames)[i].dump()));
    const Frame frame(place, (*frames)[i], json);
    Photograph photograph;
    photograph.name = photograph_name(frame);
    const Model& model = model_of(frame);
    const fs::path picture = images.empty() ? fs::path() : images / photograph.name;
    photograph.camera =
        model.lens == Lens::spherical ? read_panorama(frame, picture) : read_intrinsics(frame, picture);
    read_distortion(frame, model, photograph.camera);
    photograph.cam_from_world = read_pose(frame, (*frames)[i]);
    result.cameras.push_back({photograph.name, std::string(model.name), photograph.camera});
    result.photographs.push_back(std::move(photograph));
  }
  sort_photographs(file, result.photographs);
  return result;
}

}  // namespace hybrid::io
