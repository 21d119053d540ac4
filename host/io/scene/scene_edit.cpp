#include "io/scene/scene_edit.hpp"

#include "geometry/ring_fault.hpp"
#include "io/scene/scene_table.hpp"

namespace hybrid::io {
namespace {

SceneFaces face_of(const SceneTable& table, std::string_view key) {
  const OptionValue value = table.scalar(key);
  if (const auto* name = std::get_if<std::string>(&value)) {
    if (name->empty()) table.fail_key(key, "expected the name of a face or its index, found \"\"");
    return {table.line_of(key), *name};
  }
  return {table.line_of(key), *table.index(key)};
}

std::vector<SceneFaces> read_removed(const SceneTable& edit) {
  std::vector<SceneFaces> faces;
  for (const OptionValue& value : edit.scalars("remove_faces")) {
    if (const auto* name = std::get_if<std::string>(&value))
      faces.push_back({edit.line_of("remove_faces"), *name});
    else if (const auto* index = std::get_if<std::int64_t>(&value); index && *index >= 0 && *index < 1 << 30)
      faces.push_back({edit.line_of("remove_faces"), static_cast<int>(*index)});
    else
      edit.fail_key("remove_faces", "expected names of faces, groups or materials and indices from 0");
  }
  return faces;
}

std::vector<Vec2> points2(const SceneTable& table, std::string_view key) {
  std::vector<Vec2> points;
  for (const auto& p : table.points(key, 2, 3)) points.emplace_back(p[0], p[1]);
  return points;
}

SceneHole read_hole(const SceneTable& table) {
  SceneHole hole;
  hole.line = table.line();
  if (!table.has("face")) table.fail_table("expected the key face, found none");
  hole.face = face_of(table, "face");
  if (table.has("polygon") == table.has("world"))
    table.fail_table(
        "expected one of polygon = [[u, v], ...] in face coordinates and world = [[x, y, z], ...], found {}",
        table.has("world") ? "both" : "neither");
  if (table.has("polygon"))
    hole.on_face = points2(table, "polygon");
  else
    for (const auto& p : table.points("world", 3, 3)) hole.world.emplace_back(p[0], p[1], p[2]);
  return hole;
}

SceneClip::Box read_box(const SceneTable& table) {
  const auto v = table.numbers("box", 6);
  const SceneClip::Box box{Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5])};
  if (!(box.low.array() < box.high.array()).all())
    table.fail_key("box", "expected [x, y, z of the low corner, x, y, z of the high corner], each below");
  return box;
}

SceneClip::HalfSpace read_plane(const SceneTable& table) {
  const auto v = table.numbers("plane", 4);
  const Vec3 normal(v[0], v[1], v[2]);
  if (!(normal.norm() > 1e-9))
    table.fail_key("plane", "expected [nx, ny, nz, offset] with a normal, found a normal of length 0");
  return {normal.normalized(), v[3] / normal.norm()};
}

void check_ring(const SceneTable& table, std::string_view key, const std::vector<Vec2>& ring) {
  if (const std::string fault = ring_fault(ring); !fault.empty()) table.fail_key(key, "{}", fault);
}

SceneClip::Prism read_prism(const SceneTable& table) {
  SceneClip::Prism prism{points2(table, "prism"), -1e9, 1e9};
  check_ring(table, "prism", prism.polygon);
  if (table.has("z")) {
    const auto z = table.numbers("z", 2);
    if (!(z[0] < z[1])) table.fail_key("z", "expected [low, high], found {} and {}", z[0], z[1]);
    prism.low = z[0];
    prism.high = z[1];
  }
  return prism;
}

SceneClip read_clip(const SceneTable& table) {
  SceneClip clip;
  clip.line = table.line();
  clip.scan = table.text("scan").value_or("");
  clip.keep_inside = table.choice("keep", {"inside", "outside"}, "outside") == "inside";
  clip.in_scan_frame = table.choice("frame", {"world", "scan"}, "world") == "scan";
  if (clip.in_scan_frame && clip.scan.empty())
    table.fail_key("frame", "\"scan\" needs scan = \"id\": every scan has a frame of its own");
  if (table.has("box") + table.has("plane") + table.has("prism") != 1)
    table.fail_table("expected one of box, plane and prism, found {}",
                     table.has("box") || table.has("plane") || table.has("prism") ? "several" : "none");
  if (table.has("z") && !table.has("prism")) table.fail_key("z", "belongs to prism; remove it");
  if (table.has("box"))
    clip.shape = read_box(table);
  else if (table.has("plane"))
    clip.shape = read_plane(table);
  else
    clip.shape = read_prism(table);
  return clip;
}

SceneDepthEdit read_depth(const SceneTable& table) {
  SceneDepthEdit edit;
  edit.line = table.line();
  edit.scan = table.required_text("scan");
  for (std::string_view key : {"polygon", "by_m"})
    if (!table.has(key)) table.fail_table("expected the key {}, found none", key);
  const auto polygon = points2(table, "polygon");
  for (const Vec2& p : polygon) {
    if (p[0] != static_cast<int>(p[0]) || p[1] != static_cast<int>(p[1]) || p[0] < 0 || p[1] < 0)
      table.fail_key("polygon", "expected rows and columns of range.exr, whole numbers from 0, found {}, {}",
                     p[0], p[1]);
    edit.polygon.push_back({static_cast<int>(p[0]), static_cast<int>(p[1])});
  }
  check_ring(table, "polygon", polygon);
  edit.by_m = *table.number("by_m");
  if (edit.by_m == 0 || std::abs(edit.by_m) > 1000)
    table.fail_key("by_m", "expected metres from -1000 to 1000 but not 0, found {}", edit.by_m);
  return edit;
}

}  // namespace

const std::vector<std::string_view>& scene_edit_keys() {
  static const std::vector<std::string_view> keys = {"remove_faces", "holes", "clip", "depth"};
  return keys;
}

SceneEdits read_scene_edits(const SceneTable& edit) {
  SceneEdits edits;
  if (edit.has("remove_faces")) edits.remove_faces = read_removed(edit);
  for (const auto& table : edit.tables("holes", {"face", "polygon", "world"}))
    edits.holes.push_back(read_hole(table));
  for (const auto& table : edit.tables("clip", {"scan", "keep", "frame", "box", "plane", "prism", "z"}))
    edits.clips.push_back(read_clip(table));
  for (const auto& table : edit.tables("depth", {"scan", "polygon", "by_m"}))
    edits.depths.push_back(read_depth(table));
  return edits;
}

}  // namespace hybrid::io
