#include "io/samples/sample_header.hpp"

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "io/samples/columns.hpp"

namespace hybrid::io {
namespace {

using Json = nlohmann::ordered_json;

// Numbers in digits pack to a third or a quarter.
constexpr std::size_t kMostHeader = 1 << 16, kMostPerByte = 64;

template <std::size_t n>
std::vector<std::array<double, n>> rows_of(const Json& json) {
  return json.get<std::vector<std::array<double, n>>>();
}

bool finite(const Json& json) {
  if (json.is_number()) return std::isfinite(json.get<double>());
  if (json.is_array() || json.is_object())
    for (const auto& part : json)
      if (part.is_number() && !std::isfinite(part.get<double>())) return false;
  return true;
}

SampleHeader from_json(const Json& json) {
  SampleHeader header;
  header.rows = json.at("rows").get<int>();
  header.cols = json.at("cols").get<int>();
  header.wraps = json.at("wraps").get<bool>();
  header.elevation_rad = json.at("elevation_rad").get<std::vector<double>>();
  header.azimuth_rad = json.at("azimuth_rad").get<std::vector<double>>();
  header.elevation_ray = rows_of<2>(json.at("elevation_ray"));
  header.azimuth_ray = rows_of<2>(json.at("azimuth_ray"));
  for (const auto& p : rows_of<4>(json.at("planes"))) header.planes.push_back({{p[0], p[1], p[2]}, p[3]});
  const auto origin = json.at("origin").get<std::array<double, 3>>();
  header.origin = {origin[0], origin[1], origin[2]};
  header.point = NumberCode(json.at("point_step").get<double>());
  header.intensity = json.contains("intensity_step");
  if (header.intensity) header.intensity_code = NumberCode(json.at("intensity_step").get<double>());
  header.colour = json.at("colour").get<bool>();
  header.samples = json.at("samples").get<std::uint64_t>();
  header.discarded = json.at("discarded").get<std::uint64_t>();
  header.extra = json.at("extra").get<std::uint64_t>();
  if (json.contains("world_from_scan"))
    header.world_from_scan = pose_from_row_major(json.at("world_from_scan").get<std::array<double, 16>>());
  header.crs = json.at("crs").get<std::string>();
  return header;
}

void check(const SampleHeader& header, const std::string& place) {
  const auto rows = static_cast<std::size_t>(std::max(header.rows, 0)),
             cols = static_cast<std::size_t>(std::max(header.cols, 0));
  if (header.rows < 1 || header.cols < 1 || header.nodes() > 0xffffffffu)
    fail_input("{}: expected 1 to 2^32 nodes, found {} x {}; make the file again from the scan", place,
               header.rows, header.cols);
  if (header.elevation_rad.size() != rows || header.azimuth_rad.size() != cols ||
      header.elevation_ray.size() != rows || header.azimuth_ray.size() != cols)
    fail_input(
        "{}: expected an angle per row and column of {} x {}, found other tables; make the file again "
        "from the scan",
        place, header.rows, header.cols);
  if (!(header.point.step() >= 0) || !(header.intensity_code.step() >= 0))
    fail_input("{}: expected steps of 0 and more, found others; make the file again from the scan", place);
}

}  // namespace

std::string header_bytes(const SampleHeader& header) {
  Json json = {{"rows", header.rows},
               {"cols", header.cols},
               {"wraps", header.wraps},
               {"samples", header.samples},
               {"discarded", header.discarded},
               {"extra", header.extra},
               {"point_step", header.point.step()},
               {"colour", header.colour},
               {"crs", header.crs},
               {"origin", {header.origin.x(), header.origin.y(), header.origin.z()}},
               {"elevation_rad", header.elevation_rad},
               {"azimuth_rad", header.azimuth_rad},
               {"elevation_ray", header.elevation_ray},
               {"azimuth_ray", header.azimuth_ray},
               {"planes", Json::array()}};
  if (header.intensity) json["intensity_step"] = header.intensity_code.step();
  if (header.world_from_scan) json["world_from_scan"] = row_major(*header.world_from_scan);
  for (const Plane& plane : header.planes)
    json["planes"].push_back({plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset_m});
  return compress(json_text(json, -1));
}

SampleHeader parse_header(std::string_view bytes, const std::string& place) {
  const std::string text = decompress(bytes, kMostHeader + kMostPerByte * bytes.size(), place);
  try {
    const Json json = Json::parse(text);
    for (const auto& [key, value] : json.items())
      if (!finite(value)) fail_input("{}: {}: expected finite numbers; make the file again", place, key);
    SampleHeader header = from_json(json);
    check(header, place);
    return header;
  } catch (const Json::exception& error) {
    fail_input(
        "{}: expected the header of a sample file, found another ({}); copy the file again, or make it "
        "again from the scan",
        place, error.what());
  }
}

}  // namespace hybrid::io
