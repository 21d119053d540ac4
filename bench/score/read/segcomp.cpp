#include "score/read/segcomp.hpp"

#include <array>
#include <sstream>

#include "score/error.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

constexpr std::uint32_t kMagic = 0x59a66a95;
constexpr std::size_t kHeaderBytes = 32;

// Words of the header are big-endian; files written on little-endian machines have them the other way round.
std::array<std::uint32_t, 8> header_of(const std::string& bytes, bool big_endian) {
  std::array<std::uint32_t, 8> words{};
  for (std::size_t i = 0; i < kHeaderBytes; ++i) {
    const auto byte = static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i]));
    words[i / 4] |= byte << (8 * (big_endian ? 3 - i % 4 : i % 4));
  }
  return words;
}

template <typename Read>
void read_rows(const std::filesystem::path& file, const char* row, const Read& read) {
  std::istringstream text(read_bytes(file));
  long count = 0;
  if (!(text >> count) || count < 0)
    bad_input("{}: expected the number of rows first, found none", file.string());
  for (long i = 0; i < count; ++i)
    if (!read(text))
      bad_input("{}: expected {} rows of {}, found {}; copy it again", file.string(), count, row, i);
}

}  // namespace

RasterLabels read_rasterfile(const std::filesystem::path& file) {
  const std::string bytes = read_bytes(file);
  if (bytes.size() < kHeaderBytes)
    bad_input("{}: expected a Sun rasterfile, found {} bytes; copy it again", file.string(), bytes.size());
  auto words = header_of(bytes, true);
  if (words[0] != kMagic) words = header_of(bytes, false);
  const auto [magic, width, height, depth, length, type, map_type, map_length] = words;
  if (magic != kMagic)
    bad_input(
        "{}: expected a Sun rasterfile, found another kind of file; SegComp's label images are NAME.gt-seg",
        file.string());
  if (depth != 8 || type > 1)
    bad_input("{}: expected 8 bits per pixel, not compressed, found {} bits of type {}", file.string(), depth,
              type);
  const std::size_t row = (static_cast<std::size_t>(width) + 1) / 2 * 2;  // padded to 16 bits
  const std::size_t begin = kHeaderBytes + map_length;
  if (width == 0 || height == 0 || begin > bytes.size() ||
      bytes.size() - begin < (row * height - (row - width)))
    bad_input("{}: expected {} x {} pixels, found {} bytes; copy it again", file.string(), width, height,
              bytes.size());
  RasterLabels labels{static_cast<int>(width), static_cast<int>(height), {}};
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const auto value = static_cast<unsigned char>(bytes[begin + y * row + x]);
      labels.label.push_back(value < kFirstRegion ? 0 : value);
    }
  return labels;
}

std::vector<RegionAngle> read_region_angles(const std::filesystem::path& file) {
  std::vector<RegionAngle> angles;
  read_rows(file, "two regions and an angle", [&](std::istringstream& text) {
    RegionAngle angle{};
    text >> angle.a >> angle.b >> angle.deg;
    angles.push_back(angle);
    return !text.fail();
  });
  return angles;
}

std::map<std::uint32_t, Vec3> read_region_normals(const std::filesystem::path& file) {
  std::map<std::uint32_t, Vec3> normals;
  read_rows(file, "a region and its normal", [&](std::istringstream& text) {
    std::uint32_t region = 0;
    Vec3 normal = Vec3::Zero();
    text >> region >> normal.x() >> normal.y() >> normal.z();
    normals[region] = normal.normalized();
    return !text.fail();
  });
  return normals;
}

}  // namespace score
