#include "io/pcd.hpp"

#include <bit>
#include <vector>

#include "core/error.hpp"
#include "core/free_memory.hpp"
#include "io/fixed_records.hpp"
#include "io/input_file.hpp"
#include "io/lzf.hpp"
#include "io/pcd_header.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text_cursor.hpp"
#include "io/text_samples.hpp"
#include "io/text_stream.hpp"

namespace hybrid::io {
namespace {

// The fields that become a Scan.
struct UsedFields {
  const PcdField *x = nullptr, *y = nullptr, *z = nullptr, *intensity = nullptr;
  const PcdField* packed = nullptr;  // 0xAARRGGBB as uint, int or float bits
  const PcdField *red = nullptr, *green = nullptr, *blue = nullptr;

  bool three_colours() const { return !packed && red && green && blue; }
  ColourKind colour() const {
    if (packed) return ColourKind::byte;
    return three_colours() ? colour_kind(red->type) : ColourKind::none;
  }
};

UsedFields find_fields(const std::string& file, const PcdHeader& header, std::string& unused) {
  UsedFields used;
  for (const PcdField& field : header.fields) {
    const PcdField** slot = nullptr;
    if (field.count == 1) {
      if (field.name == "x") slot = &used.x;
      if (field.name == "y") slot = &used.y;
      if (field.name == "z") slot = &used.z;
      if (names_intensity(field.name)) slot = &used.intensity;
      if ((field.name == "rgb" || field.name == "rgba") && size_of(field.type) == 4) slot = &used.packed;
      if (field.name == "red") slot = &used.red;
      if (field.name == "green") slot = &used.green;
      if (field.name == "blue") slot = &used.blue;
    }
    if (slot && *slot)
      fail_input("{}: FIELDS: expected {} once, found it again; correct the header", file,
                 in_quotes(field.name));
    if (slot)
      *slot = &field;
    else if (field.name != "_")  // padding
      unused += (unused.empty() ? "" : " ") + field.name;
  }
  if (!used.x || !used.y || !used.z)
    fail_input("{}: FIELDS: expected x, y and z with COUNT 1, found no {}; is this a point cloud?", file,
               !used.x ? "x" : (!used.y ? "y" : "z"));
  return used;
}

// One sample: number(field) is its value, bits(field) the 32 bits of a packed colour.
template <typename Number, typename Bits>
ScanSample make_sample(const UsedFields& used, const Number& number, const Bits& bits) {
  ScanSample sample{number(*used.x), number(*used.y), number(*used.z), 0, {}};
  if (used.intensity) sample.intensity = number(*used.intensity);
  if (used.packed) {
    const std::uint32_t colour = bits(*used.packed);
    sample.rgb = {static_cast<double>((colour >> 16) & 255), static_cast<double>((colour >> 8) & 255),
                  static_cast<double>(colour & 255)};
  } else if (used.three_colours()) {
    sample.rgb = {number(*used.red), number(*used.green), number(*used.blue)};
  }
  return sample;
}

// Of a line's numbers.
ScanSample sample_of_row(const UsedFields& used, const double* row) {
  const auto number = [&](const PcdField& field) { return row[field.value_offset]; };
  const auto bits = [&](const PcdField& field) {
    if (is_real(field.type)) return std::bit_cast<std::uint32_t>(static_cast<float>(number(field)));
    const bool fits = number(field) > -2147483649.0 && number(field) < 4294967296.0;
    return fits ? static_cast<std::uint32_t>(static_cast<std::int64_t>(number(field))) : 0u;
  };
  return make_sample(used, number, bits);
}

// Of a field that lies in memory at(field).
template <typename At>
ScanSample sample_in_memory(const UsedFields& used, const At& at) {
  const auto number = [&](const PcdField& field) { return load_scalar(at(field), field.type, false); };
  const auto bits = [&](const PcdField& field) { return load_as<std::uint32_t>(at(field), false); };
  return make_sample(used, number, bits);
}

// Of a binary point.
struct FromRecord {
  const UsedFields& used;

  ScanSample operator()(const char* record) const {
    return sample_in_memory(used, [&](const PcdField& field) { return record + field.byte_offset; });
  }
};

// Where a PCD file's points lie, and what stands behind them.
struct PcdFile {
  PcdFile(const std::filesystem::path& file, bool for_salvage)
      : input(file),
        name(input.name()),
        salvage(for_salvage),
        header(read_pcd_header(input, salvage)),
        data(header.data_offset),
        data_bytes(input.size() - data) {
    used = find_fields(name, header, unused);
  }
  PcdFile(const PcdFile&) = delete;
  PcdFile& operator=(const PcdFile&) = delete;

  std::vector<std::string> notes() const {
    std::vector<std::string> found = header.notes;
    if (!unused.empty()) found.push_back("fields not used: " + unused);
    return found;
  }

