#pragma once
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "score/geometry.hpp"

namespace score {

// Throws InputError when there is no such file, it is a folder, or it cannot be opened.
void check_file(const std::filesystem::path& path);
std::string read_bytes(const std::filesystem::path& path);
nlohmann::json read_json(const std::filesystem::path& path);

// Runs `body` on a JSON document; a key that is missing or of another type becomes an InputError that names
// the file.
template <typename Body>
auto from_json(const std::filesystem::path& path, const char* remedy, const Body& body);

Vec3 json_vec3(const nlohmann::json& list);
Similarity json_pose(const nlohmann::json& list);

[[noreturn]] void bad_json(const std::filesystem::path& path, const char* problem, const char* remedy);

template <typename Body>
auto from_json(const std::filesystem::path& path, const char* remedy, const Body& body) {
  const nlohmann::json document = read_json(path);
  try {
    return body(document);
  } catch (const nlohmann::json::exception& problem) {
    bad_json(path, problem.what(), remedy);
  } catch (const std::runtime_error& problem) {
    bad_json(path, problem.what(), remedy);
  }
}

}  // namespace score
