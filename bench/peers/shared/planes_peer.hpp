#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "shared/peer_report.hpp"
#include "shared/range_exr.hpp"

namespace hybrid::peers {

struct PlanesOptions {
  std::string variant;        // one of the program's own names
  double sigma_m = 0.002;     // range noise; every peer is told the truth
  int square = 5;             // programs that work on squares
  int threads = 0;            // 0 = all
  bool squares_only = false;  // stop before growing: report.seconds is the squares', no labels
};

// One label per node, 0 = none; none at all when only squares were asked for.
using PlanesBody = std::function<std::vector<std::uint32_t>(const RangeScan&, const PlanesOptions&, Report&)>;

// The command line every plane extraction answers: --range FILE --out DIR [--variant V] [--sigma M] [--square
// N] [--squares-only] [--threads N]. Reads the scan, times `body` (unless it set report.seconds itself),
// writes the labels.
int planes_main(int argc, char** argv, const std::string& package, const std::vector<std::string>& variants,
                const PlanesBody& body);

// Makes the points' nodes of a list: valid nodes in row-major order.
std::vector<std::uint32_t> valid_nodes(const RangeScan&);

}  // namespace hybrid::peers
