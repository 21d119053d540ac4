#include "batch/export/export_st_maps.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "core/json_text.hpp"
#include "geometry/st_map.hpp"
#include "io/cameras/write_colmap.hpp"
#include "io/exr/exr.hpp"
#include "io/output.hpp"

namespace hybrid::batch {
namespace {

void write_map(const std::filesystem::path& file, const Camera& target, const Camera& source) {
  const ImageF map = st_map(target, source);
  io::write_exr(file, map.width, map.height,
                {{"R", map.pixels.data(), nullptr, 2}, {"G", map.pixels.data() + 1, nullptr, 2}});
}

}  // namespace

void write_st_maps(const std::vector<Photograph>& photographs, const MadeFile& made, const SayNote& note) {
  using Json = nlohmann::ordered_json;
  const auto camera_of = io::number_cameras(photographs);
  std::map<std::size_t, Json> maps;  // of each camera
  Json rows = Json::array();
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const Camera& camera = photographs[i].camera;
    if (!is_distorted(camera)) continue;
    auto& map = maps[camera_of[i]];
    if (map.is_null()) {
      const std::string stem = fmt::format("camera-{}", camera_of[i] + 1);
      const Camera pinhole = pinhole_of(camera);
      map = {{"undistort", stem + "-undistort.exr"},
             {"distort", stem + "-distort.exr"},
             {"pinhole",
              {{"size_px", {pinhole.width, pinhole.height}},
               {"focal_px", {pinhole.fx, pinhole.fy}},
               {"centre_px", {pinhole.cx, pinhole.cy}}}}};
      write_map(made("st/" + stem + "-undistort.exr"), pinhole, camera);
      write_map(made("st/" + stem + "-distort.exr"), camera, pinhole);
    }
    Json row = {{"photograph", photographs[i].name}};
    row.update(map);
    rows.push_back(row);
  }
  if (rows.empty()) {
    note("no photograph with distortion: no ST maps");
    return;
  }
  io::write_text(made("st/cameras.json"), json_text(rows) + "\n");
}

}  // namespace hybrid::batch
