#include "write/e57_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace synth {
namespace {

constexpr double kStep_m = 1e-5;
constexpr std::int64_t kFarthest = (1 << 25) - 1;  // 335 m
constexpr std::int64_t kBrightest = 4095;
constexpr std::uint64_t kPacketRecords = 2048;  // a multiple of 8: every stream ends with a whole byte
constexpr std::uint64_t kHeader = 48, kSection = 32;

// The same for the same seed and name.
std::string guid(std::uint64_t seed, const std::string& name) {
  std::uint64_t high = 14695981039346656037u ^ seed, low = seed + 1;
  for (const char c : name) {
    high = (high ^ static_cast<unsigned char>(c)) * 1099511628211u;
    low = (low ^ high) * 6364136223846793005u + 1442695040888963407u;
  }
  return fmt::format("{{{:08X}-{:04X}-{:04X}-{:04X}-{:012X}}}", high >> 32, (high >> 16) & 0xffff,
                     high & 0xffff, low >> 48, low & 0xffffffffffffu);
}

std::string text(const std::string& name, const std::string& value) {
  return fmt::format("<{0} type=\"String\"><![CDATA[{1}]]></{0}>\n", name, value);
}

std::string real(const std::string& name, double value) {
  return fmt::format("<{0} type=\"Float\">{1}</{0}>\n", name, value);
}

std::string whole(const std::string& name, std::int64_t value) {
  return fmt::format("<{0} type=\"Integer\">{1}</{0}>\n", name, value);
}

std::string structure(const std::string& name, const std::string& children) {
  return fmt::format("<{0} type=\"Structure\">\n{1}</{0}>\n", name, children);
}

std::string pose_xml(const Eigen::Isometry3d& pose) {
  Eigen::Quaterniond q(pose.rotation());
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const Eigen::Vector3d t = pose.translation();
  return structure(
      "pose",
      structure("rotation", real("w", q.w()) + real("x", q.x()) + real("y", q.y()) + real("z", q.z())) +
          structure("translation", real("x", t.x()) + real("y", t.y()) + real("z", t.z())));
}

// Pinhole images look along -z with y up; spherical ones along x with z up.
Eigen::Isometry3d world_from_image(const Camera& camera) {
  const Eigen::Vector3d right = camera.camera_from_world_rotation.row(0),
                        down = camera.camera_from_world_rotation.row(1),
                        forward = camera.camera_from_world_rotation.row(2);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = camera.eye;
  if (camera.spherical) {
    pose.linear().col(0) = forward;
    pose.linear().col(1) = -right;
    pose.linear().col(2) = -down;
  } else {
    pose.linear().col(0) = right;
    pose.linear().col(1) = -down;
    pose.linear().col(2) = -forward;
  }
  return pose;
}

std::uint64_t write_blob(E57Pages& pages, const std::string& bytes) {
  pages.align();
  const std::uint64_t at = pages.physical();
  const std::uint64_t padding = (4 - bytes.size() % 4) % 4;
  pages.number(std::uint64_t{0});  // section 0: a blob
  pages.number(std::uint64_t{16 + bytes.size() + padding});
  pages.write(bytes);
  pages.align();
  return at;
}

std::string blob_xml(const std::string& name, std::uint64_t at, std::size_t length) {
  return fmt::format("<{} type=\"Blob\" fileOffset=\"{}\" length=\"{}\"/>\n", name, at, length);
}

std::string picture_xml(E57Pages& pages, const E57Picture& picture, const Eigen::Isometry3d& file_from_world,
                        std::uint64_t seed, const std::string& scan_guid) {
  const Camera& camera = picture.camera;
  if (camera.k1 != 0 || camera.k2 != 0) throw std::logic_error("E57: a pinhole image has no distortion");
  std::string shown = blob_xml("jpegImage", write_blob(pages, picture.jpeg), picture.jpeg.size());
  if (!picture.mask_png.empty())
    shown += blob_xml("imageMask", write_blob(pages, picture.mask_png), picture.mask_png.size());
  shown += whole("imageWidth", camera.width_px) + whole("imageHeight", camera.height_px);
  constexpr double kPixel_m = 5e-6;
  if (camera.spherical)
    shown += real("pixelWidth", 1 / camera.focal_px) + real("pixelHeight", 1 / camera.focal_px);
  else
    shown += real("focalLength", camera.focal_px * kPixel_m) + real("pixelWidth", kPixel_m) +
             real("pixelHeight", kPixel_m) + real("principalPointX", camera.centre_x_px) +
             real("principalPointY", camera.centre_y_px);
  std::string image = text("guid", guid(seed, "image " + camera.name)) + text("name", camera.name);
  if (!scan_guid.empty()) image += text("associatedData3DGuid", scan_guid);
  image += pose_xml(file_from_world * world_from_image(camera));
  image += structure(camera.spherical ? "sphericalRepresentation" : "pinholeRepresentation", shown);
  return structure("vectorChild", image);
}

std::string root_xml(const std::string& file_guid, const std::string& data3d, const std::string& images2d) {
  const auto vector = [](const char* name, const std::string& children) {
    return fmt::format("<{0} type=\"Vector\" allowHeterogeneousChildren=\"1\">\n{1}</{0}>\n", name, children);
  };
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<e57Root type=\"Structure\" xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\">\n" +
         text("formatName", "ASTM E57 3D Imaging Data File") + text("guid", file_guid) +
         whole("versionMajor", 1) + whole("versionMinor", 0) + text("e57LibraryVersion", "synthetic scenes") +
         vector("data3D", data3d) + vector("images2D", images2d) + "</e57Root>\n";
}

void write_header(E57Pages& pages) {
  pages.write("ASTM-E57");
  pages.number(std::uint32_t{1});  // version 1.0
  pages.number(std::uint32_t{0});
  for (int i = 0; i < 3; ++i) pages.number(std::uint64_t{0});  // known last
  pages.number(E57Pages::kPage);
}

void write_end(E57Pages& pages, const std::string& xml) {
  pages.align();
  pages.patch(24, pages.physical());
  pages.patch(32, std::uint64_t{xml.size()});
  pages.write(xml);
  pages.fill();
  pages.patch(16, pages.physical());
  pages.commit();
}

}  // namespace

