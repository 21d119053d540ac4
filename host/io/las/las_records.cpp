#include "io/las/las_records.hpp"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "io/e57/e57_write_xml.hpp"
#include "io/las/las_header.hpp"
#include "io/scalar_type.hpp"

namespace hybrid::io {
// Some bits of a record.
struct LasField {
  const char* name = "";
  int at = 0;
  ScalarType type = ScalarType::u8;
  int shift = 0, bits = 0;  // bits 0: the whole number
  bool always = false;      // else only where a record has it set

  std::int64_t whole(const char* record) const {
    const char* from = record + at;
    const auto masked = [&](int value) { return bits == 0 ? value : value >> shift & ((1 << bits) - 1); };
    switch (type) {
      case ScalarType::u8:
        return masked(load_as<std::uint8_t>(from, false));
      case ScalarType::i8:
        return load_as<std::int8_t>(from, false);
      case ScalarType::u16:
        return load_as<std::uint16_t>(from, false);
      case ScalarType::i16:
        return load_as<std::int16_t>(from, false);
      case ScalarType::i32:
        return load_as<std::int32_t>(from, false);
      default:
        return load_as<std::int64_t>(from, false);  // a double's bits
    }
  }
};

// What one pass over the records tells.
struct LasExtent {
  std::vector<std::int64_t> least, greatest;  // by field
  bool waveforms = false, extra = false;
  std::uint64_t hash = 0;
};

namespace {

constexpr std::size_t kBlock_bytes = 1 << 20;
constexpr const char* kAddress = "urn:las:point-data-record";  // of the extension `las`

// LAS 1.4, tables 7 to 25.
std::vector<LasField> fields_of(const LasPointFormat& format) {
  using enum ScalarType;
  std::vector<LasField> fields = {{"cartesianX", 0, i32, 0, 0, true},
                                  {"cartesianY", 4, i32, 0, 0, true},
                                  {"cartesianZ", 8, i32, 0, 0, true},
                                  {"intensity", 12, u16, 0, 0, true}};
  if (format.red > 0) {
    fields.push_back({"colorRed", format.red, u16, 0, 0, true});
    fields.push_back({"colorGreen", format.red + 2, u16, 0, 0, true});
    fields.push_back({"colorBlue", format.red + 4, u16, 0, 0, true});
  }
  const int wide = format.extended ? 4 : 3;
  fields.push_back({"las:returnNumber", 14, u8, 0, wide});
  fields.push_back({"las:numberOfReturns", 14, u8, wide, wide});
  const int flags = format.extended ? 15 : 14;
  fields.push_back({"las:scanDirection", flags, u8, 6, 1});
  fields.push_back({"las:edgeOfFlightLine", flags, u8, 7, 1});
  if (format.extended) {
    fields.push_back({"las:classificationFlags", 15, u8, 0, 4});
    fields.push_back({"las:scannerChannel", 15, u8, 4, 2});
    fields.push_back({"las:classification", 16, u8});
    fields.push_back({"las:userData", 17, u8});
    fields.push_back({"las:scanAngle", 18, i16});
    fields.push_back({"las:pointSource", 20, u16});
  } else {
    fields.push_back({"las:classification", 15, u8, 0, 5});
    fields.push_back({"las:classificationFlags", 15, u8, 5, 3});
    fields.push_back({"las:scanAngle", 16, i8});
    fields.push_back({"las:userData", 17, u8});
    fields.push_back({"las:pointSource", 18, u16});
  }
  if (format.gps_time > 0) fields.push_back({"las:gpsTime", format.gps_time, f64});
  if (format.infrared > 0) fields.push_back({"las:nearInfrared", format.infrared, u16});
  return fields;
}

}  // namespace

class LasAsE57::Records {
 public:
  explicit Records(const std::filesystem::path& file)
      : input_(file), header_(read_las_header(input_)), format_(las_point_format(header_.point_format)) {
    if (const auto note = check_las_rest(input_, header_, false)) notes_.push_back(*note);
    candidates_ = fields_of(format_);
    measure();
  }

  const LasHeader& header() const { return header_; }
  const LasExtent& extent() const { return extent_; }
  const std::vector<std::string>& notes() const { return notes_; }
  std::string name() const { return input_.name(); }

  // The fields that are kept, in the order of their descriptions.
  std::vector<E57Field> describe() {
    std::vector<E57Field> described;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      const LasField& field = candidates_[k];
      const std::int64_t least = extent_.least[k], greatest = extent_.greatest[k];
      if (!field.always && least == 0 && greatest == 0) continue;
      kept_.push_back(field);
      E57Field& one =
          described.emplace_back(E57Field{.name = field.name, .minimum = least, .maximum = greatest});
      if (field.type == ScalarType::f64)
        one = {.name = field.name, .type = E57Type::double_real};
      else if (k < 3)
        one.type = E57Type::scaled_integer, one.scale = header_.scale[k], one.offset = header_.offset[k];
    }
    return described;
  }

  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const {
    constexpr std::size_t kRange = E57RecordReader::kRange;
    parallel_for((count + kRange - 1) / kRange, [&](std::size_t range) {
      E57Records records{.first = first + range * kRange,
                         .integers = std::vector<std::span<const std::int64_t>>(fields.size()),
                         .reals = std::vector<std::span<const double>>(fields.size())};
      records.count =
          static_cast<std::size_t>(std::min<std::uint64_t>(kRange, first + count - records.first));
      std::vector<std::int64_t> whole(fields.size() * records.count);
      std::vector<double> real(whole.size());
      for_records(records.first, records.count, [&](std::size_t i, const char* record) {
        for (std::size_t k = 0; k < fields.size(); ++k) {
          const LasField& field = kept_[fields[k]];
          const std::size_t at = k * records.count + i;
          if (field.type == ScalarType::f64)
            real[at] = load_as<double>(record + field.at, false);
          else
            whole[at] = field.whole(record);
        }
      });
      for (std::size_t k = 0; k < fields.size(); ++k)
        if (kept_[fields[k]].type == ScalarType::f64)
          records.reals[k] = std::span(real).subspan(k * records.count, records.count);
        else
          records.integers[k] = std::span(whole).subspan(k * records.count, records.count);
      body(records);
    });
  }

