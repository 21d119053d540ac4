#include "batch/registration/landmark_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "batch/overview_camera.hpp"
#include "batch/picture_marks.hpp"
#include "batch/render_unit.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "stages/contours/class_picture.hpp"

namespace hybrid::batch {
namespace {

namespace fs = std::filesystem;

constexpr Ink kBlack = {0, 0, 0}, kGrid = {255, 225, 60}, kFaint = {170, 170, 170}, kDark = {60, 60, 60},
              kRed = {190, 20, 20};

void fill(Image8& picture, const Ink& ink) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) std::copy(ink.begin(), ink.end(), picture.at(x, y));
}

// Small scans are enlarged, large ones thinned, to about this width.
constexpr int kWidth = 2000;
constexpr int kLeft = 90, kTop = 44, kCell = 3;

// Edges of the faces' rings, each once; of faces that show their front to the eye `front` is set.
struct Edge {
  std::uint32_t a, b;
  bool front;
};

std::vector<Edge> edges_of(const PolygonModel& model, const std::vector<std::uint32_t>& faces,
                           const Vec3& eye) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> edges;
  for (const std::uint32_t f : faces) {
    const Face& face = model.faces[f];
    const bool front = face_plane(model, face).distance(eye) > 0;
    const auto add = [&](const std::vector<std::uint32_t>& ring) {
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const auto [a, b] = std::minmax(ring[k], ring[(k + 1) % ring.size()]);
        edges[{a, b}] |= front;
      }
    };
    add(face.outer);
    for (const auto& hole : face.holes) add(hole);
  }
  std::vector<Edge> list;
  for (const auto& [ends, front] : edges) list.push_back({ends.first, ends.second, front});
  return list;
}

PolygonModel part_of(const PolygonModel& model, const std::vector<std::uint32_t>& faces) {
  PolygonModel part;
  std::map<std::uint32_t, std::uint32_t> at;
  const auto take = [&](std::vector<std::uint32_t>& ring) {
    for (std::uint32_t& v : ring) {
      const auto [known, is_new] = at.emplace(v, static_cast<std::uint32_t>(part.vertices.size()));
      if (is_new) part.vertices.push_back(model.vertices[v]);
      v = known->second;
    }
  };
  for (const std::uint32_t f : faces) {
    Face face = model.faces[f];
    take(face.outer);
    for (auto& hole : face.holes) take(hole);
    part.faces.push_back(std::move(face));
  }
  return part;
}

Image8 model_view(device::Queue& queue, const PolygonModel& model, const std::vector<std::uint32_t>& faces,
                  bool from_behind) {
  constexpr int kViewWidth = 1200, kViewHeight = 900;
  stages::ViewRequest request;
  request.camera = overview_camera(part_of(model, faces), kViewWidth, kViewHeight, from_behind);
  request.texture = false;
  const Vec3 eye = request.camera.centre();
  std::vector<std::uint32_t> fronts;
  std::copy_if(faces.begin(), faces.end(), std::back_inserter(fronts),
               [&](std::uint32_t f) { return face_plane(model, model.faces[f]).distance(eye) > 0; });
  Image8 picture(kViewWidth, kViewHeight, 3);
  fill(picture, kPaper);
  if (!fronts.empty()) {
    stages::RenderScene scene;
    scene.proxy = part_of(model, fronts);
    stages::Renderer renderer(queue, scene, {});
    const auto view = renderer.render(request);
    const Image8 shaded = to_picture(view.colour);
    for (std::size_t i = 0; i < view.id.size(); ++i)
      if (view.id[i] != 0)
        for (std::size_t k = 0; k < 3; ++k)  // pale, so that numbers can be read on it
          picture.pixels[3 * i + k] = static_cast<std::uint8_t>(128 + shaded.pixels[3 * i + k] / 2);
  }
  const auto pixel = [&](std::uint32_t v) {
    return request.camera.camera.project(request.camera.cam_from_world * model.vertices[v]);
  };
  std::set<std::uint32_t> vertices;
  const auto edges = edges_of(model, faces, eye);
  for (const bool front : {false, true})
    for (const Edge& edge : edges) {
      const auto a = pixel(edge.a), b = pixel(edge.b);
      if (edge.front == front && a && b) draw_line(picture, *a, *b, front ? kDark : kFaint, front ? 2 : 1);
      vertices.insert({edge.a, edge.b});
    }
  NumberLabels labels(picture, kCell, kRed);
  for (const std::uint32_t v : vertices)
    if (const auto at = pixel(v)) {
      draw_disc(picture, *at, 4, kRed);
      labels.add(*at, static_cast<int>(v));
    }
  return picture;
}

std::vector<std::uint32_t> all_or(const std::vector<std::uint32_t>& faces, std::size_t count) {
  if (!faces.empty()) return faces;
  std::vector<std::uint32_t> all(count);
  for (std::size_t f = 0; f < count; ++f) all[f] = static_cast<std::uint32_t>(f);
  return all;
}

