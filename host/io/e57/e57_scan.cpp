#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/error.hpp"
#include "core/free_memory.hpp"
#include "core/large_vector.hpp"
#include "io/e57/e57.hpp"
#include "io/e57/grid_scatter.hpp"
#include "io/e57/scan_grid.hpp"
#include "io/e57/scan_notes.hpp"
#include "io/e57/scan_samples.hpp"
#include "io/scan_builder.hpp"

namespace hybrid::io {
namespace {

class ScanReader {
 public:
  ScanReader(const std::string& file, const E57Scan& source, const E57RecordReader& reader,
             const ReadOptions& options)
      : salvage_(options.salvage),
        source_(source),
        where_(file + ": " + source.points.what),
        reader_(reader),
        samples_(where_, source, reader),
        columns_(samples_.columns()),
        exact_(options.exact && samples_.rounds()) {}

  Scan read() {
    allocate();
    describe_e57_scan(source_, samples_, reader_, scan_);
    ScanGrid grid(source_, columns_, reader_.count());
    tallies_.resize(reader_.count() / E57RecordReader::kRange + 1);
    reader_.read(columns_.fields, 0, reader_.count(), [&](const E57Records& records) {
      take(records);
      grid.add(records);
    });
    if (grid.outside()) {
      grid.restart();
      reader_.read(columns_.fields, 0, reader_.count(),
                   [&](const E57Records& records) { grid.add(records); });
    }
    note_tallies(where_, sum_of(tallies_), reader_, salvage_, scan_);
    if (exact_ && holds_the_same(scan_)) free_memory(scan_.exact);
    if (!scan_.exact.empty()) scan_.steps = samples_.steps();
    grid.finish(scan_);
    add_e57_notes(source_, columns_, reader_.count(), scan_);
    return std::move(scan_);
  }

  std::optional<GridScan> read_grid() {
    auto scatter = GridScatter::of(source_, samples_, reader_);
    if (!scatter) return {};
    tallies_.resize(reader_.count() / E57RecordReader::kRange + 1);
    reader_.read(columns_.fields, 0, reader_.count(), [&](const E57Records& records) {
      std::array<std::array<float, 3>, E57RecordReader::kRange> points;
      std::array<float, E57RecordReader::kRange> intensity;
      std::array<std::array<std::uint8_t, 3>, E57RecordReader::kRange> rgb;
      const std::size_t count = records.count;
      const auto some_intensity = std::span(intensity).first(columns_.intensity ? count : 0);
      const auto some_rgb = std::span(rgb).first(columns_.colour ? count : 0);
      samples_.points(records, std::span(points).first(count),
                      tallies_[records.first / E57RecordReader::kRange]);
      if (columns_.intensity) samples_.intensities(records, some_intensity);
      if (columns_.colour) samples_.colours(records, some_rgb);
      scatter->add(records, std::span(points).first(count), some_intensity, some_rgb);
    });
    auto grid = scatter->finish();
    if (!grid) return {};
    scan_.grid_rows = grid->scan.grid_rows;
    scan_.grid_cols = grid->scan.grid_cols;
    describe_e57_scan(source_, samples_, reader_, scan_);
    note_tallies(where_, sum_of(tallies_), reader_, salvage_, scan_);
    add_e57_notes(source_, columns_, reader_.count(), scan_);
    grid->scan = std::move(scan_);
    return grid;
  }

 private:
  void allocate() {
    const std::uint64_t count = reader_.count();
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
    if (count > kMost)
      fail_input("{}: expected at most {} points, found {}; split the file", where_, kMost, count);
    try {
      resize_large(scan_.points, count);
      if (exact_) resize_large(scan_.exact, count);
      if (columns_.intensity) resize_large(scan_.intensity, count);
      if (columns_.colour) resize_large(scan_.rgb, count);
    } catch (const std::bad_alloc&) {
      fail(ErrorKind::device,
           "{}: expected {} MiB of memory for {} points, found less free; split the file or use another "
           "machine",
           where_, count * (exact_ ? 47 : 23) >> 20, count);
    }
  }

  void take(const E57Records& records) {
    SampleTally& tally = tallies_[records.first / E57RecordReader::kRange];
    const std::size_t first = records.first, count = records.count;
    samples_.points(
        records, std::span(scan_.points).subspan(first, count), tally,
        exact_ ? std::span(scan_.exact).subspan(first, count) : std::span<std::array<double, 3>>());
    if (columns_.intensity) samples_.intensities(records, std::span(scan_.intensity).subspan(first, count));
    if (columns_.colour) samples_.colours(records, std::span(scan_.rgb).subspan(first, count));
    LostRecords lost(records.lost);
    for (std::size_t i = first; !records.lost.empty() && i < first + count; ++i)
      if (lost.has(i)) {
        ++tally.lost;
        scan_.points[i] = {kNaN, kNaN, kNaN};
      }
  }

  bool salvage_;
  const E57Scan& source_;
  std::string where_;
  const E57RecordReader& reader_;
  ScanSamples samples_;
  const ScanColumns& columns_;
  bool exact_;
  std::vector<SampleTally> tallies_;
  Scan scan_;
};

}  // namespace

Scan read_e57(const std::string& file, const E57Contents& contents, std::size_t index,
              const E57RecordReader& reader, const ReadOptions& options) {
  Scan scan = ScanReader(file, contents.scans.at(index), reader, options).read();
  name_e57_scan(file, contents, index, scan);
  return scan;
}

std::optional<GridScan> read_e57_grid(const E57File& file, std::size_t index) {
  if (file.pages().salvage()) return {};  // what is lost has no node
  const E57Scan& source = file.contents().scans.at(index);
  const E57TableReader reader = file.open(source.points);
  auto grid = ScanReader(file.name(), source, reader, {}).read_grid();
  if (!grid) return {};
  name_e57_scan(file.name(), file.contents(), index, grid->scan);
  grid->scan.notes.insert(grid->scan.notes.end(), file.notes().begin(), file.notes().end());
  return grid;
}

Scan read_e57(const E57File& file, std::size_t index, bool exact) {
  const std::vector<E57Scan>& scans = file.contents().scans;
  if (index >= scans.size())
    fail_input("{}: expected scan {}, found {} scans; choose one of them", file.name(), index, scans.size());
  Scan scan = read_e57(file.name(), file.contents(), index, file.open(scans[index].points),
                       {.salvage = file.pages().salvage(), .exact = exact});
  scan.notes.insert(scan.notes.end(), file.notes().begin(), file.notes().end());
  return scan;
}

std::vector<Scan> read_e57(const std::filesystem::path& path, const E57Options& options) {
  const E57File file(path, options);
  std::vector<Scan> scans;
  std::vector<std::string> notes;  // on scans that are left out
  std::optional<Error> failure;
  for (std::size_t i = 0; i < file.contents().scans.size(); ++i) {
    try {
      scans.push_back(read_e57(file, i));
    } catch (const Error& error) {
      if (!options.salvage || ends_the_run(error.kind())) throw;
      if (!failure) failure = error;
      notes.push_back(fmt::format("left out: {}", error.what()));
    }
  }
  if (scans.empty() && failure) throw *failure;
  for (Scan& scan : scans) scan.notes.insert(scan.notes.end(), notes.begin(), notes.end());
  return scans;
}

}  // namespace hybrid::io
