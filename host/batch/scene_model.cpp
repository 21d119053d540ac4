#include "batch/scene_model.hpp"

#include <unordered_map>

#include "core/error.hpp"
#include "core/log.hpp"
#include "geometry/outline.hpp"
#include "io/scene/map_shift.hpp"

namespace hybrid::batch {
namespace fs = std::filesystem;
namespace {

constexpr double kFarthest_m = 1e9;  // beyond any map's coordinates; areas are finite numbers
constexpr std::size_t kNamed = 3;    // in a message: so many of the faces

bool has_area(const PolygonModel& model, const Face& face) {
  try {
    face_plane(model, face);
    return true;
  } catch (const Error&) {
    return false;
  }
}

// All vertices on one line, or an outline whose parts turn both ways.
std::string why_no_area(const PolygonModel& model, const Face& face) {
  const Vec3& base = model.vertices[face.outer[0]];
  Vec3 along = Vec3::Zero();
  for (const std::uint32_t v : face.outer)
    if ((model.vertices[v] - base).norm() > along.norm()) along = model.vertices[v] - base;
  double aside = 0;
  for (const std::uint32_t v : face.outer)
    aside = std::max(aside, (model.vertices[v] - base).cross(along).norm());
  return aside > 1e-6 * along.squaredNorm()
             ? "its outline crosses itself, the areas of its parts cancel"
             : fmt::format("{} vertices on one point or line", face.outer.size());
}

void check_vertices(const fs::path& file, const PolygonModel& model, const Face& face, std::uint64_t line) {
  for (const std::uint32_t v : face.outer) {
    const Vec3& at = model.vertices[v];
    if (!(at.cwiseAbs().maxCoeff() <= kFarthest_m))
      fail_input(
          "{}:{}: face {}: vertex {}: expected coordinates within {:g} m, found {} {} {}; correct the "
          "vertex, or "
          "the model's unit in the scene file",
          file.string(), line, face.name, std::uint64_t{v} + 1, kFarthest_m, at.x(), at.y(), at.z());
  }
}

}  // namespace

PolygonModel read_scene_model(const io::SceneFile::Model& section, std::vector<io::ObjFaceNames>& names) {
  const double scale = section.unit == "mm" ? 0.001 : 1.0;
  PolygonModel model = io::read_obj(section.file, scale, section.up == "y", &names);
  if (io::take_off_shift(section.shift, model))
    log::info("{}: in coordinates of the map: [scene] shift is taken off", section.file.string());
  std::string first;
  std::size_t kept = 0, left_out = 0;
  for (std::size_t i = 0; i < model.faces.size(); ++i) {
    check_vertices(section.file, model, model.faces[i], names[i].line);
    if (has_area(model, model.faces[i])) {
      if (kept != i) {
        model.faces[kept] = std::move(model.faces[i]);
        names[kept] = std::move(names[i]);
      }
      ++kept;
    } else if (++left_out <= kNamed) {
      first += fmt::format("{}line {}, face {}: {}", first.empty() ? "" : "; ", names[i].line,
                           model.faces[i].name, why_no_area(model, model.faces[i]));
    }
  }
  if (left_out > kNamed) first += "; ...";
  if (kept == 0)
    fail_input("{}: expected faces with an area, found {} without ({}); correct them in the model",
               section.file.string(), left_out, first);
  if (left_out > 0)
    log::warning("{}: {} of {} faces have no area and are left out ({}); correct or remove them in the model",
                 section.file.string(), left_out, model.faces.size(), first);
  model.faces.resize(kept);
  names.resize(kept);
  return model;
}

void check_outlines(const io::SceneFile::Model& section, const PolygonModel& read,
                    const std::vector<io::ObjFaceNames>& names, const PolygonModel& edited) {
  std::unordered_map<std::string_view, std::uint64_t> lines;
  for (std::size_t i = 0; i < names.size(); ++i) lines[read.faces[i].name] = names[i].line;
  for (const Face& face : edited.faces)
    if (face.outer.size() > 3 || !face.holes.empty())
      with_context(fmt::format("{}:{}", section.file.string(), lines.at(face.name)),
                   [&] { Outline(edited, face).triangles(); });
}

}  // namespace hybrid::batch
