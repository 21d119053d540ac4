#include "compare/plots.hpp"

#include <algorithm>
#include <map>

#include "compare/statistics.hpp"

namespace hybrid::compare {

Plot plot_of(const std::vector<Row>& rows, PlotOf what) {
  const bool memory = what == PlotOf::memory;
  Plot plot{memory ? "Plane extraction: peak memory of the process"
                   : "Plane extraction: seconds from range image to labels",
            "megapixels",
            memory ? "MB" : "seconds",
            {}};
  std::map<std::string, std::size_t> lines;
  for (const Row& row : rows) {
    if (row.job != "planes" || row.runs.empty()) continue;
    const auto [found, added] = lines.emplace(row.program, plot.lines.size());
    if (added) plot.lines.push_back({row.program, row.ours, {}});
    double value = 0;
    if (memory)
      for (const Run& run : row.runs) value = std::max(value, run.peak_mb);
    else
      value = median(row.seconds());
    if (value > 0)
      plot.lines[found->second].points.push_back(
          {std::stod(row.size), value, row.outcome == Outcome::extrapolated});
  }
  return plot;
}

}  // namespace hybrid::compare
