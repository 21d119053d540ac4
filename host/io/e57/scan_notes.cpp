#include "io/e57/scan_notes.hpp"

#include <algorithm>
#include <filesystem>

#include "core/error.hpp"
#include "io/e57/paged_file.hpp"
#include "io/salvage.hpp"

namespace hybrid::io {

void describe_e57_scan(const E57Scan& source, const ScanSamples& samples, const E57RecordReader& reader,
                       Scan& scan) {
  scan.world_from_scan = source.world_from_scan;
  scan.notes = source.notes;
  scan.origin = samples.origin();
  scan.notes.insert(scan.notes.end(), reader.notes().begin(), reader.notes().end());
}

SampleTally sum_of(const std::vector<SampleTally>& in_order) {
  SampleTally sum;
  for (const SampleTally& tally : in_order) {
    if (tally.absurd > 0 && sum.absurd == 0) {
      sum.first_absurd = tally.first_absurd;
      sum.absurd_value = tally.absurd_value;
    }
    sum.not_finite += tally.not_finite;
    sum.invalid += tally.invalid;
    sum.absurd += tally.absurd;
    sum.lost += tally.lost;
  }
  return sum;
}

void note_tallies(const std::string& where, const SampleTally& sum, const E57RecordReader& reader,
                  bool salvage, Scan& scan) {
  const auto note = [&](std::uint64_t number, const std::string& text) {
    if (number > 0)
      scan.notes.push_back(
          fmt::format("{} of {} points {}: taken as no-returns", number, reader.count(), text));
  };
  if (sum.absurd > 0) {
    const auto problem = fmt::format("point {}: expected a coordinate within {} m, found {}",
                                     sum.first_absurd, kFarthest_m, sum.absurd_value);
    if (!salvage)
      fail_input("{}: {}, and {} points in all; correct it, or use --salvage", where, problem, sum.absurd);
    note(sum.absurd, "have absurd coordinates (" + problem + ")");
  }
  note(sum.not_finite, "are not finite");
  note(sum.invalid, "are marked invalid");
  add_damage_notes(reader, sum.lost, "taken as no-returns", scan.notes);
}

void add_damage_notes(const E57RecordReader& reader, std::uint64_t lost, const std::string& fate,
                      std::vector<std::string>& notes) {
  if (!reader.bad_pages().empty())
    notes.push_back(fmt::format("{} damaged pages of 1024 bytes, the first at byte {}",
                                reader.bad_pages().size(),
                                *reader.bad_pages().begin() * PagedFile::kPage_bytes));
  if (lost == 0) return;
  const double share = static_cast<double>(lost) / static_cast<double>(reader.count());
  notes.push_back(fmt::format("{} of {} points ({:.3g} %) are lost to damage: {}", lost, reader.count(),
                              100 * share, fate));
}

void add_e57_notes(const E57Scan& source, const ScanColumns& columns, std::uint64_t count, Scan& scan) {
  const auto list = [](const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
  };
  if (!columns.unused.empty()) scan.notes.push_back("fields not used: " + list(columns.unused));
  if (!source.dropped.empty()) scan.notes.push_back("elements not used: " + list(source.dropped));
  if (columns.intensity && source.intensity)
    scan.notes.push_back(
        fmt::format("intensities from {} to {}", source.intensity->minimum, source.intensity->maximum));
  if (count == 0) scan.notes.push_back("no points");
  if (!scan.origin.isZero())
    scan.notes.push_back(fmt::format("coordinates are large: kept relative to ({}, {}, {})", scan.origin.x(),
                                     scan.origin.y(), scan.origin.z()));
}

void name_e57_scan(const std::string& file, const E57Contents& contents, std::size_t index, Scan& scan) {
  scan.name = std::filesystem::path(file).stem().string();
  if (contents.scans.size() > 1) scan.name += fmt::format("-{}", index);
  scan.crs = contents.coordinate_system;
  if (const auto& limits = contents.scans[index].intensity)
    scan.intensity_limits = {static_cast<float>(limits->minimum), static_cast<float>(limits->maximum)};
}

}  // namespace hybrid::io
