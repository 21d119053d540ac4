#include <xxhash.h>

#include <limits>

#include "core/error.hpp"
#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "io/e57/little_endian.hpp"
#include "io/input_file.hpp"
#include "io/samples/columns.hpp"
#include "io/samples/sample_band.hpp"
#include "io/samples/sample_file.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kFront = 16;        // of a block: its size and checksum
constexpr std::uint64_t kLeastPerLine = 4;  // bytes that the angle of a row or column takes at least

// The file's blocks, one after the other.
class Blocks {
 public:
  explicit Blocks(const std::filesystem::path& file) : in_(file) {
    if (in_.size() < 12 || std::string_view(in_.at(0, 8), 8) != kSampleFileMark)
      fail_input(
          "{}: expected a sample file of hybrid (it starts with {}), found another; correct its extension",
          in_.name(), kSampleFileMark);
    if (const auto version = load<std::uint32_t>(in_.at(8, 4)); version != kSampleFileVersion)
      fail_input(
          "{}: expected version {}, found {}; read it with the program that wrote it, or make it again "
          "from the scan",
          in_.name(), kSampleFileVersion, version);
  }

  const std::string& file() const { return in_.name(); }
  std::uint64_t size() const { return in_.size(); }
  std::string place() const { return fmt::format("{}: block {} at byte {}", in_.name(), block_, at_); }
  bool at_end() const { return at_ == in_.size(); }

  struct Mark {
    std::uint64_t at = 0;
    int block = 0;
  };
  Mark mark() const { return {at_, block_}; }
  void move_to(const Mark& mark) {
    at_ = mark.at;
    block_ = mark.block;
  }
  void skip() {
    at_ += kFront + next_size();
    ++block_;
  }

  std::string next() {
    const std::uint64_t size = next_size();
    const auto expected = load<std::uint64_t>(in_.at(at_ + 8, 8));
    std::string bytes(size, '\0');
    in_.read(at_ + kFront, bytes);
    if (XXH3_64bits(bytes.data(), bytes.size()) != expected)
      fail_input(
          "{}: its checksum does not match: the file is damaged; copy it again, or make it again from the "
          "scan",
          place());
    at_ += kFront + size;
    ++block_;
    return bytes;
  }

 private:
  std::uint64_t next_size() {
    const std::uint64_t left = in_.size() - at_;
    const auto size = left < kFront ? left : load<std::uint64_t>(in_.at(at_, kFront));
    if (left < kFront || size > left - kFront)
      fail_input("{}: expected {} bytes, found {} to the end of the file: it is cut short; copy it again",
                 place(), left < kFront ? kFront : size, left);
    return size;
  }

  InputFile in_;
  std::uint64_t at_ = 12;
  int block_ = 0;
};

SampleHeader read_header(Blocks& blocks) {
  const std::string place = blocks.place();
  SampleHeader header = parse_header(blocks.next(), place);
  const auto lines = static_cast<std::uint64_t>(header.rows) + static_cast<std::uint64_t>(header.cols);
  if (kLeastPerLine * lines > blocks.size() || header.extra > blocks.size())
    fail_input(
        "{}: expected no more nodes than {} bytes can hold, found {} x {} and {} samples beside the grid; "
        "make the file again from the scan",
        place, blocks.size(), header.rows, header.cols, header.extra);
  return header;
}

void read_extra(const SampleHeader& header, std::string_view packed, const std::string& place, Scan& scan) {
  const std::size_t record = 24 + (header.intensity ? 4 : 0) + (header.colour ? 3 : 0);
  const std::string bytes = decompress(packed, header.extra * record, place);
  if (bytes.size() != header.extra * record)
    fail_input("{}: expected {} samples beside the grid, found {}; make the file again from the scan", place,
               header.extra, bytes.size() / record);
  for (const char* at = bytes.data(); at != bytes.data() + bytes.size();) {
    std::array<float, 3> point{};
    for (int k = 0; k < 3; ++k, at += 8)
      point[static_cast<std::size_t>(k)] = static_cast<float>(load<double>(at) - header.origin[k]);
    scan.points.push_back(point);
    if (header.intensity) {
      scan.intensity.push_back(load<float>(at));
      at += 4;
    }
    if (header.colour) {
      scan.rgb.push_back(load<std::array<std::uint8_t, 3>>(at));
      at += 3;
    }
  }
}

// So many nodes without a sample.
void add_nodes(const SampleHeader& header, std::size_t nodes, Scan& scan) {
  scan.points.assign(nodes, {kNaN, kNaN, kNaN});
  if (header.intensity) scan.intensity.assign(nodes, 0);
  if (header.colour) scan.rgb.assign(nodes, {});
}

// All but the samples.
Scan described_scan(const SampleHeader& header) {
  Scan scan;
  scan.grid_rows = header.rows;
  scan.grid_cols = header.cols;
  scan.row_by_row = true;
  scan.origin = header.origin;
  scan.world_from_scan = header.world_from_scan;
  scan.crs = header.crs;
  scan.range_grid = RangeGrid{header.elevation_rad, header.azimuth_rad, header.wraps, {}, {}};
  return scan;
}

[[noreturn]] void fail_samples(const std::string& file, const SampleHeader& header, std::uint64_t found) {
  fail_input("{}: expected {} samples, as its header says, found {}; make the file again from the scan", file,
             header.samples, found);
}

void read_last_block(Blocks& blocks, const SampleHeader& header, Scan& scan) {
  const std::string place = blocks.place();
  read_extra(header, blocks.next(), place, scan);
  if (!blocks.at_end())
    fail_input("{}: expected the end of the file, found more; copy it again", blocks.place());
}

