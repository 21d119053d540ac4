#include "io/pcd/pcd.hpp"

#include <algorithm>
#include <vector>

#include "core/error.hpp"
#include "core/free_memory.hpp"
#include "io/fixed_records.hpp"
#include "io/pcd/lzf.hpp"
#include "io/pcd/pcd_file.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text/text_samples.hpp"

namespace hybrid::io {
namespace {

class PcdReader {
 public:
  PcdReader(const std::filesystem::path& file, const ReadOptions& options)
      : file_(file, options.salvage),
        exact_(options.exact),
        damage_(file_.name),
        announced_(file_.header.points),
        name_(file.stem().string()) {}

  Scan read() {
    Scan scan = file_.header.data == PcdData::ascii    ? read_ascii()
                : file_.header.data == PcdData::binary ? read_binary()
                                                       : read_compressed();
    file_.set_grid_and_pose(scan);
    return scan;
  }

 private:
  ScanBuilder builder() const {
    ScanBuilder result(file_.name, name_, file_.header.points,
                       {.intensity = file_.used.intensity != nullptr,
                        .colour = file_.used.colour(),
                        .salvage = file_.salvage,
                        .exact = exact_ && file_.rounds()});
    add_notes(result, file_.notes());
    return result;
  }

  static void add_notes(ScanBuilder& result, const std::vector<std::string>& notes) {
    for (const std::string& note : notes) result.add_note(note);
  }

  static std::string end_of_points(std::uint64_t offset) {
    return fmt::format("byte {}: the points that the header announces end", offset);
  }

  // In salvage: the rows of the grid that are there, the last one filled up with no-returns.
  void crop(ScanBuilder& result, const std::string& problem) {
    const std::uint64_t found = result.size();
    if (found < announced_) {
      damage_.add(announced_ - found, problem);
      const CroppedGrid cropped = file_.grid() ? cropped_grid(file_.header.width, found) : CroppedGrid{};
      result.add_lost(cropped.nodes() - std::min(cropped.nodes(), found));
      file_.header.width = cropped.fast;
      file_.header.height = cropped.slow;
    }
    if (damage_.records() > 0) result.add_note(damage_.note(announced_));
  }

  Scan read_ascii() {
    file_.bound_points();
    ScanBuilder result = builder();
    bool commas = false;
    TextPlace place{file_.data, file_.header.data_line};
    if (file_.header.points > 0)
      place = add_text_samples(
          file_.input, place, file_.header.points, file_.header.point_values, result, commas,
          [&](const double* row) { return pcd_sample_of_row(file_.used, row); },
          [&](TextCursor& at, std::span<double> values, std::uint64_t done) {
            file_.read_line(at, values, done);
          },
          file_.salvage ? &damage_ : nullptr);
    crop(result, end_of_points(place.offset));
    add_notes(result, file_.notes_of_rest(place, commas));
    return result.finish();
  }

  Scan read_binary() {
    file_.bound_points();
    ScanBuilder result = builder();
    const std::uint64_t bytes = file_.header.points * file_.header.point_bytes;
    if (file_.header.point_bytes > FixedRecords::kLongest_bytes)
      add_records(result, [&](const PcdField& field, std::uint64_t i) {
        return file_.input.at(file_.data + i * file_.header.point_bytes + field.byte_offset,
                              size_of(field.type));
      });
    else
      FixedRecords(file_.input, file_.data, file_.header.point_bytes)
          .add(0, file_.header.points, result, FromPcdRecord{file_.used});
    crop(result, end_of_points(file_.data + bytes));
    add_notes(result, file_.notes_of_rest(bytes));
    return result.finish();
  }

  // at(field, i): where the field of point i lies in memory.
  template <typename At>
  void add_records(ScanBuilder& result, const At& at) {
    for (std::uint64_t i = 0; i < file_.header.points; ++i)
      result.add(pcd_sample_in_memory(file_.used, [&](const PcdField& field) { return at(field, i); }));
  }

