#include "batch/orthophotos.hpp"

#include <fmt/format.h>

#include "batch/picture_marks.hpp"
#include "batch/planes_json.hpp"
#include "core/parallel.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "stages/contours/orthophoto.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::int64_t kLeastSamples = 100;

void draw_contours(const Supercluster& plane, stages::Orthophoto& photo) {
  const auto pixel = [&](const Vec3& point) -> Vec2 {
    const Vec3 from = point - photo.origin;
    return Vec2(photo.right.dot(from), -photo.up.dot(from)) / photo.pixel_m;
  };
  for (const ContourRing& ring : plane.contours) {
    const Ink ink = ring.outer ? Ink{230, 40, 30} : Ink{40, 90, 240};
    for (std::size_t i = 0; i < ring.points.size(); ++i)
      draw_line(photo.picture, pixel(ring.points[i]), pixel(ring.points[(i + 1) % ring.points.size()]), ink);
  }
}

// What measures in the picture need.
Json describe(const stages::Orthophoto& photo, const Supercluster& plane, const std::string& file) {
  return {{"id", plane.id},
          {"file", file},
          {"size", {photo.picture.width, photo.picture.height}},
          {"pixel_m", photo.pixel_m},
          {"origin_m", json_of(photo.origin)},
          {"right", json_of(photo.right)},
          {"up", json_of(photo.up)}};
}

void remove_older(const std::filesystem::path& folder) {
  std::error_code code;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code))
    if (entry.path().extension() == ".png") std::filesystem::remove(entry.path(), code);
}

}  // namespace

void write_orthophotos(const std::filesystem::path& folder, const ScanProduct& product) {
  const auto& planes = product.segmentation.superclusters;
  const stages::SampleLook look(product.image);
  remove_older(folder / "planes");
  std::vector<Json> described(planes.size());
  parallel_for(planes.size(), [&](std::size_t i) {
    if (planes[i].samples < kLeastSamples) return;
    auto photo = stages::make_orthophoto(product.image, product.segmentation, planes[i], look);
    if (!photo) return;
    draw_contours(planes[i], *photo);
    const std::string file = fmt::format("{:04}.png", planes[i].id);
    described[i] = describe(*photo, planes[i], file);
    io::write_png(folder / "planes" / file, std::move(photo->picture));
  });
  Json list = Json::array();
  for (Json& entry : described)
    if (!entry.is_null()) list.push_back(std::move(entry));
  io::write_text(
      folder / "planes" / "index.json",
      Json{{"frame", "scan"}, {"pixel", "origin_m + pixel_m * (x * right - y * up)"}, {"planes", list}}.dump(
          1) +
          "\n");
}

}  // namespace hybrid::batch
