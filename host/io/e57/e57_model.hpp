#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose.hpp"

namespace hybrid::io {

enum class E57Type { integer, scaled_integer, single_real, double_real, text };

// One column of a scan's table, as its prototype declares it.
struct E57Field {
  std::string name{};  // "cartesianX", "rowIndex"; of an extension with its prefix: "nor:normalX"
  E57Type type = E57Type::integer;
  std::int64_t minimum = std::numeric_limits<std::int64_t>::min();  // of integers and scaled integers: stored
  std::int64_t maximum = std::numeric_limits<std::int64_t>::max();  // in as few bits as hold the difference
  double scale = 1, offset = 0;               // of scaled integers: value = stored * scale + offset
  std::optional<double> lowest{}, highest{};  // of reals, where declared

  bool is_integer() const { return type == E57Type::integer || type == E57Type::scaled_integer; }
  int bits() const;  // per value in the file; 0 when minimum and maximum are the same, and for text
  bool operator==(const E57Field&) const = default;
};

// What a stream of `count` values takes when its last word (of 8, 16, 32 or 64 bits, as the width asks for)
// is filled up, as the reference implementation and E57Writer do.
std::uint64_t word_padded_bytes(const E57Field& field, std::uint64_t count);

struct E57Limits {
  double minimum = 0, maximum = 0;
  bool operator==(const E57Limits&) const = default;
};

// A table in the file: a scan's points.
struct E57Table {
  std::string what{};              // for messages: "scan 3 (west wall)"
  std::uint64_t offset = 0;        // of its section, as in the file (physical)
  std::uint64_t count = 0;         // of records, as the file says
  std::vector<E57Field> fields{};  // in the order of the streams
  bool whole_words = false;        // its writer fills up the last word of each stream
};

// One scan's description (data3D).
struct E57Scan {
  std::string guid{}, name{}, description{}, sensor{};
  std::vector<std::string> original_guids{};
  std::optional<Pose> world_from_scan{};  // normalised
  E57Table points{};
  std::optional<E57Limits> intensity{};
  std::optional<std::array<E57Limits, 3>> colour{};       // red, green, blue
  std::optional<E57Limits> rows{}, columns{}, returns{};  // indexBounds
  std::vector<std::string> dropped{};  // elements that nothing here keeps: extensions, groupings, ...
  std::vector<std::string> notes{};
};

enum class E57Projection { visual_reference, pinhole, spherical, cylindrical };
const char* name_of(E57Projection projection);

// A blob's place: the bytes of a picture.
struct E57Blob {
  std::uint64_t offset = 0;  // of its section, as in the file (physical)
  std::uint64_t length = 0;  // of its content
};

// A further picture of the same image: a panorama's preview, as it may be.
struct E57Representation {
  E57Projection projection = E57Projection::visual_reference;
  bool png = false;  // else JPEG
  E57Blob picture{};
  std::optional<E57Blob> mask{};  // always PNG
  int width = 0, height = 0;      // pixels
};

// One photograph's description (images2D).
struct E57Image {
  std::string guid{}, name{}, description{}, sensor{};
  std::string scan_guid{};                 // associatedData3DGuid, may be empty
  std::optional<Pose> world_from_image{};  // as the file has it: looks along -z, y up; normalised
  E57Projection projection = E57Projection::visual_reference;
  bool png = false;  // else JPEG
  E57Blob picture{};
  std::optional<E57Blob> mask{};             // always PNG
  int width = 0, height = 0;                 // pixels
  double focal_length_m = 0;                 // pinhole
  double pixel_width = 0, pixel_height = 0;  // pinhole: metres; spherical, cylinder's width: radians
  double principal_x = 0, principal_y = 0;   // pixels from the left and top edge
  double radius_m = 0;                       // cylindrical
  std::vector<E57Representation> others{};   // than the one above, which says most about the camera
  std::vector<std::string> dropped{};
  std::vector<std::string> notes{};
};

// A namespace that element names of an extension refer to by their prefix.
struct E57Extension {
  std::string prefix{}, address{};
};

// Everything the XML section of a file says.
struct E57Contents {
  std::string guid{}, library{},
      coordinate_system{};  // coordinateMetadata: well-known text of a CRS, may be empty
  std::vector<E57Extension> extensions{};
  std::vector<E57Scan> scans{};
  std::vector<E57Image> images{};
  std::vector<std::string> notes{};
};

}  // namespace hybrid::io
