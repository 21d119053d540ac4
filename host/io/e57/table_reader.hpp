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
#include "io/e57/record_reader.hpp"

namespace hybrid::io {

// Reads a table's records in any part of it, several threads at once, in bounded memory.
class E57TableReader : public E57RecordReader {
 public:
  // Finds the packets. Throws ErrorKind::input as find_packets() does, and when the streams hold fewer or
  // more records than the table says; in salvage these are notes.
  E57TableReader(const PagedFile& file, const E57Table& table);

  std::uint64_t count() const override { return count_; }
  void read(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t count,
            const std::function<void(const E57Records&)>& body) const override;

 private:
  struct Loaded;
  void bound_count();
  bool load(std::span<const std::size_t> fields, std::uint64_t first, std::uint64_t end,
            Loaded& loaded) const;

  const PagedFile& file_;
  const E57Table& table_;
  PacketGroups groups_;
  std::uint64_t count_ = 0;
};

}  // namespace hybrid::io
