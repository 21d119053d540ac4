#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "io/e57/e57_model.hpp"

namespace hybrid::io {

// One field's stream in the making: values packed without gaps, least significant bit first.
class BitEncoder {
 public:
  explicit BitEncoder(const E57Field& field) : field_(field) {}

  // The next value that the field cannot hold: its index; values.size() when there is none.
  std::size_t first_unfit(std::span<const std::int64_t> values) const;
  std::size_t first_unfit(std::span<const double> values) const;
  void append(std::span<const std::int64_t> values);
  void append(std::span<const double> values);

  // The whole bytes so far, which the caller takes away.
  const std::vector<char>& bytes() const { return bytes_; }
  void clear();
  void finish();  // the last bits, filled up with zeros to a whole word (word_padded_bytes)

 private:
  E57Field field_;
  std::vector<char> bytes_;
  std::uint64_t count_ = 0, taken_bytes_ = 0;
  std::uint64_t word_ = 0;  // bits that wait
  int used_ = 0;            // fewer than 8 between calls
};

}  // namespace hybrid::io
