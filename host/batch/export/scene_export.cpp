#include "batch/export/scene_export.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "batch/export/export_meshes.hpp"
#include "batch/export/export_points.hpp"
#include "batch/export/export_rib.hpp"
#include "batch/export/export_st_maps.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "geometry/colour.hpp"
#include "io/cameras/write_colmap.hpp"
#include "io/las/las_crs.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "io/write_picture.hpp"
#include "io/write_scan.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kIndex = "index.json";

// The files of the export that wrote this index; nothing when it is none.
std::vector<std::string> files_of(const fs::path& index) {
  std::vector<std::string> files;
  std::error_code code;
  if (!fs::is_regular_file(index, code)) return files;
  const auto document = Json::parse(io::read_text(index), nullptr, false);
  if (!document.is_object() || !document.contains("files") || !document["files"].is_array()) return files;
  for (const auto& row : document["files"])
    if (row.is_object() && row.contains("file") && row["file"].is_string()) files.push_back(row["file"]);
  return files;
}

// A name inside the export's folder, as an index that was tampered with might not be.
bool stays_inside(const fs::path& name) {
  return name.is_relative() &&
         std::none_of(name.begin(), name.end(), [](const fs::path& part) { return part == ".."; });
}

}  // namespace

struct SceneExport::State {
  State(device::Queue& q, const ExportInputs& i, const fs::path& out)
      : inputs(i),
        folder(out / "export"),
        earlier(files_of(folder / kIndex)),
        scene(build_render_scene(i.model, i.products, i.registrations, i.photographs, i.contours,
                                 i.options.render.unseen_m)),
        renderer(q, scene, i.options.render) {}

  const ExportInputs inputs;
  fs::path folder;
  std::vector<std::string> earlier, files, notes;
  stages::RenderScene scene;
  stages::Renderer renderer;
  std::optional<ExportPoints> collected;
  std::optional<io::TexturedScene> textured;
  Json atlas;

  bool has_photographs() const { return !scene.photographs.empty(); }
  bool has_faces() const { return !scene.proxy.faces.empty() || !scene.contours.faces.empty(); }

  void note(const std::string& text) {
    if (std::find(notes.begin(), notes.end(), text) != notes.end()) return;
    notes.push_back(text);
    log::warning("export: {}", text);
  }

  // Where a file goes, which is now one of the export's.
  fs::path made(const std::string& name) {
    files.push_back(name);
    return folder / name;
  }

  const ExportPoints& points() {
    if (!collected) {
      collected = collect_points(renderer, has_photographs(), inputs.products, inputs.registrations,
                                 inputs.remains, inputs.options.decimate.tile);
      if (collected->position.empty()) note("no registered scan with retained samples: no points");
    }
    return *collected;
  }

  // Atlas pages and meshes; the pages are files when this returns.
  io::TexturedScene& model() {
    if (textured) return *textured;
    io::TexturedScene made_scene;
    made_scene.crs = inputs.scene.crs;
    made_scene.shift = inputs.scene.shift;
    made_scene.photographs = scene.photographs;
    if (!has_faces()) {
      note("no faces: no atlas");
    } else if (!has_photographs()) {
      note("no photographs: the model has no textures");
      made_scene.meshes = plain_meshes(scene);
    } else {
      bake(made_scene);
    }
    textured = std::move(made_scene);
    return *textured;
  }

  void bake(io::TexturedScene& to) {
    const auto plan = stages::plan_atlas(renderer, scene, inputs.options.exporting.atlas);
    const bool png = inputs.options.exporting.picture == "png";
    std::size_t texels = 0, seen = 0;
    Json pages = Json::array();
    for (std::size_t page = 0; page < plan.layout.pages.size(); ++page) {
      const auto baked = stages::bake_page(renderer, scene, plan, static_cast<int>(page));
      const auto file = made(fmt::format("atlas-{}.{}", page, png ? "png" : "jpg"));
      if (png)
        io::write_png(file, baked.colour);
      else
        io::write_jpeg(file, baked.colour);
      io::write_png(made(fmt::format("coverage-{}.png", page)), baked.coverage);
      to.pages.push_back({file, baked.colour.width, baked.colour.height});
      pages.push_back({baked.colour.width, baked.colour.height});
      texels += baked.texels;
      seen += baked.seen;
    }
    to.meshes = textured_meshes(scene, plan.charts);
    if (plan.layout.enlarged > 1)
      note(
          fmt::format("the atlas holds {} pages at most: texels are {:.2f} times as large as wanted; raise "
                      "atlas_pages or atlas_page",
                      inputs.options.exporting.atlas.pages, plan.layout.enlarged));
    const auto [finest, coarsest] =
        std::minmax_element(plan.charts.begin(), plan.charts.end(),
                            [](const auto& a, const auto& b) { return a.texel_m < b.texel_m; });
    atlas = {{"pages", pages},
             {"charts", plan.charts.size()},
             {"unseen_faces", plan.unseen_faces},
             {"texels", texels},
             {"red_share", texels ? static_cast<double>(texels - seen) / static_cast<double>(texels) : 0.0},
             {"texel_m", {finest->texel_m, coarsest->texel_m}},
             {"enlarged", plan.layout.enlarged}};
  }

