#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "geometry/vectors.hpp"
#include "io/cameras/read_cameras.hpp"
#include "io/depth_image.hpp"
#include "io/scan_frame.hpp"
#include "io/scene/scene_edit.hpp"

namespace hybrid::io {

// The scene file as written (SCENE.md), checked for unknown keys, types and ranges; paths resolved against
// the file's folder, with ${NAME} and ${NAME:-default} taken from the environment. Errors name file, line,
// key, expectation.
struct SceneLandmark {
  int line = 0;
  std::optional<Vec3> scan;                 // metres, scan frame ...
  std::optional<std::array<int, 2>> pixel;  // ... or row, column of range.exr
  std::optional<Vec3> model;                // metres, model frame ...
  std::optional<int> vertex;                // ... or vertex index of the model file
  bool snap = true;
};

// A landmark of the photographs: what shows, or where, and its place in the model.
struct ScenePhotographPick {
  int line = 0;
  std::string photograph;                      // as its camera file names it; "" = `point`
  std::optional<std::array<double, 2>> pixel;  // row, column, from 0, of its pixels' centres; none: where the
                                               // photograph was taken
  std::optional<Vec3> point;                   // in the cameras' frame
  std::optional<Vec3> model;                   // metres, model frame ...
  std::optional<int> vertex;                   // ... or vertex index of the model file
  bool snap = true;
};

struct SceneScan {
  int line = 0;
  std::string id;  // as written, or "" (then from the file name)
  std::filesystem::path file;
  std::optional<int> index;
  std::vector<SceneLandmark> landmarks;
  std::optional<std::array<double, 16>> pose;
  bool fixed = false;
  // Where the scanner stood, in the file's coordinates, for files that cannot say. Then landmarks' `scan`
  // points and `pose` above refer to the file's coordinates, too.
  std::optional<Vec3> scanner;
  double unit_m = 1;  // of the file's lengths; everything in the scene file is in metres
  // How the file's axes lie; landmarks' `scan` points and `pose` are in the file's frame. Of a depth image:
  // the camera's.
  ScanAxes axes = ScanAxes::z_up;
  // A depth image (.png). Then landmarks' `scan` points and `pose` refer to its camera: x right, y down, z
  // forward.
  std::optional<DepthCamera> depth;
};

struct SceneView {
  int line = 0;
  std::string name;
  std::string path;        // of a frame: the [[path]] it belongs to; its name is <path>/0000 ...
  std::string photograph;  // or eye/target/up/fov_deg/size:
  Vec3 eye = Vec3::Zero(), target = Vec3::UnitY(), up = Vec3::UnitZ();
  double fov_deg = 60;
  bool panorama = false;  // projection = "equirectangular": of all directions, not of fov_deg
  std::array<int, 2> size{1920, 1080};
  std::string show = "both";
  bool texture = true, cameras = false;
  std::vector<std::string> leave_out;
};

// The camera of a view that has one of its own (eye, target, ...). Throws as look_at() and look_around() do.
Photograph camera_of(const SceneView& view);

// The value of an option key of [planes], [register], [edit], [render] or [export]: the stage that owns the
// key checks it against its option table.
struct SceneOption {
  int line = 0;
  OptionValue value;
};
using SceneOptions = std::map<std::string, SceneOption>;

struct SceneFile {
  std::filesystem::path path;
  std::string name;
  // Made of scans alone (implied_scene.hpp): that they are of one place is a guess, and one that hangs
  // together with no other is no failure.
  bool implied = false;
  bool levelled = false;
  std::string crs;
  Vec3 shift = Vec3::Zero();  // what the file says in coordinates of the map is without it already
  std::optional<std::filesystem::path>
      truth;  // truth.json of a synthetic scene: scores only, never read by a stage

  std::vector<SceneScan> scans;
  struct Model {
    std::filesystem::path file;
    std::string unit = "m", up = "z";
    Vec3 shift = Vec3::Zero();  // the scene's, for a model of the map (map_shift.hpp)
  };
  std::optional<Model> model;
  struct Photographs {
    CameraSource cameras;
    std::filesystem::path images;  // not of e57
    std::vector<std::filesystem::path>
        e57_files;  // whose images are the photographs; `cameras` has the first
    std::optional<std::array<double, 16>> world_from_photographs;
    std::vector<ScenePhotographPick> landmarks;  // or by these
    Vec3 shift = Vec3::Zero();                   // the scene's, for cameras of the map (map_shift.hpp)
  };
  std::optional<Photographs> photographs;
  SceneOptions planes, registration, edit, render, exporting;
  SceneEdits edits;         // the rest of [edit]
  bool has_export = false;  // an [export] is there: a run without --only exports, too
  std::vector<SceneView> views;
};

class SceneTable;
// size, show, texture, cameras and leave_out of a view or path.
void read_view_options(const SceneTable& table, SceneView& view);
// projection, fov_deg, and the size of a panorama that gives none; after read_view_options().
void read_view_projection(const SceneTable& table, SceneView& view);

// Throws ErrorKind::input. Files that the scene names are not opened. A folder of scans or a scan file is a
// scene, too: read_scene_of() in implied_scene.hpp.
SceneFile read_scene_file(const std::filesystem::path& file);

// The id of a scan that has none in the scene file: the file's stem, with "-<index>" when the file holds
// several scans (`count`), and -2, -3 ... when that is in `taken`.
std::string default_scan_id(const std::filesystem::path& file, int index, int count,
                            const std::vector<std::string>& taken);

}  // namespace hybrid::io
