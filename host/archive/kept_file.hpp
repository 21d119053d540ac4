#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/error.hpp"

namespace hybrid::archive {

// Values of this build in a file, exactly: only read back by the build that wrote it (the store's keys see to
// that). Arrays are cut into blocks, their bytes regrouped by significance and compressed; every block has
// its checksum. pass() is called with the same values in the same order by both classes.
template <typename T>
struct IsRaw : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T>> {};
template <typename T, std::size_t N>
struct IsRaw<std::array<T, N>> : IsRaw<T> {};

class KeptWriter {
 public:
  static constexpr bool kReads = false;
  void bytes(const void* from, std::size_t count) {
    const char* begin = static_cast<const char*>(from);
    plain_.insert(plain_.end(), begin, begin + count);
  }
  std::size_t count(std::size_t elements) {
    const std::uint64_t value = elements;
    bytes(&value, sizeof value);
    return elements;
  }
  // `width`: bytes of the values that the elements are made of.
  void block_bytes(const void* from, std::size_t size, std::size_t width) {
    arrays_.push_back({static_cast<const std::uint8_t*>(from), size, width});
  }
  // The arrays must still be there.
  void save(const std::filesystem::path& file) const;

 private:
  struct Array {
    const std::uint8_t* data;
    std::size_t size, width;
  };
  std::vector<char> plain_;
  std::vector<Array> arrays_;
};

class KeptReader {
 public:
  static constexpr bool kReads = true;
  // Throws ErrorKind::input naming the file and the byte when it is cut short or damaged.
  explicit KeptReader(const std::filesystem::path& file);
  void bytes(void* to, std::size_t count);
  std::size_t count(std::size_t);
  void block_bytes(void* to, std::size_t size, std::size_t width);
  // Unpacks the arrays; the end of the file must be reached.
  void finish();
  // The next array has as many elements: so that nothing larger is allocated.
  void expect_array(std::size_t count, std::size_t element_bytes) const;

 private:
  struct Block {
    std::size_t offset, packed, size;
    std::uint64_t checksum;
  };
  struct Array {
    std::size_t size;
    std::vector<Block> blocks;
    std::uint8_t* target = nullptr;
    std::size_t width = 1;
  };
  [[noreturn]] void damaged(std::size_t at) const;

  std::filesystem::path file_;
  std::string content_;
  std::size_t at_ = 0, end_ = 0, array_ = 0;  // of the plain values; the next array
  std::vector<Array> arrays_;
};

template <typename File, typename T>
requires IsRaw<T>::value void pass(File& file, T& value) {
  file.bytes(&value, sizeof value);
}

template <typename File>
void pass(File& file, std::string& text) {
  const std::size_t count = file.count(text.size());
  if constexpr (File::kReads) text.resize(count);
  file.bytes(text.data(), count);
}

// Elements of one kind of number.
template <typename File, typename T>
void pass_array(File& file, std::vector<T>& values, std::size_t width) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t count = file.count(values.size());
  if constexpr (File::kReads) {
    file.expect_array(count, sizeof(T));
    values.resize(count);
  }
  file.block_bytes(values.data(), count * sizeof(T), width);
}

template <typename T>
struct WidthOf : std::integral_constant<std::size_t, sizeof(T)> {};
template <typename T, std::size_t N>
struct WidthOf<std::array<T, N>> : WidthOf<T> {};

template <typename File, typename T>
requires IsRaw<T>::value void pass(File& file, std::vector<T>& values) {
  pass_array(file, values, WidthOf<T>::value);
}

}  // namespace hybrid::archive
