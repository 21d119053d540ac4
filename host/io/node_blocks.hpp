#pragma once
#include <functional>

#include "io/scan_stream.hpp"

namespace hybrid::io {

// An organised scan's nodes line by line, columns or rows: body(block) of consecutive nodes with the sample
// of each, where block.node is empty or has Scan::kNoNode for nodes without one (whose point is NaN). Of
// several samples at a node the last. Where samples come in another order than line by line, in memory are
// the lines of `most` nodes, and samples are read again for each such band that they may be in; else an
// eighth of that.
inline constexpr std::uint64_t kBandNodes = 1 << 22;
void for_each_node_block(const ScanStream& scan, bool by_columns,
                         const std::function<void(const SampleBlock&)>& body,
                         std::uint64_t most = kBandNodes);

}  // namespace hybrid::io
