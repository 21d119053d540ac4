#include "batch/editing/edit_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "batch/overview_camera.hpp"
#include "batch/picture_marks.hpp"
#include "batch/render_unit.hpp"
#include "core/parallel.hpp"
#include "stages/contours/class_picture.hpp"

namespace hybrid::batch {
namespace {

void paste(const Image8& from, int left, int top, Image8& to) {
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x) std::copy_n(from.at(x, y), 3, to.at(left + x, top + y));
}

Image8 stacked(const Image8& above, const Image8& below) {
  constexpr int kGap = 8;
  Image8 both(std::max(above.width, below.width), above.height + kGap + below.height, 3);
  std::fill(both.pixels.begin(), both.pixels.end(), std::uint8_t{255});
  paste(above, 0, 0, both);
  paste(below, 0, above.height + kGap, both);
  return both;
}

constexpr Ink kCut{200, 0, 0};  // outlines of holes
constexpr std::array<double, 3> kPaneTint{0.45, 0.75, 1};

// A hole's border, where nothing hides it.
void draw_outline(const PolygonModel& model, const std::vector<std::uint32_t>& ring, const Photograph& camera,
                  const stages::RenderedView& view, Image8& picture) {
  constexpr int kPieces = 32;       // of an edge, each drawn or hidden as a whole
  constexpr double kBehind = 0.01;  // of its distance that a line may lie behind what is shown
  const auto pixel_of = [&](const Vec3& point) -> std::optional<Vec2> {
    const Vec3 in_camera = camera.cam_from_world * point;
    const auto pixel = camera.camera.project(in_camera);
    if (!pixel) return std::nullopt;
    const auto at =
        static_cast<std::size_t>(std::clamp(static_cast<int>(pixel->y()), 0, picture.height - 1)) *
            static_cast<std::size_t>(picture.width) +
        static_cast<std::size_t>(std::clamp(static_cast<int>(pixel->x()), 0, picture.width - 1));
    return static_cast<double>(view.depth_m[at]) < (1 - kBehind) * in_camera.z() ? std::nullopt : pixel;
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3 &a = model.vertices[ring[i]], &b = model.vertices[ring[(i + 1) % ring.size()]];
    for (int k = 0; k < kPieces; ++k) {
      const auto from = pixel_of(a + k * (b - a) / kPieces), to = pixel_of(a + (k + 1) * (b - a) / kPieces);
      if (from && to) draw_line(picture, *from, *to, kCut, 2);
    }
  }
}

// The model lit from the camera: panes (faces that `before` has not) bluish, the outlines of holes that
// `before` has not red.
Image8 plain_picture(device::Queue& queue, const PolygonModel& model, const PolygonModel& before,
                     const Photograph& camera) {
  stages::RenderScene scene;
  scene.proxy = model;
  stages::RenderOptions options;
  options.samples_per_axis = 2;
  stages::Renderer renderer(queue, scene, options);
  stages::ViewRequest request;
  request.camera = camera;
  request.show = "proxy";
  request.texture = false;
  auto view = renderer.render(request);
  std::map<std::string, const Face*> old;
  for (const Face& face : before.faces) old.emplace(face.name, &face);
  for (std::size_t i = 0; i < view.id.size(); ++i)
    if (view.id[i] > 0 && !old.count(model.faces[view.id[i] - 1].name))
      for (std::size_t k = 0; k < 3; ++k) view.colour.pixels[3 * i + k] *= static_cast<float>(kPaneTint[k]);
  Image8 picture = to_picture(view.colour);
  for (const Face& face : model.faces) {
    const auto same = old.find(face.name);
    const std::size_t had = same == old.end() ? 0 : same->second->holes.size();
    for (std::size_t h = had; h < face.holes.size(); ++h)
      draw_outline(model, face.holes[h], camera, view, picture);
  }
  return picture;
}

// Grey by the angle of the surface through a node and its neighbours to the light.
Image8 relief(const RangeImage& image) {
  Image8 picture(image.cols, image.rows, 3);
  const Vec3 light = Vec3(0.4, 0.5, 0.75).normalized();  // to the right, upwards and towards the scanner
  parallel_for(static_cast<std::size_t>(image.rows), [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int col = 0; col < image.cols; ++col) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] == kEmpty || row + 1 >= image.rows || col + 1 >= image.cols) continue;
      const std::size_t right = image.index(row, col + 1), below = image.index(row + 1, col);
      if (image.mask[right] == kEmpty || image.mask[below] == kEmpty) continue;
      const Vec3 p = image.point(i), towards = -p.normalized();
      Vec3 normal = (image.point(right) - p).cross(image.point(below) - p).normalized();
      if (normal.dot(towards) < 0) normal = -normal;
      const Vec3 across = Vec3::UnitZ().cross(towards).normalized(), up = towards.cross(across);
      const double lit =
          light.x() * normal.dot(across) + light.y() * normal.dot(up) + light.z() * normal.dot(towards);
      std::fill_n(picture.at(col, row), 3, static_cast<std::uint8_t>(40 + 215 * std::clamp(lit, 0.0, 1.0)));
    }
  });
  return picture;
}

