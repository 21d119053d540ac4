#include "io/exr_header.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

#include "core/error.hpp"
#include "io/scalar_type.hpp"
#include "io/text_cursor.hpp"

namespace hybrid::io {
namespace {

constexpr std::int64_t kMostChannelBytes = 4096;  // about 200 channels: the library allocates a tile of each

class HeaderWalk {
 public:
  explicit HeaderWalk(InputFile& input) : input_(input), file_(input.name()) {}

  void run(unsigned tile_px) {
    const std::string_view magic = input_.ahead(0, 4).substr(0, 4);
    if (magic != "\x76\x2f\x31\x01")
      fail_input("{}: byte 0: expected an OpenEXR file (76 2f 31 01), found {}; is this a range image?",
                 file_, in_quotes(magic));
    if (input_.size() < 8) fail_at("the version of the file");
    // Bit 9: tiles; bits 11 and 12: deep samples, several parts.
    const std::uint32_t flags = static_cast<std::uint32_t>(whole(4)) & 0x1a00u;
    if (tile_px == kExrEither && (flags & 0x1800u) != 0)
      fail_input("{}: byte 4: expected one flat image, found {}; write the range image as a flat single part",
                 file_, (flags & 0x800u) != 0 ? "deep samples (any number per pixel)" : "several parts");
    const bool lines = tile_px == kExrEither ? flags == 0 : tile_px == kExrLines;
    if (tile_px != kExrEither && flags != (lines ? 0u : 0x200u))
      fail_input(
          "{}: byte 4: expected a {} image in a single part, found another kind of OpenEXR file; write it "
          "again",
          file_, lines ? "scan-line" : "tiled");
    at_ = 8;
    for (std::string name = text(); !name.empty(); name = text()) attribute(name);
    if (width_ < 1 || height_ < 1)
      fail_input("{}: byte {}: expected a data window of at least 1 x 1, found {} x {}; the file is damaged",
                 file_, at_, width_, height_);
    if (lines)
      check_lines();
    else
      check_tiles(tile_px);
  }

 private:
  void check_tiles(unsigned tile_px) const {
    const auto fits = [](std::uint32_t side) { return side >= 1 && side <= kMostTile_px; };
    if (tile_px == kExrEither && !(fits(tile_width_) && fits(tile_height_)))
      fail_input(
          "{}: byte {}: expected tiles of at most {} pixels a side, found {} x {}; write smaller tiles",
          file_, at_, kMostTile_px, tile_width_, tile_height_);
    if (tile_px != kExrEither && (tile_width_ != tile_px || tile_height_ != tile_px))
      fail_input(
          "{}: byte {}: expected tiles of {} x {} pixels, found {} x {}; this file is from another program",
          file_, at_, tile_px, tile_px, tile_width_, tile_height_);
    const auto tiles = [](std::int64_t pixels, std::uint32_t side) {
      return static_cast<std::uint64_t>((pixels - 1) / side + 1);
    };
    // A tile takes its entry in the offset table, its coordinates and its size, even when nothing follows.
    constexpr std::uint64_t kLeastTile = 8 + 20;
    check_count_fits(file_, fmt::format("byte {}", at_), "tiles",
                     tiles(width_, tile_width_) * tiles(height_, tile_height_), kLeastTile,
                     input_.size() - at_);
  }

  void check_lines() const {
    constexpr std::int64_t kMostWidth = 1 << 16;
    constexpr std::array<std::uint8_t, 10> kLinesOfBlock{1,  1,  1,  16, 32,
                                                         16, 32, 32, 32, 255};  // by compression
    if (width_ > kMostWidth || compression_ >= kLinesOfBlock.size())
      fail_input("{}: byte {}: expected lines of at most {} pixels, found {} with compression {}", file_, at_,
                 kMostWidth, width_, compression_);
    // A block takes its entry in the offset table, its first line's number and its size.
    constexpr std::uint64_t kLeastBlock = 8 + 8;
    check_count_fits(file_, fmt::format("byte {}", at_), "blocks of lines",
                     static_cast<std::uint64_t>((height_ - 1) / kLinesOfBlock[compression_] + 1), kLeastBlock,
                     input_.size() - at_);
  }

  [[noreturn]] void fail_at(const char* expected) const {
    fail_input(
        "{}: byte {}: expected {}, found the end of the file; the file is cut short or damaged: copy it "
        "again",
        file_, at_, expected);
  }

  // Names have at most 255 bytes.
  std::string text() {
    const std::string_view rest = input_.ahead(at_, 256).substr(0, 256);
    const std::size_t end = rest.find('\0');
    if (end == rest.npos) {
      if (rest.size() < 256) fail_at("an attribute of the header");
      fail_input(
          "{}: byte {}: expected a name of at most 255 bytes, found {}; the file is damaged: copy it again",
          file_, at_, in_quotes(rest));
    }
    at_ += end + 1;
    return std::string(rest.substr(0, end));
  }

  std::int32_t whole(std::uint64_t at) { return load_as<std::int32_t>(input_.at(at, 4), false); }

