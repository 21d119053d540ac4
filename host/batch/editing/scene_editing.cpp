#include "batch/editing/scene_editing.hpp"

#include <algorithm>

#include "batch/editing/edit_pictures.hpp"
#include "core/json_text.hpp"
#include "core/parallel.hpp"
#include "io/exr/exr.hpp"
#include "io/models/obj.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "stages/editing/panes.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// A face's name as a file's: names come from the model file and may hold anything.
std::string file_name(const std::string& name, std::size_t face) {
  std::string safe;
  for (const char c : name)
    safe += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ? c : '_';
  return fmt::format("{:03}-{}", face, safe.substr(0, 100));
}

// Samples of a scan whose nodes were moved, for files that take them from the scan itself.
void move_samples(const RangeImage& image, const RangeImage& before, Scan& scan) {
  for (std::size_t i = 0; i < image.count(); ++i) {
    if (image.mask[i] != kMeasured || image.range_m[i] == before.range_m[i]) continue;
    const std::uint32_t source = image.source[i];
    set_point(scan, source, scan.point(source) * (static_cast<double>(image.range_m[i]) / before.range_m[i]));
  }
}

}  // namespace

PolygonModel SceneEditing::edit(const io::SceneFile& scene, const PolygonModel& model,
                                const std::vector<io::ObjFaceNames>& names) {
  before_ = model;
  uncut_ = edit_model(scene, model, names, model_);
  changed_ = !model_.empty();
  return uncut_;
}

void SceneEditing::edit_depths(const io::SceneFile& scene, const std::string& id, RangeImage& image,
                               Scan& scan) {
  if (std::none_of(scene.edits.depths.begin(), scene.edits.depths.end(),
                   [&](const auto& edit) { return edit.scan == id; }))
    return;
  const RangeImage before = image;
  scans_[id]["depth_edited_samples"] = batch::edit_depths(scene, id, image, scan);
  reliefs_[id] = relief_picture(before, image);
  if (!scan.origin.isZero()) move_samples(image, before, scan);
}

void SceneEditing::clip(const io::SceneFile& scene, const ScanRegistration& registration,
                        const ScanRemains& remains, ScanProduct& product) {
  const Json clips = clip_scan(scene, registration, remains, product, dropped_);
  if (!clips.is_null()) scans_[product.id]["clips"] = clips;
}

void SceneEditing::openings(const stages::OpeningOptions& options,
                            const stages::DisplacementOptions& displacement,
                            std::vector<ScanProduct>& products,
                            const std::vector<std::optional<ScanRegistration>>& registrations,
                            PolygonModel& model) {
  options_ = options;
  if (options.openings != "off") {
    found_ = openings_of_scans(model, products, registrations, options);
    cut_openings(model, found_);
    const auto cut =
        std::count_if(found_.openings.begin(), found_.openings.end(), [](const auto& o) { return o.cut; });
    changed_ = changed_ || cut > 0;
    stages::confirm_panes(model, found_);
    stages::complete_panes(model, found_);
    const auto panes = stages::add_panes(found_, model);
    for (std::size_t i = 0; i < products.size(); ++i)
      if (registrations[i])
        stages::mark_through_glass(products[i].image, registrations[i]->world_from_scan(), model, panes,
                                   products[i].stray);
    model_["openings"] = {{"found", found_.openings.size()}, {"cut", cut}, {"panes", panes.size()}};
    for (const auto& face : found_.faces)
      if (face.status == "displaced" || face.status == "absent")
        model_["openings"]["faces_" + face.status].push_back(
            {{"face", model.faces[face.face].name}, {"offset_m", face.offset_m}});
  }
  if (!displacement.displacement) return;
  displacements_ = displacements_of_scans(model, products, registrations, displacement);
  for (const auto& map : displacements_)
    model_["displacement"].push_back({{"face", model.faces[map.face].name},
                                      {"texel_m", map.texel_m},
                                      {"size", {map.cols, map.rows}},
                                      {"measured_m2", map.measured_m2}});
}

std::vector<stages::GlazedOpening> SceneEditing::glazed_openings(const PolygonModel& model) const {
  std::vector<stages::GlazedOpening> glazed;
  for (const auto& opening : found_.openings)
    if (opening.cut && opening.pane_m)
      glazed.push_back({face_frame(model, model.faces[opening.face]), opening.ring, *opening.pane_m});
  return glazed;
}

void SceneEditing::write_displacements(const fs::path& out, const PolygonModel& model) const {
  fs::remove_all(out / "model" / "displacement");
  for (const auto& map : displacements_) {
    const std::string& name = model.faces[map.face].name;
    io::write_exr(out / "model" / "displacement" / (file_name(name, map.face) + ".exr"), map.cols, map.rows,
                  {{"height", map.height_m.data(), nullptr, 1}, {"samples", nullptr, map.samples.data(), 1}},
                  {{"face", name},
                   {"texel_m", Json(map.texel_m).dump()},
                   {"world_from_texel", Json(map.world_from_texel).dump()}});
  }
}

void SceneEditing::write_openings(const fs::path& out) const {
  fs::remove_all(out / "model" / "openings");
  if (options_.openings == "off") {
    fs::remove(out / "model" / "openings.json");
    return;
  }
  parallel_for(found_.faces.size(), [&](std::size_t k) {
    const auto& face = found_.faces[k];
    if (std::any_of(found_.openings.begin(), found_.openings.end(),
                    [&](const auto& opening) { return opening.face == face.face; }) ||
        face.status == "displaced")
      io::write_png(
          out / "model" / "openings" / (file_name(uncut_.faces[face.face].name, face.face) + ".png"),
          openings_picture(uncut_, face, found_.openings));
  });
  io::write_text(out / "model" / "openings.json", json_text(openings_json(uncut_, found_, options_)) + "\n");
}

void SceneEditing::write(device::Queue& queue, const fs::path& out, const std::vector<ScanProduct>& products,
                         const PolygonModel& model) const {
  write_openings(out);
  write_displacements(out, model);
  if (changed_) {
    io::write_png(out / "model" / "edited.png", edited_model_picture(queue, before_, model));
    io::write_obj(out / "model" / "edited.obj", model);
  } else {
    fs::remove(out / "model" / "edited.png");
    fs::remove(out / "model" / "edited.obj");
  }
  for (const auto& product : products) {
    const fs::path folder = out / "scans" / product.id;
    if (product.clipped.empty())
      fs::remove(folder / "clipped.png");
    else
      io::write_png(folder / "clipped.png", clipped_picture(product.image, product.clipped));
    if (const auto relief = reliefs_.find(product.id); relief != reliefs_.end())
      io::write_png(folder / "depth-edits.png", relief->second);
    else
      fs::remove(folder / "depth-edits.png");
  }
}

Json SceneEditing::figures() const {
  Json json = model_;
  if (!scans_.empty()) json["scans"] = scans_;
  return json.empty() ? Json() : json;
}

}  // namespace hybrid::batch
