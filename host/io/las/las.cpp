#include "io/las/las.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "core/error.hpp"
#include "core/log.hpp"
#include "core/parallel.hpp"
#include "io/built_stream.hpp"
#include "io/input_file.hpp"
#include "io/las/las_header.hpp"
#include "io/salvage.hpp"
#include "io/scalar_type.hpp"
#include "io/scan_builder.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kPart_bytes = 1 << 20;
constexpr std::size_t kPartsPerThread = 4;

// Point records that follow each other.
struct Part {
  std::vector<char> bytes;
  std::size_t count = 0;
  std::string any;  // the bits that any record has set
  std::array<std::int32_t, 3> least{}, greatest{};

  void load(const InputFile& file, std::uint64_t offset, std::size_t records, std::size_t record_bytes) {
    count = records;
    bytes.resize(records * record_bytes);
    file.read(offset, bytes);
    any.assign(record_bytes, '\0');
    least.fill(std::numeric_limits<std::int32_t>::max());
    greatest.fill(std::numeric_limits<std::int32_t>::min());
    for (std::size_t i = 0; i < records; ++i) {
      const char* record = bytes.data() + i * record_bytes;
      for (std::size_t k = 0; k < record_bytes; ++k) any[k] = static_cast<char>(any[k] | record[k]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto value = load_as<std::int32_t>(record + 4 * axis, false);
        least[axis] = std::min(least[axis], value);
        greatest[axis] = std::max(greatest[axis], value);
      }
    }
  }
};

class LasReader {
 public:
  LasReader(const std::filesystem::path& file, const std::string& name, const ReadOptions& options)
      : input_(file),
        salvage_(options.salvage),
        exact_(options.exact),
        header_(read_las_header(input_, options.salvage)),
        format_(las_point_format(header_.point_format)),
        name_(name) {
    any_.assign(header_.record_bytes, '\0');
    least_.fill(std::numeric_limits<std::int32_t>::max());
    greatest_.fill(std::numeric_limits<std::int32_t>::min());
  }

  InputFile& input() { return input_; }
  const LasHeader& header() const { return header_; }
  bool has_colour() const { return format_.red > 0; }

  Scan read() {
    ScanBuilder builder(input_.name(), name_, header_.points,
                        {.intensity = true,
                         .colour = has_colour() ? ColourKind::word : ColourKind::none,
                         .salvage = salvage_,
                         .exact = exact_});
    for (const std::string& note : header_.notes) builder.add_note(note);
    add_points(0, header_.points, builder);
    for (const std::string& note : notes()) builder.add_note(note);
    Scan scan = builder.finish();
    describe(scan, !scan.exact.empty());
    return scan;
  }

  // What the header says of all samples.
  void describe(Scan& scan, bool exact) const {
    scan.intensity_limits = {0.0f, 65535.0f};
    if (exact) {
      const auto& [sx, sy, sz] = header_.scale;
      const auto& [ox, oy, oz] = header_.offset;
      scan.steps = {{sx, sy, sz}, {ox, oy, oz}};
    }
    scan.crs = header_.crs;
    scan.crs_records = header_.crs_records;
  }

  // Of all points, which were added.
  std::vector<std::string> notes() {
    std::vector<std::string> notes;
    if (header_.points < header_.announced) {
      Damage damage(input_.name());
      damage.add(header_.announced - header_.points,
                 fmt::format("byte {}: the points that the header announces end",
                             header_.data_offset + header_.points * header_.record_bytes));
      notes.push_back(damage.note(header_.announced));
    }
    if (const auto note = check_las_rest(input_, header_, salvage_)) notes.push_back(*note);
    if (!header_.unit.empty() && header_.unit != "m") {
      notes.push_back(
          fmt::format("its coordinate system counts in {}: coordinates stay as they are, and are taken for "
                      "metres; convert the file to metres first",
                      header_.unit));
      log::warning("{}: {}", input_.name(), notes.back());
    }
    note_extent(notes);
    note_unused(notes);
    return notes;
  }

  // Points [first, first + count), read on all threads.
  template <typename Builder>
  void add_points(std::uint64_t first, std::uint64_t count, Builder& builder) {
    const auto record_bytes = static_cast<std::size_t>(header_.record_bytes);
    const std::size_t per_part = std::max<std::size_t>(1, kPart_bytes / record_bytes);
    parts_.resize(kPartsPerThread * static_cast<std::size_t>(thread_count()));
    std::vector<std::size_t> counts;
    for (std::uint64_t done = 0; done < count;) {
      counts.clear();
      for (std::uint64_t left = count - done; left > 0 && counts.size() < parts_.size();
           left -= counts.back())
        counts.push_back(static_cast<std::size_t>(std::min<std::uint64_t>(left, per_part)));
      parallel_for(counts.size(), [&](std::size_t k) {
        parts_[k].load(input_, header_.data_offset + (first + done + k * per_part) * header_.record_bytes,
                       counts[k], record_bytes);
      });
      for (std::size_t k = 0; k < counts.size(); ++k) take(parts_[k]);
      builder.add_parts(counts, [&](std::size_t k, std::size_t i) {
        return sample(parts_[k].bytes.data() + i * record_bytes);
      });
      for (const std::size_t part : counts) done += part;
    }
  }

