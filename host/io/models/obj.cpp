#include "io/models/obj.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "core/error.hpp"
#include "geometry/keyhole.hpp"
#include "io/input_file.hpp"
#include "io/output.hpp"
#include "io/text/plain_text.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

// Statements that carry nothing a polygon needs.
constexpr std::array<std::string_view, 16> kIgnored = {
    "vt",    "vn",       "vp",       "s",   "mtllib", "l",      "p",          "mg",
    "bevel", "c_interp", "d_interp", "lod", "maplib", "usemap", "shadow_obj", "trace_obj"};

constexpr std::size_t kMostVertices = std::numeric_limits<std::uint32_t>::max();

// Reads one file statement by statement.
class ObjReader {
 public:
  ObjReader(const fs::path& file, double scale, bool y_up)
      : file_(file), scale_(scale), y_up_(y_up), input_(file), cursor_(input_, start_of_text(input_)) {}

  PolygonModel read() {
    while (next_statement()) read_statement(statement_);
    finish(std::max<std::uint64_t>(cursor_.line(), 2) - 1);
    return std::move(model_);
  }
  std::vector<ObjFaceNames> face_names() && { return std::move(face_names_); }

 private:
  // The next line, joined with the following ones while it ends in a backslash.
  bool next_statement() {
    if (cursor_.at_end()) return false;
    line_ = cursor_.line();
    statement_ = cursor_.next_line();
    if (!statement_.ends_with('\\')) return true;
    joined_ = statement_;
    while (joined_.ends_with('\\')) {
      joined_.back() = ' ';
      if (!cursor_.at_end()) joined_ += cursor_.next_line();
    }
    statement_ = joined_;
    return true;
  }

  void read_statement(std::string_view rest) {
    const std::string_view keyword = take_word(rest);
    if (keyword.empty() || keyword.starts_with('#')) return;
    if (keyword == "v") {
      read_vertex(rest);
    } else if (keyword == "f") {
      read_face(rest);
    } else if (keyword == "g" || keyword == "o" || keyword == "usemtl") {
      name_ = trim(rest);
      (keyword == "g" ? names_.group : keyword == "o" ? names_.object : names_.material) = name_;
    } else if (std::find(kIgnored.begin(), kIgnored.end(), keyword) == kIgnored.end()) {
      fail_at(file_, line_,
              "expected an OBJ statement (v, f, g, o, usemtl, ...), found \"{}\"; curves and surfaces are "
              "not read, export polygons",
              excerpt(keyword));
    }
  }

  void read_vertex(std::string_view rest) {
    std::array<double, 6> numbers{};
    std::size_t count = 0;
    for (auto word = take_word(rest); !word.empty() && !word.starts_with('#');
         word = take_word(rest), ++count) {
      const auto number = to_double(word);
      if (!number || !std::isfinite(*number))
        fail_at(file_, line_, "vertex {}: expected a finite number, found \"{}\"", model_.vertices.size(),
                excerpt(word));
      if (count < numbers.size()) numbers[count] = *number;
    }
    if (count != 3 && count != 4 && count != 6)
      fail_at(file_, line_, "vertex {}: expected x y z, x y z w or x y z r g b, found {} numbers",
              model_.vertices.size(), count);
    if (count == 4 && numbers[3] != 1)
      fail_at(file_, line_,
              "vertex {}: expected w = 1 (rational weights have no meaning for polygons), found {}; write x "
              "y z alone",
              model_.vertices.size(), numbers[3]);
    if (model_.vertices.size() >= kMostVertices)
      fail_at(file_, line_, "expected at most {} vertices, found more; split the model", kMostVertices);
    const Vec3 point = scale_ * Vec3(numbers[0], numbers[1], numbers[2]);
    model_.vertices.push_back(y_up_ ? Vec3(point.x(), -point.z(), point.y()) : point);
  }

  void read_face(std::string_view rest) {
    Face face;
    for (auto word = take_word(rest); !word.empty() && !word.starts_with('#'); word = take_word(rest)) {
      const std::uint32_t vertex = read_corner(word);
      if (face.outer.empty() || face.outer.back() != vertex) face.outer.push_back(vertex);
    }
    if (face.outer.size() > 1 && face.outer.front() == face.outer.back()) face.outer.pop_back();
    if (std::unordered_set<std::uint32_t>(face.outer.begin(), face.outer.end()).size() < 3)
      fail_at(file_, line_, "face: expected at least 3 different vertices, found \"{}\"",
              excerpt(trim(statement_)));
    face.name = name_;
    names_.place = model_.faces.size();
    names_.line = line_;
    face_names_.push_back(names_);
    model_.faces.push_back(std::move(face));
  }

