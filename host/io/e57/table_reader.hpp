#pragma once
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/e57/e57_model.hpp"
#include "io/e57/packets.hpp"
#include "io/e57/paged_file.hpp"

namespace hybrid::io {

// Consecutive records, column by column, exactly as stored: integers (scaled ones before scaling) as int64,
// reals as double.
struct E57Records {
  struct Lost {
    std::uint64_t first = 0, end = 0;  // records
  };
  std::uint64_t first = 0;
  std::size_t count = 0;
  std::vector<std::span<const std::int64_t>> integers{};  // one per asked field; empty for reals
  std::vector<std::span<const double>> reals{};           // the same; empty for integers
  std::vector<Lost> lost{};  // in salvage: records with a value that could not be read, which is 0; ascending
};

// Reads a table's records in any part of it, several threads at once, in bounded memory.
class E57TableReader {
 public:
  static constexpr std::size_t kRange = 4096;  // records per call of a body: columns stay in a core's cache

  // Finds the packets. Throws ErrorKind::input as find_packets() does, and when the streams hold fewer or
  // more records than the table says; in salvage these are notes.
  E57TableReader(const PagedFile& file, const E57Table& table);

  std::uint64_t count() const { return count_; }  // records that can be read
  const std::vector<std::string>& notes() const { return notes_; }
  // In salvage: the damaged pages that read() met, by number.
  const std::set<std::uint64_t>& bad_pages() const { return bad_pages_; }

  // Calls body with the records [first, first + count) of the fields with these indices, in ranges of at most
  // kRange that start at multiples of it from `first`, several at once and in any order: bodies write
  // disjoint memory. Throws ErrorKind::input naming the first damaged page (not in salvage), and for a field
  // of text.
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const;

 private:
  struct Loaded;
  void bound_count();
  bool load(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t end,
            Loaded& loaded) const;

  const PagedFile& file_;
  const E57Table& table_;
  std::vector<std::string> notes_;
  PacketGroups groups_;
  std::uint64_t count_ = 0;
  mutable std::set<std::uint64_t> bad_pages_;
};

}  // namespace hybrid::io
