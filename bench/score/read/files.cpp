#include "score/read/files.hpp"

#include <fstream>
#include <system_error>

#include "score/error.hpp"

namespace score {

void check_file(const std::filesystem::path& path) {
  std::error_code problem;
  const auto status = std::filesystem::status(path, problem);
  if (!std::filesystem::exists(status))
    bad_input("{}: expected a file, found none; check the path, or make the missing part again",
              path.string());
  if (std::filesystem::is_directory(status))
    bad_input("{}: expected a file, found a folder; name a file inside it", path.string());
  if (!std::ifstream(path, std::ios::binary))
    bad_input("{}: the file cannot be opened; check its permissions", path.string());
}

std::string read_bytes(const std::filesystem::path& path) {
  check_file(path);
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::string bytes(static_cast<std::size_t>(file.tellg()), '\0');
  file.seekg(0);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    bad_input("{}: the file cannot be read; copy it again", path.string());
  return bytes;
}

nlohmann::json read_json(const std::filesystem::path& path) {
  const std::string text = read_bytes(path);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& problem) {
    bad_input("{}: expected JSON, found something else ({}); write it again", path.string(), problem.what());
  }
}

void bad_json(const std::filesystem::path& path, const char* problem, const char* remedy) {
  bad_input("{}: {}; {}", path.string(), problem, remedy);
}

Vec3 json_vec3(const nlohmann::json& list) {
  const auto numbers = list.get<std::array<double, 3>>();
  if (list.size() != 3) bad_input("expected 3 numbers, found {}", list.size());
  return {numbers[0], numbers[1], numbers[2]};
}

Similarity json_pose(const nlohmann::json& list) {
  if (!list.is_array() || list.size() != 16)
    bad_input("expected a pose of 16 numbers, found {}", list.dump());
  return similarity_from_row_major(list.get<std::array<double, 16>>());
}

}  // namespace score
