#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "trace/scanner.hpp"

namespace synth {

// A scan's file, written as its columns come: x y z intensity in the scan frame, acquisition order.
class ScanFile {
 public:
  virtual ~ScanFile() = default;
  virtual void add(const std::vector<Sample>& column) = 0;
  virtual void finish() = 0;
};

std::string scan_file_name(const ScannerPose&);  // id.ply, or id.ptx for a grid

// PLY (binary, no grid) or PTX (text, grid, identity as pose).
std::unique_ptr<ScanFile> open_scan_file(const std::filesystem::path&, const ScannerPose&, const Preset&);

// Channels plane (uint), range (float), kind (uint: 0 planar, 1 curved, 2 mixed, 3 ghost) per input sample,
// row-major at width 1024; samples without a return, and the rest of the last row, hold 0 and NaN. Waits on
// disk until the number of samples, which the image's header states, is known.
class TruthFile {
 public:
  explicit TruthFile(const std::filesystem::path&);
  ~TruthFile();
  void add(const std::vector<Sample>& column);
  void finish();

 private:
  struct Spill;
  std::filesystem::path path_;
  std::unique_ptr<Spill> spill_;
};

}  // namespace synth
