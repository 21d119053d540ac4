#include "io/pcd.hpp"

#include <bit>
#include <vector>

#include "core/error.hpp"
#include "core/free_memory.hpp"
#include "io/input_file.hpp"
#include "io/lzf.hpp"
#include "io/pcd_header.hpp"
#include "io/salvage.hpp"
#include "io/scan_builder.hpp"
#include "io/text_cursor.hpp"
#include "io/text_samples.hpp"

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

class PcdReader {
 public:
  PcdReader(const std::filesystem::path& file, const ReadOptions& options)
      : input_(file),
        file_(input_.name()),
        salvage_(options.salvage),
        exact_(options.exact),
        damage_(file_),
        header_(read_pcd_header(input_, options.salvage)),
        announced_(header_.points),
        data_(header_.data_offset),
        data_bytes_(input_.size() - data_),
        name_(file.stem().string()) {
    used_ = find_fields(file_, header_, unused_);
  }

  Scan read() {
    Scan scan = header_.data == PcdData::ascii    ? read_ascii()
                : header_.data == PcdData::binary ? read_binary()
                                                  : read_compressed();
    if (header_.width > 1 && header_.height > 1) {
      scan.grid_rows = static_cast<int>(header_.height);
      scan.grid_cols = static_cast<int>(header_.width);
      scan.row_by_row = true;
    }
    set_pose(scan);
    return scan;
  }

 private:
  ScanBuilder builder() const {
    // Single precision holds what was written in it.
    const bool rounds = header_.data == PcdData::ascii ||
                        std::ranges::any_of(std::array{used_.x, used_.y, used_.z}, [](const PcdField* field) {
                          return field->type != ScalarType::f32;
                        });
    ScanBuilder result(file_, name_, header_.points,
                       {.intensity = used_.intensity != nullptr,
                        .colour = used_.colour(),
                        .salvage = salvage_,
                        .exact = exact_ && rounds});
    for (const std::string& note : header_.notes) result.add_note(note);
    if (!unused_.empty()) result.add_note("fields not used: " + unused_);
    return result;
  }

  static std::string end_of_points(std::uint64_t offset) {
    return fmt::format("byte {}: the points that the header announces end", offset);
  }

  // In salvage: no more points than there is room for.
  void bound_points(std::uint64_t least_bytes, std::uint64_t available, const std::string& place) {
    if (!salvage_)
      check_count_fits(file_, place, "points", header_.points, least_bytes, available, true);
    else
      header_.points = std::min(header_.points, available / std::max<std::uint64_t>(least_bytes, 1));
  }

  // In salvage: the rows of the grid that are there, the last one filled up with no-returns.
  void crop(ScanBuilder& result, const std::string& problem) {
    const std::uint64_t found = result.size();
    if (found < announced_) {
      damage_.add(announced_ - found, problem);
      const bool grid = header_.width > 1 && header_.height > 1;
      const CroppedGrid cropped = grid ? cropped_grid(header_.width, found) : CroppedGrid{};
      result.add_lost(cropped.nodes() - std::min(cropped.nodes(), found));
      header_.width = cropped.fast;
      header_.height = cropped.slow;
    }
    if (damage_.records() > 0) result.add_note(damage_.note(announced_));
  }

  // Where a byte of the data lies in the file.
  std::string byte(std::uint64_t offset) const { return fmt::format("byte {}", data_ + offset); }

