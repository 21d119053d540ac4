#include "archive/kept_file.hpp"

#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <atomic>

#include "core/parallel.hpp"
#include "io/output.hpp"
#include "io/output_file.hpp"

namespace hybrid::archive {
namespace {

constexpr std::string_view kMagic = "hybrid kept 1\n";
constexpr std::size_t kBlock_bytes = 1 << 20;
constexpr int kLevel = 1;  // zstd's fastest: reading scans again would take longer than its gain is worth

// Byte k of every value beside byte k of the next one: what changes slowly compresses well.
void regroup(const std::uint8_t* from, std::size_t size, std::size_t width, std::uint8_t* to) {
  const std::size_t count = size / width;
  for (std::size_t k = 0; k < width; ++k)
    for (std::size_t i = 0; i < count; ++i) to[k * count + i] = from[i * width + k];
}
void group_back(const std::uint8_t* from, std::size_t size, std::size_t width, std::uint8_t* to) {
  const std::size_t count = size / width;
  for (std::size_t k = 0; k < width; ++k)
    for (std::size_t i = 0; i < count; ++i) to[i * width + k] = from[k * count + i];
}

struct Packed {
  const std::uint8_t* data;
  std::size_t size, width;
  std::string bytes{};
};

void pack(Packed& block) {
  std::vector<std::uint8_t> grouped(block.size);
  regroup(block.data, block.size, block.width, grouped.data());
  block.bytes.resize(ZSTD_compressBound(block.size));
  const std::size_t size =
      ZSTD_compress(block.bytes.data(), block.bytes.size(), grouped.data(), block.size, kLevel);
  if (ZSTD_isError(size)) fail(ErrorKind::failed, "zstd: {}", ZSTD_getErrorName(size));
  block.bytes.resize(size);
}

// A multiple of every width that is a power of two or three times one.
std::size_t block_size(std::size_t left, std::size_t width) {
  return std::min(left, kBlock_bytes / width * width);
}

template <typename T>
void put(io::OutputFile& out, T value) {
  out.write(&value, sizeof value);
}

}  // namespace

// Layout: magic, bytes of plain values and their checksum, plain values, number of arrays; per array its size
// and its blocks: packed bytes, checksum of these, content.
void KeptWriter::save(const std::filesystem::path& file) const {
  io::write_atomically(file, [&](const std::filesystem::path& temporary) {
    io::OutputFile out(temporary);
    out.write(kMagic.data(), kMagic.size());
    put<std::uint64_t>(out, plain_.size());
    put<std::uint64_t>(out, XXH3_64bits(plain_.data(), plain_.size()));
    out.write(plain_.data(), plain_.size());
    put<std::uint64_t>(out, arrays_.size());
    for (const Array& array : arrays_) {
      put<std::uint64_t>(out, array.size);
      // A few blocks at a time: the packed copy stays small beside the arrays.
      for (std::size_t at = 0; at < array.size;) {
        std::vector<Packed> blocks;
        for (int i = 0; i < 64 && at < array.size; ++i) {
          const std::size_t size = block_size(array.size - at, array.width);
          blocks.push_back({array.data + at, size, array.width});
          at += size;
        }
        parallel_for(blocks.size(), [&](std::size_t i) { pack(blocks[i]); });
        for (const Packed& block : blocks) {
          put<std::uint64_t>(out, block.size);
          put<std::uint64_t>(out, block.bytes.size());
          put<std::uint64_t>(out, XXH3_64bits(block.bytes.data(), block.bytes.size()));
          out.write(block.bytes.data(), block.bytes.size());
        }
      }
    }
    out.close();
  });
}

KeptReader::KeptReader(const std::filesystem::path& file) : file_(file), content_(io::read_text(file)) {
  std::size_t at = kMagic.size();
  const auto number = [&] {
    if (content_.size() - at < sizeof(std::uint64_t)) damaged(at);
    std::uint64_t value = 0;
    std::memcpy(&value, content_.data() + at, sizeof value);
    at += sizeof value;
    return value;
  };
  if (!content_.starts_with(kMagic)) damaged(0);
  const std::uint64_t plain = number(), checksum = number();
  if (plain > content_.size() - at || XXH3_64bits(content_.data() + at, plain) != checksum) damaged(at);
  at_ = at;
  end_ = at += plain;
  for (std::uint64_t left = number(); left > 0; --left) {
    Array array;
    array.size = number();
    for (std::size_t done = 0; done < array.size;) {
      Block block{};
      block.size = number();
      block.packed = number();
      block.checksum = number();
      block.offset = at;
      if (block.size == 0 || block.size > kBlock_bytes || block.size > array.size - done ||
          block.packed > content_.size() - at)
        damaged(at);
      at += block.packed;
      done += block.size;
      array.blocks.push_back(block);
    }
    arrays_.push_back(std::move(array));
  }
  if (at != content_.size()) damaged(at);
}

void KeptReader::damaged(std::size_t at) const {
  fail_input(
      "{}: byte {}: expected what the planes stages kept, found a damaged file; hybrid batch verify finds "
      "all "
      "such",
      file_.string(), at);
}

void KeptReader::bytes(void* to, std::size_t count) {
  if (count > end_ - at_) damaged(at_);
  if (count > 0) std::memcpy(to, content_.data() + at_, count);
  at_ += count;
}

std::size_t KeptReader::count(std::size_t) {
  std::uint64_t value = 0;
  bytes(&value, sizeof value);
  return value;
}

void KeptReader::expect_array(std::size_t count, std::size_t element_bytes) const {
  if (array_ >= arrays_.size() || arrays_[array_].size / element_bytes != count ||
      arrays_[array_].size % element_bytes != 0)
    damaged(at_);
}

void KeptReader::block_bytes(void* to, std::size_t size, std::size_t width) {
  if (array_ >= arrays_.size() || arrays_[array_].size != size) damaged(at_);
  arrays_[array_].target = static_cast<std::uint8_t*>(to);
  arrays_[array_].width = width;
  ++array_;
}

void KeptReader::finish() {
  if (at_ != end_ || array_ != arrays_.size()) damaged(at_);
  struct Job {
    const Block* block;
    std::uint8_t* target;
    std::size_t width;
  };
  std::vector<Job> jobs;
  for (const Array& array : arrays_) {
    std::size_t done = 0;
    for (const Block& block : array.blocks) {
      jobs.push_back({&block, array.target + done, array.width});
      done += block.size;
    }
  }
  std::atomic<std::size_t> bad{content_.size()};
  parallel_for(jobs.size(), [&](std::size_t i) {
    const auto& [block, target, width] = jobs[i];
    const char* packed = content_.data() + block->offset;
    std::vector<std::uint8_t> grouped(block->size);
    if (XXH3_64bits(packed, block->packed) != block->checksum ||
        ZSTD_decompress(grouped.data(), grouped.size(), packed, block->packed) != block->size) {
      bad = block->offset;
      return;
    }
    group_back(grouped.data(), block->size, width, target);
  });
  if (bad != content_.size()) damaged(bad);
  content_ = {};
}

}  // namespace hybrid::archive
