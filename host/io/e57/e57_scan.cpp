#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/error.hpp"
#include "io/e57/e57.hpp"
#include "io/e57/large_pages.hpp"
#include "io/e57/scan_colours.hpp"
#include "io/e57/scan_columns.hpp"
#include "io/e57/scan_grid.hpp"
#include "io/scan_builder.hpp"

namespace hybrid::io {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());
constexpr double kAbsurd_m = 1e9;  // beyond every coordinate system of the Earth

// What of a range of records is no return, and why.
struct Tally {
  std::uint64_t not_finite = 0, invalid = 0, absurd = 0, lost = 0;
  std::uint64_t first_absurd = std::numeric_limits<std::uint64_t>::max();
  double absurd_value = 0;
};

// Coordinates of a range of records, in double, as Cartesian ones.
struct Coordinates {
  std::array<std::vector<double>, 3> axis;

  void take(const E57Table& table, const ScanColumns& columns, const E57Records& records) {
    for (std::size_t k = 0; k < 3; ++k) {
      axis[k].resize(records.count);
      values_of(table.fields[columns.fields[columns.place[k]]], records, columns.place[k], axis[k]);
    }
    if (columns.spherical) to_cartesian(axis[0], axis[1], axis[2]);
  }
};

class ScanReader {
 public:
  ScanReader(const E57File& file, const E57Scan& source)
      : file_(file),
        source_(source),
        table_(source.points),
        where_(file.name() + ": " + table_.what),
        reader_(file.open(table_)),
        columns_(ScanColumns::of(where_, table_)) {}

