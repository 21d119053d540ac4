#pragma once
#include <gtest/gtest.h>

#include "io/e57/e57_source.hpp"
#include "io/e57_scans.hpp"
#include "io/files.hpp"

// Every kind of image that an E57 file can hold, one row each.
namespace hybrid::testing {

using io::E57Projection;

inline constexpr const char* kScanGuid = "{a-scan}";

struct ImageRow {
  const char* name;
  E57Projection projection;
  bool png = false, mask = false, pose = true, scan = false;
  bool reference = false;  // a visual reference beside it
  bool photograph = true;  // has a camera
};

inline const ImageRow kImageRows[] = {
    {.name = "pinhole jpeg", .projection = E57Projection::pinhole},
    {.name = "pinhole png mask", .projection = E57Projection::pinhole, .png = true, .mask = true},
    {.name = "pinhole scan", .projection = E57Projection::pinhole, .scan = true},
    {.name = "pinhole without a pose", .projection = E57Projection::pinhole, .pose = false},
    {.name = "spherical jpeg mask", .projection = E57Projection::spherical, .mask = true, .scan = true},
    {.name = "spherical png", .projection = E57Projection::spherical, .png = true},
    {.name = "spherical and reference", .projection = E57Projection::spherical, .reference = true},
    {.name = "cylindrical jpeg", .projection = E57Projection::cylindrical},
    {.name = "cylindrical png mask scan",
     .projection = E57Projection::cylindrical,
     .png = true,
     .mask = true,
     .scan = true},
    {.name = "cylindrical and reference",
     .projection = E57Projection::cylindrical,
     .mask = true,
     .reference = true},
    {.name = "reference jpeg", .projection = E57Projection::visual_reference, .photograph = false},
    {.name = "reference png mask",
     .projection = E57Projection::visual_reference,
     .png = true,
     .mask = true,
     .photograph = false},
    {.name = "reference scan",
     .projection = E57Projection::visual_reference,
     .pose = false,
     .scan = true,
     .photograph = false},
};

// Bytes that no two rows share; nothing decodes them here.
inline std::string picture_of(const ImageRow& row) {
  return std::string("picture of ") + row.name;
}
inline std::string mask_of(const ImageRow& row) {
  return std::string("mask of ") + row.name;
}

inline io::E57Image image_of(const ImageRow& row) {
  io::E57Image image{
      .name = row.name, .projection = row.projection, .png = row.png, .width = 40, .height = 20};
  image.guid = std::string("{") + row.name + "}";
  if (row.scan) image.scan_guid = kScanGuid;
  if (row.pose) image.world_from_image = Pose{1, Eigen::Quaterniond(0.8, 0, 0.6, 0), {1, 2, 3.5}};
  image.focal_length_m = 0.02;
  const bool pinhole = row.projection == E57Projection::pinhole;
  image.pixel_width = pinhole ? 1e-4 : 0.01;
  image.pixel_height = pinhole ? 2e-4 : 0.02;
  image.principal_x = 19.5;
  image.principal_y = 11;
  image.radius_m = 0.25;
  return image;
}

// A scan and all rows; a row's reference is put into the description, which E57Writer has no words for: it
// shows the picture of the row before.
inline std::filesystem::path write_image_rows(const std::filesystem::path& folder) {
  const auto file = folder / "plain.e57", changed = folder / "in.e57";
  const auto put = [&](const std::string& bytes) { std::ofstream(changed, std::ios::binary) << bytes; };
  io::E57Writer writer(file, {.guid = "{file}"});
  io::E57Scan scan{.guid = kScanGuid, .name = "scan"};
  for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
    scan.points.fields.push_back(real_field(axis));
  writer.begin_scan(scan);
  writer.write(random_columns(scan.points.fields, 10).records());
  writer.end_scan();
  for (const ImageRow& row : kImageRows)
    writer.add_image(image_of(row), picture_of(row), row.mask ? mask_of(row) : std::string());
  writer.close();
  std::string bytes = bytes_of(file);
  const auto images = io::E57File(file).contents().images;
  for (std::size_t i = 0; i < std::size(kImageRows); ++i) {
    if (!kImageRows[i].reference) continue;
    const std::string end = kImageRows[i].projection == E57Projection::spherical
                                ? "</sphericalRepresentation>"
                                : "</cylindricalRepresentation>";
    put(bytes);
    const std::string xml = io::E57File(changed).xml();
    const auto from = xml.find(kImageRows[i].name);
    const std::string element = xml.substr(from, xml.find(end, from) + end.size() - from);
    const io::E57Blob& blob = images[i - 1].picture;
    bytes = with_xml(
        bytes, element,
        element + fmt::format("<visualReferenceRepresentation type=\"Structure\"><{0}Image type=\"Blob\" "
                              "fileOffset=\"{1}\" length=\"{2}\"/><imageWidth type=\"Integer\">8</imageWidth>"
                              "<imageHeight type=\"Integer\">4</imageHeight></visualReferenceRepresentation>",
                              kImageRows[i - 1].png ? "png" : "jpeg", blob.offset, blob.length));
  }
  put(bytes);
  return changed;
}

}  // namespace hybrid::testing
