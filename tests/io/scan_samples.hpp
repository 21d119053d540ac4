#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

namespace hybrid::testing {

// The raw bytes of values, in the other byte order if asked.
template <typename T>
std::string raw(T value, bool big_endian = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big_endian) std::reverse(bytes, bytes + sizeof(T));
  return {bytes, sizeof(T)};
}

// LZF without matches: literal runs of up to 32 bytes.
inline std::string lzf_literals(const std::string& bytes) {
  std::string result;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    result += static_cast<char>(run.size() - 1);
    result += run;
  }
  return result;
}

// Records as PCD compresses them: field, of so many bytes, after field.
inline std::string pcd_packed(const std::string& records, const std::vector<std::size_t>& field_bytes) {
  const std::size_t record = std::accumulate(field_bytes.begin(), field_bytes.end(), std::size_t{0});
  std::string fields;
  std::size_t at = 0;
  for (const std::size_t bytes : field_bytes) {
    for (std::size_t i = at; i < records.size(); i += record) fields += records.substr(i, bytes);
    at += bytes;
  }
  const std::string packed = lzf_literals(fields);
  return raw(static_cast<std::uint32_t>(packed.size())) + raw(static_cast<std::uint32_t>(fields.size())) +
         packed;
}

// The four points of every sample file, their intensities and colours.
inline constexpr float kSamplePoints[4][3] = {{1.5f, 0, 0.25f}, {0, 2, -0.5f}, {-3, 0, 1}, {0.125f, -4, 2}};
inline constexpr float kSampleIntensity[4] = {0.5f, 0.25f, 0.75f, 1};
inline constexpr std::uint8_t kSampleRgb[4][3] = {{1, 2, 3}, {254, 255, 0}, {10, 20, 30}, {128, 64, 32}};

// The same scan in each format: "pcd ascii", "pcd binary", "pcd binary_compressed", "ply ascii", "ply
// binary_little_endian", "ply binary_big_endian", "ptx" (2 x 2), "pts".
inline std::string sample_file(const std::string& format, const std::string& data_kind) {
  std::string data;
  for (int i = 0; i < 4; ++i) {
    const auto* p = kSamplePoints[i];
    const auto* c = kSampleRgb[i];
    if (format == "ptx" || format == "pts" || data_kind == "ascii") {
      data += fmt::format("{} {} {} {}", p[0], p[1], p[2], kSampleIntensity[i]);
      if (format == "pcd")
        data += fmt::format(" {}\n", c[0] << 16 | c[1] << 8 | c[2]);
      else
        data += fmt::format(" {} {} {}\n", c[0], c[1], c[2]);
      continue;
    }
    const bool big = data_kind == "binary_big_endian";
    std::string record;
    for (int k = 0; k < 3; ++k) record += raw(p[k], big);
    record += raw(kSampleIntensity[i], big);
    if (format == "pcd")
      record += raw(static_cast<std::uint32_t>(c[0] << 16 | c[1] << 8 | c[2]));
    else
      record += std::string(reinterpret_cast<const char*>(c), 3);
    data += record;
  }
  if (format == "ptx") return "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n" + data;
  if (format == "pts") return "4\n" + data;
  if (format == "ply")
    return fmt::format(
        "ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
        "z\nproperty float "
        "intensity\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n{}",
        data_kind, data);
  if (data_kind == "binary_compressed") data = pcd_packed(data, {4, 4, 4, 4, 4});
  return fmt::format(
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity rgb\nSIZE 4 4 4 4 4\nTYPE F F F F U\nCOUNT 1 1 1 1 "
      "1\nWIDTH "
      "4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA {}\n{}",
      data_kind, data);
}

}  // namespace hybrid::testing