  bool grid() const { return header.width > 1 && header.height > 1; }
  // Single precision holds what was written in it.
  bool rounds() const {
    return header.data == PcdData::ascii ||
           std::ranges::any_of(std::array{used.x, used.y, used.z},
                               [](const PcdField* field) { return field->type != ScalarType::f32; });
  }

  // Where a byte of the data lies in the file.
  std::string byte(std::uint64_t offset) const { return fmt::format("byte {}", data + offset); }

  // Throws where the rest of the file cannot hold the points; in salvage there are no more of them.
  void bound_points() {
    // A value takes a digit and a separator; the last line may lack its end.
    const bool ascii = header.data == PcdData::ascii;
    const std::uint64_t least_bytes = ascii ? 2 * header.point_values : header.point_bytes,
                        available = data_bytes + (ascii ? 1 : 0);
    if (!salvage)
      check_count_fits(name, ascii ? fmt::format("line {}", header.data_line) : byte(0), "points",
                       header.points, least_bytes, available, true);
    else
      header.points = std::min(header.points, available / std::max<std::uint64_t>(least_bytes, 1));
  }

  void read_line(TextCursor& at, std::span<double> values, std::uint64_t done) const {
    const std::uint64_t line = at.line();
    if (at.at_end())
      fail_input(
          "{}: line {}: expected {} points, found {}; the file is cut short: copy or export it again, {}",
          name, line, header.points, done, kSalvageRemedy);
    const std::size_t found = at.read_numbers(values);
    if (found != values.size())
      fail_input(
          "{}: line {}: expected {} values as FIELDS and COUNT say, found {}; correct or remove that line, "
          "{}",
          name, line, values.size(), found, kSalvageRemedy);
  }

  // What stands behind the last point, as a note or none. A further point means that the header is wrong; of
  // text: `place` is behind the last point, and whether commas were seen.
  std::vector<std::string> notes_of_rest(const TextPlace& place, bool commas) {
    std::vector<std::string> found;
    if (commas) found.emplace_back("values are separated by commas, which PCD does not provide for");
    TextCursor cursor(input, place.offset, place.line);
    cursor.skip_blank_lines();
    if (cursor.at_end()) return found;
    const std::uint64_t line = cursor.line(), rest = cursor.remaining();
    if (!salvage && cursor.next_line_is_numbers(header.point_values))
      fail_input(
          "{}: line {}: expected the end of the file after {} points, found another point; correct WIDTH, "
          "HEIGHT and POINTS in the header, {}",
          name, line, header.points, kSalvageRemedy);
    found.push_back(fmt::format("line {}: {} bytes after the last point are ignored", line, rest));
    return found;
  }

  // PCL's writer fills the last page with zeros, which are worth no note.
  std::vector<std::string> notes_of_rest(std::uint64_t used_bytes) {
    const std::uint64_t rest = data_bytes - used_bytes;
    if (rest > 0) check_not_sent_as_text(input, data);
    if (input.only_zeros_from(data + used_bytes)) return {};
    if (header.data == PcdData::binary && rest >= header.point_bytes && !salvage)
      fail_input(
          "{}: {}: expected the end of the file after {} points, found {} more bytes, room for {} points; "
          "correct WIDTH, HEIGHT and POINTS in the header, {}",
          name, byte(used_bytes), header.points, rest, rest / header.point_bytes, kSalvageRemedy);
    return {fmt::format("{}: {} bytes after the last point are ignored", byte(used_bytes), rest)};
  }

  void set_grid_and_pose(Scan& scan) const {
    if (grid()) {
      scan.grid_rows = static_cast<int>(header.height);
      scan.grid_cols = static_cast<int>(header.width);
      scan.row_by_row = true;
    }
    const auto& v = header.viewpoint;
    const Pose pose{1, Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized(), {v[0], v[1], v[2]}};
    if (pose.translation.isZero(0) && pose.rotation.vec().isZero(0)) return;
    scan.world_from_scan = pose;
    scan.notes.emplace_back(
        "VIEWPOINT is taken as the scanner's pose, and the points as being in the scanner's frame");
  }

  InputFile input;
  const std::string& name;
  bool salvage;
  PcdHeader header;
  std::uint64_t data, data_bytes;  // where the data begins, and how much there is
  UsedFields used;
  std::string unused;
};

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
          [&](const double* row) { return sample_of_row(file_.used, row); },
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
          .add(0, file_.header.points, result, FromRecord{file_.used});
    crop(result, end_of_points(file_.data + bytes));
    add_notes(result, file_.notes_of_rest(bytes));
    return result.finish();
  }

  // at(field, i): where the field of point i lies in memory.
  template <typename At>
  void add_records(ScanBuilder& result, const At& at) {
    for (std::uint64_t i = 0; i < file_.header.points; ++i)
      result.add(sample_in_memory(file_.used, [&](const PcdField& field) { return at(field, i); }));
  }

