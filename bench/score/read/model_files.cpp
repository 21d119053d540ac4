#include "score/read/model_files.hpp"

#include <charconv>
#include <sstream>

#include "score/error.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

constexpr const char* kEditAgain = "run hybrid's edit stage again";

// The vertex of "7", "7/1", "7//2" or "-1"; 0-based.
std::size_t corner_of(const std::string& word, std::size_t vertices, const std::string& where) {
  long number = 0;
  const char* end = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), end, number);
  const long index = number < 0 ? static_cast<long>(vertices) + number : number - 1;
  if (parsed.ec != std::errc() || (parsed.ptr != end && *parsed.ptr != '/') || index < 0 ||
      index >= static_cast<long>(vertices))
    bad_input("{}: expected a vertex from 1 to {}, found {}; write the model again", where, vertices, word);
  return static_cast<std::size_t>(index);
}

}  // namespace

std::vector<Ring> read_obj_polygons(const std::filesystem::path& file) {
  std::istringstream text(read_bytes(file));
  std::vector<Vec3> vertices;
  std::vector<Ring> polygons;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    const std::string where = fmt::format("{}: line {}", file.string(), number);
    if (keyword == "v") {
      Vec3 vertex;
      if (!(words >> vertex.x() >> vertex.y() >> vertex.z()))
        bad_input("{}: expected three numbers, found {}; write the model again", where, line);
      vertices.push_back(vertex);
    } else if (keyword == "f") {
      polygons.emplace_back();
      for (std::string word; words >> word;)
        polygons.back().push_back(vertices.at(corner_of(word, vertices.size(), where)));
      if (polygons.back().size() < 3)
        bad_input("{}: expected a face of three corners or more, found {}; write the model again", where,
                  line);
    }
  }
  return polygons;
}

EditedModel read_edited_model(const std::filesystem::path& results) {
  EditedModel model;
  const auto edited = results / "model" / "edited.obj", reported = results / "model" / "openings.json";
  if (std::filesystem::exists(edited)) model.polygons = read_obj_polygons(edited);
  if (std::filesystem::exists(reported))
    model.reported = from_json(reported, kEditAgain, [](const nlohmann::json& document) {
      std::vector<Ring> rings;
      for (const auto& entry : document.at("openings")) {
        rings.emplace_back();
        for (const auto& corner : entry.at("ring")) rings.back().push_back(json_vec3(corner));
        if (rings.back().size() < 3) bad_input("openings: expected rings of 3 corners or more");
      }
      return rings;
    });
  return model;
}

}  // namespace score
