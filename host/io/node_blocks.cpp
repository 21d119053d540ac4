#include "io/node_blocks.hpp"

#include <algorithm>
#include <limits>

#include "core/interrupt.hpp"

namespace hybrid::io {
namespace {

// The nodes of some lines of a grid that follow each other, with their samples.
struct Band : SampleColumns {
  void clear(const ScanStream& scan, std::size_t nodes) {
    points.assign(nodes, {kNaN, kNaN, kNaN});
    if (scan.has_exact()) exact.assign(nodes, {});
    if (scan.has_intensity()) intensity.assign(nodes, 0);
    if (scan.has_colour()) rgb.assign(nodes, {});
    node.assign(nodes, Scan::kNoNode);
  }
  void take(const SampleBlock& block, std::size_t i, std::size_t at, std::uint32_t its_node) {
    points[at] = block.points[i];
    if (!exact.empty()) exact[at] = block.exact[i];
    if (!intensity.empty()) intensity[at] = block.intensity[i];
    if (!rgb.empty()) rgb[at] = block.rgb[i];
    node[at] = its_node;
  }
};

// Which line and which place in it a sample's node has.
class Lines {
 public:
  Lines(const ScanStream& scan, bool by_columns)
      : rows_(static_cast<std::uint64_t>(scan.head().grid_rows)),
        cols_(static_cast<std::uint64_t>(scan.head().grid_cols)),
        by_columns_(by_columns),
        by_node_(scan.has_node()),
        row_by_row_(scan.head().row_by_row) {}

  std::uint64_t count() const { return by_columns_ ? cols_ : rows_; }
  std::uint64_t length() const { return by_columns_ ? rows_ : cols_; }
  std::uint64_t nodes() const { return rows_ * cols_; }
  std::uint32_t node(const SampleBlock& block, std::size_t i) const {
    if (by_node_) return block.node[i];
    const std::uint64_t sample = block.first + i;
    if (sample >= nodes()) return Scan::kNoNode;
    return static_cast<std::uint32_t>(row_by_row_ ? sample : sample % rows_ * cols_ + sample / rows_);
  }
  std::uint64_t line(std::uint32_t node) const { return by_columns_ ? node % cols_ : node / cols_; }
  std::uint64_t place(std::uint32_t node) const { return by_columns_ ? node / cols_ : node % cols_; }

 private:
  std::uint64_t rows_, cols_;
  bool by_columns_, by_node_, row_by_row_;
};

// Samples of which some belong to a line, or a band of lines.
struct Stretch {
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max(), end = 0;
  std::uint64_t size() const { return end > first ? end - first : 0; }
  void add(const Stretch& other) {
    first = std::min(first, other.first);
    end = std::max(end, other.end);
  }
};

template <typename Body>  // body(block)
void for_blocks(const ScanStream& scan, Stretch stretch, const Body& body) {
  for (std::uint64_t first = stretch.first; first < stretch.end; first += ScanStream::kBlock) {
    check_interrupted();
    body(scan.read(
        first, static_cast<std::size_t>(std::min<std::uint64_t>(ScanStream::kBlock, stretch.end - first))));
  }
}

// By the bounds of parts of the scan, so that other samples are among them, too.
std::vector<Stretch> stretches_of_lines(const ScanStream& scan, const Lines& lines, bool by_columns) {
  if (!scan.has_node()) return std::vector<Stretch>(lines.count(), {0, lines.nodes()});
  std::vector<Stretch> stretches(lines.count());
  for (std::size_t part = 0; part < scan.facts().nodes.size(); ++part) {
    const SampleFacts::NodeBounds& bounds = scan.facts().nodes[part];
    const std::uint64_t first = part * SampleFacts::kPart,
                        end = std::min<std::uint64_t>(first + SampleFacts::kPart, scan.count()),
                        last_line = by_columns ? bounds.last_col : bounds.last_row;
    for (std::uint64_t line = by_columns ? bounds.first_col : bounds.first_row; line <= last_line; ++line)
      stretches[line].add({first, end});
  }
  return stretches;
}

struct Bands {
  std::uint64_t lines = 1;  // of each but the last
  std::vector<Stretch> stretches{};
};

Bands bands_of(const ScanStream& scan, const Lines& lines, bool by_columns, std::uint64_t most) {
  const std::vector<Stretch> of_lines = stretches_of_lines(scan, lines, by_columns);
  Bands bands;
  for (const std::uint64_t nodes : {most / 8, most}) {
    bands.lines = std::clamp<std::uint64_t>(nodes / lines.length(), 1, lines.count());
    bands.stretches.assign((lines.count() + bands.lines - 1) / bands.lines, {});
    for (std::uint64_t line = 0; line < lines.count(); ++line)
      bands.stretches[line / bands.lines].add(of_lines[line]);
    std::uint64_t read = 0;
    for (const Stretch& stretch : bands.stretches) read += stretch.size();
    if (read <= 2 * scan.count()) break;
  }
  return bands;
}

}  // namespace

void for_each_node_block(const ScanStream& scan, bool by_columns,
                         const std::function<void(const SampleBlock&)>& body, std::uint64_t most) {
  const Lines lines(scan, by_columns);
  if (!scan.has_node() && scan.head().row_by_row != by_columns)
    return for_blocks(scan, {0, lines.nodes()}, body);
  const Bands bands = bands_of(scan, lines, by_columns, most);
  Band band;
  for (std::size_t b = 0; b < bands.stretches.size(); ++b) {
    const std::uint64_t from = b * bands.lines, end = std::min(from + bands.lines, lines.count());
    band.clear(scan, (end - from) * lines.length());
    for_blocks(scan, bands.stretches[b], [&](const SampleBlock& block) {
      for (std::size_t i = 0; i < block.size(); ++i) {
        const std::uint32_t node = lines.node(block, i);
        if (node == Scan::kNoNode) continue;
        const std::uint64_t line = lines.line(node);
        if (line < from || line >= end) continue;
        band.take(block, i, (line - from) * lines.length() + lines.place(node), node);
      }
    });
    body(band.block(scan.head(), from * lines.length(), 0, band.size()));
  }
}

}  // namespace hybrid::io
