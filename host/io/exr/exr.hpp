#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hybrid::io {

// One channel of a tiled EXR: exactly one of `f` and `u` is set; width * height values.
struct ExrChannel {
  std::string name;
  const float* f = nullptr;
  const std::uint32_t* u = nullptr;
  int stride = 1;  // distance between values, in elements: 3 for one channel of interleaved RGB
};

// Tiled, ZIP-compressed, written by rename when complete; no dates, so that the same values give the same
// bytes. `attributes` are texts of the header, prefixed hybrid:.
void write_exr(const std::filesystem::path& file, int width, int height,
               const std::vector<ExrChannel>& channels,
               const std::map<std::string, std::string>& attributes = {});

}  // namespace hybrid::io
