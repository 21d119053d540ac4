#include "stages/scan/columns.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/error.hpp"
#include "core/log.hpp"
#include "core/parallel_blocks.hpp"
#include "geometry/angles.hpp"
#include "stages/scan/scattered.hpp"
#include "stages/scan/sweeps.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSameColumn = 0.5;      // columns: sweeps closer than this share one
constexpr double kMissingColumn = 1.75;  // columns: wider gaps get empty columns
constexpr double kOpenGap = 3;           // columns: a wider gap may stay open
constexpr std::size_t kSweepsInBlock = 64;
constexpr double kMostNodesPerSample = 50;  // beyond, the steps found are not the scan's

// Sweeps in the order of increasing azimuth, azimuths unwrapped from the first, which follows the widest gap.
struct Turn {
  std::vector<std::size_t> sweep;
  std::vector<double> azimuth_rad;
  double step_rad = 0;  // between columns; 0 for a lone one
  double gap_rad = 0;   // the widest
};

Turn around(const Sweeps& sweeps) {
  Turn turn;
  const std::size_t count = sweeps.count();
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return sweeps.azimuth_rad[a] < sweeps.azimuth_rad[b]; });
  std::vector<double> gaps(count);  // before order[k]
  for (std::size_t k = 0; k < count; ++k)
    gaps[k] = sweeps.azimuth_rad[order[k]] -
              (k > 0 ? sweeps.azimuth_rad[order[k - 1]] : sweeps.azimuth_rad[order[count - 1]] - kTurn);
  const auto widest = std::max_element(gaps.begin(), gaps.end());
  turn.gap_rad = *widest;
  const auto first = static_cast<std::size_t>(widest - gaps.begin());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = (first + k) % count;
    turn.sweep.push_back(order[at]);
    turn.azimuth_rad.push_back(sweeps.azimuth_rad[order[at]] + (first + k >= count ? kTurn : 0));
  }
  gaps.erase(widest);
  turn.step_rad = typical_step(std::move(gaps));
  return turn;
}

// Sweeps of each column; a column without any is a gap of the scan.
struct Group {
  std::vector<std::size_t> sweeps;
  double azimuth_rad = 0;
};

std::vector<Group> group(const Turn& turn) {
  std::vector<Group> groups;
  double first = 0, sum = 0;
  for (std::size_t k = 0; k < turn.sweep.size(); ++k) {
    if (groups.empty() || turn.azimuth_rad[k] - first >= kSameColumn * turn.step_rad) {
      if (turn.step_rad > 0 || groups.empty()) {
        groups.emplace_back();
        first = turn.azimuth_rad[k];
        sum = 0;
      }
    }
    sum += turn.azimuth_rad[k] - first;
    groups.back().sweeps.push_back(turn.sweep[k]);
    groups.back().azimuth_rad = first + sum / static_cast<double>(groups.back().sweeps.size());
  }
  return groups;
}

void add_missing(std::vector<Group>& filled, double from, double to, double step) {
  if (step <= 0 || to - from <= kMissingColumn * step) return;
  const double parts = std::round((to - from) / step);
  for (double k = 1; k < parts; ++k) filled.push_back({{}, from + (to - from) * k / parts});
}

// Columns in order of azimuth from [-pi, pi) on for a full turn, else from the open gap on.
std::vector<Group> lay_out(const Turn& turn, bool wraps) {
  const auto groups = group(turn);
  std::vector<Group> filled;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (g > 0) add_missing(filled, groups[g - 1].azimuth_rad, groups[g].azimuth_rad, turn.step_rad);
    filled.push_back(groups[g]);
  }
  if (!wraps) return filled;
  add_missing(filled, groups.back().azimuth_rad, groups.front().azimuth_rad + kTurn, turn.step_rad);
  for (auto& column : filled) column.azimuth_rad = wrapped(column.azimuth_rad);
  std::stable_sort(filled.begin(), filled.end(),
                   [](const auto& a, const auto& b) { return a.azimuth_rad < b.azimuth_rad; });
  return filled;
}

