#include "io/e57/bit_encoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/e57/little_endian.hpp"

namespace hybrid::io {

std::size_t BitEncoder::first_unfit(std::span<const std::int64_t> values) const {
  const auto fits = [&](std::int64_t value) { return value >= field_.minimum && value <= field_.maximum; };
  return static_cast<std::size_t>(std::ranges::find_if_not(values, fits) - values.begin());
}

std::size_t BitEncoder::first_unfit(std::span<const double> values) const {
  if (field_.type == E57Type::double_real) return values.size();
  const auto fits = [](double value) {
    return std::isnan(value) || static_cast<double>(static_cast<float>(value)) == value;
  };
  return static_cast<std::size_t>(std::ranges::find_if_not(values, fits) - values.begin());
}

void BitEncoder::append(std::span<const std::int64_t> values) {
  const int width = field_.bits();
  count_ += values.size();
  if (width == 0) return;
  const std::size_t start = bytes_.size();
  // Whole words are written behind the end, of which what is filled counts.
  bytes_.resize(start + (values.size() * static_cast<std::size_t>(width) + 7) / 8 + 16);
  char* at = bytes_.data() + start;
  for (const std::int64_t value : values) {
    const std::uint64_t bits = static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(field_.minimum);
    word_ |= bits << used_;
    const int filled = used_ + width;
    store(at, word_);
    if (filled >= 64) {  // the word is full: what did not fit starts the next
      at += 8;
      word_ = used_ == 0 ? 0 : bits >> (64 - used_);
      used_ = filled - 64;
    } else {
      used_ = filled;
    }
  }
  store(at, word_);
  at += used_ / 8;
  word_ = used_ / 8 == 8 ? 0 : word_ >> (used_ / 8 * 8);
  used_ %= 8;
  bytes_.resize(static_cast<std::size_t>(at - bytes_.data()));
}

void BitEncoder::append(std::span<const double> values) {
  count_ += values.size();
  const std::size_t start = bytes_.size();
  if (field_.type == E57Type::double_real) {
    bytes_.resize(start + values.size_bytes());
    if (!values.empty()) std::memcpy(&bytes_[start], values.data(), values.size_bytes());
    return;
  }
  bytes_.resize(start + 4 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    store(&bytes_[start + 4 * i], static_cast<float>(values[i]));
}

void BitEncoder::clear() {
  taken_bytes_ += bytes_.size();
  bytes_.clear();
}

void BitEncoder::finish() {
  const std::uint64_t whole = word_padded_bytes(field_, count_) - taken_bytes_;
  if (used_ > 0) bytes_.push_back(static_cast<char>(word_));
  bytes_.resize(whole);
  word_ = 0;
  used_ = 0;
}

}  // namespace hybrid::io
