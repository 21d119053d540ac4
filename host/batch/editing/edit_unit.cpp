#include "batch/editing/edit_unit.hpp"

#include <algorithm>
#include <cmath>

#include "core/log.hpp"
#include "core/suggest.hpp"
#include "stages/editing/clip_scan.hpp"
#include "stages/editing/edit_model.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

std::string place(const io::SceneFile& scene, int line, const std::string& what) {
  return fmt::format("{}:{}: [edit]: {}", scene.path.string(), line, what);
}

// The model as it was read, whose faces edits are named by.
struct NamedModel {
  const PolygonModel& model;
  const std::vector<io::ObjFaceNames>& names;

  bool is_named(std::size_t face, const std::string& name) const {
    const io::ObjFaceNames& own = names[face];
    return model.faces[face].name == name || own.group == name || own.object == name || own.material == name;
  }
};

// Indices of the faces that are meant.
std::vector<std::size_t> find_faces(const NamedModel& named, const io::SceneFaces& faces) {
  const PolygonModel& model = named.model;
  if (const int* index = std::get_if<int>(&faces.which)) {
    const auto place = static_cast<std::size_t>(*index);
    for (std::size_t i = 0; i < named.names.size(); ++i)
      if (named.names[i].place == place) return {i};
    fail_input("face {}: the model has {} faces (0-based, in file order){}", place, model.faces.size(),
               place < named.names.back().place ? ", this one was left out" : "");
  }
  const auto& name = std::get<std::string>(faces.which);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < model.faces.size(); ++i)
    if (named.is_named(i, name)) found.push_back(i);
  if (!found.empty()) return found;
  std::vector<std::string_view> known;
  for (const Face& face : model.faces) known.push_back(face.name);
  fail_input("{}", unknown_name("face, group or material", name, known));
}

std::size_t find_face(const NamedModel& named, const io::SceneFaces& faces) {
  const auto found = find_faces(named, faces);
  if (found.size() > 1)
    fail_input("expected one face, found {} of the name \"{}\": {}, {}{}; name one of them", found.size(),
               std::get<std::string>(faces.which), named.model.faces[found[0]].name,
               named.model.faces[found[1]].name, found.size() > 2 ? ", ..." : "");
  return found[0];
}

void cut_scene_hole(const io::SceneHole& hole, const NamedModel& named, PolygonModel& model, Json& figures) {
  const std::size_t face = find_face(named, hole.face);
  const FaceFrame frame = face_frame(model, model.faces[face]);
  const Ring2 ring = hole.world.empty() ? hole.on_face : stages::ring_on_face(frame, hole.world);
  stages::cut_hole(model, face, ring);
  figures.push_back({{"face", model.faces[face].name}, {"area_m2", std::abs(signed_area(ring))}});
}

stages::ClipShape shape_of(const io::SceneClip& clip) {
  if (const auto* box = std::get_if<io::SceneClip::Box>(&clip.shape))
    return stages::ClipBox{box->low, box->high};
  if (const auto* half = std::get_if<io::SceneClip::HalfSpace>(&clip.shape))
    return stages::ClipHalfSpace{half->normal, half->offset_m};
  const auto& prism = std::get<io::SceneClip::Prism>(clip.shape);
  return stages::ClipPrism{prism.polygon, prism.low, prism.high};
}

// A polygon stands for its supercluster as a whole; one that lost samples is drawn by those that are left.
void give_back_contours(const std::vector<std::uint8_t>& clipped, ScanProduct& product) {
  const auto& labels = product.segmentation.sample_label;
  std::vector<std::uint8_t> touched(product.segmentation.superclusters.size() + 1, 0);
  for (std::size_t i = 0; i < clipped.size(); ++i)
    if (clipped[i]) touched[labels[i]] = 1;
  touched[0] = 0;
  auto& contours = product.contour_faces;
  std::vector<Face> faces;
  std::vector<std::uint32_t> superclusters;
  for (std::size_t k = 0; k < contours.model.faces.size(); ++k) {
    if (touched[contours.supercluster[k]]) continue;
    faces.push_back(contours.model.faces[k]);
    superclusters.push_back(contours.supercluster[k]);
  }
  contours.model.faces = std::move(faces);
  contours.supercluster = std::move(superclusters);
  for (auto& fit : contours.fits)
    if (touched[fit.supercluster]) fit.polygon = false;
  for (std::size_t i = 0; i < contours.covered.size(); ++i) {
    if (!contours.covered[i] || !touched[labels[i]]) continue;
    contours.covered[i] = 0;
    auto& fate = product.decimation.fate[i];
    if (fate != stages::kDiscarded) continue;
    fate = stages::kUnexplained;
    --product.decimation.discarded;
  }
}