  Scan read() {
    allocate();
    scan_.world_from_scan = source_.world_from_scan;
    scan_.notes = source_.notes;
    choose_origin();
    ScanGrid grid(source_, columns_, reader_.count());
    if (columns_.colour) colours_.emplace(reader_, source_, columns_);
    tallies_.resize(reader_.count() / E57TableReader::kRange + 1);
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
      resize_in_large_pages(scan_.points, count);
      if (columns_.intensity) resize_in_large_pages(scan_.intensity, count);
      if (columns_.colour) resize_in_large_pages(scan_.rgb, count);
    } catch (const std::bad_alloc&) {
      fail(ErrorKind::device,
           "{}: expected {} MiB of memory for {} points, found less free; split the file or use another "
           "machine",
           where_, count * 23 >> 20, count);
    }
  }

  // 0: a return. Finite numbers that are no coordinates are told apart, as they mean damage.
  enum Kind { good, invalid, not_finite, absurd };
  Kind kind(const Coordinates& c, const std::vector<double>& state, std::size_t i) const {
    if (!state.empty() && state[i] != 0) return invalid;
    const double most = std::max({std::abs(c.axis[0][i]), std::abs(c.axis[1][i]), std::abs(c.axis[2][i])});
    const double sum = c.axis[0][i] + c.axis[1][i] + c.axis[2][i];
    if (std::isnan(sum) || most > kLargest) return not_finite;
    return most > kAbsurd_m ? absurd : good;
  }

  std::vector<double> values(const E57Records& records, const ScanColumns::Slot& slot) const {
    std::vector<double> values;
    if (!slot) return values;
    values.resize(records.count);
    values_of(table_.fields[columns_.fields[*slot]], records, *slot, values);
    return values;
  }

  // From the first returns, as ScanBuilder does.
  void choose_origin() {
    std::vector<std::array<double, 3>> returns;
    ScanColumns only = columns_;
    only.fields.resize(columns_.invalid ? 4 : 3);  // ScanColumns::of takes these first
    for (std::uint64_t at = 0; at < reader_.count() && returns.size() < kOriginSamples;
         at += kOriginSamples) {
      const std::uint64_t count = std::min<std::uint64_t>(kOriginSamples, reader_.count() - at);
      std::vector<std::array<double, 3>> chunk(count, {NAN, NAN, NAN});
      reader_.read(only.fields, at, count, [&](const E57Records& records) {
        Coordinates c;
        c.take(table_, columns_, records);
        const std::vector<double> state = values(records, columns_.invalid);
        for (std::size_t i = 0; i < records.count; ++i)
          if (kind(c, state, i) == good)
            chunk[records.first - at + i] = {c.axis[0][i], c.axis[1][i], c.axis[2][i]};
        for (const auto& lost : records.lost)
          for (std::uint64_t i = lost.first; i < lost.end; ++i) chunk[i - at] = {NAN, NAN, NAN};
      });
      for (const auto& point : chunk)
        if (!std::isnan(point[0]) && returns.size() < kOriginSamples) returns.push_back(point);
    }
    if (!returns.empty()) scan_.origin = local_origin(returns);
  }

  void take(const E57Records& records) {
    Tally& tally = tallies_[records.first / E57TableReader::kRange];
    thread_local Coordinates c;
    c.take(table_, columns_, records);
    const std::vector<double> state = values(records, columns_.invalid);
    const bool far = !scan_.origin.isZero();
    const double ox = scan_.origin.x(), oy = scan_.origin.y(), oz = scan_.origin.z();
    for (std::size_t i = 0; i < records.count; ++i) {
      const Kind found = kind(c, state, i);
      const double x = c.axis[0][i], y = c.axis[1][i], z = c.axis[2][i];
      tally.invalid += found == invalid;
      tally.not_finite += found == not_finite;
      if (found == absurd && tally.absurd++ == 0) {
        tally.first_absurd = records.first + i;
        tally.absurd_value = std::max({std::abs(x), std::abs(y), std::abs(z)});
      }
      const bool zero = far && x == 0 && y == 0 && z == 0;
      scan_.points[records.first + i] =
          found == good && !zero
              ? std::array{static_cast<float>(x - ox), static_cast<float>(y - oy), static_cast<float>(z - oz)}
              : std::array{kNaN, kNaN, kNaN};
    }
    if (columns_.intensity) take_intensity(records);
    if (columns_.colour) take_colours(records);
    std::uint64_t done = records.first;  // the lost ranges of several fields overlap
    for (const auto& lost : records.lost)
      for (done = std::max(done, lost.first); done < lost.end; ++done, ++tally.lost)
        scan_.points[done] = {kNaN, kNaN, kNaN};
  }

  void take_intensity(const E57Records& records) {
    const std::vector<double> value = values(records, columns_.intensity),
                              state = values(records, columns_.intensity_invalid);
    for (std::size_t i = 0; i < records.count; ++i)
      scan_.intensity[records.first + i] =
          state.empty() || state[i] == 0 ? static_cast<float>(value[i]) : 0.0f;
  }

  void take_colours(const E57Records& records) {
    const std::vector<double> state = values(records, columns_.colour_invalid);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<double> value = values(records, (*columns_.colour)[k]);
      for (std::size_t i = 0; i < records.count; ++i)
        scan_.rgb[records.first + i][k] = state.empty() || state[i] == 0 ? colours_->byte(k, value[i]) : 0;
    }
  }

  void note_tallies() {
    Tally sum;
    for (const Tally& tally : tallies_) {
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
      if (!file_.pages().salvage())
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

  const E57File& file_;
  const E57Scan& source_;
  const E57Table& table_;
  std::string where_;
  E57TableReader reader_;
  ScanColumns columns_;
  std::optional<ColourScale> colours_;
  std::vector<Tally> tallies_;
  Scan scan_;
};

}  // namespace

Scan read_e57(const E57File& file, std::size_t index) {
  const std::vector<E57Scan>& scans = file.contents().scans;
  if (index >= scans.size())
    fail_input("{}: expected scan {}, found {} scans; choose one of them", file.name(), index, scans.size());
  Scan scan = ScanReader(file, scans[index]).read();
  scan.name = std::filesystem::path(file.name()).stem().string();
  if (scans.size() > 1) scan.name += fmt::format("-{}", index);
  scan.notes.insert(scan.notes.end(), file.notes().begin(), file.notes().end());
  scan.crs = file.contents().coordinate_system;
  if (const auto& limits = scans[index].intensity)
    scan.intensity_limits = {static_cast<float>(limits->minimum), static_cast<float>(limits->maximum)};
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
