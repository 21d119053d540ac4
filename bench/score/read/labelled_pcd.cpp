#include "score/read/labelled_pcd.hpp"

#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

#include "score/error.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

struct Header {
  std::vector<std::string> fields, size, type, count;
  long width = 0, height = 0;
  std::string data;
  std::size_t begin = 0;  // of the points, bytes
};

class PcdReader {
 public:
  explicit PcdReader(const std::filesystem::path& file) : file_(file), bytes_(read_bytes(file)) {}

  LabelledPcd read() {
    const Header header = read_header();
    LabelledPcd cloud;
    cloud.width = static_cast<int>(header.width);
    cloud.height = static_cast<int>(header.height);
    const std::size_t count =
        static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
    if (count > bytes_.size()) fail("{} points in {} bytes", count, bytes_.size());
    const bool ascii = header.data == "ascii";
    if (!ascii && header.data != "binary") fail("DATA {}; save it as ascii or binary", header.data);
    const std::map<std::string, std::size_t> wanted = columns(header);
    at_ = header.begin;
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, 4> values;
      const auto record = ascii ? ascii_record(header.fields.size()) : binary_record(header);
      std::size_t k = 0;
      for (const char* name : {"x", "y", "z", "intensity"}) values[k++] = record[wanted.at(name)];
      cloud.points.emplace_back(values[0], values[1], values[2]);
      if (!(values[3] >= 0 && values[3] < 4e9 && values[3] == std::floor(values[3])))
        fail("intensity {} of point {}, which is no label", values[3], i);
      cloud.label.push_back(static_cast<std::uint32_t>(values[3]));
    }
    return cloud;
  }

 private:
  template <typename... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) const {
    bad_input(
        "{}: expected an organised PCD with the fields x y z intensity (whole numbers: labels), found {}",
        file_.string(), fmt::format(format, std::forward<Args>(args)...));
  }

  Header read_header() {
    Header header;
    std::size_t at = 0;
    while (header.data.empty()) {
      const auto end = bytes_.find('\n', at);
      if (end == std::string::npos) fail("a header without DATA");
      std::istringstream words(bytes_.substr(at, end - at));
      at = end + 1;
      std::string keyword;
      words >> keyword;
      const auto list = [&](std::vector<std::string>& into) {
        for (std::string word; words >> word;) into.push_back(word);
      };
      if (keyword == "FIELDS") list(header.fields);
      if (keyword == "SIZE") list(header.size);
      if (keyword == "TYPE") list(header.type);
      if (keyword == "COUNT") list(header.count);
      if (keyword == "WIDTH") words >> header.width;
      if (keyword == "HEIGHT") words >> header.height;
      if (keyword == "DATA") words >> header.data;
    }
    if (header.width < 1 || header.height < 2) fail("{} x {} points", header.width, header.height);
    const std::size_t fields = header.fields.size();
    for (const std::string& count : header.count)
      if (count != "1") fail("COUNT {}", count);
    if (header.size.size() != fields || header.type.size() != fields)
      fail("another number of sizes than fields");
    header.begin = at;
    return header;
  }

  std::map<std::string, std::size_t> columns(const Header& header) const {
    std::map<std::string, std::size_t> places;
    for (std::size_t k = 0; k < header.fields.size(); ++k) places[header.fields[k]] = k;
    for (const char* name : {"x", "y", "z", "intensity"})
      if (places.count(name) == 0) fail("no field {}", name);
    return places;
  }

  std::vector<double> ascii_record(std::size_t fields) {
    std::vector<double> values;
    for (std::size_t k = 0; k < fields; ++k) {
      while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_]))) ++at_;
      double value = 0;
      const auto parsed = std::from_chars(bytes_.data() + at_, bytes_.data() + bytes_.size(), value);
      if (parsed.ec != std::errc()) fail("no number where a point should be, at byte {}", at_);
      at_ = static_cast<std::size_t>(parsed.ptr - bytes_.data());
      values.push_back(value);
    }
    return values;
  }

  std::vector<double> binary_record(const Header& header) {
    std::vector<double> values;
    for (std::size_t k = 0; k < header.fields.size(); ++k) {
      const std::string kind = header.type[k] + header.size[k];
      if (kind == "F4")
        values.push_back(take<float>());
      else if (kind == "F8")
        values.push_back(take<double>());
      else if (kind == "U4")
        values.push_back(take<std::uint32_t>());
      else if (kind == "I4")
        values.push_back(take<std::int32_t>());
      else if (kind == "U2")
        values.push_back(take<std::uint16_t>());
      else if (kind == "U1")
        values.push_back(take<std::uint8_t>());
      else
        fail("a field of type {}", kind);
    }
    return values;
  }

  template <typename T>
  T take() {
    if (bytes_.size() - at_ < sizeof(T)) fail("an end in the middle of the points");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

  std::filesystem::path file_;
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace

LabelledPcd read_labelled_pcd(const std::filesystem::path& file) {
  return PcdReader(file).read();
}

}  // namespace score