  void write_glb() {
    auto& scene_of_model = model();
    const auto& all = points();
    scene_of_model.points.clear();
    for (std::size_t i = 0; i < all.position.size(); ++i)
      if (all.drawn[i]) {
        io::CloudPoint point{all.position[i], {}};
        for (std::size_t k = 0; k < 3; ++k) point.rgb[k] = linear_of_bytes<float>()[all.rgb[i][k]];
        scene_of_model.points.push_back(point);
      }
    if (scene_of_model.meshes.empty() && scene_of_model.points.empty() && !has_photographs())
      note("scene.glb: nothing to show");
    io::write_glb(made("scene.glb"), scene_of_model);
  }

  void write_obj() {
    if (model().meshes.empty()) return;
    made("scene.mtl");
    io::write_textured_obj(made("scene.obj"), model());
  }

  void write_cloud(const std::string& format) {
    if (points().position.empty()) return;
    auto cloud = std::make_unique<io::ScanInMemory>(cloud_of(points(), inputs.scene));
    const auto file = made("points." + format);
    const std::string& crs = inputs.scene.crs;
    if (format == "las" && !crs.empty() && io::las_crs_records(crs).empty())
      note(fmt::format("points.las: without the coordinate system {:.40}: no EPSG:n and no WKT", crs));
    const io::ScanSource source = [&] { return std::move(cloud); };
    format == "las" ? io::write_las(file, source) : io::write_ply_scan(file, source);
  }

  void write_scans() {
    std::size_t next = 0;
    const auto registered = [&] {
      while (next < inputs.products.size() && !inputs.registrations[next]) ++next;
      return next < inputs.products.size();
    };
    if (!registered()) {
      note("no registered scan: no scans.e57");
      return;
    }
    io::write_e57(made("scans.e57"), [&]() -> std::unique_ptr<io::ScanStream> {
      if (!registered()) return nullptr;
      const std::size_t i = next++;
      auto scan = inputs.read_scan(i);
      scan->name = inputs.products[i].id;
      set_registered_pose(*scan, inputs.registrations[i]->world_from_scan(), inputs.scene);
      return std::make_unique<io::ScanInMemory>(std::move(*scan));
    });
  }

  void write_colmap() {
    if (!has_photographs()) {
      note("no photographs: no COLMAP model");
      return;
    }
    std::vector<io::ColmapPoint> cloud;
    const auto& all = points();
    for (std::size_t i = 0; i < all.position.size(); ++i) cloud.push_back({all.position[i], all.rgb[i]});
    for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"})
      made(std::string("colmap/") + name);
    const auto left_out = io::write_colmap(folder / "colmap", scene.photographs, cloud);
    if (!left_out.empty())
      note(fmt::format("colmap: panoramas have no camera model there and are left out: {}",
                       fmt::join(left_out, ", ")));
  }

  // A format that failed leaves nothing, of an earlier export neither; an atlas that is whole stays for the
  // others.
  void take_back(std::size_t first) {
    for (std::size_t i = files.size(); i > first; --i) {
      const std::string& name = files[i - 1];
      const bool of_atlas = name.rfind("atlas-", 0) == 0 || name.rfind("coverage-", 0) == 0;
      if (textured && of_atlas) continue;
      std::error_code ignored;
      fs::remove(folder / name, ignored);
      files.erase(files.begin() + static_cast<std::ptrdiff_t>(i) - 1);
    }
  }

  void write(const std::string& format) {
    const auto put = [&](const std::string& name) { return made(name); };
    const auto say = [&](const std::string& text) { note(text); };
    if (format == "glb") write_glb();
    if (format == "obj") write_obj();
    if (format == "ply" || format == "las") write_cloud(format);
    if (format == "e57") write_scans();
    if (format == "colmap") write_colmap();
    if (format == "st") write_st_maps(scene.photographs, put, say);
    if (format == "rib")
      write_rib_export(renderer, scene, inputs.scene.views, inputs.photographs, inputs.options, folder, put,
                       say);
  }

  void remove_earlier() {
    const std::set<std::string> now(files.begin(), files.end());
    for (const auto& name : earlier) {
      std::error_code ignored;
      if (!now.count(name) && stays_inside(name)) fs::remove(folder / name, ignored);
    }
  }
};

SceneExport::SceneExport(device::Queue& queue, const ExportInputs& inputs, const fs::path& out)
    : state_(std::make_unique<State>(queue, inputs, out)) {}
SceneExport::~SceneExport() = default;

std::vector<std::string> SceneExport::formats() const {
  const auto wanted = wanted_formats(state_->inputs.options.exporting);
  return {wanted.begin(), wanted.end()};
}

void SceneExport::write(const std::string& format) {
  const std::size_t first = state_->files.size();
  try {
    state_->write(format);
  } catch (...) {
    state_->take_back(first);
    throw;
  }
}

Json SceneExport::finish() {
  State& s = *state_;
  std::sort(s.files.begin(), s.files.end());
  s.files.erase(std::unique(s.files.begin(), s.files.end()), s.files.end());
  Json rows = Json::array();
  std::error_code code;
  for (const auto& name : s.files)
    if (const auto bytes = fs::file_size(s.folder / name, code); !code)
      rows.push_back({{"file", name}, {"bytes", bytes}});
  Json figures = {{"files", rows}};
  if (!s.atlas.is_null()) figures["atlas"] = s.atlas;
  if (s.collected)
    figures["points"] = {{"count", s.collected->position.size()},
                         {"stray", s.collected->stray},
                         {"red", s.collected->uncoloured}};
  figures["notes"] = s.notes;
  s.remove_earlier();
  io::write_text(s.folder / kIndex, json_text(figures) + "\n");
  return figures;
}

}  // namespace hybrid::batch
