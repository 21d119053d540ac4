#include "io/exr_header.hpp"

#include <cstdint>

#include "core/error.hpp"
#include "io/mapped_file.hpp"
#include "io/scalar_type.hpp"
#include "io/text_cursor.hpp"

namespace hybrid::io {
namespace {

class HeaderWalk {
 public:
  HeaderWalk(const std::string& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  void run(unsigned tile_px) {
    if (!bytes_.starts_with("\x76\x2f\x31\x01"))
      fail_input("{}: byte 0: expected an OpenEXR file (76 2f 31 01), found {}; is this a range image?",
                 file_, in_quotes(bytes_.substr(0, 4)));
    if (bytes_.size() < 8) fail_at("the version of the file");
    // Bit 9: tiles; bits 11 and 12: deep samples, several parts.
    if ((static_cast<std::uint32_t>(whole(4)) & 0x1a00u) != 0x200u)
      fail_input("{}: byte 4: expected a tiled image in a single part, found another kind of OpenEXR file",
                 file_);
    at_ = 8;
    for (std::string_view name = text(); !name.empty(); name = text()) attribute(name);
    const auto tiles = [&](std::int64_t pixels) {
      return static_cast<std::uint64_t>((pixels - 1) / tile_px + 1);
    };
    if (width_ < 1 || height_ < 1)
      fail_input("{}: byte {}: expected a data window of at least 1 x 1, found {} x {}; the file is damaged",
                 file_, at_, width_, height_);
    // A tile takes its entry in the offset table, its coordinates and its size, even when nothing follows.
    constexpr std::uint64_t kLeastTile = 8 + 20;
    check_count_fits(file_, fmt::format("byte {}", at_), "tiles", tiles(width_) * tiles(height_), kLeastTile,
                     bytes_.size() - at_);
  }

 private:
  [[noreturn]] void fail_at(const char* expected) const {
    fail_input(
        "{}: byte {}: expected {}, found the end of the file; the file is cut short or damaged: copy it "
        "again",
        file_, at_, expected);
  }

  std::string_view text() {
    const std::size_t end = bytes_.find('\0', std::min(at_, bytes_.size()));
    if (end == bytes_.npos) fail_at("an attribute of the header");
    const std::string_view result = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return result;
  }

  std::int32_t whole(std::size_t at) const { return load_as<std::int32_t>(bytes_.data() + at, false); }

  void attribute(std::string_view name) {
    const std::string_view type = text();
    if (bytes_.size() - at_ < 4) fail_at("the size of an attribute");
    const std::int64_t size = whole(at_);
    at_ += 4;
    if (size < 0 || static_cast<std::uint64_t>(size) > bytes_.size() - at_)
      fail_input(
          "{}: byte {}: expected {} bytes of attribute {}, found {} to the end of the file; it is cut short "
          "or "
          "damaged: copy it again",
          file_, at_, size, in_quotes(name), bytes_.size() - at_);
    if (name == "dataWindow" && type == "box2i" && size == 16) {
      width_ = std::int64_t{whole(at_ + 8)} - whole(at_) + 1;
      height_ = std::int64_t{whole(at_ + 12)} - whole(at_ + 4) + 1;
    }
    at_ += static_cast<std::size_t>(size);
  }

  const std::string& file_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::int64_t width_ = 0, height_ = 0;
};

}  // namespace

void check_exr_header(const std::string& file, std::string_view bytes, unsigned tile_px) {
  HeaderWalk(file, bytes).run(tile_px);
}

}  // namespace hybrid::io
