#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/scan_stream.hpp"

namespace hybrid::io {

// Gives the scans to be written one after the other, so that one is open at a time; null after the last.
using ScanSource = std::function<std::unique_ptr<ScanStream>()>;

// A format that scans are written in, and what it can hold.
struct ScanWriter {
  const char* extension = "";
  const char* name = "";
  bool several = false;  // scans in one file
  bool grid = false, pose = false, pose_scale = false, crs = false;
  bool no_returns = false;
  std::optional<std::array<float, 2>> intensity_limits{};  // least and greatest value that it can hold
  bool whole_intensity = false;
  bool las_steps = false;  // coordinates are whole numbers (las_steps.hpp)
  // The whole file by rename when complete; takes one scan of the source unless it holds `several`.
  void (*write)(const std::filesystem::path& file, const ScanSource& next) = nullptr;
};

// PTX, PTS, PLY, PCD (both binary), LAS, E57 and EXR. All hold coordinates, intensity and colour. Coordinates
// in text are the shortest decimals that read back as the same sample.
const std::vector<ScanWriter>& scan_writers();
// By the file's extension; throws ErrorKind::usage naming those there are.
const ScanWriter& writer_for(const std::filesystem::path& file);

// What the format cannot hold of the scan, by name, and what changes on the way.
struct WriteLosses {
  std::vector<std::string> dropped, changed;
};
WriteLosses losses_of(const ScanWriter& writer, const ScanStream& scan);

}  // namespace hybrid::io
