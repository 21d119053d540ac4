#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "perfect_results.hpp"

namespace score_tests {
namespace {

namespace fs = std::filesystem;
using namespace score;
using Json = nlohmann::ordered_json;

class ExrWriter {
 public:
  ExrWriter(int width, int height) : header_(width, height), row_(4 * static_cast<std::size_t>(width)) {
    height_ = height;
  }
  template <typename T>
  void add(const char* name, const std::vector<T>& values) {
    const auto type = std::is_same_v<T, float> ? Imf::FLOAT : Imf::UINT;
    header_.channels().insert(name, Imf::Channel(type));
    buffer_.insert(name, Imf::Slice(type, reinterpret_cast<char*>(const_cast<T*>(values.data())), 4, row_));
  }
  Imf::Header& header() { return header_; }
  void write(const fs::path& file) {
    Imf::OutputFile out(file.c_str(), header_);
    out.setFrameBuffer(buffer_);
    out.writePixels(height_);
  }

 private:
  Imf::Header header_;
  Imf::FrameBuffer buffer_;
  std::size_t row_;
  int height_;
};

Json json_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

void write_planes(const fs::path& file, const PerfectScan& scan) {
  Json list = Json::array();
  for (const auto& [id, plane] : scan.planes) {
    Json contours = Json::array();
    for (const auto& ring : plane.rings) {
      Json points = Json::array();
      for (const Vec3& point : ring) points.push_back(json_of(point));
      contours.push_back({{"ring", "outer"}, {"points_m", points}});
    }
    list.push_back({{"id", id},
                    {"normal", json_of(plane.plane.normal)},
                    {"offset_m", plane.plane.offset_m},
                    {"contours", contours}});
  }
  write_text(file, Json{{"superclusters", list}}.dump());
}

void write_pose(const fs::path& file, const PerfectScan& scan) {
  Json matrix = Json::array();
  const Similarity& pose = scan.world_from_scan;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) matrix.push_back(pose.scale * pose.rotation(row, col));
    matrix.push_back(pose.translation[row]);
  }
  for (const double last : {0.0, 0.0, 0.0, 1.0}) matrix.push_back(last);
  write_text(file, Json{{"world_from_scan", matrix}, {"status", scan.status}, {"how", scan.how}}.dump());
}

void write_detail(const fs::path& file, const std::vector<Eigen::Vector3f>& points) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "property uchar stray\nend_header\n",
      points.size());
  for (const auto& point : points) {
    bytes.append(reinterpret_cast<const char*>(point.data()), 12);
    bytes.push_back('\0');
  }
  write_text(file, bytes);
}

void write_view(const fs::path& file, const ViewResult& view) {
  std::array<std::vector<float>, 3> rgb;
  for (std::size_t i = 0; i < view.linear.rgb.size(); ++i) rgb[i % 3].push_back(view.linear.rgb[i]);
  ExrWriter writer(view.linear.width, view.linear.height);
  writer.add("R", rgb[0]);
  writer.add("G", rgb[1]);
  writer.add("B", rgb[2]);
  writer.add("id", view.id);
  writer.add("coverage", view.coverage);
  writer.add("best", view.best);
  writer.add("Z", view.depth_m);
  writer.write(file);
}

void write_model(const fs::path& folder, const Results& results) {
  std::string obj;
  int next = 1;
  for (const auto& polygon : results.polygons) {
    std::string face = "f";
    for (const Vec3& corner : polygon) {
      obj += fmt::format("v {} {} {}\n", corner.x(), corner.y(), corner.z());
      face += fmt::format(" {}", next++);
    }
    obj += face + "\n";
  }
  write_text(folder / "edited.obj", obj);
  Json list = Json::array();
  for (const auto& polygon : results.reported) {
    Json ring = Json::array();
    for (const Vec3& corner : polygon) ring.push_back(json_of(corner));
    list.push_back({{"face", "any"}, {"ring", ring}});
  }
  write_text(folder / "openings.json", Json{{"openings", list}}.dump());
}

}  // namespace

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

void write_range_exr(const fs::path& file, const LabelledGrid& grid, const std::vector<float>& range_m) {
  std::vector<std::uint32_t> mask;
  std::array<std::vector<float>, 3> xyz;
  for (std::size_t i = 0; i < grid.source.size(); ++i) {
    mask.push_back(grid.source[i] != kNoSource);
    for (int axis = 0; axis < 3; ++axis) xyz[static_cast<std::size_t>(axis)].push_back(grid.point[i][axis]);
  }
  ExrWriter writer(grid.cols, grid.rows);
  writer.header().insert("hybrid:wraps", Imf::IntAttribute(grid.wraps ? 1 : 0));
  writer.add("range", range_m);
  writer.add("mask", mask);
  writer.add("source", grid.source);
  writer.add("x", xyz[0]);
  writer.add("y", xyz[1]);
  writer.add("z", xyz[2]);
  writer.write(file);
}

void write_labels_exr(const fs::path& file, const LabelledGrid& grid) {
  ExrWriter writer(grid.cols, grid.rows);
  writer.add("id", grid.label);
  writer.write(file);
}

void write_results(const Results& results, const fs::path& folder) {
  for (const PerfectScan& scan : results.scans) {
    const fs::path place = folder / "scans" / scan.id;
    fs::create_directories(place);
    write_range_exr(place / "range.exr", scan.grid, scan.range_m);
    write_labels_exr(place / "labels.exr", scan.grid);
    write_planes(place / "planes.json", scan);
    write_pose(place / "pose.json", scan);
    write_detail(place / "detail.ply", scan.kept);
  }
  fs::create_directories(folder / "views");
  for (const PerfectView& view : results.views)
    write_view(folder / "views" / (view.name + ".exr"), view.image);
  fs::create_directories(folder / "model");
  write_model(folder / "model", results);
}

}  // namespace score_tests
