#include "score/read/scan_result.hpp"

#include "score/error.hpp"
#include "score/read/exr_file.hpp"
#include "score/read/files.hpp"
#include "score/read/ply_file.hpp"

namespace score {
namespace {

constexpr std::uint32_t kMeasured = 1;  // of the channel `mask`
constexpr const char* kRunAgain = "run hybrid again on the scene";

}  // namespace

LabelledGrid read_labelled_grid(const std::filesystem::path& folder) {
  const auto range_file = folder / "range.exr", label_file = folder / "labels.exr";
  ExrFile range(range_file), labels(label_file);
  if (range.width() != labels.width() || range.height() != labels.height())
    bad_input("{}: expected {} x {} pixels as in range.exr beside it, found {} x {}; write both from one run",
              label_file.string(), range.width(), range.height(), labels.width(), labels.height());
  LabelledGrid grid;
  grid.rows = range.height();
  grid.cols = range.width();
  grid.wraps = range.whole_number("hybrid:wraps").value_or(0) != 0;
  range.prepare({"source", "range", "mask", "x", "y", "z"});
  grid.source = range.uints("source");
  grid.range_m = range.floats("range");
  grid.label = labels.uints("id");
  const auto mask = range.uints("mask");
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] != kMeasured) {
      grid.source[i] = kNoSource;
      grid.label[i] = 0;
    }
  if (range.has("x") && range.has("y") && range.has("z")) {
    const auto x = range.floats("x"), y = range.floats("y"), z = range.floats("z");
    grid.point.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) grid.point[i] = {x[i], y[i], z[i]};
  }
  return grid;
}

std::optional<std::map<std::uint32_t, ResultPlane>> read_result_planes(const std::filesystem::path& folder) {
  const auto file = folder / "planes.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  return from_json(file, kRunAgain, [](const nlohmann::json& document) {
    std::map<std::uint32_t, ResultPlane> planes;
    for (const auto& entry : document.at("superclusters")) {
      ResultPlane plane;
      plane.plane = {json_vec3(entry.at("normal")), entry.at("offset_m").get<double>()};
      const auto id = entry.at("id").get<std::uint32_t>();
      if (!(std::abs(plane.plane.normal.norm() - 1) < 1e-3))
        bad_input("supercluster {}: expected a unit normal, found one of length {}", id,
                  plane.plane.normal.norm());
      for (const auto& contour : entry.at("contours")) {
        plane.rings.emplace_back();
        for (const auto& point : contour.at("points_m")) plane.rings.back().push_back(json_vec3(point));
      }
      if (!planes.emplace(id, plane).second) bad_input("expected supercluster {} once, found it twice", id);
    }
    return planes;
  });
}

std::optional<std::vector<ResultCylinder>> read_result_cylinders(const std::filesystem::path& folder) {
  const auto file = folder / "planes.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  return from_json(file, kRunAgain, [](const nlohmann::json& document) {
    std::optional<std::vector<ResultCylinder>> cylinders;
    if (!document.contains("cylinders")) return cylinders;
    cylinders.emplace();
    for (const auto& entry : document.at("cylinders")) {
      if (entry.at("seen_from") != "outside") continue;
      const ResultCylinder cylinder{json_vec3(entry.at("foot_m")), json_vec3(entry.at("axis")),
                                    entry.at("length_m").get<double>(), entry.at("radius_m").get<double>()};
      if (!(std::abs(cylinder.axis.norm() - 1) < 1e-3) || !(cylinder.length_m >= 0) ||
          !(cylinder.radius_m > 0))
        bad_input("cylinder {}: expected an axis of length 1, a length and a radius", entry.at("id").dump());
      cylinders->push_back(cylinder);
    }
    return cylinders;
  });
}

std::optional<ResultPose> read_result_pose(const std::filesystem::path& folder) {
  const auto file = folder / "pose.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  return from_json(file, kRunAgain, [](const nlohmann::json& document) {
    const auto status = document.at("status").get<std::string>();
    if (status != "accepted" && status != "abstained")
      bad_input("status: expected accepted or abstained, found {}", status);
    const auto& pose = document.at("world_from_scan");
    if (status == "abstained" && pose.is_null()) return ResultPose{};
    return ResultPose{json_pose(pose), status == "accepted", document.value("how", "") == "frame"};
  });
}

std::optional<std::vector<Eigen::Vector3f>> read_kept_points(const std::filesystem::path& folder) {
  const auto file = folder / "detail.ply";
  if (!std::filesystem::exists(file)) return std::nullopt;
  return read_ply(file).vertices;
}

}  // namespace score
