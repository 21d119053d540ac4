#pragma once
#include <filesystem>
#include <memory>
#include <vector>

#include "trace/scanner.hpp"

namespace synth {

// A scan's file, written as its columns come: points in the scan frame and intensity.
class ScanFile {
 public:
  virtual ~ScanFile() = default;
  // The returns of the next column, rising.
  virtual void add(const std::vector<Sample>& column) = 0;
  virtual void finish() = 0;
};

// id.ply: returns in acquisition order, no grid. id.ptx, id.exr: a grid as of grid_rows(), its empty places
// included, for scanners with uneven columns too. id.e57: returns in acquisition order, each with its row and
// column of that grid. `own` becomes one of these.
std::string scan_file_name(const ScannerPose&, const Options&);
ScanFormat format_of(const ScannerPose&, const Options&);

// PLY (binary), PTX (text, identity as pose), EXR (tiled range image, no pose) or E57 (pose in a frame of its
// own).
std::unique_ptr<ScanFile> open_scan_file(const std::filesystem::path&, const ScannerPose&, const Options&);

// Channels plane (uint), range (float), kind (uint: 0 planar, 1 curved, 2 mixed, 3 ghost) per sample of the
// scan's file, whose index in row-major order is the sample's: as large as the range image for EXR; else of
// width 1024, in rows, its last row filled up. Places without a return hold 0 and NaN. Waits on disk until
// all samples are known.
std::unique_ptr<ScanFile> open_truth_file(const std::filesystem::path&, const ScannerPose&, const Options&);

// How many samples the file has when the scan has so many returns.
std::size_t file_samples(const ScannerPose&, const Options&, std::size_t returns);

// The column on its grid, empty places filled.
std::vector<Sample> on_grid(const std::vector<Sample>& column, int rows);

}  // namespace synth
