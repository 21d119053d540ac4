#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/error.hpp"
#include "core/large_vector.hpp"
#include "io/e57/e57.hpp"
#include "io/e57/scan_grid.hpp"
#include "io/e57/scan_samples.hpp"

namespace hybrid::io {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class ScanReader {
 public:
  ScanReader(const std::string& file, const E57Scan& source, const E57RecordReader& reader, bool salvage)
      : salvage_(salvage),
        source_(source),
        where_(file + ": " + source.points.what),
        reader_(reader),
        samples_(where_, source, reader),
        columns_(samples_.columns()) {}

  Scan read() {
    allocate();
    scan_.world_from_scan = source_.world_from_scan;
    scan_.notes = source_.notes;
    scan_.origin = samples_.origin();
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
    scan_.notes.insert(scan_.notes.end(), reader_.notes().begin(), reader_.notes().end());
    note_tallies();
    grid.finish(scan_);
    add_notes();
    return std::move(scan_);
  }

 private:
  void allocate() {
    const std::uint64_t count = reader_.count();
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
    if (count > kMost)
      fail_input("{}: expected at most {} points, found {}; split the file", where_, kMost, count);
    try {
      resize_large(scan_.points, count);
      if (columns_.intensity) resize_large(scan_.intensity, count);
      if (columns_.colour) resize_large(scan_.rgb, count);
    } catch (const std::bad_alloc&) {
      fail(ErrorKind::device,
           "{}: expected {} MiB of memory for {} points, found less free; split the file or use another "
           "machine",
           where_, count * 23 >> 20, count);
    }
  }

  void take(const E57Records& records) {
    SampleTally& tally = tallies_[records.first / E57RecordReader::kRange];
    const std::size_t first = records.first, count = records.count;
    samples_.points(records, std::span(scan_.points).subspan(first, count), tally);
    if (columns_.intensity) samples_.intensities(records, std::span(scan_.intensity).subspan(first, count));
    if (columns_.colour) samples_.colours(records, std::span(scan_.rgb).subspan(first, count));
    std::uint64_t done = first;  // the lost ranges of several fields overlap
    for (const auto& lost : records.lost)
      for (done = std::max(done, lost.first); done < lost.end; ++done, ++tally.lost)
        scan_.points[done] = {kNaN, kNaN, kNaN};
  }

  void note_tallies() {
    SampleTally sum;
    for (const SampleTally& tally : tallies_) {
      if (tally.absurd > 0 && sum.absurd == 0) {
        sum.first_absurd = tally.first_absurd;
        sum.absurd_value = tally.absurd_value;
      }
      sum.not_finite += tally.not_finite;
      sum.invalid += tally.invalid;
      sum.absurd += tally.absurd;
      sum.lost += tally.lost;
    }
    const auto note = [&](std::uint64_t number, const std::string& text) {
      if (number > 0)
        scan_.notes.push_back(
            fmt::format("{} of {} points {}: taken as no-returns", number, scan_.points.size(), text));
    };
    if (sum.absurd > 0) {
      const auto problem = fmt::format("point {}: expected a coordinate within {} m, found {}",
                                       sum.first_absurd, kAbsurd_m, sum.absurd_value);
      if (!salvage_)
        fail_input("{}: {}, and {} points in all; correct it, or use --salvage", where_, problem, sum.absurd);
      note(sum.absurd, "have absurd coordinates (" + problem + ")");
    }
    note(sum.not_finite, "are not finite");
    note(sum.invalid, "are marked invalid");
    if (!reader_.bad_pages().empty())
      scan_.notes.push_back(fmt::format("{} damaged pages of 1024 bytes, the first at byte {}",
                                        reader_.bad_pages().size(),
                                        *reader_.bad_pages().begin() * PagedFile::kPage_bytes));
    const auto share =
        static_cast<double>(sum.lost) / static_cast<double>(std::max<std::size_t>(scan_.points.size(), 1));
    note(sum.lost, fmt::format("({:.2f} %) are lost to damage", 100 * share));
  }

  void add_notes() {
    const auto list = [](const std::vector<std::string>& names) {
      std::string text;
      for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
      return text;
    };
    if (!columns_.unused.empty()) scan_.notes.push_back("fields not used: " + list(columns_.unused));
    if (!source_.dropped.empty()) scan_.notes.push_back("elements not used: " + list(source_.dropped));
    if (columns_.intensity && source_.intensity)
      scan_.notes.push_back(
          fmt::format("intensities from {} to {}", source_.intensity->minimum, source_.intensity->maximum));
    if (scan_.points.empty()) scan_.notes.push_back("no points");
    if (!scan_.origin.isZero())
      scan_.notes.push_back(fmt::format("coordinates are large: kept relative to ({}, {}, {})",
                                        scan_.origin.x(), scan_.origin.y(), scan_.origin.z()));
  }

  bool salvage_;
  const E57Scan& source_;
  std::string where_;
  const E57RecordReader& reader_;
  ScanSamples samples_;
  const ScanColumns& columns_;
  std::vector<SampleTally> tallies_;
  Scan scan_;
};

}  // namespace

Scan read_e57(const std::string& file, const E57Contents& contents, std::size_t index,
              const E57RecordReader& reader, bool salvage) {
  Scan scan = ScanReader(file, contents.scans.at(index), reader, salvage).read();
  scan.name = std::filesystem::path(file).stem().string();
  if (contents.scans.size() > 1) scan.name += fmt::format("-{}", index);
  scan.crs = contents.coordinate_system;
  if (const auto& limits = contents.scans[index].intensity)
    scan.intensity_limits = {static_cast<float>(limits->minimum), static_cast<float>(limits->maximum)};
  return scan;
}

Scan read_e57(const E57File& file, std::size_t index) {
  const std::vector<E57Scan>& scans = file.contents().scans;
  if (index >= scans.size())
    fail_input("{}: expected scan {}, found {} scans; choose one of them", file.name(), index, scans.size());
  Scan scan =
      read_e57(file.name(), file.contents(), index, file.open(scans[index].points), file.pages().salvage());
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