void sort_sweeps(const SampleAngles& angles, Sweeps& sweeps) {
  parallel_for(sweeps.count(), [&](std::size_t s) {
    const auto at = [&](std::size_t k) { return sweeps.samples.begin() + static_cast<std::ptrdiff_t>(k); };
    sort_by_elevation(angles, {at(sweeps.begin[s]), at(sweeps.begin[s + 1])});
  });
}

// Angle between neighbours of a sweep. The typical difference gives the number of steps between neighbours,
// their sum over all sweeps the step itself: jitter cancels but at the ends.
double elevation_step(const SampleAngles& angles, const Sweeps& sweeps) {
  std::vector<double> differences;
  const std::size_t stride = 1 + sweeps.samples.size() / 1'000'000;
  for (std::size_t s = 0; s < sweeps.count(); ++s)
    for (std::size_t k = sweeps.begin[s] + 1; k < sweeps.begin[s + 1]; ++k)
      if (k % stride == 0)
        differences.push_back(angles.elevation_rad[sweeps.samples[k - 1]] -
                              angles.elevation_rad[sweeps.samples[k]]);
  const double rough = typical_step(std::move(differences));
  if (rough <= 0) return 0;
  struct Length {
    double rad = 0, steps = 0;
    void operator+=(const Length& other) {
      rad += other.rad;
      steps += other.steps;
    }
  };
  const auto length_of = [&](std::size_t first, std::size_t last) {
    Length length;
    for (std::size_t s = first; s < last; ++s)
      for (std::size_t k = sweeps.begin[s] + 1; k < sweeps.begin[s + 1]; ++k) {
        const double difference =
            angles.elevation_rad[sweeps.samples[k - 1]] - angles.elevation_rad[sweeps.samples[k]];
        const double whole = std::round(difference / rough);
        if (!(whole < 1 || whole > 8 || std::abs(difference / rough - whole) > 0.3))
          length += {difference, whole};
      }
    return length;
  };
  const auto length = sum_blocks<Length>(sweeps.count(), length_of, kSweepsInBlock);
  return length.steps > 0 ? length.rad / length.steps : rough;
}

// Offset of the rows, in steps, that lies closest to the samples' own elevations: circular mean. Exact when
// all columns start at the same elevations, arbitrary but fixed when each starts anywhere.
double phase(const SampleAngles& angles, const Sweeps& sweeps, double step) {
  std::vector<double> x(sweeps.count()), y(sweeps.count());
  parallel_for(sweeps.count(), [&](std::size_t s) {
    for (std::size_t k = sweeps.begin[s]; k < sweeps.begin[s + 1]; ++k) {
      const double angle = kTurn * angles.elevation_rad[sweeps.samples[k]] / step;
      x[s] += std::cos(angle);
      y[s] += std::sin(angle);
    }
  });
  return std::atan2(std::accumulate(y.begin(), y.end(), 0.0), std::accumulate(x.begin(), x.end(), 0.0)) /
         kTurn;
}

void lay_rows(const SampleAngles& angles, const Sweeps& sweeps, double step, ScanColumns& columns) {
  columns.elevation_step_rad = step;
  if (step <= 0) return;
  const double offset = phase(angles, sweeps, step);
  double lowest = kTurn, highest = -kTurn;
  for (std::size_t s = 0; s < sweeps.count(); ++s) {
    highest = std::max(highest, angles.elevation_rad[sweeps.samples[sweeps.begin[s]]]);
    lowest = std::min(lowest, angles.elevation_rad[sweeps.samples[sweeps.begin[s + 1] - 1]]);
  }
  const double top = std::round(highest / step - offset), bottom = std::round(lowest / step - offset);
  columns.top_elevation_rad = (top + offset) * step;
  columns.rows = static_cast<int>(std::min(top - bottom + 1, 1e9));
}