void drop_clipped(const std::vector<std::uint8_t>& clipped, stages::Decimation& decimation) {
  for (std::size_t i = 0; i < clipped.size(); ++i) {
    if (!clipped[i]) continue;
    decimation.discarded -= decimation.fate[i] == stages::kDiscarded;
    --decimation.measured;
    decimation.fate[i] = stages::kNoSample;
  }
}

// Marks the samples beside the grid that a clip drops, as clip_nodes() does those in it.
std::int64_t clip_extra(const ScanRemains& remains, const Pose& shape_from_scan,
                        const stages::ClipShape& shape, bool keep_inside,
                        std::vector<std::uint8_t>& clipped) {
  std::int64_t dropped = 0;
  for (std::size_t i = 0; i < clipped.size(); ++i) {
    const auto& p = remains.extra[i].position;
    if (clipped[i] || stages::holds(shape, shape_from_scan * Vec3(p[0], p[1], p[2])) == keep_inside) continue;
    clipped[i] = 1;
    ++dropped;
  }
  return dropped;
}

// Moves the samples beside the grid that lie towards the edit's nodes, as these were; returns which. Those
// that would come to lie behind the scanner, as its own body would, stay.
std::vector<std::size_t> move_extra(const io::SceneDepthEdit& edit, const RangeImage& image, Scan& scan) {
  std::vector<Vec3> points;
  for (const std::uint32_t source : image.extra) points.push_back(scan.point(source));
  auto found = stages::points_in_area(image, points, edit.polygon);
  std::erase_if(found, [&](std::size_t i) { return !(points[i].norm() + edit.by_m > 0); });
  for (const std::size_t i : found)
    set_point(scan, image.extra[i], points[i] * (1 + edit.by_m / points[i].norm()));
  return found;
}

// All registered scans but their stray and clipped samples.
struct Evidence {
  std::vector<std::vector<std::uint8_t>> ignored;
  std::vector<stages::OpeningScan> scans;

  Evidence(const std::vector<ScanProduct>& products,
           const std::vector<std::optional<ScanRegistration>>& registrations)
      : ignored(products.size()) {
    for (std::size_t i = 0; i < products.size(); ++i) {
      if (!registrations[i]) continue;
      const auto& product = products[i];
      ignored[i] = product.stray;
      for (std::size_t k = 0; k < product.clipped.size(); ++k) ignored[i][k] |= product.clipped[k];
      const auto& pose = *registrations[i];
      scans.push_back({&product.image, &product.segmentation, &ignored[i], pose.world_from_scan(),
                       product.sigma_m, pose.fixed ? std::array<double, 36>{} : pose.icp.covariance});
    }
  }
};

Json ring_json(const FaceFrame& frame, const Ring2& ring) {
  Json points = Json::array();
  for (const Vec2& p : ring) {
    const Vec3 world = frame.world(p);
    points.push_back({world.x(), world.y(), world.z()});
  }
  return points;
}

Json opening_json(const PolygonModel& model, const stages::Opening& opening) {
  const Face& face = model.faces[opening.face];
  const FaceFrame frame = face_frame(model, face);
  Json flat = Json::array();
  for (const Vec2& p : opening.ring) flat.push_back({p.x(), p.y()});
  Json json = {{"face", face.name},
               {"kind", opening.kind},
               {"cut", opening.cut},
               {"area_m2", opening.area_m2},
               {"rays", opening.rays},
               {"against", opening.against},
               {"confidence", opening.confidence},
               {"border_seen", opening.border_seen},
               {"depth_m", opening.depth_m}};
  if (opening.pane_m) json["pane_m"] = *opening.pane_m;
  if (opening.pane_from) json["pane_from"] = model.faces[*opening.pane_from].name;
  if (opening.carried_from) json["carried_from"] = model.faces[*opening.carried_from].name;
  if (opening.completed_from) json["completed_from"] = model.faces[*opening.completed_from].name;
  if (!opening.cut) json["why_not"] = opening.why_not;
  json["polygon"] = flat;
  json["ring"] = ring_json(frame, opening.ring);
  return json;
}

