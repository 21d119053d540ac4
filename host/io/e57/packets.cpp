#include "io/e57/packets.hpp"

#include <algorithm>
#include <array>

#include "core/error.hpp"
#include "io/e57/little_endian.hpp"

namespace hybrid::io {
namespace {

constexpr std::uint64_t kGroup_bytes = 256 << 10;
constexpr std::uint64_t kAhead_bytes = 4 * PagedFile::kPayload_bytes;

// Small reads in ascending order, some pages at a time. In salvage damaged pages pass: whether a packet makes
// sense is the better question there.
class HeaderWindow {
 public:
  explicit HeaderWindow(const PagedFile& file) : file_(file) {}
  const char* at(std::uint64_t offset, std::uint64_t bytes) {
    if (offset < start_ || offset + bytes > start_ + window_.size()) {
      // To the end of a page, so that none is read twice.
      const std::uint64_t first = offset / PagedFile::kPayload_bytes * PagedFile::kPayload_bytes;
      const std::uint64_t wanted = std::max(offset + bytes - first, kAhead_bytes);
      std::uint64_t end = first + (wanted + PagedFile::kPayload_bytes - 1) / PagedFile::kPayload_bytes *
                                      PagedFile::kPayload_bytes;
      window_.resize(std::min(end, std::max(file_.size(), offset + bytes)) - first);
      start_ = first;
      std::vector<std::uint64_t> bad_pages;
      file_.read(first, window_, file_.salvage() ? &bad_pages : nullptr);
    }
    return window_.data() + (offset - start_);
  }

 private:
  const PagedFile& file_;
  std::uint64_t start_ = 0;
  std::vector<char> window_;
};

struct Section {
  std::uint64_t data = 0, end = 0;  // logical
  bool whole = true;                // its end is known and within the file
};

Section read_section_header(const PagedFile& file, const E57Table& table, std::vector<std::string>& notes) {
  if (table.count == 0 && file.salvage()) return {};
  const std::uint64_t start = file.logical(table.offset, table.what + ": its points");
  std::array<char, kSectionHeader_bytes> header{};
  std::vector<std::uint64_t> bad_pages;
  file.read(start, header, file.salvage() ? &bad_pages : nullptr);
  const auto where = fmt::format("byte {}: {}", table.offset, table.what);
  const auto length = load<std::uint64_t>(&header[8]), data = load<std::uint64_t>(&header[16]);
  Section section{start + kSectionHeader_bytes, start + length};
  const bool is_section = header[0] == 1;
  if (is_section && length >= kSectionHeader_bytes && length <= file.size() - start) {
    if (table.count == 0 && data == 0) return {section.end, section.end};
    section.data = file.logical(data, table.what + ": its first packet");
    if (section.data >= start + kSectionHeader_bytes && section.data <= section.end) return section;
  }
  const std::string problem =
      !is_section
          ? fmt::format("expected a section of points (1), found {}",
                        static_cast<int>(static_cast<unsigned char>(header[0])))
          : fmt::format(
                "expected a section of {} to {} bytes with its first packet inside, found {} bytes and "
                "the packet at byte {}",
                kSectionHeader_bytes, file.size() - start, length, data);
  if (!file.salvage())
    fail_input("{}: {}: {}; the file is damaged: copy or export it again, or use --salvage", file.name(),
               where, problem);
  notes.push_back(fmt::format("{}: {}: packets are sought behind it", where, problem));
  return {start + kSectionHeader_bytes, file.size(), false};
}

class PacketWalk {
 public:
  PacketWalk(const PagedFile& file, const E57Table& table, std::vector<std::string>& notes)
      : file_(file),
        table_(table),
        notes_(notes),
        section_(read_section_header(file, table, notes)),
        window_(file) {
    groups_.streams = table.fields.size();
  }

  PacketGroups walk() {
    start_chain();
    for (std::uint64_t at = section_.data; at < section_.end;) {
      std::string problem;
      if (read(at, problem)) {
        take(at);
        at += header_.length;
        continue;
      }
      if (!file_.salvage())
        fail_input("{}: byte {}: {}: {}; the file is damaged: copy or export it again, or use --salvage",
                   file_.name(), PagedFile::physical(at), table_.what, problem);
      const std::uint64_t next = section_.whole ? next_data_packet(at + 4) : section_.end;
      notes_.push_back(fmt::format(
          "byte {}: {}: {}: {} bytes ({:.2f} % of the points' section) are lost", PagedFile::physical(at),
          table_.what, problem, next - at,
          100 * static_cast<double>(next - at) / static_cast<double>(section_.end - section_.data)));
      at = next;
      start_chain();
    }
    return joined();
  }

 private:
  // Packets that follow each other without a break: their streams' bytes counted from their first.
  struct Chain {
    std::size_t first_group = 0;
    std::vector<std::uint64_t> sums;
  };

  void start_chain() {
    chains_.push_back({groups_.count(), std::vector<std::uint64_t>(groups_.streams, 0)});
    open_ = false;
  }