  Scan read_compressed() {
    const auto [compressed, expanded] = file_.compressed_sizes();
    std::vector<char> packed(compressed),
        records(std::min<std::uint64_t>(expanded, compressed * kLzfLargestExpansion));
    file_.input.read(file_.data + 8, packed);
    std::size_t produced = 0;
    const std::string damage = decompress_lzf({packed.data(), packed.size()}, records, &produced);
    if (!damage.empty() && !file_.salvage) file_.fail_compressed(damage);
    free_memory(packed);
    if (produced < expanded)
      return salvage_fields(records, produced, file_.byte(8) + ": " + damage, compressed);
    ScanBuilder result = builder();
    add_records(result, [&](const PcdField& field, std::uint64_t i) {
      return records.data() + file_.header.points * field.byte_offset + i * size_of(field.type);
    });
    add_notes(result, file_.notes_of_rest(8 + compressed));
    return result.finish();
  }

  // The fields lie one behind the other: points whose x, y and z are all there are whole but for fields that
  // are cut off.
  Scan salvage_fields(std::vector<char>& records, std::size_t produced, const std::string& problem,
                      std::uint64_t compressed) {
    const auto held = [&](const PcdField& field) {
      const std::uint64_t start = file_.header.points * field.byte_offset;
      return produced < start ? 0 : std::min(file_.header.points, (produced - start) / size_of(field.type));
    };
    const std::uint64_t stride = file_.header.points;
    std::string cut;
    for (const PcdField* field :
         {file_.used.intensity, file_.used.packed, file_.used.red, file_.used.green, file_.used.blue})
      if (field && held(*field) < stride) cut += " " + field->name;
    const std::uint64_t points = std::min({held(*file_.used.x), held(*file_.used.y), held(*file_.used.z)});
    records.resize(produced + sizeof(double));
    std::fill(records.begin() + static_cast<std::ptrdiff_t>(produced), records.end(), '\0');
    if (points == 0)
      fail_input(
          "{}: {}: of {} uncompressed bytes {} can be read, too few for x, y and z of one point; copy or "
          "export the file again",
          file_.name, problem, stride * file_.header.point_bytes, produced);
    file_.header.points = points;
    ScanBuilder result = builder();
    add_records(result, [&](const PcdField& field, std::uint64_t i) {
      const std::uint64_t at = stride * field.byte_offset + i * size_of(field.type);
      return records.data() + std::min<std::uint64_t>(at, produced);
    });
    announced_ = stride;
    crop(result, problem);
    if (points == stride) result.add_note(problem);
    if (!cut.empty()) result.add_note(fmt::format("cut off and 0 from some point on:{}", cut));
    add_notes(result, file_.notes_of_rest(8 + compressed));
    return result.finish();
  }

  PcdFile file_;
  bool exact_;
  Damage damage_;
  std::uint64_t announced_;  // points, by the header
  std::string name_;
};

const char* name_of(PcdData data) {
  return data == PcdData::ascii ? "ascii" : data == PcdData::binary ? "binary" : "binary_compressed";
}

}  // namespace

Scan read_pcd(const std::filesystem::path& file, const ReadOptions& options) {
  return PcdReader(file, options).read();
}

std::vector<ScanEntry> list_pcd(const std::filesystem::path& file, const ReadOptions& options) {
  InputFile input(file);
  const PcdHeader header = read_pcd_header(input, options.salvage);
  ScanEntry entry{.name = file.stem().string(), .samples = header.points};
  if (header.width > 1 && header.height > 1) {
    entry.grid_rows = static_cast<int>(header.height);
    entry.grid_cols = static_cast<int>(header.width);
  }
  entry.structure = fmt::format("{},", name_of(header.data));
  for (const PcdField& field : header.fields) entry.structure += " " + field.name;
  entry.offset = header.data_offset;
  entry.line = header.data_line;
  entry.end = input.size();
  return {entry};
}

}  // namespace hybrid::io