  // The library reads these types by what they are, not by the size that is written: with another size it
  // would take other bytes for the next attribute's than this walk, and their size on trust.
  void check_size(const std::string& name, const std::string& type, std::int64_t size) {
    static const std::map<std::string_view, std::int64_t> kSizes{{"box2f", 16},
                                                                 {"box2i", 16},
                                                                 {"chromaticities", 32},
                                                                 {"compression", 1},
                                                                 {"deepImageState", 1},
                                                                 {"double", 8},
                                                                 {"envmap", 1},
                                                                 {"float", 4},
                                                                 {"int", 4},
                                                                 {"keycode", 28},
                                                                 {"lineOrder", 1},
                                                                 {"m33d", 72},
                                                                 {"m33f", 36},
                                                                 {"m44d", 128},
                                                                 {"m44f", 64},
                                                                 {"rational", 8},
                                                                 {"tiledesc", 9},
                                                                 {"timecode", 8},
                                                                 {"v2d", 16},
                                                                 {"v2f", 8},
                                                                 {"v2i", 8},
                                                                 {"v3d", 24},
                                                                 {"v3f", 12},
                                                                 {"v3i", 12}};
    std::int64_t needed = size;
    if (const auto found = kSizes.find(type); found != kSizes.end()) needed = found->second;
    if (type == "chlist") needed = list_of_channels(size);
    if (type == "floatvector") needed = size / 4 * 4;
    if (type == "stringvector") needed = texts(size);
    if (type == "preview") {
      const std::int64_t width = size < 8 ? 0 : static_cast<std::uint32_t>(whole(at_));
      const std::int64_t height = size < 8 ? 0 : static_cast<std::uint32_t>(whole(at_ + 4));
      const bool small = width <= size && height <= size;
      needed = small ? 8 + 4 * width * height : size + 1;
    }
    if (needed != size)
      fail_input(
          "{}: byte {}: expected attribute {} of type {} to have {} bytes, found {}; the file is damaged: "
          "copy it "
          "again",
          file_, at_, in_quotes(name), in_quotes(type), needed, size);
  }

  // Lengths, each followed by as many bytes.
  std::int64_t texts(std::int64_t size) {
    std::int64_t taken = 0;
    while (taken < size && taken >= 0) {
      const std::int64_t length =
          size - taken < 4 ? -1 : std::int64_t{whole(at_ + static_cast<std::uint64_t>(taken))};
      taken = length < 0 || length > size - taken - 4 ? -1 : taken + 4 + length;
    }
    return taken;
  }

  // Names, each with 16 bytes, to an empty one; -1 when it does not end within `size`.
  std::int64_t list_of_channels(std::int64_t size) {
    const std::string_view list(input_.at(at_, static_cast<std::uint64_t>(std::min(size, kMostChannelBytes))),
                                static_cast<std::size_t>(std::min(size, kMostChannelBytes)));
    std::size_t at = 0;
    while (at < list.size()) {
      const std::size_t end = list.find('\0', at);
      if (end == list.npos) return -1;
      if (end == at) return static_cast<std::int64_t>(at + 1);
      at = end + 1 + 16;
    }
    return -1;
  }

  void attribute(const std::string& name) {
    const std::string type = text();
    if (input_.size() - at_ < 4) fail_at("the size of an attribute");
    const std::int64_t size = whole(at_);
    at_ += 4;
    if (size < 0 || static_cast<std::uint64_t>(size) > input_.size() - at_)
      fail_input(
          "{}: byte {}: expected {} bytes of attribute {}, found {} to the end of the file; it is cut short "
          "or "
          "damaged: copy it again",
          file_, at_, size, in_quotes(name), input_.size() - at_);
    if (type == "chlist" && size > kMostChannelBytes)
      fail_input(
          "{}: byte {}: expected at most {} bytes that describe channels, found {}; is this a range image?",
          file_, at_, kMostChannelBytes, size);
    check_size(name, type, size);
    if (name == "dataWindow" && type == "box2i" && size == 16) {
      width_ = std::int64_t{whole(at_ + 8)} - whole(at_) + 1;
      height_ = std::int64_t{whole(at_ + 12)} - whole(at_ + 4) + 1;
    }
    if (name == "tiles" && type == "tiledesc" && size == 9) {
      tile_width_ = static_cast<std::uint32_t>(whole(at_));
      tile_height_ = static_cast<std::uint32_t>(whole(at_ + 4));
    }
    if (name == "compression" && size == 1) compression_ = static_cast<unsigned char>(*input_.at(at_, 1));
    at_ += static_cast<std::uint64_t>(size);
  }

  InputFile& input_;
  const std::string& file_;
  std::uint64_t at_ = 0;
  std::int64_t width_ = 0, height_ = 0;
  std::size_t compression_ = 0;
  std::uint32_t tile_width_ = 0, tile_height_ = 0;
};

}  // namespace

void check_exr_header(InputFile& file, unsigned tile_px) {
  HeaderWalk(file).run(tile_px);
}

}  // namespace hybrid::io