// In memory: a band per thread, and the samples beside the grid.
class SampleStream : public ScanStream {
 public:
  SampleStream(const std::filesystem::path& file, const ScanEntry& entry)
      : blocks_(file), header_(read_header(blocks_)), nodes_(header_.nodes()) {
    head_ = described_scan(header_);
    head_.name = entry.name;
    for (int band = 0; band < header_.bands(); ++band) {
      marks_.push_back(blocks_.mark());
      blocks_.skip();
    }
    samples_.resize(marks_.size());
    read_last_block(blocks_, header_, extra_);
    count_ = nodes_ + header_.extra;
    intensity_ = header_.intensity;
    colour_ = header_.colour;
    measure(entry.kept_bytes);
    std::uint64_t found = 0;
    for (const std::uint64_t samples : samples_) found += samples;
    if (found != header_.samples) fail_samples(blocks_.file(), header_, found);
  }

 private:
  SampleBlock load(std::uint64_t first, std::size_t count) const override {
    block_ = {};
    const std::uint64_t end = first + count;
    while (first < std::min(end, nodes_)) {
      const auto band = static_cast<std::size_t>(first / band_nodes());
      const std::uint64_t from = band * band_nodes();
      const Scan& scan = decoded(band);
      first += append(scan, first - from, std::min(end - from, std::uint64_t{scan.points.size()}));
    }
    if (first < end) append(extra_, first - nodes_, end - nodes_);
    return block_.block(head_, end - count, 0, count);
  }

  // Samples [first, end) of a part.
  std::uint64_t append(const Scan& scan, std::uint64_t first, std::uint64_t end) const {
    const auto part = [&](const auto& values) {
      return values.empty() ? std::span(values) : std::span(values).subspan(first, end - first);
    };
    block_.append({&head_, 0, part(scan.points), {}, part(scan.intensity), part(scan.rgb), {}});
    return end - first;
  }

  std::uint64_t band_nodes() const {
    return static_cast<std::uint64_t>(kBandRows) * static_cast<std::uint64_t>(header_.cols);
  }

  // This one and some behind it are decoded at once.
  const Scan& decoded(std::size_t band) const {
    if (band >= first_band_ && band < first_band_ + bands_.size()) return bands_[band - first_band_];
    std::vector<Scan> bands(std::min(static_cast<std::size_t>(thread_count()), marks_.size() - band));
    std::vector<std::string> bytes(bands.size()), places(bands.size());
    for (std::size_t i = 0; i < bands.size(); ++i) {
      blocks_.move_to(marks_[band + i]);
      places[i] = blocks_.place();
      bytes[i] = blocks_.next();
    }
    parallel_for(bands.size(), [&](std::size_t i) {
      const int row = static_cast<int>(band + i) * kBandRows;
      const int rows = std::min(kBandRows, header_.rows - row);
      add_nodes(header_, static_cast<std::size_t>(rows) * static_cast<std::size_t>(header_.cols), bands[i]);
      samples_[band + i] = decode_band(header_, bytes[i], places[i], row, bands[i], row);
    });
    bands_ = std::move(bands);
    first_band_ = band;
    return bands_.front();
  }

  mutable Blocks blocks_;
  SampleHeader header_;
  std::uint64_t nodes_;
  std::vector<Blocks::Mark> marks_;             // by band
  mutable std::vector<std::uint64_t> samples_;  // the same: how many it has
  mutable std::size_t first_band_ = 0;
  mutable std::vector<Scan> bands_;
  mutable SampleColumns block_;
  Scan extra_;
};

}  // namespace

Scan read_sample_file(const std::filesystem::path& file, const ReadOptions&) {
  Blocks blocks(file);
  const SampleHeader header = read_header(blocks);
  Scan scan = described_scan(header);
  add_nodes(header, header.nodes(), scan);
  scan.name = file.stem().string();
  const auto several = 2 * static_cast<std::size_t>(thread_count());
  std::vector<std::string> bytes(several), places(several);
  std::vector<std::uint64_t> samples(several);
  std::uint64_t found = 0;
  for (int first = 0; first < header.bands(); first += static_cast<int>(several)) {
    check_interrupted();
    const auto count = std::min(several, static_cast<std::size_t>(header.bands() - first));
    for (std::size_t i = 0; i < count; ++i) {
      places[i] = blocks.place();
      bytes[i] = blocks.next();
    }
    parallel_for(count, [&](std::size_t i) {
      samples[i] = decode_band(header, bytes[i], places[i], (first + static_cast<int>(i)) * kBandRows, scan);
    });
    for (std::size_t i = 0; i < count; ++i) found += samples[i];
  }
  if (found != header.samples) fail_samples(blocks.file(), header, found);
  read_last_block(blocks, header, scan);
  return scan;
}

std::unique_ptr<ScanStream> stream_sample_file(const std::filesystem::path& file, const ScanEntry& entry) {
  return std::make_unique<SampleStream>(file, entry);
}

std::vector<ScanEntry> list_sample_file(const std::filesystem::path& file, const ReadOptions&) {
  Blocks blocks(file);
  const SampleHeader header = read_header(blocks);
  ScanEntry entry;
  entry.name = file.stem().string();
  entry.samples = header.nodes() + header.extra;
  entry.grid_rows = header.rows;
  entry.grid_cols = header.cols;
  entry.structure = fmt::format("sample file: {} samples, {} by {} planes{}{}", header.samples,
                                header.discarded, header.planes.size(), header.intensity ? ", intensity" : "",
                                header.colour ? ", colour" : "");
  entry.crs = header.crs;
  entry.unit = std::string("m");
  return {entry};
}

}  // namespace hybrid::io
