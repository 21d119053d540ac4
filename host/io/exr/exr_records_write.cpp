#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "geometry/range_image.hpp"
#include "io/e57/scan_samples.hpp"
#include "io/exr/exr_record_tiles.hpp"
#include "io/exr/exr_stream.hpp"
#include "io/exr/exr_threads.hpp"
#include "io/exr/range_exr_band.hpp"
#include "io/exr/range_exr_header.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {

using namespace records_attribute;

constexpr std::uint32_t kNaNBits = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN());
constexpr std::size_t kMostChannels_bytes = 4000;  // check_exr_header() takes no more

// For people and other programs: how a field's values follow from its channel's.
std::string encoding_of(const E57Field& field, const FieldChannels& channels) {
  std::string raw = channels.names.empty() ? fmt::format("{}", field.minimum) : channels.names[0];
  if (channels.kind == FieldChannels::from_row) return "the node's row";
  if (channels.kind == FieldChannels::from_column) return "the node's column";
  if (channels.kind == FieldChannels::single) return raw + ", float";
  if (channels.kind == FieldChannels::double_halves) return "double, its low and high 32 bits";
  if (channels.kind == FieldChannels::two_words) raw = channels.names[0] + " + 2^32 * " + channels.names[1];
  if (channels.kind != FieldChannels::constant && field.minimum != 0)
    raw += fmt::format(" + ({})", field.minimum);
  if (field.type != E57Type::scaled_integer) return raw;
  return fmt::format("({}) * {}{}", raw, field.scale,
                     field.offset == 0 ? "" : fmt::format(" + ({})", field.offset));
}

class Writer {
 public:
  Writer(const std::filesystem::path& file, const E57Scan& scan, const E57RecordReader& reader,
         const RecordsDescription& description)
      : file_(file), scan_(scan), table_(scan.points), reader_(reader), description_(description) {
    with_context_of_file([&] { plan_ = plan_records(table_, reader_); });
    groups_ = groups_of(plan_.layout);
    fields_ = channels_of(table_, plan_.layout);
    try {
      samples_.emplace(file.string() + ": " + table_.what, scan, reader);
    } catch (const Error& error) {  // no coordinates: the records alone
      if (error.kind() != ErrorKind::input) throw;
    }
    list_channels();
    tiles_.resize(groups_.size());
    hashes_.resize(static_cast<std::size_t>(across()) * static_cast<std::size_t>(down()));
  }

  void write() {
    write_atomically(file_, [&](const std::filesystem::path& temporary) {
      write_exr_stream(temporary, [&](ExrStream& stream) {
        const std::string& checksum = stream.add_placeholder(32);
        const std::string& sums = stream.add_placeholder(kTileSum_digits * hashes_.size());
        {
          Imf::TiledOutputFile out(stream, header(checksum, sums), start_exr_threads());
          out_ = &out;
          for (std::size_t k = 0; k < groups_.size(); ++k)
            if (plan_.last[k] == RecordPlan::kNone) finish(k);
          write_records();
        }
        stream.replace_placeholder(0, records_checksum(texts(), hashes_));
        stream.replace_placeholder(1, tile_sums_text(hashes_));
      });
    });
  }

 private:
  template <typename Body>
  void with_context_of_file(const Body& body) const {
    try {
      body();
    } catch (Error& error) {
      error.add_context(table_.what);
      throw;
    }
  }

  static int tiles(int pixels) {
    return (pixels + static_cast<int>(kRangeTile_px) - 1) / static_cast<int>(kRangeTile_px);
  }
  int across() const { return tiles(plan_.layout.cols); }
  int down() const { return tiles(plan_.layout.rows); }

  void list_channels() {
    const auto add = [&](std::string name, Imf::PixelType type, std::uint32_t empty) {
      channels_.push_back({std::move(name), type, empty});
      return channels_.size() - 1;
    };
    add("source", Imf::UINT, kNoSource);
    if (samples_) {
      add("mask", Imf::UINT, kEmpty);
      for (const char* name : {"range", "x", "y", "z"}) add(name, Imf::FLOAT, kNaNBits);
      if (samples_->columns().intensity) intensity_ = add("intensity", Imf::FLOAT, 0);
      if (samples_->columns().colour)
        for (const char* name : {"R", "G", "B"}) colour_ = add(name, Imf::HALF, 0) - 2;
    }
    for (const FieldChannels& field : fields_) {
      raw_.push_back(channels_.size());
      for (const std::string& name : field.names) add(name, field.is_float() ? Imf::FLOAT : Imf::UINT, 0);
    }
    std::size_t bytes = 0;
    for (const RecordChannel& channel : channels_) bytes += channel.name.size() + 17;
    if (bytes > kMostChannels_bytes)
      fail_input(
          "{}: {}: expected fewer fields, found {}, whose channels' names take {} of at most {} bytes; leave "
          "fields out",
          file_.string(), table_.what, table_.fields.size(), bytes, kMostChannels_bytes);
  }