std::string stanza(const std::string& id, const PolygonModel& model,
                   const std::vector<std::uint32_t>& faces) {
  constexpr std::size_t kMostListed = 400;
  std::string text = fmt::format(
      "# For the [[scan]] table of \"{}\" in the scene file: 4 corners, well spread, that you recognise in "
      "both "
      "pictures.\n# pixel = [row, column] as at the edges of scan.png, where the scan has a sample; vertex = "
      "the "
      "number in model.png.\n\nlandmarks = [\n",
      id);
  for (int k = 0; k < 4; ++k) text += "  { pixel = [ROW, COLUMN], vertex = NUMBER },\n";
  text += "]\n\n# Vertices of the model as drawn, metres:\n";
  std::set<std::uint32_t> vertices;
  for (const std::uint32_t f : faces) {
    vertices.insert(model.faces[f].outer.begin(), model.faces[f].outer.end());
    for (const auto& hole : model.faces[f].holes) vertices.insert(hole.begin(), hole.end());
  }
  std::size_t listed = 0;
  for (const std::uint32_t v : vertices) {
    if (++listed > kMostListed) {
      text += fmt::format("# ... and {} more\n", vertices.size() - kMostListed);
      break;
    }
    const Vec3& p = model.vertices[v];
    text += fmt::format("# {:>4}  ({:.3f}, {:.3f}, {:.3f})\n", v, p.x(), p.y(), p.z());
  }
  return text;
}

}  // namespace

int sheet_grid_step(const RangeImage& image) {
  const int nodes = std::max({image.cols, image.rows, 1});
  int step = 10;
  for (int k = 0; step * 18 < nodes; ++k) step = step * (k % 3 == 1 ? 5 : 4) / 2;
  return step;
}

Image8 scan_sheet(const ScanProduct& product) {
  const RangeImage& image = product.image;
  const Image8 range = stages::range_picture(image),
               classes = stages::class_picture(image, product.segmentation);
  // A node is `grow` pixels wide, or every `thin`-th is shown.
  const int longest = std::max({image.cols, image.rows, 1});
  const int grow = std::max(1, kWidth / longest), thin = std::max(1, (longest + kWidth - 1) / kWidth);
  const auto at = [&](int node) { return node * grow / thin; };
  Image8 picture(kLeft + at(image.cols) + 1, kTop + at(image.rows) + 1, 3);
  fill(picture, kPaper);
  for (int y = kTop; y < picture.height; ++y)
    for (int x = kLeft; x < picture.width; ++x) {
      const int row = std::min((y - kTop) * thin / grow, image.rows - 1);
      const int col = std::min((x - kLeft) * thin / grow, image.cols - 1);
      if (row < 0 || col < 0) continue;
      // Planes tell corners, range tells depth.
      const int light = 120 + range.at(col, row)[0] * 135 / 255;
      for (int k = 0; k < 3; ++k)
        picture.at(x, y)[k] = static_cast<std::uint8_t>(classes.at(col, row)[k] * light / 255);
    }
  const int step = sheet_grid_step(image);
  for (int col = 0; col < image.cols; col += step) {
    draw_line(picture, Vec2(kLeft + at(col), kTop - 6), Vec2(kLeft + at(col), picture.height - 1), kGrid);
    draw_number(picture, kLeft + at(col) - number_size(col, kCell).width / 2, 10, col, kCell, kBlack);
  }
  for (int row = 0; row < image.rows; row += step) {
    draw_line(picture, Vec2(kLeft - 6, kTop + at(row)), Vec2(picture.width - 1, kTop + at(row)), kGrid);
    draw_number(picture, kLeft - 10 - number_size(row, kCell).width, kTop + at(row) - 6, row, kCell, kBlack);
  }
  return picture;
}

Image8 model_sheet(device::Queue& queue, const PolygonModel& model, const std::vector<std::uint32_t>& faces) {
  const auto shown = all_or(faces, model.faces.size());
  const Image8 left = model_view(queue, model, shown, false), right = model_view(queue, model, shown, true);
  Image8 both(left.width + right.width, left.height, 3);
  for (int y = 0; y < both.height; ++y) {
    std::copy_n(left.at(0, y), 3 * left.width, both.at(0, y));
    std::copy_n(right.at(0, y), 3 * right.width, both.at(left.width, y));
  }
  return both;
}

void write_landmark_sheet(device::Queue& queue, const fs::path& folder, const ScanProduct& product,
                          const PolygonModel& model, const stages::AutomaticAlignment& alignment) {
  const fs::path sheet = folder / "sheet";
  io::write_png(sheet / "model.png", model_sheet(queue, model, alignment.faces));
  io::write_text(sheet / "landmarks.toml",
                 stanza(product.id, model, all_or(alignment.faces, model.faces.size())));
}

void write_scan_sheet(const fs::path& folder, const ScanProduct& product) {
  io::write_png(folder / "sheet" / "scan.png", scan_sheet(product));
}

void remove_sheets(const fs::path& folder) {
  for (const char* name : {"scan.png", "model.png", "landmarks.toml", "places.png", "places.toml"})
    fs::remove(folder / "sheet" / name);
  std::error_code not_empty;
  fs::remove(folder / "sheet", not_empty);
}

}  // namespace hybrid::batch
