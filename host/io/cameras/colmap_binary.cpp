#include <bit>
#include <cmath>
#include <cstring>

#include "core/error.hpp"
#include "io/cameras/colmap.hpp"
#include "io/cameras/colmap_model.hpp"
#include "io/input_file.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "COLMAP's binary models are little endian");

// Least bytes of a camera (no parameters), an image (one letter, no points) and exactly those of a 2D point.
constexpr std::uint64_t kCameraBytes = 24, kImageBytes = 4 + 7 * 8 + 4 + 2 + 8, kPointBytes = 24;

// Takes values off the front of a file, with errors that name file, byte and field.
class ByteReader {
 public:
  explicit ByteReader(const fs::path& file) : file_(file) {}

  std::string place() const { return fmt::format("{}: byte {}", file_.name(), at_); }
  template <typename T>
  T take(std::string_view field) {
    if (left() < sizeof(T))
      fail_input("{}: expected {}, found the end of the file: cut short?", place(), field);
    T value;
    std::memcpy(&value, file_.at(at_, sizeof(T)), sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  double number(std::string_view field) {
    const std::string before = place();
    const double value = take<double>(field);
    if (!std::isfinite(value)) fail_input("{}: {}: expected a finite number, found {}", before, field, value);
    return value;
  }
  std::uint64_t count(const char* records, std::uint64_t least_bytes) {
    const std::string before = fmt::format("byte {}", at_);
    const auto value = take<std::uint64_t>(records);
    check_count_fits(file_.name(), before, records, value, least_bytes, left());
    return value;
  }
  std::string text(std::string_view field) {  // up to a zero byte
    const std::string before = place();
    std::string value;
    while (left() > 0) {
      const char letter = *file_.at(at_++, 1);
      if (letter == '\0') return value;
      value += letter;
    }
    fail_input("{}: expected {}, found no end of it: cut short?", before, field);
  }
  void skip(std::uint64_t bytes) { at_ += bytes; }  // which are there
  void expect_end(const char* records, std::uint64_t count) const {
    if (left() > 0)
      fail_input("{}: expected the end after {} {}, found {} bytes more; the count is wrong", place(), count,
                 records, left());
  }

 private:
  std::uint64_t left() const { return file_.size() - at_; }

  InputFile file_;
  std::uint64_t at_ = 0;
};

void read_cameras_bin(const fs::path& file, ColmapCollector& model) {
  ByteReader bytes(file);
  const std::uint64_t count = bytes.count("cameras", kCameraBytes);
  if (count == 0) fail_input("{}: expected at least one camera, found none", bytes.place());
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::string place = bytes.place();
    const auto id = bytes.take<std::uint32_t>("camera id");
    const ColmapLens& lens = colmap_lens(place, std::int64_t{bytes.take<std::int32_t>("camera model")});
    // Beyond 2^63 they turn negative, which is refused, too.
    const auto width = static_cast<std::int64_t>(bytes.take<std::uint64_t>("width"));
    const auto height = static_cast<std::int64_t>(bytes.take<std::uint64_t>("height"));
    std::vector<double> parameters;
    for (std::size_t k = 0; k < lens.parameters.size(); ++k)
      parameters.push_back(
          bytes.number(fmt::format("parameter {} of {} of {}", k + 1, lens.parameters.size(), lens.name)));
    model.add_camera(place, id, lens, width, height, parameters);
  }
  bytes.expect_end("cameras", count);
}

void read_images_bin(const fs::path& file, ColmapCollector& model) {
  ByteReader bytes(file);
  const std::uint64_t count = bytes.count("images", kImageBytes);
  if (count == 0) fail_input("{}: expected at least one image, found none", bytes.place());
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::string place = bytes.place();
    const auto id = bytes.take<std::uint32_t>("image id");
    const double qw = bytes.number("QW"), qx = bytes.number("QX"), qy = bytes.number("QY"),
                 qz = bytes.number("QZ");
    const double x = bytes.number("TX"), y = bytes.number("TY"), z = bytes.number("TZ");
    const auto camera = bytes.take<std::uint32_t>("camera id");
    model.add_image(place, id, {qw, qx, qy, qz}, {x, y, z}, camera, bytes.text("the image's name"));
    bytes.skip(kPointBytes * bytes.count("2D points", kPointBytes));
  }
  bytes.expect_end("images", count);
}

}  // namespace

CameraFile read_colmap_binary(const fs::path& folder) {
  ColmapCollector model;
  read_cameras_bin(folder / "cameras.bin", model);
  read_images_bin(folder / "images.bin", model);
  return std::move(model.file());
}

}  // namespace hybrid::io