void fill(const SampleAngles& angles, const Sweeps& sweeps, const std::vector<Group>& groups,
          ScanColumns& columns) {
  columns.begin.push_back(0);
  for (const auto& column : groups) {
    std::size_t end = columns.begin.back();
    for (const std::size_t s : column.sweeps) end += sweeps.begin[s + 1] - sweeps.begin[s];
    columns.begin.push_back(end);
    columns.azimuth_rad.push_back(column.azimuth_rad);
  }
  columns.samples.resize(columns.begin.back());
  columns.row_position.resize(columns.begin.back());
  parallel_for(groups.size(), [&](std::size_t c) {
    const auto first = columns.samples.begin() + static_cast<std::ptrdiff_t>(columns.begin[c]);
    auto last = first;
    for (const std::size_t s : groups[c].sweeps)
      last = std::copy(sweeps.samples.begin() + static_cast<std::ptrdiff_t>(sweeps.begin[s]),
                       sweeps.samples.begin() + static_cast<std::ptrdiff_t>(sweeps.begin[s + 1]), last);
    if (groups[c].sweeps.size() > 1) sort_by_elevation(angles, {first, last});
    for (std::size_t k = columns.begin[c]; k < columns.begin[c + 1]; ++k)
      columns.row_position[k] =
          static_cast<float>((columns.top_elevation_rad - angles.elevation_rad[columns.samples[k]]) /
                             columns.elevation_step_rad);
  });
}

// Lays columns and rows over the sweeps. None when that makes no grid.
std::optional<ScanColumns> grid_of(const SampleAngles& angles, Sweeps sweeps, double row_step_rad) {
  if (sweeps.count() == 0) return std::nullopt;
  ScanColumns columns;
  columns.sweeps = sweeps.count();
  sort_sweeps(angles, sweeps);
  const Turn turn = around(sweeps);
  columns.wraps = turn.step_rad > 0 && turn.gap_rad <= kOpenGap * turn.step_rad;
  const auto groups = lay_out(turn, columns.wraps);
  lay_rows(angles, sweeps, row_step_rad > 0 ? row_step_rad : elevation_step(angles, sweeps), columns);
  const double nodes = static_cast<double>(groups.size()) * columns.rows;
  if (columns.rows < 1 || nodes > kMostNodesPerSample * static_cast<double>(sweeps.samples.size()))
    return std::nullopt;
  fill(angles, sweeps, groups, columns);
  return columns;
}

// An organised file of one row or column is no grid.
std::string grid_remedy(const Scan& scan) {
  if (scan.grid_rows < 1 || scan.grid_cols < 1) return "use an organised file (PTX, PCD with HEIGHT > 1)";
  return fmt::format("its grid of {} x {} is a single line: export the scan with its rows and columns",
                     scan.grid_rows, scan.grid_cols);
}

}  // namespace

void fail_without_returns(const std::string& where) {
  fail_input("expected returns, found none {}; export the scan again with its points, or leave it out",
             where);
}

ScanColumns recover_columns(const Scan& scan) {
  const auto angles = sample_angles(scan);
  if (std::all_of(angles.elevation_rad.begin(), angles.elevation_rad.end(),
                  [](double e) { return std::isnan(e); }))
    fail_without_returns(fmt::format("among {} samples", scan.points.size()));
  Sweeps sweeps = sweeps_of_acquisition(angles);
  if (sweeps.count() == 0) sweeps = sweeps_of_azimuth(angles);
  if (auto columns = grid_of(angles, std::move(sweeps), 0)) return std::move(*columns);

  if (!scan.scanner_is_known)
    fail_input(
        "no columns found among {} samples: expected the scanner at the origin and samples in the order of "
        "acquisition, column by column, or at all elevations of shared azimuths, found neither; {}, or say "
        "where the scanner stood: scanner = [x, y, z] of [[scan]], or hybrid planes --scanner x,y,z",
        scan.points.size(), grid_remedy(scan));
  ScatteredSweeps scattered = scatter_sweeps(angles);
  auto columns = grid_of(angles, std::move(scattered.sweeps), scattered.step_rad);
  if (!columns)
    fail_input(
        "{} samples lie too few or too unevenly about the scanner's position for a grid: is it where the "
        "scanner stood? (scanner = [x, y, z] of [[scan]], or hybrid planes --scanner x,y,z)",
        scan.points.size());
  log::info("scan {}: no columns found: laid over {} x {} nodes, {:.4f} degrees apart", scan.name,
            columns->rows, columns->count(), scattered.step_rad * 360 / kTurn);
  return std::move(*columns);
}

}  // namespace hybrid::stages
