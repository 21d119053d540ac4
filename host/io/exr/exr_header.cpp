#include "io/exr/exr_header.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>

#include "core/error.hpp"
#include "io/exr/exr_chunks.hpp"
#include "io/scalar_type.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kMostPixelsPerByte = 1000;  // a byte deflated holds 516 halves at most
constexpr std::int64_t kMostChannelBytes = 4096;  // about 200 channels: the library allocates a tile of each

class HeaderWalk {
 public:
  explicit HeaderWalk(InputFile& input) : input_(input), file_(input.name()) {}

  ExrHeaderFacts run() {
    const std::string_view magic = input_.ahead(0, 4).substr(0, 4);
    if (magic != "\x76\x2f\x31\x01")
      fail_input("{}: byte 0: expected an OpenEXR file (76 2f 31 01), found {}; is this a range image?",
                 file_, in_quotes(magic));
    if (input_.size() < 8) fail_at("the version of the file");
    constexpr std::uint32_t kTiles = 0x200, kDeep = 0x800, kParts = 0x1000;
    const auto flags = static_cast<std::uint32_t>(whole(4));
    if ((flags & kDeep) != 0) fail_deep(4);
    at_ = 8;
    several_ = (flags & kParts) != 0;
    if (!several_) {
      part_ = {};
      part_.tiled = (flags & kTiles) != 0;
      for (std::string name = text(); !name.empty(); name = text()) attribute(name);
      check_part();
      return facts();
    }
    for (std::string name = text(); !name.empty(); name = text()) {
      const Part before = part_;
      part_ = {};
      for (; !name.empty(); name = text()) attribute(name);
      check_part();
      // The slices of one buffer take the pixels of all parts.
      if (before.width > 0 && (part_.width != before.width || part_.height != before.height ||
                               part_.left != before.left || part_.top != before.top))
        fail_input(
            "{}: byte {}: expected all parts with the data window of the first, {} x {} from ({}, {}), found "
            "{} "
            "x {} from ({}, {}); write the image's parts alone",
            file_, at_, before.width, before.height, before.left, before.top, part_.width, part_.height,
            part_.left, part_.top);
    }
    if (part_.width == 0) fail_at("the header of a part");
    return facts();
  }

 private:
  ExrHeaderFacts facts() const { return {format_, at_, several_}; }

  struct Part {
    std::int64_t left = 0, top = 0, width = 0, height = 0;
    std::size_t compression = 0;
    std::uint32_t tile_width = 0, tile_height = 0;
    bool tiled = false;
  };

  void check_part() {
    if (part_.width < 1 || part_.height < 1)
      fail_input("{}: byte {}: expected a data window of at least 1 x 1, found {} x {}; the file is damaged",
                 file_, at_, part_.width, part_.height);
    if (part_.tiled)
      check_tiles();
    else
      check_lines();
    check_pixels("an image of", part_.height);
  }

  void check_tiles() {
    const auto fits = [](std::uint32_t side) { return side >= 1 && side <= kMostTile_px; };
    if (!(fits(part_.tile_width) && fits(part_.tile_height)))
      fail_input(
          "{}: byte {}: expected tiles of at most {} pixels a side, found {} x {}; write smaller tiles",
          file_, at_, kMostTile_px, part_.tile_width, part_.tile_height);
    const auto tiles = [](std::int64_t pixels, std::uint32_t side) {
      return static_cast<std::uint64_t>((pixels - 1) / side + 1);
    };
    // A tile takes its entry in the offset table, its coordinates and its size, even when nothing follows.
    claim("tiles", tiles(part_.width, part_.tile_width) * tiles(part_.height, part_.tile_height), 8 + 20);
  }

  void check_lines() {
    constexpr std::int64_t kMostWidth = 1 << 16;
    if (part_.width > kMostWidth || part_.compression >= Imf::NUM_COMPRESSION_METHODS)
      fail_input("{}: byte {}: expected lines of at most {} pixels, found {} with compression {}", file_, at_,
                 kMostWidth, part_.width, part_.compression);
    const std::int64_t lines = exr_block_lines(static_cast<Imf::Compression>(part_.compression));
    // The library allocates a whole block, of however few lines the image is.
    check_pixels("blocks of", lines);
    // A block takes its entry in the offset table, its first line's number and its size.
    claim("blocks of lines", static_cast<std::uint64_t>((part_.height - 1) / lines + 1), 8 + 8);
  }

  // The least that blocks take in a file says little of an image most of which is missing, or whose lines are
  // long.
  void check_pixels(const char* of, std::int64_t height) const {
    const std::uint64_t most = kMostPixelsPerByte * input_.size();
    if (static_cast<std::uint64_t>(part_.width) > most / static_cast<std::uint64_t>(height))
      fail_input(
          "{}: header: expected what {} bytes can hold of an image, found {} {} x {} pixels; copy it again",
          file_, input_.size(), of, height, part_.width);
  }

  // What no part has claimed yet of the bytes to the end must hold them.
  void claim(const char* what, std::uint64_t count, std::uint64_t least_bytes) {
    const std::uint64_t rest = input_.size() - at_;
    check_count_fits(file_, fmt::format("byte {}", at_), what, count, least_bytes,
                     rest - std::min(rest, claimed_));
    claimed_ += count * least_bytes;
  }

  [[noreturn]] void fail_deep(std::uint64_t at) const {
    fail_input(
        "{}: byte {}: expected a flat image, found deep samples (any number per pixel); write the image as "
        "a flat one",
        file_, at);
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
    check_size(name, type, size);
    if (name == "dataWindow" && type == "box2i" && size == 16) {
      part_.left = whole(at_);
      part_.top = whole(at_ + 4);
      part_.width = std::int64_t{whole(at_ + 8)} - part_.left + 1;
      part_.height = std::int64_t{whole(at_ + 12)} - part_.top + 1;
    }
    if (name == "tiles" && type == "tiledesc" && size == 9) {
      part_.tile_width = static_cast<std::uint32_t>(whole(at_));
      part_.tile_height = static_cast<std::uint32_t>(whole(at_ + 4));
    }
    if (name == "compression" && size == 1)
      part_.compression = static_cast<unsigned char>(*input_.at(at_, 1));
    // Of a single part the flags tell.
    if (name == "type" && type == "string") {
      const auto length = static_cast<std::size_t>(std::min<std::int64_t>(size, 16));
      const std::string_view kind(input_.at(at_, length), length);
      if (kind.starts_with("deep")) fail_deep(at_);
      if (several_) part_.tiled = kind == "tiledimage";
    }
    if (name == "hybrid:format" && type == "string" && format_.empty()) {
      const auto length = static_cast<std::size_t>(std::min<std::int64_t>(size, 64));
      format_.assign(input_.at(at_, length), length);
    }
    if (type == "chlist") channel_bytes_ += size;
    if (channel_bytes_ > kMostChannelBytes)
      fail_input(
          "{}: byte {}: expected at most {} bytes that describe channels, found {}; write fewer channels",
          file_, at_, kMostChannelBytes, channel_bytes_);
    at_ += static_cast<std::uint64_t>(size);
  }

  InputFile& input_;
  const std::string& file_;
  std::uint64_t at_ = 0;
  bool several_ = false;  // parts
  Part part_;
  std::string format_;
  std::uint64_t claimed_ = 0;       // bytes, by the tiles and lines of the parts so far
  std::int64_t channel_bytes_ = 0;  // of all parts
};

}  // namespace

ExrHeaderFacts check_exr_header(InputFile& file) {
  return HeaderWalk(file).run();
}

}  // namespace hybrid::io