std::string empty_scan(const io::SceneFile& scene, const std::string& id) {
  std::string lines;
  for (const auto& clip : scene.edits.clips)
    if (clip.scan.empty() || clip.scan == id)
      lines += fmt::format("{}{}", lines.empty() ? "" : ", ", clip.line);
  return fmt::format("clips (line {}) drop all of its samples; check their coordinates, keep and frame",
                     lines);
}

}  // namespace

PolygonModel edit_model(const io::SceneFile& scene, const PolygonModel& model,
                        const std::vector<io::ObjFaceNames>& names, Json& figures) {
  const NamedModel named{model, names};
  PolygonModel edited = model;
  Json holes = Json::array(), removed = Json::array();
  for (std::size_t i = 0; i < scene.edits.holes.size(); ++i) {
    const auto& hole = scene.edits.holes[i];
    with_context(place(scene, hole.line, fmt::format("holes {}", i + 1)),
                 [&] { cut_scene_hole(hole, named, edited, holes); });
  }
  std::vector<bool> marks(model.faces.size(), false);
  for (const auto& faces : scene.edits.remove_faces)
    with_context(place(scene, faces.line, "remove_faces"), [&] {
      for (const std::size_t face : find_faces(named, faces)) marks[face] = true;
    });
  for (std::size_t f = 0; f < marks.size(); ++f)
    if (marks[f]) removed.push_back(model.faces[f].name);
  if (!removed.empty())
    edited = with_context(place(scene, scene.edits.remove_faces[0].line, "remove_faces"),
                          [&] { return stages::without_faces(edited, marks); });
  if (!removed.empty()) figures["removed_faces"] = removed;
  if (!holes.empty()) figures["holes"] = holes;
  return edited;
}

void set_point(Scan& scan, std::uint32_t sample, const Vec3& point) {
  for (int k = 0; k < 3; ++k)
    scan.points[sample][static_cast<std::size_t>(k)] = static_cast<float>(point[k] - scan.origin[k]);
}

bool edits_name_other_scans(const io::SceneFile& scene, const std::vector<std::string>& ids) {
  const auto other = [&](const auto& edit) {
    return !edit.scan.empty() && std::find(ids.begin(), ids.end(), edit.scan) == ids.end();
  };
  const auto& edits = scene.edits;
  return std::any_of(edits.clips.begin(), edits.clips.end(), other) ||
         std::any_of(edits.depths.begin(), edits.depths.end(), other);
}

void check_edited_scans(const io::SceneFile& scene, const std::vector<std::string>& ids) {
  const auto check = [&](const std::string& id, int line, const char* what) {
    if (id.empty() || std::find(ids.begin(), ids.end(), id) != ids.end()) return;
    fail_input("{}: {}", place(scene, line, what),
               unknown_name("scan", id, std::vector<std::string_view>(ids.begin(), ids.end())));
  };
  for (const auto& clip : scene.edits.clips) check(clip.scan, clip.line, "clip");
  for (const auto& depth : scene.edits.depths) check(depth.scan, depth.line, "depth");
}

std::int64_t edit_depths(const io::SceneFile& scene, const std::string& id, RangeImage& image, Scan& scan) {
  std::vector<std::uint8_t> moved(image.count(), 0), extra_moved(image.extra.size(), 0);
  for (const auto& edit : scene.edits.depths) {
    if (edit.scan != id) continue;
    with_context(place(scene, edit.line, "depth"), [&] {
      const auto nodes = stages::move_area(image, edit.polygon, edit.by_m);
      const auto extra = move_extra(edit, image, scan);
      if (extra.empty() && std::count(nodes.begin(), nodes.end(), 1) == 0)
        log::warning("scan {}: depth edit in line {}: no measured sample in its polygon", id, edit.line);
      for (std::size_t i = 0; i < moved.size(); ++i) moved[i] |= nodes[i];
      for (const std::size_t i : extra) extra_moved[i] = 1;
    });
  }
  return std::count(moved.begin(), moved.end(), 1) + std::count(extra_moved.begin(), extra_moved.end(), 1);
}

