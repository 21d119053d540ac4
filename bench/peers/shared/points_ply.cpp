#include "shared/points_ply.hpp"

#include <bit>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace hybrid::peers {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written in the machine's byte order");
static_assert(sizeof(PlyPoint) == 28);

std::string header_of(std::size_t count) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "area"})
    text += std::string("property float ") + name + "\n";
  return text + "end_header\n";
}

}  // namespace

void write_points_ply(const std::filesystem::path& file, const std::vector<PlyPoint>& points) {
  std::ofstream output(file, std::ios::binary);
  output << header_of(points.size());
  output.write(reinterpret_cast<const char*>(points.data()),
               static_cast<std::streamsize>(28 * points.size()));
  output.close();
  if (!output) throw std::runtime_error(file.string() + ": cannot be written");
}

std::vector<PlyPoint> read_points_ply(const std::filesystem::path& file) {
  std::ifstream input(file, std::ios::binary);
  if (!input) throw std::runtime_error(file.string() + ": cannot be opened");
  std::string line, text;
  std::size_t count = 0;
  while (text.size() < 1000 && std::getline(input, line)) {
    text += line + "\n";
    std::istringstream words(line);
    std::string element, vertex;
    if (words >> element >> vertex && element == "element") words >> count;
    if (line == "end_header") break;
  }
  if (text != header_of(count))
    throw std::runtime_error(file.string() +
                             ": expected a binary PLY of x y z nx ny nz area as hybrid-peers writes it");
  const auto start = static_cast<std::size_t>(input.tellg());
  const std::size_t bytes = std::filesystem::file_size(file);
  if (bytes - start != 28 * count)
    throw std::runtime_error(file.string() + ": expected " + std::to_string(count) + " points, found " +
                             std::to_string((bytes - start) / 28));
  std::vector<PlyPoint> points(count);
  input.read(reinterpret_cast<char*>(points.data()), static_cast<std::streamsize>(28 * count));
  return points;
}

}  // namespace hybrid::peers
