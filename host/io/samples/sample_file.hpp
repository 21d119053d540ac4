#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/range_image.hpp"
#include "geometry/scan.hpp"
#include "geometry/superclusters.hpp"
#include "io/scan_stream.hpp"
#include "io/scene/scan_entry.hpp"

namespace hybrid::io {

// A sample file (.hsf): every measured sample of a range image, exactly, in a few bytes each. Samples that
// decimation discards are differences to the plane that stands for them, the kept ones differences to the
// sample before them in the row (point_code.hpp); intensity and colour are differences to that sample, too.
//
// Layout, little-endian: "HYBRIDSF", u32 version 1, then blocks of u64 size, u64 XXH3-64 and as many bytes.
// Block 0 is the header, zstd over JSON (grid with its rays, planes, pose, coordinate system, steps); then
// one block per 64 rows, of columns (columns.hpp); last the samples beside the grid, as they are. Bands
// depend on nothing but the header: memory is one band per thread, and any row can be read alone.
struct SampleFileInput {
  const RangeImage& image;
  const std::vector<Supercluster>& planes;
  const std::vector<std::uint32_t>& label;     // per node, id in planes, 0: none
  const std::vector<std::uint8_t>& discarded;  // per node: 1: coded by its plane
  // Of a georeferenced scan, whose points the image's floats cannot hold: by `source`, relative to its
  // origin.
  const Scan* georeferenced = nullptr;
  // Beside the grid: x y z, or nothing.
  std::vector<std::array<double, 3>> extra{};
  std::vector<float> extra_intensity{};                  // one per extra sample, or empty
  std::vector<std::array<std::uint8_t, 3>> extra_rgb{};  // the same
  std::optional<Pose> world_from_scan{};
  std::string crs{};
};

// What the file is made of, for summary.json.
struct SampleFileSize {
  std::int64_t samples = 0, discarded = 0;  // samples on the grid; of these, by their plane
  std::uint64_t bytes = 0;                  // of the file
  std::uint64_t discarded_bytes = 0;        // the discarded samples' points, with their plane's id
};

// Written by rename when complete. The same bytes for any number of threads.
SampleFileSize write_sample_file(const std::filesystem::path& file, const SampleFileInput& input);

// The samples in the order of the grid's nodes, row by row, as read_exr_scan() gives those of a range.exr: no
// sample is a no-return. Throws ErrorKind::input naming file and block: damaged, cut short, another version.
Scan read_sample_file(const std::filesystem::path& file, const ReadOptions& options = {});
// The same in blocks.
std::unique_ptr<ScanStream> stream_sample_file(const std::filesystem::path& file, const ScanEntry& entry);
std::vector<ScanEntry> list_sample_file(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace hybrid::io
