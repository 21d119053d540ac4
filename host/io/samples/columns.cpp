#include "io/samples/columns.hpp"

#include <zstd.h>

#include <memory>

#include "core/error.hpp"

namespace hybrid::io {
namespace {

// Beyond this level files of scans shrink by less than 1 % and take twice as long.
constexpr int kZstdLevel = 6;

struct FreeCompressor {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

// Bands are compressed by several threads, each many frames: one context per thread.
ZSTD_CCtx* compressor() {
  thread_local const std::unique_ptr<ZSTD_CCtx, FreeCompressor> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  return context.get();
}

[[noreturn]] void fail_damaged(const std::string& place, const char* expected) {
  fail_input("{}: expected {}, found damaged data; copy the file again, or make it again from the scan",
             place, expected);
}

}  // namespace

std::string compress(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compressCCtx(compressor(), out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size)) fail(ErrorKind::failed, "zstd: {}", ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

std::string decompress(std::string_view bytes, std::size_t most, const std::string& place) {
  const auto announced = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (announced == ZSTD_CONTENTSIZE_ERROR || announced == ZSTD_CONTENTSIZE_UNKNOWN || announced > most)
    fail_damaged(place, "a zstd frame that says how much it holds");
  std::string out(announced, '\0');
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) || size != announced) fail_damaged(place, "a whole zstd frame");
  return out;
}

std::size_t append_column(std::span<const std::uint32_t> values, std::string& bytes) {
  const std::size_t before = bytes.size();
  std::uint32_t any = 0;
  for (const std::uint32_t value : values) any |= value;
  std::size_t planes = 0;
  while (planes < 4 && any >> (8 * planes) != 0) ++planes;
  bytes.push_back(static_cast<char>(planes));
  std::string plane(values.size(), '\0');
  for (std::size_t p = 0; p < planes; ++p) {
    for (std::size_t i = 0; i < values.size(); ++i)
      plane[i] = static_cast<char>(static_cast<std::uint8_t>(values[i] >> (8 * p)));
    const std::string packed = compress(plane);
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<char>(static_cast<std::uint8_t>(packed.size() >> shift)));
    bytes += packed;
    if (p + 1 == 4) break;  // a shift by 32 is none
  }
  return bytes.size() - before;
}

std::uint32_t ColumnReader::take_number(std::size_t bytes) {
  if (bytes_.size() < bytes) fail_damaged(place_, "a column");
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    value |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes_[i])) << (8 * i);
  bytes_.remove_prefix(bytes);
  return value;
}

std::vector<std::uint32_t> ColumnReader::take(std::size_t count) {
  const std::uint32_t planes = take_number(1);
  if (planes > 4) fail_damaged(place_, "a column of at most 4 bytes a value");
  std::vector<std::uint32_t> values(count, 0);
  for (std::uint32_t p = 0; p < planes; ++p) {
    const std::uint32_t packed = take_number(4);
    if (bytes_.size() < packed) fail_damaged(place_, "a column");
    const std::string plane = decompress(bytes_.substr(0, packed), count, place_);
    if (plane.size() != count) fail_damaged(place_, "as many values as its samples");
    bytes_.remove_prefix(packed);
    for (std::size_t i = 0; i < count; ++i)
      values[i] |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(plane[i])) << (8 * p);
  }
  return values;
}

void ColumnReader::finish() const {
  if (!bytes_.empty()) fail_damaged(place_, "the end of a block");
}

}  // namespace hybrid::io
