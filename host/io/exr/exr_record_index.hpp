#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/exr/exr_records.hpp"

namespace hybrid::io {

// Finds the pixels of records by an image's channel `source`, group by group: of a scanner's order every
// group holds one stretch of records, and only the groups that are in memory need their places kept. Records
// in any other order take four bytes each.
class RecordIndex {
 public:
  static constexpr std::uint32_t kNowhere = 0xffffffffu;  // also: a node without a record

  // Refers to all of them.
  RecordIndex(const std::string& file, const RecordLayout& layout, const std::vector<RecordGroup>& groups,
              bool salvage, const std::string& remedy);

  // Every group once. Throws ErrorKind::input for a record that is there twice or beyond the count.
  void add(std::size_t group, const std::uint32_t* source);
  std::uint64_t placed() const { return placed_; }

  // Then, when this says so, every group once more with keep().
  bool wants_all() const;
  void keep(std::size_t group, const std::uint32_t* source);
  bool keeps_all() const { return !pixel_of_.empty(); }

  // The records of a group lie in [first, end).
  std::uint64_t first(std::size_t group) const { return stretch_[group].first; }
  std::uint64_t end(std::size_t group) const { return stretch_[group].end; }
  // A group comes into memory, or leaves it; not needed where all are kept.
  void load(std::size_t group, const std::uint32_t* source);
  void unload(std::size_t group);
  // The pixels of records [first, first + count), whose groups are in memory; valid until the next call. In
  // salvage kNowhere for those that no group has. This, keep() and load() throw ErrorKind::input when the
  // file holds other records than add() saw.
  const std::uint32_t* pixels(std::uint64_t first, std::size_t count);

 private:
  struct Stretch {
    std::uint64_t first = ~0ull, end = 0;
    std::vector<std::uint32_t> pixel_of{};  // while in memory
  };
  template <typename Take>  // take(record, pixel)
  void for_records(std::size_t group, const std::uint32_t* source, const Take& take) const;

  void check_same(bool same) const;

  const std::string& file_;
  const RecordLayout& layout_;
  const std::vector<RecordGroup>& groups_;
  bool salvage_;
  const std::string& remedy_;  // for what add() throws
  std::vector<bool> seen_;
  std::uint64_t placed_ = 0;
  std::vector<Stretch> stretch_;  // by group
  std::vector<std::uint32_t> pixel_of_, block_;
};

}  // namespace hybrid::io
