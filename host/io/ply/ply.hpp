#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "geometry/scan.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// PLY 1.0 vertices: ascii (one record per line) and both endians, any property order and types, lists, other
// elements skipped. Used: x y z, intensity (or scalar_intensity), red green blue (bytes, 16-bit words or
// reals); names in any case; the rest is listed in Scan::notes. Throws ErrorKind::input naming file, line or
// byte.
Scan read_ply(const std::filesystem::path& file, const ReadOptions& options = {});
// The same in blocks; null in salvage, and without vertices.
std::unique_ptr<ScanStream> stream_ply(const std::filesystem::path& file, const ScanEntry& entry);
// Its one scan, by the header alone.
std::vector<ScanEntry> list_ply(const std::filesystem::path& file);

// A point of detail.ply.
struct PlyPoint {
  std::array<double, 3> position{};
  float intensity = 0;
  std::array<std::uint8_t, 3> rgb{};
  std::uint8_t stray = 0;  // stages::Stray
};
struct PlyContent {
  bool intensity = false, colour = false;
  bool double_precision = false;  // georeferenced
  bool stray = false;
};

// Binary little-endian PLY, written by rename when complete.
void write_ply(const std::filesystem::path& file, const std::vector<PlyPoint>& points,
               const PlyContent& content);
// Points made as they are written, on all threads; at most a few thousand are in memory.
void write_ply(const std::filesystem::path& file, std::size_t count,
               const std::function<PlyPoint(std::size_t)>& point, const PlyContent& content);

}  // namespace hybrid::io
