#include <ImfChannelList.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputPart.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <limits>
#include <numeric>

#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "io/decoded_tiles.hpp"
#include "io/exr/exr_errors.hpp"
#include "io/exr/exr_header.hpp"
#include "io/exr/exr_record_index.hpp"
#include "io/exr/exr_record_tiles.hpp"
#include "io/exr/exr_threads.hpp"
#include "io/exr/range_exr_band.hpp"
#include "io/exr/range_exr_header.hpp"
#include "io/salvage.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

using namespace records_attribute;

// Those of the records from `first` on that have no pixel.
std::vector<E57Records::Lost> lost_of(std::uint64_t first, std::span<const std::uint32_t> pixels) {
  std::vector<E57Records::Lost> lost;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i] != RecordIndex::kNowhere) continue;
    const std::uint64_t record = first + i;
    if (lost.empty() || lost.back().end != record) lost.push_back({record, record});
    ++lost.back().end;
  }
  return lost;
}

}  // namespace

struct ExrRecords::State {
  State(const std::filesystem::path& path, bool for_salvage) : file(path.string()), salvage(for_salvage) {
    {
      InputFile input(path);
      check_exr_header(input);
    }
    open_image();
    if (text(range_attribute::kFormat) != kRecordsFormatName)
      fail_input("{}: header: expected {} \"{}\", found {}; these are no records", file,
                 range_attribute::kFormat, kRecordsFormatName, in_quotes(text(range_attribute::kFormat)));
    const Imath::Box2i window = header().dataWindow();
    layout = RecordLayout::parse(file, text(kLayout), whole(kSamples));
    if (window.min != Imath::V2i(0, 0) || window.max != Imath::V2i(layout.cols - 1, layout.rows - 1) ||
        !header().hasTileDescription() || header().tileDescription().mode != Imf::ONE_LEVEL ||
        header().tileDescription().xSize != kRangeTile_px ||
        header().tileDescription().ySize != kRangeTile_px)
      fail_input(
          "{}: header: expected {} x {} pixels from (0, 0) in one level, as {} says, found others; copy or "
          "write "
          "the file again",
          file, layout.rows, layout.cols, kLayout);
    description.xml = text(kXml);
    description.scan_xml = text(kScanXml);
    description.parts = text(kParts);
    description.part_sums = text(kPartSums);
    if (!description.xml.empty()) description.scan = whole(kScan);
    for (const std::string_view word : words(cuts_text = text(kCuts)))
      description.cuts.push_back(number(kCuts, word));
  }

  // Its header; the library takes memory for tiles with open_tiles() only.
  void open_image() {
    in.reset();
    guarded([&] { image = std::make_unique<Imf::MultiPartInputFile>(file.c_str(), start_exr_threads()); });
  }
  void open_tiles() {
    guarded([&] { in.emplace(*image, 0); });
  }

  const Imf::Header& header() const { return image->header(0); }
  std::string text(const char* name) const { return text_attribute(header(), name); }
  std::uint64_t number(const char* name, std::string_view word) const {
    std::uint64_t value = 0;
    if (!parse_whole(word, value) || value > std::numeric_limits<std::uint32_t>::max())
      fail_input("{}: header: {}: expected a whole number below 2^32, found {}; copy or write the file again",
                 file, name, in_quotes(word));
    return value;
  }
  std::uint64_t whole(const char* name) const { return number(name, text(name)); }

  template <typename Body>
  void guarded(const Body& body) const {
    with_exr_errors(body, [&](const char* what) {
      fail_input(
          "{}: expected a range image with records, found another or a damaged file ({}); copy or write it "
          "again, {}",
          file, what, remedy);
    });
  }

  // The channels as the writer had them, in its order.
  void list_channels() {
    const auto add = [&](const std::string& name, Imf::PixelType type) {
      const Imf::Channel* channel = header().channels().findChannel(name);
      if (!channel || channel->type != type || channel->xSampling != 1 || channel->ySampling != 1)
        fail_input("{}: header: expected a {} channel {}, found none; copy or write the file again", file,
                   type == Imf::UINT   ? "uint"
                   : type == Imf::HALF ? "half"
                                       : "float",
                   name);
      channels.push_back({name, type, name == "source" ? RecordIndex::kNowhere : 0});
    };
    const auto has = [&](const char* name) { return header().channels().findChannel(name) != nullptr; };
    add("source", Imf::UINT);
    if (has("mask")) {
      add("mask", Imf::UINT);
      for (const char* name : {"range", "x", "y", "z"}) add(name, Imf::FLOAT);
      if (has("intensity")) add("intensity", Imf::FLOAT);
      if (has("R"))
        for (const char* name : {"R", "G", "B"}) add(name, Imf::HALF);
    }
    for (const FieldChannels& field : fields) {
      raw.push_back(channels.size());
      for (const std::string& name : field.names) add(name, field.is_float() ? Imf::FLOAT : Imf::UINT);
    }
  }