Eigen::Isometry3d site_from_world() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(std::numbers::pi / 6, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(12.5, -7.25, 1.5);
  return pose;
}

E57ScanFile::E57ScanFile(const std::filesystem::path& path, const ScannerPose& pose, const Preset& preset,
                         std::uint64_t seed)
    : pages_(path),
      pose_(pose),
      seed_(seed),
      low_(Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity())),
      high_(-low_),
      rows_(grid_rows(pose, preset)),
      columns_(preset.scan_columns) {
  const std::string scaled = fmt::format(" scale=\"{}\" offset=\"0\"", kStep_m);
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
    fields_.push_back({name, "ScaledInteger", -kFarthest, kFarthest, scaled});
  fields_.push_back({"intensity", "ScaledInteger", 0, kBrightest,
                     fmt::format(" scale=\"{}\" offset=\"0\"", 1.0 / kBrightest)});
  fields_.push_back({"rowIndex", "Integer", 0, rows_ - 1, ""});
  fields_.push_back({"columnIndex", "Integer", 0, columns_ - 1, ""});
  for (Field& field : fields_)
    field.bits = std::bit_width(static_cast<std::uint64_t>(field.maximum - field.minimum));
  write_header(pages_);
  const std::uint64_t section[4] = {1, 0, 0, 0};  // of compressed vectors; the rest is known last
  pages_.write(section, sizeof section);
  data_offset_ = pages_.physical();
}

void E57ScanFile::put(std::size_t index, std::int64_t value) {
  Field& field = fields_[index];
  if (value < field.minimum || value > field.maximum)
    throw std::runtime_error(fmt::format("E57: {} does not fit its bits", field.name));
  field.held |= static_cast<std::uint64_t>(value - field.minimum) << field.held_bits;
  field.held_bits += field.bits;
  for (; field.held_bits >= 8; field.held_bits -= 8, field.held >>= 8)
    field.bytes += static_cast<char>(field.held & 255);
}

void E57ScanFile::add(const std::vector<Sample>& column) {
  for (const Sample& s : column) {
    const Eigen::Vector3d point = s.point_in_scan.cast<double>();
    for (int k = 0; k < 3; ++k) put(static_cast<std::size_t>(k), std::llround(point[k] / kStep_m));
    put(3, std::llround(static_cast<double>(s.intensity) * static_cast<double>(kBrightest)));
    put(4, s.row);
    put(5, static_cast<std::int64_t>(column_));
    low_ = low_.cwiseMin(point);
    high_ = high_.cwiseMax(point);
    ++records_;
    if (++in_packet_ == kPacketRecords) write_packet();
  }
  ++column_;
}