Ink ink_of(stages::CellEvidence evidence) {
  switch (evidence) {
    case stages::CellEvidence::none:
      return {0, 0, 0};
    case stages::CellEvidence::closed:
      return {170, 170, 170};
    case stages::CellEvidence::attached:
      return {100, 100, 100};
    case stages::CellEvidence::behind:
      return {140, 200, 255};
    case stages::CellEvidence::through:
      return {40, 90, 220};
  }
  return {0, 0, 0};
}

// The faces of the model that are no longer as they were, alone: what the pictures look at.
PolygonModel changed_faces(const PolygonModel& before, const PolygonModel& after) {
  std::set<std::pair<std::string_view, std::size_t>> kept;  // name and number of holes
  for (const Face& face : after.faces) kept.emplace(face.name, face.holes.size());
  PolygonModel changed;
  for (const Face& face : before.faces) {
    if (kept.count({face.name, face.holes.size()}) > 0) continue;
    for (const std::uint32_t vertex : face.outer) changed.vertices.push_back(before.vertices[vertex]);
  }
  return changed;
}

}  // namespace

Image8 edited_model_picture(device::Queue& queue, const PolygonModel& before, const PolygonModel& after) {
  constexpr int kWidth = 800, kHeight = 600, kGap = 8;
  Image8 sheet(2 * kWidth + kGap, 2 * kHeight + kGap, 3);
  std::fill(sheet.pixels.begin(), sheet.pixels.end(), std::uint8_t{255});
  const PolygonModel changed = changed_faces(before, after);
  for (const bool behind : {false, true}) {
    const Photograph camera =
        overview_camera(changed.vertices.empty() ? before : changed, kWidth, kHeight, behind);
    const int top = behind ? kHeight + kGap : 0;
    paste(plain_picture(queue, before, before, camera), 0, top, sheet);
    paste(plain_picture(queue, after, before, camera), kWidth + kGap, top, sheet);
  }
  return sheet;
}

Image8 clipped_picture(const RangeImage& image, const std::vector<std::uint8_t>& clipped) {
  const Image8 grey = stages::range_picture(image);
  Image8 before(grey.width, grey.height, 3);
  for (std::size_t k = 0; k < before.pixels.size(); ++k) before.pixels[k] = grey.pixels[k / 3];
  Image8 after = before;
  for (std::size_t i = 0; i < clipped.size(); ++i)
    if (clipped[i]) {
      after.pixels[3 * i] = 220;
      after.pixels[3 * i + 1] /= 3;
      after.pixels[3 * i + 2] /= 3;
    }
  return stacked(before, after);
}

Image8 relief_picture(const RangeImage& before, const RangeImage& after) {
  return stacked(relief(before), relief(after));
}

Image8 openings_picture(const PolygonModel& model, const stages::FaceEvidence& face,
                        const std::vector<stages::Opening>& openings) {
  constexpr int kLongest_px = 1600;
  const double scale =
      std::clamp(kLongest_px / static_cast<double>(std::max(face.cols, face.rows)), 0.05, 8.0);
  const int width = std::max(1, static_cast<int>(face.cols * scale));
  const int height = std::max(1, static_cast<int>(face.rows * scale));
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int col = std::min(face.cols - 1, static_cast<int>(x / scale));
      const int row = std::min(face.rows - 1, static_cast<int>((height - 1 - y) / scale));
      const auto ink = ink_of(face.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(face.cols) +
                                         static_cast<std::size_t>(col)]);
      std::copy(ink.begin(), ink.end(), picture.at(x, y));
    }
  const double px_per_m = scale / face.cell_m;
  const auto draw = [&](const Ring2& ring, const Ink& ink, int line_px) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
      draw_line(picture, {a.x() * px_per_m, height - a.y() * px_per_m},
                {b.x() * px_per_m, height - b.y() * px_per_m}, ink, line_px);
    }
  };
  const Face& own = model.faces[face.face];
  for (const Ring2& ring : flat_rings(face_frame(model, own), model, own)) draw(ring, {255, 255, 255}, 1);
  for (const auto& opening : openings)
    if (opening.face == face.face) draw(opening.ring, opening.cut ? Ink{230, 20, 20} : Ink{255, 160, 0}, 2);
  return picture;
}

}  // namespace hybrid::batch
