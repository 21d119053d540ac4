#pragma once
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/e57/e57_model.hpp"

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

// Which of consecutive records are lost, asked for in ascending order.
class LostRecords {
 public:
  explicit LostRecords(const std::vector<E57Records::Lost>& lost) : at_(lost.begin()), end_(lost.end()) {}
  bool has(std::uint64_t record) {
    while (at_ != end_ && at_->end <= record) ++at_;
    return at_ != end_ && at_->first <= record;
  }

 private:
  std::vector<E57Records::Lost>::const_iterator at_, end_;
};

// A table's records, wherever they lie: in an E57 file, or in a range image made from one.
class E57RecordReader {
 public:
  static constexpr std::size_t kRange = 4096;  // records per call of a body: columns stay in a core's cache

  virtual ~E57RecordReader() = default;
  virtual std::uint64_t count() const = 0;  // records that can be read
  const std::vector<std::string>& notes() const { return notes_; }
  // In salvage: the damaged pages that read() met, by number.
  const std::set<std::uint64_t>& bad_pages() const { return bad_pages_; }

  // Calls body with the records [first, first + count) of the fields with these indices, in ranges of at most
  // kRange that start at multiples of it from `first`, several at once and in any order: bodies write
  // disjoint memory. Throws ErrorKind::input for damage (not in salvage), and for a field of text.
  virtual void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
                    const std::function<void(const E57Records&)>& body) const = 0;

 protected:
  std::vector<std::string> notes_;
  mutable std::set<std::uint64_t> bad_pages_;
};

// Records that one mostly takes at once.
inline constexpr std::size_t kBlock_records = 1 << 16;

// The indices of all of a table's fields.
std::vector<std::size_t> all_fields(const E57Table& table);

// The same in order, columns of up to `most` records at a time.
void for_each_block(const E57RecordReader& reader, const E57Table& table, std::span<const std::size_t> fields,
                    std::size_t most, const std::function<void(const E57Records&)>& body);

// Only some of the columns: those at these positions.
E57Records selected(const E57Records& records, std::span<const std::size_t> columns);

}  // namespace hybrid::io