  Scan read_compressed() {
    check_count_fits(file_.name, file_.byte(0), "sizes", 2, 4, file_.data_bytes);
    std::uint64_t compressed = load_as<std::uint32_t>(file_.input.at(file_.data, 4), false);
    const std::uint64_t expanded = load_as<std::uint32_t>(file_.input.at(file_.data + 4, 4), false);
    if (file_.salvage) compressed = std::min(compressed, file_.data_bytes - 8);
    if (compressed > file_.data_bytes - 8)
      fail_input(
          "{}: {}: expected {} compressed bytes, found {}; the file is cut short: copy or export it again, "
          "{}",
          file_.name, file_.byte(0), compressed, file_.data_bytes - 8, kSalvageRemedy);
    // Of all counts the one that was written with the data tells where the fields lie.
    if (file_.salvage && expanded % file_.header.point_bytes == 0 &&
        expanded / file_.header.point_bytes != file_.header.points) {
      file_.header.points = expanded / file_.header.point_bytes;
      file_.header.notes.push_back(
          fmt::format("{}: expected {} points, found an uncompressed size of {}: as many, "
                      "and as not organised",
                      file_.byte(4), announced_, file_.header.points));
      file_.header.height = 1;
    }
    if (file_.header.points > expanded / file_.header.point_bytes ||
        file_.header.points * file_.header.point_bytes != expanded)
      fail_input(
          "{}: {}: expected {} points of {} bytes, found an uncompressed size of {} bytes; the header is "
          "wrong, or the file damaged: export it again",
          file_.name, file_.byte(4), file_.header.points, file_.header.point_bytes, expanded);
    if (!file_.salvage)
      check_count_fits(file_.name, file_.byte(4), "uncompressed bytes", expanded, 1,
                       compressed * kLzfLargestExpansion);
    std::vector<char> packed(compressed),
        records(std::min<std::uint64_t>(expanded, compressed * kLzfLargestExpansion));
    file_.input.read(file_.data + 8, packed);
    std::size_t produced = 0;
    const std::string damage = decompress_lzf({packed.data(), packed.size()}, records, &produced);
    if (!damage.empty() && !file_.salvage)
      fail_input("{}: {}: expected LZF data, found {}; the file is damaged: copy or export it again, {}",
                 file_.name, file_.byte(8), damage, kSalvageRemedy);
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

class PcdTextStream : public TextStream {
 public:
  PcdTextStream(const std::filesystem::path& file, const ScanEntry& entry, std::unique_ptr<PcdFile> opened)
      : TextStream(file, entry), file_(std::move(opened)) {
    add_notes(file_->notes());
    const auto notes = take({.start = {file_->data, file_->header.data_line},
                             .count = file_->header.points,
                             .columns = file_->header.point_values,
                             .intensity = file_->used.intensity != nullptr,
                             .colour = file_->used.colour()});
    add_notes(file_->notes_of_rest(after(), commas_seen()));
    add_notes(notes);
    file_->set_grid_and_pose(head_);
  }

 private:
  ScanSample sample(const double* row) const override { return sample_of_row(file_->used, row); }
  void read_line(TextCursor& cursor, std::span<double> values, std::uint64_t done) const override {
    file_->read_line(cursor, values, done);
  }

  std::unique_ptr<PcdFile> file_;
};

class PcdRecordStream : public BuiltStream {
 public:
  PcdRecordStream(const ScanEntry& entry, std::unique_ptr<PcdFile> opened)
      : BuiltStream(entry),
        file_(std::move(opened)),
        records_(file_->input, file_->data, file_->header.point_bytes) {
    count_ = file_->header.points;
    intensity_ = file_->used.intensity != nullptr;
    exact_ = entry.exact && file_->rounds();
    add_notes(file_->notes());
    take_first(records_.first_pass(count_, file_->used.colour(), FromRecord{file_->used}));
    add_notes(file_->notes_of_rest(count_ * file_->header.point_bytes));
    add_notes(take(file_->name, false));
    file_->set_grid_and_pose(head_);
  }

 private:
  void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const override {
    with_colours(builder, [&](auto& to) { records_.add(first, count, to, FromRecord{file_->used}); });
  }

  std::unique_ptr<PcdFile> file_;
  mutable FixedRecords records_;
};

const char* name_of(PcdData data) {
  return data == PcdData::ascii ? "ascii" : data == PcdData::binary ? "binary" : "binary_compressed";
}

}  // namespace

Scan read_pcd(const std::filesystem::path& file, const ReadOptions& options) {
  return PcdReader(file, options).read();
}

std::unique_ptr<ScanStream> stream_pcd(const std::filesystem::path& file, const ScanEntry& entry) {
  if (entry.salvage) return nullptr;
  auto opened = std::make_unique<PcdFile>(file, false);
  if (opened->header.data == PcdData::binary_compressed) return nullptr;
  if (opened->header.data == PcdData::binary && opened->header.point_bytes > FixedRecords::kLongest_bytes)
    return nullptr;
  opened->bound_points();
  if (opened->header.data == PcdData::ascii)
    return std::make_unique<PcdTextStream>(file, entry, std::move(opened));
  return std::make_unique<PcdRecordStream>(entry, std::move(opened));
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