  // The channels with these numbers, of one group.
  RecordTiles load(std::size_t group, std::span<const std::size_t> numbers) {
    const RecordGroup& g = groups[group];
    std::vector<RecordChannel> some;
    for (const std::size_t number : numbers) some.push_back(channels[number]);
    RecordTiles tiles(g, some);
    if (decoded && decoded->get(group, numbers, tiles)) return tiles;
    try {
      guarded([&] {
        in->setFrameBuffer(tiles.slices(some));
        in->readTiles(g.tile_x, g.tile_x + g.tiles_x - 1, g.tile_y, g.tile_y + g.tiles_y - 1);
      });
    } catch (const Error& error) {
      if (!salvage || error.kind() != ErrorKind::input) throw;
      open_image();
      open_tiles();
      load_good_tiles(g, some, tiles);
    }
    clear_lost(tiles, some);
    return tiles;
  }

  // Of tiles that are lost every node is without a record.
  void clear_lost(RecordTiles& tiles, std::span<const RecordChannel> some) const {
    const RecordGroup& g = tiles.group();
    for (int y = g.tile_y; y < g.tile_y + g.tiles_y; ++y)
      for (int x = g.tile_x; x < g.tile_x + g.tiles_x; ++x)
        if (!lost.empty() && lost[tile_number(x, y)]) tiles.clear_tile(x, y, some);
  }

  std::size_t tile_number(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(in->numXTiles()) +
           static_cast<std::size_t>(x);
  }

  // In salvage: tiles that cannot be decoded are lost.
  void load_good_tiles(const RecordGroup& g, std::span<const RecordChannel> some, RecordTiles& tiles) {
    for (int y = g.tile_y; y < g.tile_y + g.tiles_y; ++y)
      for (int x = g.tile_x; x < g.tile_x + g.tiles_x; ++x) {
        const std::size_t number = tile_number(x, y);
        try {
          in->setFrameBuffer(tiles.slices(some));
          in->readTile(x, y);
        } catch (const std::bad_alloc&) {
          throw;
        } catch (const std::exception&) {
          lost[number] = true;
          open_image();  // a stream that met its end stays there
          open_tiles();
        }
      }
  }