  // "7", "7/1", "7//3", "7/1/3": the vertex, 0-based. The other indices are checked for their form alone.
  std::uint32_t read_corner(std::string_view word) const {
    std::size_t end = std::min(word.find('/'), word.size());
    const auto index = to_integer(word.substr(0, end));
    bool good = index.has_value();
    int slashes = 0;
    for (std::string_view rest = word.substr(end); !rest.empty(); rest.remove_prefix(end)) {
      rest.remove_prefix(1);
      end = std::min(rest.find('/'), rest.size());
      const bool may_be_empty = ++slashes == 1 && end < rest.size();  // the middle of 7//3
      good = good && slashes <= 2 &&
             (may_be_empty && end == 0 ? true : to_integer(rest.substr(0, end)).has_value());
    }
    if (!good) fail_at(file_, line_, "face: expected v, v/vt, v//vn or v/vt/vn, found \"{}\"", excerpt(word));
    const auto count = static_cast<std::int64_t>(model_.vertices.size());
    if (*index == 0 || *index < -count || *index > std::numeric_limits<std::uint32_t>::max())
      fail_at(file_, line_, "face: expected a vertex from 1, or from -{} to -1, found {}", count, *index);
    return static_cast<std::uint32_t>(*index > 0 ? *index - 1 : count + *index);
  }

  void finish(std::uint64_t last_line) {
    if (model_.faces.empty())
      fail_at(file_, last_line,
              "expected at least one face (f), found none among {} vertices; export polygons",
              model_.vertices.size());
    std::unordered_map<std::string, int> repeats;
    std::unordered_set<std::string> taken;
    for (const Face& face : model_.faces) taken.insert(face.name);
    std::unordered_set<std::string> used;
    for (std::size_t i = 0; i < model_.faces.size(); ++i) {
      Face& face = model_.faces[i];
      // A positive index may point forward in the file, so that its range is known only now.
      for (std::uint32_t vertex : face.outer)
        if (vertex >= model_.vertices.size())
          fail_at(file_, face_names_[i].line, "face: expected a vertex from 1 to {}, found {}",
                  model_.vertices.size(), std::uint64_t{vertex} + 1);
      split_keyholes(model_, face);
      if (face.name.empty()) face.name = fmt::format("face-{}", i);
      face.name = unique_name(face.name, repeats[face.name], taken, used);
    }
  }

  // name, then name-2, name-3 ...; a suffixed name that the file itself gives to another face is skipped.
  static std::string unique_name(const std::string& name, int& repeats,
                                 const std::unordered_set<std::string>& taken,
                                 std::unordered_set<std::string>& used) {
    if (used.insert(name).second) {
      repeats = 1;
      return name;
    }
    for (;;) {
      std::string next = fmt::format("{}-{}", name, ++repeats);
      if (!taken.contains(next) && used.insert(next).second) return next;
    }
  }

  fs::path file_;
  double scale_;
  bool y_up_;
  InputFile input_;
  TextCursor cursor_;
  PolygonModel model_;
  std::string_view statement_;
  std::string joined_, name_;
  ObjFaceNames names_;
  std::vector<ObjFaceNames> face_names_;  // as the file has them
  std::uint64_t line_ = 0;
};

}  // namespace

PolygonModel read_obj(const fs::path& file, double scale, bool y_up, std::vector<ObjFaceNames>* names) {
  if (!(scale > 0) || !std::isfinite(scale))
    fail_input("{}: expected a positive scale of the coordinates, found {}", file.string(), scale);
  ObjReader reader(file, scale, y_up);
  PolygonModel model = reader.read();
  if (names) *names = std::move(reader).face_names();
  return model;
}

void write_obj(const fs::path& file, const PolygonModel& model) {
  fmt::memory_buffer text;
  const auto out = fmt::appender(text);
  for (const Vec3& vertex : model.vertices)
    fmt::format_to(out, "v {} {} {}\n", vertex.x(), vertex.y(), vertex.z());
  for (const Face& face : model.faces) {
    std::vector<std::uint64_t> corners;
    for (std::uint32_t vertex : face.holes.empty() ? face.outer : keyhole_ring(model, face))
      corners.push_back(std::uint64_t{vertex} + 1);
    fmt::format_to(out, "g {}\nf {}\n", face.name, fmt::join(corners, " "));
  }
  write_text(file, fmt::to_string(text));
}

}  // namespace hybrid::io