void warn_of_idle_clips(const io::SceneFile& scene, const std::vector<std::optional<std::int64_t>>& dropped) {
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    if (dropped[i].value_or(1) > 0) continue;
    const auto& clip = scene.edits.clips[i];
    log::warning(
        "{}: it drops no sample: none that other clips have left lies {} its shape; check its numbers, which "
        "are "
        "{}, and keep = \"{}\"",
        place(scene, clip.line, fmt::format("clip {}", i + 1)), clip.keep_inside ? "outside" : "inside",
        clip.in_scan_frame ? "metres in the scan's own frame" : "metres in the model's frame",
        clip.keep_inside ? "inside" : "outside");
  }
}

Json clip_scan(const io::SceneFile& scene, const ScanRegistration& registration, const ScanRemains& remains,
               ScanProduct& product, std::vector<std::optional<std::int64_t>>& dropped) {
  Json clips = Json::array();
  dropped.resize(scene.edits.clips.size());
  for (std::size_t c = 0; c < scene.edits.clips.size(); ++c) {
    const auto& clip = scene.edits.clips[c];
    if (!clip.scan.empty() && clip.scan != product.id) continue;
    with_context(place(scene, clip.line, "clip"), [&] {
      product.clipped.resize(product.image.count(), 0);
      product.extra_clipped.resize(remains.extra.size(), 0);
      const Pose shape_from_scan = clip.in_scan_frame ? Pose{} : registration.world_from_scan();
      const auto shape = shape_of(clip);
      const std::int64_t samples =
          stages::clip_nodes(product.image, shape_from_scan, shape, clip.keep_inside, product.clipped) +
          clip_extra(remains, shape_from_scan, shape, clip.keep_inside, product.extra_clipped);
      clips.push_back({{"line", clip.line}, {"samples", samples}});
      dropped[c] = dropped[c].value_or(0) + samples;
    });
  }
  if (clips.empty()) return {};
  give_back_contours(product.clipped, product);
  drop_clipped(product.clipped, product.decimation);
  product.decimation.measured -= std::count(product.extra_clipped.begin(), product.extra_clipped.end(), 1);
  if (product.decimation.measured <= 0) {
    product.notes.push_back(empty_scan(scene, product.id));
    log::warning("scan {}: {}", product.id, product.notes.back());
  }
  return clips;
}

stages::Openings openings_of_scans(const PolygonModel& model, const std::vector<ScanProduct>& products,
                                   const std::vector<std::optional<ScanRegistration>>& registrations,
                                   const stages::OpeningOptions& options) {
  return stages::find_openings(model, Evidence(products, registrations).scans, options);
}

std::vector<stages::DisplacementMap> displacements_of_scans(
    const PolygonModel& model, const std::vector<ScanProduct>& products,
    const std::vector<std::optional<ScanRegistration>>& registrations,
    const stages::DisplacementOptions& options) {
  return stages::displacement_maps(model, Evidence(products, registrations).scans, options);
}

void cut_openings(PolygonModel& model, stages::Openings& openings) {
  for (auto& opening : openings.openings) {
    if (!opening.cut) continue;
    try {
      stages::cut_hole(model, opening.face, opening.ring, opening.cell_m);
    } catch (const Error& error) {
      opening.cut = false;
      opening.why_not = error.what();
    }
  }
}

Json openings_json(const PolygonModel& model, const stages::Openings& openings,
                   const stages::OpeningOptions& options) {
  Json json = {{"openings", Json::array()}, {"faces", Json::array()}};
  for (const auto& opening : openings.openings) json["openings"].push_back(opening_json(model, opening));
  for (const auto& face : openings.faces)
    json["faces"].push_back({{"face", model.faces[face.face].name},
                             {"status", face.status},
                             {"offset_m", face.offset_m},
                             {"spread_m", face.spread_m},
                             {"depth_m", face.depth_m},
                             {"cell_m", face.cell_m},
                             {"samples", face.samples}});
  json["mode"] = options.openings;
  return json;
}

}  // namespace hybrid::batch
