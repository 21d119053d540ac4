#include "io/e57/e57_writer.hpp"

#include <algorithm>
#include <array>

#include "core/error.hpp"
#include "io/e57/bit_encoder.hpp"
#include "io/e57/e57_write_xml.hpp"
#include "io/e57/little_endian.hpp"
#include "io/e57/paged_file.hpp"
#include "io/e57/paged_output.hpp"
#include "io/hash_state.hpp"

namespace hybrid::io {
namespace {

constexpr std::size_t kLargestPacket_bytes = 60'000;  // of 65536, and of 65535 per stream
constexpr std::size_t kMostEntries = 2048;            // of an index packet

// With the limits that the field's bits have.
E57Field widened(E57Field field) {
  if (!field.is_integer() || field.bits() == 64) return field;
  const std::uint64_t most = (std::uint64_t{1} << field.bits()) - 1;
  const auto highest = static_cast<std::int64_t>(static_cast<std::uint64_t>(field.minimum) + most);
  if (highest >= field.minimum) field.maximum = highest;
  return field;
}

}  // namespace

// An identifier from content: the same content has the same.
class E57Digest {
 public:
  void add(std::span<const char> bytes) { XXH3_128bits_update(state_.get(), bytes.data(), bytes.size()); }
  std::string guid() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{{{:08X}-{:04X}-{:04X}-{:04X}-{:012X}}}", hash.high64 >> 32,
                       hash.high64 >> 16 & 0xffff, hash.high64 & 0xffff, hash.low64 >> 48,
                       hash.low64 & 0xffff'ffff'ffff);
  }

 private:
  static XXH3_state_t* fresh() {
    XXH3_state_t* state = XXH3_createState();
    XXH3_128bits_reset(state);
    return state;
  }
  HashState state_{fresh()};
};

// Which record a packet starts with, for readers that jump: at most kMostEntries, evenly spread.
class E57PacketIndex {
 public:
  void add(std::uint64_t record, std::uint64_t offset) {
    if (packets_++ % stride_ != 0) return;
    if (entries_.size() == kMostEntries) {
      for (std::size_t i = 0; i < kMostEntries / 2; ++i) entries_[i] = entries_[2 * i];
      entries_.resize(kMostEntries / 2);
      stride_ *= 2;
      if ((packets_ - 1) % stride_ != 0) return;
    }
    entries_.push_back({record, offset});
  }
  std::vector<char> packet() const {
    std::vector<char> bytes(16 + 16 * entries_.size());
    store(&bytes[2], static_cast<std::uint16_t>(bytes.size() - 1));
    store(&bytes[4], static_cast<std::uint16_t>(entries_.size()));
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      store(&bytes[16 + 16 * i], entries_[i][0]);
      store(&bytes[24 + 16 * i], entries_[i][1]);
    }
    return bytes;
  }

 private:
  std::vector<std::array<std::uint64_t, 2>> entries_;
  std::uint64_t packets_ = 0, stride_ = 1;
};

struct E57Writer::State {
  State(const std::filesystem::path& path, const E57WriterOptions& given)
      : file(path.string()), options(given), out(path) {
    contents.library = "Hybrid";
    contents.coordinate_system = options.coordinate_system;
    contents.extensions = options.extensions;
    out.keep(kFileHeader_bytes);
    out.write(std::array<char, kFileHeader_bytes>{});
  }

  void write_packet();

  std::string file;
  E57WriterOptions options;
  PagedOutput out;
  E57Contents contents;
  E57Digest file_digest;

  // Of the scan in the making.
  bool in_scan = false;
  std::vector<BitEncoder> encoders;
  std::uint64_t section = 0;        // logical
  std::size_t packet_records = 0;   // a whole packet's
  std::size_t waiting_records = 0;  // in the encoders
  E57PacketIndex index;
  std::unique_ptr<E57Digest> digest;
};

E57Writer::E57Writer(const std::filesystem::path& file, const E57WriterOptions& options)
    : state_(std::make_unique<State>(file, options)) {}
E57Writer::~E57Writer() = default;

void E57Writer::begin_scan(const E57Scan& scan) {
  State& s = *state_;
  if (s.in_scan) fail(ErrorKind::failed, "{}: expected the end of a scan, found another", s.file);
  std::uint64_t record_bits = 0;
  for (const E57Field& field : scan.points.fields) {
    if (field.type == E57Type::text || !(s.options.as_stored || is_xml_name(field.name)) ||
        field.minimum > field.maximum)
      fail(ErrorKind::failed,
           "{}: expected a field of numbers with an XML name and a range, found \"{}\"; leave it out", s.file,
           field.name);
    record_bits += static_cast<std::uint64_t>(field.bits());
  }
  s.in_scan = true;
  s.contents.scans.push_back(scan);
  s.encoders.clear();
  for (const E57Field& field : scan.points.fields)
    s.encoders.emplace_back(s.options.as_stored ? widened(field) : field);
  s.index = {};
  s.digest = std::make_unique<E57Digest>();
  s.waiting_records = 0;
  // A multiple of eight ends every stream of a packet on a whole byte, so that packets stand alone.
  const std::size_t fits = kLargestPacket_bytes * 8 / std::max<std::uint64_t>(record_bits, 8);
  s.packet_records = s.options.records_per_packet > 0
                         ? std::min(s.options.records_per_packet, std::max<std::size_t>(fits, 1))
                     : fits >= 8 ? fits / 8 * 8
                                 : std::max<std::size_t>(fits, 1);
  s.out.align();
  s.section = s.out.position();
  s.contents.scans.back().points.offset = PagedFile::physical(s.section);
  s.contents.scans.back().points.count = 0;
  s.out.keep(kSectionHeader_bytes);
  s.out.write(std::array<char, kSectionHeader_bytes>{});
}