void E57ScanFile::write_packet() {
  if (in_packet_ == 0) return;
  std::size_t length = 6 + 2 * fields_.size();
  for (Field& field : fields_) {
    if (field.held_bits > 0) field.bytes += static_cast<char>(field.held & 255);
    field.held = 0;
    field.held_bits = 0;
    length += field.bytes.size();
  }
  const std::size_t padded = (length + 3) / 4 * 4;
  pages_.number(std::uint8_t{1});  // a data packet
  pages_.number(std::uint8_t{0});
  pages_.number(static_cast<std::uint16_t>(padded - 1));
  pages_.number(static_cast<std::uint16_t>(fields_.size()));
  for (const Field& field : fields_) pages_.number(static_cast<std::uint16_t>(field.bytes.size()));
  for (Field& field : fields_) {
    pages_.write(field.bytes);
    field.bytes.clear();
  }
  pages_.align();
  in_packet_ = 0;
}

std::string E57ScanFile::points_xml() const {
  std::string prototype;
  for (const Field& field : fields_)
    prototype += fmt::format("<{} type=\"{}\" minimum=\"{}\" maximum=\"{}\"{}/>\n", field.name, field.type,
                             field.minimum, field.maximum, field.attributes);
  return fmt::format(
      "<points type=\"CompressedVector\" fileOffset=\"{}\" recordCount=\"{}\">\n{}"
      "<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"/>\n</points>\n",
      kHeader, records_, structure("prototype", prototype));
}

void E57ScanFile::finish() {
  write_packet();
  // One index packet with one entry, the start: the least that readers who seek ask for.
  const std::uint64_t index_offset = pages_.physical();
  pages_.number(std::uint8_t{0});
  pages_.number(std::uint8_t{0});
  pages_.number(std::uint16_t{16 + 16 - 1});
  pages_.number(std::uint16_t{1});
  pages_.number(std::uint8_t{0});
  pages_.write(std::string(9, '\0'));
  pages_.number(std::uint64_t{0});
  pages_.number(data_offset_);
  pages_.patch(kHeader + 8, pages_.logical() - kHeader);
  pages_.patch(kHeader + 16, data_offset_);
  pages_.patch(kHeader + 24, index_offset);

  const Eigen::Isometry3d file_from_world = site_from_world();
  const std::string scan_guid = guid(seed_, "scan " + pose_.id);
  std::string scan = text("guid", scan_guid) + text("name", pose_.id) +
                     pose_xml(file_from_world * pose_.world_from_scan) + points_xml();
  scan += structure("intensityLimits", real("intensityMinimum", 0) + real("intensityMaximum", 1));
  scan += structure("indexBounds", whole("rowMinimum", 0) + whole("rowMaximum", rows_ - 1) +
                                       whole("columnMinimum", 0) + whole("columnMaximum", columns_ - 1) +
                                       whole("returnMinimum", 0) + whole("returnMaximum", 0));
  if (records_ > 0)
    scan += structure("cartesianBounds", real("xMinimum", low_.x()) + real("xMaximum", high_.x()) +
                                             real("yMinimum", low_.y()) + real("yMaximum", high_.y()) +
                                             real("zMinimum", low_.z()) + real("zMaximum", high_.z()));
  std::string images;
  for (const E57Picture& picture : pictures_)
    images += picture_xml(pages_, picture, file_from_world, seed_, scan_guid);
  write_end(pages_, root_xml(guid(seed_, "file " + pose_.id), structure("vectorChild", scan), images));
}

void write_e57_pictures(const std::filesystem::path& path, const std::vector<E57Picture>& pictures,
                        std::uint64_t seed) {
  E57Pages pages(path);
  write_header(pages);
  std::string images;
  for (const E57Picture& picture : pictures)
    images += picture_xml(pages, picture, Eigen::Isometry3d::Identity(), seed, "");
  write_end(pages, root_xml(guid(seed, "photographs"), "", images));
}

}  // namespace synth