  // In salvage, of a group with all channels: tiles whose checksum is another are lost, too.
  void lose_changed_tiles(RecordTiles& tiles, std::span<const std::uint64_t> hashes) {
    const RecordGroup& g = tiles.group();
    for (int y = g.tile_y; y < g.tile_y + g.tiles_y; ++y)
      for (int x = g.tile_x; x < g.tile_x + g.tiles_x; ++x)
        if (hashes[tile_number(x, y)] != sums[tile_number(x, y)]) lost[tile_number(x, y)] = true;
    clear_lost(tiles, channels);
  }

  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const char* name : {kSamples, kLayout, kXml, kCuts, kScanXml, kScan, kParts})
      all.push_back(text(name));
    if (const std::string part_sums = text(kPartSums); !part_sums.empty()) all.push_back(part_sums);
    return all;
  }

  // In salvage: by the tiles' checksums, where header and sums are as they were written. Where they are not,
  // nobody knows what the records are: then all must be in order, as without salvage.
  void prepare_salvage(std::size_t tiles) {
    sums = parse_tile_sums(text(kTileSums), tiles);
    salvage = sums.size() == tiles && records_checksum(texts(), sums) == text(range_attribute::kChecksum);
    lost.assign(salvage ? tiles : 0, false);
    if (!salvage) remedy = "as its header has no checksums of tiles by which salvage could tell damaged ones";
  }

  std::string file;
  bool salvage = false;
  std::string remedy = kSalvageRemedy;
  std::vector<bool> lost;           // by tile; empty without salvage
  std::vector<std::uint64_t> sums;  // the same
  std::unique_ptr<Imf::MultiPartInputFile> image;
  std::optional<Imf::TiledInputPart> in;
  RecordLayout layout;
  RecordsDescription description;
  std::string cuts_text;
  E57Table table;
  std::vector<RecordGroup> groups;
  std::vector<FieldChannels> fields;
  std::vector<RecordChannel> channels;
  std::vector<std::size_t> raw;  // by field: its first channel
  std::optional<RecordIndex> index;
  std::optional<DecodedTiles> decoded;

  // What the last read() left for the next.
  std::vector<std::size_t> cached_fields;
  std::vector<std::size_t> cached_channels;
  std::vector<std::size_t> cached_raw;  // by asked field
  std::vector<std::unique_ptr<RecordTiles>> cached;

  void cache_for(std::span<const std::size_t> asked) {
    if (std::ranges::equal(asked, cached_fields) && !cached.empty()) return;
    cached.clear();
    cached.resize(groups.size());
    cached_fields.assign(asked.begin(), asked.end());
    cached_channels.clear();
    cached_raw.clear();
    for (const std::size_t field : asked) {
      cached_raw.push_back(cached_channels.size());
      for (std::size_t k = 0; k < fields.at(field).names.size(); ++k)
        cached_channels.push_back(raw[field] + k);
    }
    if (!index->keeps_all()) cached_channels.push_back(0);  // source
  }

  // Loads the groups of records [first, end); those before them will not be asked for soon.
  void load_groups(std::uint64_t first, std::uint64_t end) {
    const auto want = [&](std::size_t group) {
      if (cached[group]) return;
      cached[group] = std::make_unique<RecordTiles>(load(group, cached_channels));
      index->load(group, cached[group]->words(cached_channels.size() - 1));
    };
    for (std::size_t group = 0; group < groups.size(); ++group)
      if (index->end(group) <= first) {
        cached[group].reset();
        index->unload(group);
      } else if (!index->keeps_all() && index->first(group) < end) {
        want(group);
      }
    if (!index->keeps_all()) return;
    const std::uint32_t* pixels = index->pixels(first, static_cast<std::size_t>(end - first));
    for (std::uint64_t i = 0; i < end - first; ++i)
      if (pixels[i] != RecordIndex::kNowhere) want(group_at(layout, pixels[i]));
  }

  // The stored bits of a field, without its minimum.
  std::uint64_t bits(std::size_t slot, std::uint32_t pixel) const {
    const std::size_t group = group_at(layout, pixel), at = groups[group].index(pixel, layout.cols);
    const FieldChannels& field = fields[cached_fields[slot]];
    const std::uint64_t low = cached[group]->words(cached_raw[slot])[at];
    return field.names.size() == 1
               ? low
               : low | std::uint64_t{cached[group]->words(cached_raw[slot] + 1)[at]} << 32;
  }

  std::int64_t integer(std::size_t slot, std::uint32_t pixel) const {
    const std::size_t field = cached_fields[slot];
    const auto minimum = static_cast<std::uint64_t>(table.fields[field].minimum);
    const auto along = [](std::int64_t from, std::int64_t step, std::uint32_t by) {
      return static_cast<std::int64_t>(static_cast<std::uint64_t>(from) +
                                       static_cast<std::uint64_t>(step) * by);
    };
    const auto cols = static_cast<std::uint32_t>(layout.cols);
    switch (fields[field].kind) {
      case FieldChannels::constant:
        return table.fields[field].minimum;
      case FieldChannels::from_row:
        return along(layout.row_first, layout.row_step, pixel / cols);
      case FieldChannels::from_column:
        return along(layout.column_first, layout.column_step, pixel % cols);
      default:
        return static_cast<std::int64_t>(bits(slot, pixel) + minimum);
    }
  }

  double real(std::size_t slot, std::uint32_t pixel) const {
    if (fields[cached_fields[slot]].kind == FieldChannels::single)
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits(slot, pixel))));
    return std::bit_cast<double>(bits(slot, pixel));
  }
};

ExrRecords::ExrRecords(const std::filesystem::path& file, bool salvage)
    : state_(std::make_unique<State>(file, salvage)) {}
ExrRecords::~ExrRecords() = default;

const RecordLayout& ExrRecords::layout() const {
  return state_->layout;
}
const RecordsDescription& ExrRecords::description() const {
  return state_->description;
}
std::uint64_t ExrRecords::count() const {
  return state_->layout.samples;
}