void E57Writer::State::write_packet() {
  const std::size_t lengths = 6 + 2 * encoders.size();
  std::size_t total = lengths;
  for (const BitEncoder& encoder : encoders) total += encoder.bytes().size();
  std::vector<char> packet((total + 3) / 4 * 4);
  packet[0] = 1;
  store(&packet[2], static_cast<std::uint16_t>(packet.size() - 1));
  store(&packet[4], static_cast<std::uint16_t>(encoders.size()));
  std::size_t at = lengths;
  for (std::size_t k = 0; k < encoders.size(); ++k) {
    const std::vector<char>& bytes = encoders[k].bytes();
    store(&packet[6 + 2 * k], static_cast<std::uint16_t>(bytes.size()));
    std::ranges::copy(bytes, packet.begin() + static_cast<std::ptrdiff_t>(at));
    at += bytes.size();
    encoders[k].clear();
  }
  index.add(contents.scans.back().points.count - waiting_records, PagedFile::physical(out.position()));
  digest->add(packet);
  out.write(packet);
  waiting_records = 0;
}

void E57Writer::write(const E57Records& records) {
  State& s = *state_;
  E57Table& table = s.contents.scans.back().points;
  for (std::size_t done = 0; done < records.count;) {
    const std::size_t count = std::min(records.count - done, s.packet_records - s.waiting_records);
    for (std::size_t k = 0; k < table.fields.size(); ++k) {
      const auto append = [&](const auto& values) {
        const std::size_t unfit = s.encoders[k].first_unfit(values);
        if (unfit < values.size())
          fail(ErrorKind::failed, "{}: point {}: expected a value that field {} can hold, found {}", s.file,
               table.count + unfit, table.fields[k].name, values[unfit]);
        s.encoders[k].append(values);
      };
      if (table.fields[k].is_integer())
        append(records.integers.at(k).subspan(done, count));
      else
        append(records.reals.at(k).subspan(done, count));
    }
    done += count;
    table.count += count;
    s.waiting_records += count;
    if (s.waiting_records == s.packet_records) s.write_packet();
  }
}

std::uint64_t E57Writer::end_scan() {
  State& s = *state_;
  E57Scan& scan = s.contents.scans.back();
  for (BitEncoder& encoder : s.encoders) encoder.finish();
  // The last bits, which may not have filled a byte before, or the one packet of a scan without points.
  const bool rest = std::ranges::any_of(s.encoders, [](const BitEncoder& e) { return !e.bytes().empty(); });
  if (rest || s.out.position() == s.section + kSectionHeader_bytes) s.write_packet();
  const std::uint64_t index = s.out.position();
  s.out.write(s.index.packet());
  std::array<char, kSectionHeader_bytes> header{};
  header[0] = 1;
  store(&header[8], s.out.position() - s.section);
  store(&header[16], PagedFile::physical(s.section + kSectionHeader_bytes));
  store(&header[24], PagedFile::physical(index));
  s.out.patch(s.section, header);
  s.digest->add(scan.name);
  for (const E57Field& field : scan.points.fields) s.digest->add(field.name);
  if (scan.guid.empty()) scan.guid = s.digest->guid();
  s.file_digest.add(scan.guid);
  s.in_scan = false;
  return scan.points.offset;
}

E57Blob E57Writer::add_blob(std::span<const char> bytes) {
  PagedOutput& out = state_->out;
  out.align();
  const std::uint64_t start = out.position();
  std::array<char, kBlobHeader_bytes> header{};
  store(&header[8], (kBlobHeader_bytes + bytes.size() + 3) / 4 * 4);
  out.write(header);
  out.write(bytes);
  out.align();
  return {PagedFile::physical(start), bytes.size()};
}

void E57Writer::add_image(const E57Image& image, std::span<const char> picture, std::span<const char> mask) {
  State& s = *state_;
  E57Image written = image;
  written.picture = add_blob(picture);
  written.mask.reset();
  if (!mask.empty()) written.mask = add_blob(mask);
  if (written.guid.empty()) {
    E57Digest digest;
    digest.add(picture);
    digest.add(image.name);
    written.guid = digest.guid();
  }
  s.file_digest.add(written.guid);
  s.contents.images.push_back(std::move(written));
}

void E57Writer::close() {
  State& s = *state_;
  s.contents.guid = s.options.guid.empty() ? s.file_digest.guid() : s.options.guid;
  close(write_e57_xml(s.contents, s.options.created_gps_s));
}

void E57Writer::close(const std::string& xml) {
  State& s = *state_;
  s.out.align();
  const std::uint64_t start = s.out.position();
  s.out.write(xml);
  std::array<char, kFileHeader_bytes> header{};
  std::ranges::copy(std::string_view("ASTM-E57"), header.begin());
  store(&header[8], std::uint32_t{1});
  store(&header[16], s.out.file_bytes());
  store(&header[24], PagedFile::physical(start));
  store(&header[32], std::uint64_t{xml.size()});
  store(&header[40], PagedFile::kPage_bytes);
  s.out.patch(0, header);
  s.out.close();
}

}  // namespace hybrid::io