  // What the checksum protects of the header.
  std::vector<std::string> texts() const {
    std::string cuts;
    for (const std::size_t cut : description_.cuts) cuts += fmt::format("{} ", cut);
    std::vector<std::string> texts = {std::to_string(plan_.layout.samples),
                                      plan_.layout.text(),
                                      description_.xml,
                                      cuts,
                                      description_.scan_xml,
                                      std::to_string(description_.scan),
                                      description_.parts};
    if (!description_.part_sums.empty()) texts.push_back(description_.part_sums);
    return texts;
  }

  Imf::Header header(const std::string& checksum, const std::string& tile_sums) const {
    Imf::Header header(plan_.layout.cols, plan_.layout.rows);
    if (plan_.layout.grid()) header.displayWindow().max.y = plan_.layout.grid_rows - 1;
    header.compression() = Imf::PIZ_COMPRESSION;
    header.lineOrder() = Imf::RANDOM_Y;
    header.setTileDescription(Imf::TileDescription(kRangeTile_px, kRangeTile_px));
    for (const RecordChannel& channel : channels_)
      header.channels().insert(channel.name, Imf::Channel(channel.type));
    const auto text = [&](const std::string& name, const std::string& value) {
      header.insert(name, Imf::StringAttribute(value));
    };
    const auto values = texts();
    const char* const names[] = {kSamples, kLayout, kXml, kCuts, kScanXml, kScan, kParts, kPartSums};
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!values[k].empty()) text(names[k], values[k]);
    text(range_attribute::kFormat, kRecordsFormatName);
    text(range_attribute::kChecksum, checksum);
    text(kTileSums, tile_sums);
    for (std::size_t k = 0; k < fields_.size(); ++k)
      text(fmt::format("{}field {}", range_attribute::kPrefix, table_.fields[k].name),
           encoding_of(table_.fields[k], fields_[k]));
    if (samples_ && !samples_->origin().isZero()) {
      const Vec3& origin = samples_->origin();
      text(kOrigin, fmt::format("{} {} {}", origin.x(), origin.y(), origin.z()));
    }
    if (scan_.world_from_scan) {
      std::string pose;
      for (const double value : row_major(*scan_.world_from_scan)) pose += fmt::format("{} ", value);
      text(range_attribute::kPose, pose);
    }
    for (const auto& [name, value] : description_.attributes) text(range_attribute::kPrefix + name, value);
    return header;
  }

  void write_records() {
    const auto all = all_fields(table_);
    const auto slot = [&](const char* name) {
      return std::ranges::find(table_.fields, name, &E57Field::name) - table_.fields.begin();
    };
    const auto row = static_cast<std::size_t>(slot("rowIndex")),
               column = static_cast<std::size_t>(slot("columnIndex"));
    RecordPlaces places(plan_.layout);
    pixels_.resize(kBlock_records);
    for_each_block(reader_, table_, all, kBlock_records, [&](const E57Records& records) {
      check_interrupted();
      const auto pixels = std::span(pixels_).first(records.count);
      const std::span<const std::int64_t> none;
      places.next(plan_.layout.grid() ? records.integers[row] : none,
                  plan_.layout.grid() ? records.integers[column] : none, pixels);
      locate(pixels);
      put_source(records);
      if (samples_) put_samples(records);
      parallel_for(fields_.size(), [&](std::size_t k) { put_field(records, k); });
      for (std::size_t k = 0; k < groups_.size(); ++k)
        if (tiles_[k] && plan_.last[k] < records.first + records.count) finish(k);
    });
  }

  // Where in which group's memory each record of a block goes.
  void locate(std::span<const std::uint32_t> pixels) {
    at_.resize(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::size_t group = group_at(plan_.layout, pixels[i]);
      if (!tiles_[group]) tiles_[group] = std::make_unique<RecordTiles>(groups_[group], channels_);
      at_[i] = {tiles_[group].get(), groups_[group].index(pixels[i], plan_.layout.cols)};
    }
  }

  template <typename Value>
  void put(std::size_t channel, const Value& value) {
    for (std::size_t i = 0; i < at_.size(); ++i) at_[i].tiles->words(channel)[at_[i].index] = value(i);
  }

  void put_source(const E57Records& records) {
    put(0, [&](std::size_t i) { return static_cast<std::uint32_t>(records.first + i); });
  }

  void put_field(const E57Records& records, std::size_t k) {
    const auto minimum = static_cast<std::uint64_t>(table_.fields[k].minimum);
    const auto whole = [&](std::size_t i) {
      return static_cast<std::uint64_t>(records.integers[k][i]) - minimum;
    };
    const auto real = [&](std::size_t i) { return std::bit_cast<std::uint64_t>(records.reals[k][i]); };
    const auto low = [](std::uint64_t bits) { return static_cast<std::uint32_t>(bits); };
    const auto high = [](std::uint64_t bits) { return static_cast<std::uint32_t>(bits >> 32); };
    switch (fields_[k].kind) {
      case FieldChannels::single:
        return put(raw_[k], [&](std::size_t i) {
          return std::bit_cast<std::uint32_t>(static_cast<float>(records.reals[k][i]));
        });
      case FieldChannels::double_halves:
        put(raw_[k], [&](std::size_t i) { return low(real(i)); });
        return put(raw_[k] + 1, [&](std::size_t i) { return high(real(i)); });
      case FieldChannels::two_words:
        put(raw_[k] + 1, [&](std::size_t i) { return high(whole(i)); });
        [[fallthrough]];
      case FieldChannels::word:
        return put(raw_[k], [&](std::size_t i) { return low(whole(i)); });
      default:
        return;
    }
  }

  // The values that everyone knows.
  void put_samples(const E57Records& records) {
    const E57Records some = selected(records, samples_->columns().fields);
    std::vector<std::array<float, 3>> points(records.count);
    SampleTally ignored;
    samples_->points(some, points, ignored);
    const auto is_return = [&](std::size_t i) {
      const auto& [x, y, z] = points[i];
      return !std::isnan(x) && (x != 0 || y != 0 || z != 0);
    };
    const Vec3 origin = samples_->origin();
    put(1, [&](std::size_t i) { return is_return(i) ? std::uint32_t{kMeasured} : std::uint32_t{kEmpty}; });
    put(2, [&](std::size_t i) {
      const Vec3 point = origin + Vec3(points[i][0], points[i][1], points[i][2]);
      return is_return(i) ? std::bit_cast<std::uint32_t>(static_cast<float>(point.norm())) : kNaNBits;
    });
    for (std::size_t axis = 0; axis < 3; ++axis)
      put(3 + axis, [&](std::size_t i) { return std::bit_cast<std::uint32_t>(points[i][axis]); });
    if (samples_->columns().intensity) {
      std::vector<float> values(records.count);
      samples_->intensities(some, values);
      put(intensity_, [&](std::size_t i) { return std::bit_cast<std::uint32_t>(values[i]); });
    }
    if (!samples_->columns().colour) return;
    std::vector<std::array<std::uint8_t, 3>> values(records.count);
    samples_->colours(some, values);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < at_.size(); ++i)
        at_[i].tiles->halves(colour_ + c)[at_[i].index] = linear_half(values[i][c]).bits();
  }

  // Writes a group whose records are all there, or that has none.
  void finish(std::size_t k) {
    if (!tiles_[k]) tiles_[k] = std::make_unique<RecordTiles>(groups_[k], channels_);
    tiles_[k]->hash(channels_, across(), hashes_);
    out_->setFrameBuffer(tiles_[k]->slices(channels_));
    const RecordGroup& g = groups_[k];
    out_->writeTiles(g.tile_x, g.tile_x + g.tiles_x - 1, g.tile_y, g.tile_y + g.tiles_y - 1);
    tiles_[k].reset();
  }

  const std::filesystem::path& file_;
  const E57Scan& scan_;
  const E57Table& table_;
  const E57RecordReader& reader_;
  const RecordsDescription& description_;
  RecordPlan plan_;
  std::vector<RecordGroup> groups_;
  std::vector<FieldChannels> fields_;
  std::optional<ScanSamples> samples_;
  std::vector<RecordChannel> channels_;
  std::vector<std::size_t> raw_;  // by field: its first channel
  std::size_t intensity_ = 0, colour_ = 0;
  std::vector<std::unique_ptr<RecordTiles>> tiles_;  // by group, those in the making
  std::vector<std::uint64_t> hashes_;
  std::vector<std::uint32_t> pixels_;
  struct At {
    RecordTiles* tiles = nullptr;
    std::size_t index = 0;
  };
  std::vector<At> at_;
  Imf::TiledOutputFile* out_ = nullptr;
};

}  // namespace

void write_exr_records(const std::filesystem::path& file, const E57Scan& scan, const E57RecordReader& reader,
                       const RecordsDescription& description) {
  Writer(file, scan, reader, description).write();
}

}  // namespace hybrid::io
