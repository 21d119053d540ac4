#include <bit>

#include "core/error.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"
#include "io/ply/ply.hpp"
#include "io/record_blocks.hpp"

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

void append_point(std::string& bytes, const PlyPoint& point, const PlyContent& content) {
  for (const double coordinate : point.position) {
    if (content.double_precision)
      append_raw(bytes, coordinate);
    else
      append_raw(bytes, static_cast<float>(coordinate));
  }
  if (content.intensity) append_raw(bytes, point.intensity);
  if (content.colour) append_raw(bytes, point.rgb);
  if (content.stray) append_raw(bytes, point.stray);
}

}  // namespace

void write_ply(const std::filesystem::path& file, std::size_t count,
               const std::function<PlyPoint(std::size_t)>& point, const PlyContent& content) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    OutputFile out(temporary);
    const std::string front = header(count, content);
    out.write(front.data(), front.size());
    write_records(out, count,
                  [&](std::size_t i, std::string& bytes) { append_point(bytes, point(i), content); });
    out.close();
  });
}

void write_ply(const std::filesystem::path& file, const std::vector<PlyPoint>& points,
               const PlyContent& content) {
  write_ply(
      file, points.size(), [&](std::size_t i) { return points[i]; }, content);
}

}  // namespace hybrid::io