 private:
  void take(const Part& part) {
    for (std::size_t k = 0; k < any_.size(); ++k) any_[k] = static_cast<char>(any_[k] | part.any[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least_[axis] = std::min(least_[axis], part.least[axis]);
      greatest_[axis] = std::max(greatest_[axis], part.greatest[axis]);
    }
  }

  double coordinate(std::size_t axis, std::int32_t value) const {
    return value * header_.scale[axis] + header_.offset[axis];
  }

  ScanSample sample(const char* record) const {
    const auto axis = [&](std::size_t i) {
      return coordinate(i, load_as<std::int32_t>(record + 4 * i, false));
    };
    const auto word = [&](int at) { return static_cast<double>(load_as<std::uint16_t>(record + at, false)); };
    ScanSample sample{axis(0), axis(1), axis(2), word(12), {}};
    if (format_.red > 0) sample.rgb = {word(format_.red), word(format_.red + 2), word(format_.red + 4)};
    return sample;
  }

  void note_extent(std::vector<std::string>& notes) const {
    if (header_.points == 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double least = coordinate(axis, least_[axis]), greatest = coordinate(axis, greatest_[axis]);
      const double slack = 2 * header_.scale[axis];
      if (least >= header_.minimum[axis] - slack && greatest <= header_.maximum[axis] + slack) continue;
      notes.push_back(
          fmt::format("the header gives {} from {} to {}, its points lie from {} to {}: damaged, or changed "
                      "without its header",
                      "xyz"[axis], header_.minimum[axis], header_.maximum[axis], least, greatest));
    }
  }

  bool any(int from, int bytes) const {
    return std::any_of(any_.begin() + from, any_.begin() + from + bytes, [](char c) { return c != 0; });
  }

  void note_unused(std::vector<std::string>& notes) const {
    std::string unused;
    const auto add = [&](bool used, const char* name) {
      if (used) unused += (unused.empty() ? "" : ", ") + std::string(name);
    };
    const int flags = static_cast<unsigned char>(any_[14]), more = static_cast<unsigned char>(any_[15]);
    const int returns = format_.extended ? flags : flags & 0x3f,
              first_of_one = format_.extended ? 0x11 : 0x09;
    add(returns != 0 && returns != first_of_one, "return numbers");
    add(format_.extended ? (more & 0xc0) != 0 : (flags & 0xc0) != 0, "scan direction");
    add(format_.extended ? any(16, 1) : (more & 0x1f) != 0, "classification");
    add(format_.extended ? (more & 0x0f) != 0 : (more & 0xe0) != 0, "classification flags");
    add(format_.extended && (more & 0x30) != 0, "scanner channel");
    add(format_.extended ? any(18, 2) : any(16, 1), "scan angle");
    add(any(17, 1), "user data");
    add(format_.extended ? any(20, 2) : any(18, 2), "point source");
    add(format_.gps_time > 0 && any(format_.gps_time, 8), "GPS time");
    add(format_.infrared > 0 && any(format_.infrared, 2), "near infrared");
    add(format_.waveform > 0 && any(format_.waveform, 29), "waveforms");
    const int extra = static_cast<int>(any_.size()) - format_.bytes;
    add(extra > 0 && any(format_.bytes, extra), "extra bytes");
    if (!unused.empty()) notes.push_back("fields not used: " + unused);
  }

  InputFile input_;
  bool salvage_, exact_;
  LasHeader header_;
  const LasPointFormat& format_;
  std::string name_, any_;
  std::array<std::int32_t, 3> least_{}, greatest_{};
  std::vector<Part> parts_;
};

class LasStream : public BuiltStream {
 public:
  LasStream(const std::filesystem::path& file, const ScanEntry& entry)
      : BuiltStream(entry), reader_(file, entry.name, {.salvage = entry.salvage}) {
    const LasHeader& header = reader_.header();
    count_ = header.points;
    intensity_ = true;
    FirstPass all;
    all.colour = reader_.has_colour() ? ColourKind::word : ColourKind::none;
    reader_.add_points(0, count_, all);
    take_first(all);
    head_.notes = header.notes;
    add_notes(reader_.notes());
    add_notes(take(reader_.input().name(), false));
    reader_.describe(head_, exact_);
  }

 private:
  void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const override {
    with_colours(builder, [&](auto& to) { reader_.add_points(first, count, to); });
  }

  mutable LasReader reader_;
};

}  // namespace

std::vector<ScanEntry> list_las(const std::filesystem::path& file, const ReadOptions& options) {
  InputFile input(file);
  const LasHeader header = read_las_header(input, options.salvage);
  ScanEntry entry{.name = file.stem().string(), .samples = header.points};
  entry.structure = fmt::format("LAS 1.{}, point format {}, steps of {} {} {}", header.minor,
                                header.point_format, header.scale[0], header.scale[1], header.scale[2]);
  entry.crs = header.crs;
  entry.unit = header.unit;
  entry.offset = header.data_offset;
  entry.end = header.data_end;
  return {entry};
}

std::unique_ptr<ScanStream> stream_las(const std::filesystem::path& file, const ScanEntry& entry) {
  return std::make_unique<LasStream>(file, entry);
}

Scan read_las(const std::filesystem::path& file, const ScanEntry& entry) {
  return LasReader(file, entry.name, {.salvage = entry.salvage, .exact = entry.exact}).read();
}

}  // namespace hybrid::io
