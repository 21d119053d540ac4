#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "core/interrupt.hpp"
#include "core/parallel.hpp"
#include "io/output_file.hpp"
#include "io/scan_stream.hpp"

namespace hybrid::io {

// Writes `count` records in order, each appended to a text by append(index, text), on all threads. Memory:
// the blocks in work.
template <typename Append>
void write_records(OutputFile& out, std::size_t count, const Append& append) {
  constexpr std::size_t kBlock = 8192;
  std::vector<std::string> texts(4 * static_cast<std::size_t>(thread_count()));
  for (std::size_t first = 0; first < count; first += kBlock * texts.size()) {
    check_interrupted();
    const std::size_t blocks = std::min(texts.size(), (count - first + kBlock - 1) / kBlock);
    parallel_for(blocks, [&](std::size_t b) {
      texts[b].clear();
      const std::size_t begin = first + b * kBlock, end = std::min(begin + kBlock, count);
      for (std::size_t i = begin; i < end; ++i) append(i, texts[b]);
    });
    for (std::size_t b = 0; b < blocks; ++b) out.write(texts[b].data(), texts[b].size());
  }
}

// The same of a scan's samples in their order: append(block, index in it, text).
template <typename Append>
void write_blocks(OutputFile& out, const ScanStream& scan, const Append& append) {
  scan.for_each_block([&](const SampleBlock& block) {
    write_records(out, block.size(), [&](std::size_t i, std::string& text) { append(block, i, text); });
    return true;
  });
}

// The bytes of a value as they lie in memory.
template <typename T>
void append_raw(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace hybrid::io