  Scan read_ascii() {
    // A value takes a digit and a separator; the last line may lack its end.
    bound_points(2 * header_.point_values, data_bytes_ + 1, fmt::format("line {}", header_.data_line));
    ScanBuilder result = builder();
    const auto to_sample = [&](const double* row) {
      const auto number = [&](const PcdField& field) { return row[field.value_offset]; };
      const auto bits = [&](const PcdField& field) {
        if (is_real(field.type)) return std::bit_cast<std::uint32_t>(static_cast<float>(number(field)));
        const bool fits = number(field) > -2147483649.0 && number(field) < 4294967296.0;
        return fits ? static_cast<std::uint32_t>(static_cast<std::int64_t>(number(field))) : 0u;
      };
      return make_sample(used_, number, bits);
    };
    const auto read_line = [&](TextCursor& at, std::span<double> values, std::uint64_t done) {
      const std::uint64_t line = at.line();
      if (at.at_end())
        fail_input(
            "{}: line {}: expected {} points, found {}; the file is cut short: copy or export it again, {}",
            file_, line, header_.points, done, kSalvageRemedy);
      const std::size_t found = at.read_numbers(values);
      if (found != values.size())
        fail_input(
            "{}: line {}: expected {} values as FIELDS and COUNT say, found {}; correct or remove that line, "
            "{}",
            file_, line, values.size(), found, kSalvageRemedy);
    };
    bool commas = false;
    TextPlace place{data_, header_.data_line};
    if (header_.points > 0)
      place = add_text_samples(input_, place, header_.points, header_.point_values, result, commas, to_sample,
                               read_line, salvage_ ? &damage_ : nullptr);
    crop(result, end_of_points(place.offset));
    if (commas) result.add_note("values are separated by commas, which PCD does not provide for");
    TextCursor cursor(input_, place.offset, place.line);
    note_rest(result, cursor);
    return result.finish();
  }

  // A further point means that the header is wrong; anything else is told.
  void note_rest(ScanBuilder& result, TextCursor& cursor) const {
    cursor.skip_blank_lines();
    if (cursor.at_end()) return;
    const std::uint64_t line = cursor.line(), rest = cursor.remaining();
    if (!salvage_ && cursor.next_line_is_numbers(header_.point_values))
      fail_input(
          "{}: line {}: expected the end of the file after {} points, found another point; correct WIDTH, "
          "HEIGHT and POINTS in the header, {}",
          file_, line, header_.points, kSalvageRemedy);
    result.add_note(fmt::format("line {}: {} bytes after the last point are ignored", line, rest));
  }

  // at(field, i): where the field of point i lies in memory.
  template <typename At>
  void add_records(ScanBuilder& result, const At& at) const {
    std::uint64_t i = 0;
    const auto number = [&](const PcdField& field) { return load_scalar(at(field, i), field.type, false); };
    const auto bits = [&](const PcdField& field) { return load_as<std::uint32_t>(at(field, i), false); };
    for (; i < header_.points; ++i) result.add(make_sample(used_, number, bits));
  }

  // PCL's writer fills the last page with zeros, which are worth no note.
  void note_rest(ScanBuilder& result, std::uint64_t used_bytes) {
    const std::uint64_t rest = data_bytes_ - used_bytes;
    if (rest > 0) check_not_sent_as_text(input_, data_);
    if (input_.only_zeros_from(data_ + used_bytes)) return;
    if (header_.data == PcdData::binary && rest >= header_.point_bytes && !salvage_)
      fail_input(
          "{}: {}: expected the end of the file after {} points, found {} more bytes, room for {} points; "
          "correct WIDTH, HEIGHT and POINTS in the header, {}",
          file_, byte(used_bytes), header_.points, rest, rest / header_.point_bytes, kSalvageRemedy);
    result.add_note(fmt::format("{}: {} bytes after the last point are ignored", byte(used_bytes), rest));
  }

  // Field by field through the file's window: a point may be longer than that.
  Scan read_binary() {
    bound_points(header_.point_bytes, data_bytes_, byte(0));
    ScanBuilder result = builder();
    add_records(result, [&](const PcdField& field, std::uint64_t i) {
      return input_.at(data_ + i * header_.point_bytes + field.byte_offset, size_of(field.type));
    });
    crop(result, end_of_points(data_ + header_.points * header_.point_bytes));
    note_rest(result, header_.points * header_.point_bytes);
    return result.finish();
  }