void ExrRecords::open(const E57Table& table) {
  State& s = *state_;
  s.open_tiles();
  const int across = s.in->numXTiles();
  const std::size_t count = static_cast<std::size_t>(across) * static_cast<std::size_t>(s.in->numYTiles());
  if (s.salvage) s.prepare_salvage(count);
  if (!s.in->isComplete() && !s.salvage)
    fail_input(
        "{}: tiles: expected all {} x {}, found some missing; the file is cut short: copy or write it "
        "again, {}",
        s.file, s.in->numXTiles(), s.in->numYTiles(), s.remedy);
  s.table = table;
  s.groups = groups_of(s.layout);
  s.fields = channels_of(table, s.layout);
  s.list_channels();
  s.index.emplace(s.file, s.layout, s.groups, s.salvage, s.remedy);
  std::vector<std::uint64_t> hashes(count);
  std::vector<std::size_t> all(s.channels.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  // Read again are the records' places and what is stored of them.
  std::vector<std::size_t> again(all.begin() + static_cast<std::ptrdiff_t>(s.raw.empty() ? 1 : s.raw[0]),
                                 all.end());
  again.insert(again.begin(), 0);
  DecodedTiles decoded(s.groups, again);
  for (std::size_t group = 0; group < s.groups.size(); ++group) {
    check_interrupted();
    RecordTiles tiles = s.load(group, all);
    tiles.hash(s.channels, across, hashes);
    if (s.salvage) s.lose_changed_tiles(tiles, hashes);
    s.index->add(group, tiles.words(0));
    decoded.put(group, tiles);
  }
  s.decoded.emplace(std::move(decoded));
  if (s.index->wants_all())
    for (std::size_t group = 0; group < s.groups.size(); ++group)
      s.index->keep(group, s.load(group, std::span(again).first(1)).words(0));
  if (s.salvage) {
    const auto tiles = std::ranges::count(s.lost, true);
    if (tiles == 0) return;
    const auto first = std::ranges::find(s.lost, true) - s.lost.begin();
    notes_.push_back(
        fmt::format("{} of {} tiles of 256 x 256 nodes are damaged, the first at row {}, column {}", tiles,
                    s.lost.size(), first / across * int{kRangeTile_px}, first % across * int{kRangeTile_px}));
    return;
  }
  const std::string expected = s.text(range_attribute::kChecksum),
                    found = records_checksum(s.texts(), hashes);
  if (s.index->placed() != s.layout.samples || expected != found)
    fail_input(
        "{}: content: expected {} records and checksum {}, found {} and {}; the file is damaged: copy or "
        "write it again, {}",
        s.file, s.layout.samples, expected, s.index->placed(), found, s.remedy);
}

void ExrRecords::read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
                      const std::function<void(const E57Records&)>& body) const {
  State& s = *state_;
  s.cache_for(fields);
  for (std::uint64_t at = first, end = first + count; at < end; at += kBlock_records) {
    const std::uint64_t block_end = std::min(at + kBlock_records, end);
    s.load_groups(at, block_end);
    const std::uint32_t* block = s.index->pixels(at, static_cast<std::size_t>(block_end - at));
    parallel_for((block_end - at + kRange - 1) / kRange, [&](std::size_t range) {
      E57Records records{.first = at + range * kRange,
                         .integers = std::vector<std::span<const std::int64_t>>(fields.size()),
                         .reals = std::vector<std::span<const double>>(fields.size())};
      records.count = static_cast<std::size_t>(std::min<std::uint64_t>(kRange, block_end - records.first));
      std::vector<std::int64_t> integers(fields.size() * kRange);
      std::vector<double> reals(fields.size() * kRange);
      const std::uint32_t* pixels = block + (records.first - at);
      if (s.salvage) records.lost = lost_of(records.first, {pixels, records.count});
      const auto is_there = [&](std::size_t i) { return pixels[i] != RecordIndex::kNowhere; };
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const auto integer = std::span(integers).subspan(k * kRange, records.count);
        const auto real = std::span(reals).subspan(k * kRange, records.count);
        if (s.table.fields[fields[k]].is_integer()) {
          for (std::size_t i = 0; i < records.count; ++i)
            integer[i] = is_there(i) ? s.integer(k, pixels[i]) : 0;
          records.integers[k] = integer;
        } else {
          for (std::size_t i = 0; i < records.count; ++i) real[i] = is_there(i) ? s.real(k, pixels[i]) : 0;
          records.reals[k] = real;
        }
      }
      body(records);
    });
  }
}

bool holds_exr_records(const std::filesystem::path& file) {
  InputFile input(file);
  return check_exr_header(input).format == kRecordsFormatName;
}

}  // namespace hybrid::io