  // The packet's header into header_ and lengths_; false and what is wrong with it when it makes no sense.
  bool read(std::uint64_t at, std::string& problem) {
    const std::uint64_t left = section_.end - at;
    std::array<char, kPacketHeader_bytes> start{};
    if (left < 4) {
      problem = fmt::format("expected a packet, found the {} last bytes of the section", left);
      return false;
    }
    const std::uint64_t least =
        std::min(kPacketHeader_bytes, left);  // a packet of four bytes counts no streams
    std::copy_n(window_.at(at, least), least, start.data());
    header_ = packet_header(start.data());
    if (header_.type > PacketHeader::ignored || header_.length % 4 != 0 || header_.length > left) {
      problem = fmt::format(
          "expected a packet (type 0 to 2, of at most {} bytes in fours), found type {} of {} bytes", left,
          header_.type, header_.length);
      return false;
    }
    if (header_.type != PacketHeader::data) return true;
    // Writers close a section without points by a packet without streams.
    if (header_.streams != groups_.streams && !(header_.streams == 0 && table_.count == 0)) {
      problem = fmt::format("expected a packet of {} streams as the prototype has fields, found {}",
                            groups_.streams, header_.streams);
      return false;
    }
    std::uint64_t needed = kPacketHeader_bytes + 2ull * header_.streams;
    if (needed <= header_.length) {
      const char* length = window_.at(at, needed) + kPacketHeader_bytes;
      lengths_.resize(header_.streams);
      for (std::size_t s = 0; s < lengths_.size(); ++s)
        needed += lengths_[s] = load<std::uint16_t>(length + 2 * s);
    }
    if (needed <= header_.length && header_.length - needed < 4) return true;
    problem = fmt::format("expected a packet of {} bytes for its streams, found {}", (needed + 3) / 4 * 4,
                          header_.length);
    return false;
  }

  void take(std::uint64_t at) {
    if (header_.type != PacketHeader::data) {
      open_ = false;
      return;
    }
    std::vector<std::uint64_t>& sums = chains_.back().sums;
    if (!open_) {
      groups_.begin.push_back(at);
      groups_.end.push_back(at);
      groups_.bytes_before.insert(groups_.bytes_before.end(), sums.begin(), sums.end());
    }
    for (std::size_t s = 0; s < lengths_.size(); ++s) sums[s] += lengths_[s];
    groups_.end.back() = at + header_.length;
    open_ = groups_.end.back() - groups_.begin.back() < kGroup_bytes;
  }

  // From `at` on, two in a row that make sense, or one that ends the section.
  std::uint64_t next_data_packet(std::uint64_t at) {
    std::string problem;
    for (; at + kPacketHeader_bytes <= section_.end; at += 4) {
      const char* start = window_.at(at, kPacketHeader_bytes);
      if (start[0] != PacketHeader::data || !read(at, problem) || header_.streams != groups_.streams)
        continue;
      const std::uint64_t end = at + header_.length;
      if (end == section_.end || read(end, problem)) return at;
    }
    return section_.end;
  }

  // What follows a gap has its place only from the section's end: the last chain ends where the streams end,
  // which is known for writers that fill up the last word. Chains between two gaps cannot be placed.
  PacketGroups joined() {
    const Chain front = chains_.front(), back = chains_.back();
    std::vector<std::uint64_t> totals = front.sums;
    std::vector<std::uint64_t> shift(groups_.streams, 0);
    bool fits =
        chains_.size() > 1 && back.first_group < groups_.count() && section_.whole && table_.whole_words;
    // A count that lies would make the gap as large as it likes: what is lost lay in the section.
    std::uint64_t room = section_.whole ? section_.end - section_.data : 0;
    for (std::size_t s = 0; s < groups_.streams && fits; ++s) {
      const std::uint64_t expected = word_padded_bytes(table_.fields[s], table_.count);
      const std::uint64_t held = front.sums[s] + back.sums[s];
      fits = table_.fields[s].type != E57Type::text && expected >= held && expected - held <= room;
      room -= fits ? expected - held : 0;
      shift[s] = expected - back.sums[s];
    }
    if (chains_.size() > 1) {
      const std::size_t from = chains_[1].first_group, to = fits ? back.first_group : groups_.count();
      const auto erase = [](auto& values, std::size_t first, std::size_t last) {
        values.erase(values.begin() + static_cast<std::ptrdiff_t>(first),
                     values.begin() + static_cast<std::ptrdiff_t>(last));
      };
      erase(groups_.begin, from, to);
      erase(groups_.end, from, to);
      erase(groups_.bytes_before, from * groups_.streams, to * groups_.streams);
      for (std::size_t i = from * groups_.streams; i < groups_.bytes_before.size(); ++i)
        groups_.bytes_before[i] += shift[i % groups_.streams];
      for (std::size_t s = 0; s < groups_.streams && fits; ++s) totals[s] = shift[s] + back.sums[s];
    }
    groups_.bytes_before.insert(groups_.bytes_before.end(), totals.begin(), totals.end());
    return std::move(groups_);
  }

  const PagedFile& file_;
  const E57Table& table_;
  std::vector<std::string>& notes_;
  Section section_;
  HeaderWindow window_;
  PacketGroups groups_;
  std::vector<Chain> chains_;
  bool open_ = false;  // the last group takes further packets
  PacketHeader header_;
  std::vector<std::uint16_t> lengths_;
};

}  // namespace

PacketHeader packet_header(const char* bytes) {
  return {static_cast<unsigned char>(bytes[0]), load<std::uint16_t>(bytes + 2) + 1u,
          load<std::uint16_t>(bytes + 4)};
}

PacketGroups find_packets(const PagedFile& file, const E57Table& table, std::vector<std::string>& notes) {
  return PacketWalk(file, table, notes).walk();
}

}  // namespace hybrid::io
