#pragma once
#include <vector>

#include "compare/plot_svg.hpp"
#include "compare/row.hpp"

namespace hybrid::compare {

enum class PlotOf { seconds, memory };

// Time or memory of the planes job against the size of the scan, a line for each program.
Plot plot_of(const std::vector<Row>& rows, PlotOf what);

}  // namespace hybrid::compare