 private:
  // take(i, record) for `count` records from `first` on, in some memory at a time however long a record is.
  template <typename Take>
  void for_records(std::uint64_t first, std::size_t count, const Take& take) const {
    const auto size = static_cast<std::size_t>(header_.record_bytes);
    const std::size_t most = std::max<std::size_t>(1, kBlock_bytes / size);
    thread_local std::vector<char> bytes;
    for (std::size_t done = 0; done < count; done += most) {
      const std::size_t some = std::min(most, count - done);
      bytes.resize(some * size);
      input_.read(header_.data_offset + (first + done) * size, bytes);
      for (std::size_t i = 0; i < some; ++i) take(done + i, bytes.data() + i * size);
    }
  }

  void measure() {
    constexpr std::uint64_t kPart = 1 << 16;
    constexpr auto kLeast = std::numeric_limits<std::int64_t>::min();
    constexpr auto kGreatest = std::numeric_limits<std::int64_t>::max();
    const LasExtent none{std::vector(candidates_.size(), kGreatest), std::vector(candidates_.size(), kLeast),
                         false, false, 0};
    std::vector<LasExtent> parts((header_.points + kPart - 1) / kPart, none);
    const auto size = static_cast<std::size_t>(header_.record_bytes);
    const auto any = [](const char* from, const char* end) {
      return std::any_of(from, end, [](char c) { return c != 0; });
    };
    parallel_for(parts.size(), [&](std::size_t p) {
      LasExtent& part = parts[p];
      const auto count = static_cast<std::size_t>(std::min(kPart, header_.points - p * kPart));
      for_records(p * kPart, count, [&](std::size_t, const char* record) {
        for (std::size_t k = 0; k < candidates_.size(); ++k) {
          const std::int64_t value = candidates_[k].whole(record);
          part.least[k] = std::min(part.least[k], value);
          part.greatest[k] = std::max(part.greatest[k], value);
        }
        if (format_.waveform > 0)
          part.waveforms |= any(record + format_.waveform, record + format_.waveform + 29);
        part.extra |= any(record + format_.bytes, record + size);
        part.hash = XXH3_64bits_withSeed(record, size, part.hash);
      });
    });
    extent_ = none;
    for (const LasExtent& part : parts) {
      for (std::size_t k = 0; k < candidates_.size(); ++k) {
        extent_.least[k] = std::min(extent_.least[k], part.least[k]);
        extent_.greatest[k] = std::max(extent_.greatest[k], part.greatest[k]);
      }
      extent_.waveforms |= part.waveforms;
      extent_.extra |= part.extra;
      extent_.hash = XXH3_64bits_withSeed(&part.hash, sizeof part.hash, extent_.hash);
    }
    if (parts.empty()) extent_.least.assign(candidates_.size(), 0), extent_.greatest = extent_.least;
  }

  InputFile input_;
  LasHeader header_;
  const LasPointFormat& format_;
  std::vector<std::string> notes_;
  std::vector<LasField> candidates_, kept_;
  LasExtent extent_;
};

// Shares the file with its source.
class LasAsE57::Reader : public E57RecordReader {
 public:
  explicit Reader(std::shared_ptr<const Records> records) : records_(std::move(records)) {
    notes_ = records_->notes();
  }
  std::uint64_t count() const override { return records_->header().points; }
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const override {
    records_->read(fields, first, count, body);
  }

 private:
  std::shared_ptr<const Records> records_;
};

LasAsE57::LasAsE57(const std::filesystem::path& file) {
  const auto records = std::make_shared<Records>(file);
  E57Scan scan;
  scan.points.fields = records->describe();
  scan.points.what = scan.name = file.stem().string();
  scan.points.count = records->header().points;
  scan.guid = fmt::format("{{las-{:016x}}}", records->extent().hash);
  scan.intensity = E57Limits{0, 65535};
  if (std::ranges::any_of(scan.points.fields, [](const E57Field& field) { return field.name == "colorRed"; }))
    scan.colour.emplace().fill({0, 65535});
  if (records->extent().waveforms) drop("waveforms");
  if (records->extent().extra) drop("extra bytes of the points");
  E57Contents contents;
  contents.library = "Hybrid";
  contents.coordinate_system = records->header().crs;
  contents.extensions.push_back({"las", kAddress});
  contents.guid = scan.guid;
  contents.scans.push_back(std::move(scan));
  describe(records->name(), write_e57_xml(contents, {}));
  records_ = records;
}

LasAsE57::~LasAsE57() = default;

std::unique_ptr<E57RecordReader> LasAsE57::open_stored(std::size_t) const {
  return std::make_unique<Reader>(records_);
}

std::vector<char> LasAsE57::blob(std::size_t) const {
  return {};
}

}  // namespace hybrid::io
