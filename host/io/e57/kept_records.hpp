#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/e57/record_reader.hpp"

namespace hybrid::io {

// Records of a table that can be read, renumbered without those that cannot.
struct KeptRanges {
  struct Range {
    std::uint64_t first = 0, end = 0;  // records of the table
    std::uint64_t kept_first = 0;      // the number that the first one has now
  };
  std::vector<Range> ranges{};  // ascending
  std::uint64_t count = 0, lost = 0;
  std::vector<std::string> notes{};  // the reader's, and what is lost
};

// Reads all records of these fields once, in salvage. One of which any field is lost is lost.
KeptRanges find_kept(const E57RecordReader& reader, std::span<const std::size_t> fields);

// Only those of a reader's records. In memory: a block of them.
class KeptRecords : public E57RecordReader {
 public:
  KeptRecords(std::unique_ptr<E57RecordReader> reader, const E57Table& table, const KeptRanges& kept);
  std::uint64_t count() const override { return kept_.count; }
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const override;

 private:
  using At = std::vector<KeptRanges::Range>::const_iterator;
  struct Block;
  At range_of(std::uint64_t kept) const;
  void fill(Block& block, const E57Records& records) const;

  std::unique_ptr<E57RecordReader> reader_;
  const E57Table& table_;
  KeptRanges kept_;
};

}  // namespace hybrid::io