  Scan read_compressed() {
    check_count_fits(file_, byte(0), "sizes", 2, 4, data_bytes_);
    std::uint64_t compressed = load_as<std::uint32_t>(input_.at(data_, 4), false);
    const std::uint64_t expanded = load_as<std::uint32_t>(input_.at(data_ + 4, 4), false);
    if (salvage_) compressed = std::min(compressed, data_bytes_ - 8);
    if (compressed > data_bytes_ - 8)
      fail_input(
          "{}: {}: expected {} compressed bytes, found {}; the file is cut short: copy or export it again, "
          "{}",
          file_, byte(0), compressed, data_bytes_ - 8, kSalvageRemedy);
    // Of all counts the one that was written with the data tells where the fields lie.
    if (salvage_ && expanded % header_.point_bytes == 0 && expanded / header_.point_bytes != header_.points) {
      header_.points = expanded / header_.point_bytes;
      header_.notes.push_back(
          fmt::format("{}: expected {} points, found an uncompressed size of {}: as many, "
                      "and as not organised",
                      byte(4), announced_, header_.points));
      header_.height = 1;
    }
    if (header_.points > expanded / header_.point_bytes || header_.points * header_.point_bytes != expanded)
      fail_input(
          "{}: {}: expected {} points of {} bytes, found an uncompressed size of {} bytes; the header is "
          "wrong, or the file damaged: export it again",
          file_, byte(4), header_.points, header_.point_bytes, expanded);
    if (!salvage_)
      check_count_fits(file_, byte(4), "uncompressed bytes", expanded, 1, compressed * kLzfLargestExpansion);
    std::vector<char> packed(compressed),
        records(std::min<std::uint64_t>(expanded, compressed * kLzfLargestExpansion));
    input_.read(data_ + 8, packed);
    std::size_t produced = 0;
    const std::string damage = decompress_lzf({packed.data(), packed.size()}, records, &produced);
    if (!damage.empty() && !salvage_)
      fail_input("{}: {}: expected LZF data, found {}; the file is damaged: copy or export it again, {}",
                 file_, byte(8), damage, kSalvageRemedy);
    free_memory(packed);
    if (produced < expanded) return salvage_fields(records, produced, byte(8) + ": " + damage, compressed);
    ScanBuilder result = builder();
    add_records(result, [&](const PcdField& field, std::uint64_t i) {
      return records.data() + header_.points * field.byte_offset + i * size_of(field.type);
    });
    note_rest(result, 8 + compressed);
    return result.finish();
  }

  // The fields lie one behind the other: points whose x, y and z are all there are whole but for fields that
  // are cut off.
  Scan salvage_fields(std::vector<char>& records, std::size_t produced, const std::string& problem,
                      std::uint64_t compressed) {
    const auto held = [&](const PcdField& field) {
      const std::uint64_t start = header_.points * field.byte_offset;
      return produced < start ? 0 : std::min(header_.points, (produced - start) / size_of(field.type));
    };
    const std::uint64_t stride = header_.points;
    std::string cut;
    for (const PcdField* field : {used_.intensity, used_.packed, used_.red, used_.green, used_.blue})
      if (field && held(*field) < stride) cut += " " + field->name;
    const std::uint64_t points = std::min({held(*used_.x), held(*used_.y), held(*used_.z)});
    records.resize(produced + sizeof(double));
    std::fill(records.begin() + static_cast<std::ptrdiff_t>(produced), records.end(), '\0');
    if (points == 0)
      fail_input(
          "{}: {}: of {} uncompressed bytes {} can be read, too few for x, y and z of one point; copy or "
          "export the file again",
          file_, problem, stride * header_.point_bytes, produced);
    header_.points = points;
    ScanBuilder result = builder();
    add_records(result, [&](const PcdField& field, std::uint64_t i) {
      const std::uint64_t at = stride * field.byte_offset + i * size_of(field.type);
      return records.data() + std::min<std::uint64_t>(at, produced);
    });
    announced_ = stride;
    crop(result, problem);
    if (points == stride) result.add_note(problem);
    if (!cut.empty()) result.add_note(fmt::format("cut off and 0 from some point on:{}", cut));
    note_rest(result, 8 + compressed);
    return result.finish();
  }

  void set_pose(Scan& scan) const {
    const auto& v = header_.viewpoint;
    const Pose pose{1, Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized(), {v[0], v[1], v[2]}};
    if (pose.translation.isZero(0) && pose.rotation.vec().isZero(0)) return;
    scan.world_from_scan = pose;
    scan.notes.emplace_back(
        "VIEWPOINT is taken as the scanner's pose, and the points as being in the scanner's frame");
  }

  InputFile input_;
  const std::string& file_;
  bool salvage_, exact_;
  Damage damage_;
  PcdHeader header_;
  std::uint64_t announced_;          // points, by the header
  std::uint64_t data_, data_bytes_;  // where the data begins, and how much there is
  std::string name_, unused_;
  UsedFields used_;
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
