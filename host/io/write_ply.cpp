#include <bit>
#include <cstring>

#include "core/error.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"
#include "io/ply.hpp"

namespace hybrid::io {
namespace {

static_assert(std::endian::native == std::endian::little, "the records are written as they lie in memory");

std::string header(std::size_t count, const PlyContent& content) {
  const char* real = content.double_precision ? "double" : "float";
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} "
      "z\n",
      count, real, real, real);
  if (content.intensity) text += "property float intensity\n";
  if (content.colour) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (content.stray) text += "property uchar stray\n";
  return text + "end_header\n";
}

template <typename T>
void append(std::string& bytes, const T& value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

void append_point(std::string& bytes, const PlyPoint& point, const PlyContent& content) {
  for (const double coordinate : point.position) {
    if (content.double_precision)
      append(bytes, coordinate);
    else
      append(bytes, static_cast<float>(coordinate));
  }
  if (content.intensity) append(bytes, point.intensity);
  if (content.colour) append(bytes, point.rgb);
  if (content.stray) append(bytes, point.stray);
}

}  // namespace

void write_ply(const std::filesystem::path& file, const std::vector<PlyPoint>& points,
               const PlyContent& content) {
  constexpr std::size_t kBlock = 1 << 20;
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    std::string bytes = header(points.size(), content);
    for (const PlyPoint& point : points) {
      append_point(bytes, point, content);
      if (bytes.size() < kBlock) continue;
      out.write(bytes.data(), bytes.size());
      bytes.clear();
    }
    out.write(bytes.data(), bytes.size());
    out.close();
  });
}

}  // namespace hybrid::io
