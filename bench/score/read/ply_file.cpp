#include "score/read/ply_file.hpp"

#include <bit>
#include <cstring>
#include <map>
#include <sstream>
#include <string>

#include "score/error.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

static_assert(std::endian::native == std::endian::little, "records are read as they lie in memory");

struct Property {
  std::string name, type, count_type;  // count_type: of a list's length, empty for a single value
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file) : file_(file), bytes_(read_bytes(file)) {}

  PlyContent read() {
    const auto elements = header();
    PlyContent content;
    for (const Element& element : elements) {
      if (element.count > bytes_.size()) fail("more {} than the file has bytes", element.name);
      for (std::size_t i = 0; i < element.count; ++i) {
        if (element.name == "vertex")
          content.vertices.push_back(vertex(element));
        else
          record(element, element.name == "face" ? &content.triangles : nullptr);
      }
    }
    for (const auto& triangle : content.triangles)
      for (const std::uint32_t corner : triangle)
        if (corner >= content.vertices.size())
          fail("a face with vertex {} of {}", corner, content.vertices.size());
    return content;
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    bad_input("{}: expected a binary little-endian PLY, found {}; write it again", file_.string(),
              fmt::format(format, std::forward<Args>(args)...));
  }

  std::string line() {
    const auto end = bytes_.find('\n', at_);
    if (end == std::string::npos) fail("a header without an end");
    std::string text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }

  std::vector<Element> header() {
    if (line() != "ply") fail("another kind of file");
    std::vector<Element> elements;
    bool binary = false;
    for (std::string text = line(); text != "end_header"; text = line()) {
      std::istringstream words(text);
      std::string word;
      words >> word;
      if (word == "format") {
        words >> word;
        binary = word == "binary_little_endian";
      } else if (word == "element") {
        elements.emplace_back();
        words >> elements.back().name >> elements.back().count;
      } else if (word == "property") {
        if (elements.empty()) fail("a property before the first element");
        Property property;
        words >> property.type;
        if (property.type == "list") words >> property.count_type >> property.type;
        words >> property.name;
        elements.back().properties.push_back(property);
      }
    }
    if (!binary) fail("another format");
    return elements;
  }

  double number(const std::string& type) {
    static const std::map<std::string, int> kinds = {
        {"char", 0},   {"int8", 0},    {"uchar", 1},  {"uint8", 1},  {"short", 2}, {"int16", 2},
        {"ushort", 3}, {"uint16", 3},  {"int", 4},    {"int32", 4},  {"uint", 5},  {"uint32", 5},
        {"float", 6},  {"float32", 6}, {"double", 7}, {"float64", 7}};
    const auto kind = kinds.find(type);
    if (kind == kinds.end()) fail("a property of type {}", type);
    switch (kind->second) {
      case 0:
        return take<std::int8_t>();
      case 1:
        return take<std::uint8_t>();
      case 2:
        return take<std::int16_t>();
      case 3:
        return take<std::uint16_t>();
      case 4:
        return take<std::int32_t>();
      case 5:
        return take<std::uint32_t>();
      case 6:
        return take<float>();
      default:
        return take<double>();
    }
  }

  template <typename T>
  T take() {
    if (bytes_.size() - at_ < sizeof(T)) fail("an end in the middle of the data");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

  Eigen::Vector3f vertex(const Element& element) {
    Eigen::Vector3f point = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
    for (const Property& property : element.properties) {
      if (!property.count_type.empty()) fail("a list in the element vertex");
      const double value = number(property.type);
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
        point[property.name[0] - 'x'] = static_cast<float>(value);
    }
    return point;
  }

  void record(const Element& element, std::vector<std::array<std::uint32_t, 3>>* triangles) {
    for (const Property& property : element.properties) {
      const bool list = !property.count_type.empty();
      const auto count = list ? static_cast<std::size_t>(number(property.count_type)) : 1;
      std::vector<double> values;
      for (std::size_t i = 0; i < count; ++i) values.push_back(number(property.type));
      if (!list || !triangles) continue;
      if (count != 3) fail("a face of {} corners", count);
      triangles->push_back({static_cast<std::uint32_t>(values[0]), static_cast<std::uint32_t>(values[1]),
                            static_cast<std::uint32_t>(values[2])});
    }
  }

  std::filesystem::path file_;
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace

PlyContent read_ply(const std::filesystem::path& file) {
  return PlyReader(file).read();
}

}  // namespace score
