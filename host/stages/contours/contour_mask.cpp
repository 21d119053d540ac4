#include "stages/contours/contour_mask.hpp"

#include <algorithm>
#include <array>

#include "core/disjoint_sets.hpp"
#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

// Equal labels in a row, columns [begin, end).
struct RowRun {
  int row, begin, end;
  std::uint32_t label, patch;
};

struct Patches {
  std::vector<RowRun> runs;            // row by row, left to right
  std::vector<std::size_t> row_begin;  // rows + 1
};

void find_runs(const RangeImage& image, const std::vector<std::uint32_t>& labels, Patches& patches) {
  std::vector<std::vector<RowRun>> rows(static_cast<std::size_t>(image.rows));
  parallel_for(rows.size(), [&](std::size_t row) {
    const std::uint32_t* line = &labels[image.index(static_cast<int>(row), 0)];
    for (int begin = 0; begin < image.cols;) {
      int end = begin + 1;
      while (end < image.cols && line[end] == line[begin]) ++end;
      rows[row].push_back({static_cast<int>(row), begin, end, line[begin], 0});
      begin = end;
    }
  });
  patches.row_begin = {0};
  for (const auto& row : rows) {
    patches.runs.insert(patches.runs.end(), row.begin(), row.end());
    patches.row_begin.push_back(patches.runs.size());
  }
}

// Calls body(upper, lower, overlap) for the touching runs of two successive rows.
template <typename Body>
void touching(const Patches& patches, std::size_t row, const Body& body) {
  std::size_t a = patches.row_begin[row], b = patches.row_begin[row + 1];
  while (a < patches.row_begin[row + 1] && b < patches.row_begin[row + 2]) {
    const RowRun &upper = patches.runs[a], &lower = patches.runs[b];
    const int overlap = std::min(upper.end, lower.end) - std::max(upper.begin, lower.begin);
    if (overlap > 0) body(a, b, overlap);
    if (upper.end <= lower.end) ++a;
    if (lower.end <= upper.end) ++b;
  }
}

Patches find_patches(const RangeImage& image, const std::vector<std::uint32_t>& labels) {
  Patches patches;
  find_runs(image, labels, patches);
  DisjointSets sets(patches.runs.size());
  const auto join = [&](std::size_t a, std::size_t b) {
    sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  };
  for (std::size_t row = 0; row < static_cast<std::size_t>(image.rows); ++row) {
    const std::size_t first = patches.row_begin[row], last = patches.row_begin[row + 1] - 1;
    if (image.wraps && patches.runs[first].label == patches.runs[last].label) join(first, last);
    if (row + 1 == static_cast<std::size_t>(image.rows)) continue;
    touching(patches, row, [&](std::size_t a, std::size_t b, int) {
      if (patches.runs[a].label == patches.runs[b].label) join(a, b);
    });
  }
  for (std::size_t i = 0; i < patches.runs.size(); ++i)
    patches.runs[i].patch = sets.of(static_cast<std::uint32_t>(i));
  return patches;
}

// Edges of a small patch's rim by the label on the other side. A patch of a few samples meets few labels:
// what comes after the eighth counts as rim only.
struct Rim {
  std::array<std::uint32_t, 8> label{};
  std::array<int, 8> edges{};
  int total = 0;

  void add(std::uint32_t other, int count) {
    total += count;
    for (std::size_t k = 0; k < label.size(); ++k)
      if (edges[k] == 0 || label[k] == other) {
        label[k] = other;
        edges[k] += count;
        return;
      }
  }
};

// Per run: index of its patch's rim, or kNoRim where the patch is none of the small ones sought.
constexpr std::uint32_t kNoRim = 0xffffffffu;

std::vector<Rim> find_rims(const RangeImage& image, const Patches& patches,
                           const std::vector<std::uint32_t>& slot, std::size_t count) {
  std::vector<Rim> rims(count);
  const auto add = [&](const RowRun& from, std::uint32_t other, int edges) {
    if (slot[from.patch] != kNoRim) rims[slot[from.patch]].add(other, edges);
  };
  const auto meet = [&](const RowRun& a, const RowRun& b, int edges) {
    if (a.patch == b.patch) return;
    add(a, b.label, edges);
    add(b, a.label, edges);
  };
  for (std::size_t row = 0; row < static_cast<std::size_t>(image.rows); ++row) {
    const std::size_t first = patches.row_begin[row], last = patches.row_begin[row + 1] - 1;
    for (std::size_t i = first; i < last; ++i) meet(patches.runs[i], patches.runs[i + 1], 1);
    if (image.wraps) meet(patches.runs[last], patches.runs[first], 1);
    if (row + 1 < static_cast<std::size_t>(image.rows))
      touching(patches, row, [&](std::size_t a, std::size_t b, int overlap) {
        meet(patches.runs[a], patches.runs[b], overlap);
      });
  }
  return rims;
}

// What a small patch becomes: its own label when it stays. Ties go to the smaller label.
std::uint32_t replacement(std::uint32_t own, const Rim& rim) {
  std::uint32_t best = own;
  int most = 0;
  for (std::size_t k = 0; k < rim.label.size(); ++k)
    if (rim.edges[k] > most || (rim.edges[k] == most && most > 0 && rim.label[k] < best)) {
      most = rim.edges[k];
      best = rim.label[k];
    }
  return own == 0 && 4 * most < 3 * rim.total ? own : best;
}

enum class Kind { specks, holes };

void clean(const RangeImage& image, int least, Kind kind, std::vector<std::uint32_t>& labels,
           std::vector<LabelChange>& changes) {
  const Patches patches = find_patches(image, labels);
  std::vector<std::int64_t> size(patches.runs.size(), 0);
  for (const RowRun& run : patches.runs) size[run.patch] += run.end - run.begin;
  std::vector<std::uint32_t> slot(patches.runs.size(), kNoRim), owner;
  for (std::uint32_t i = 0; i < patches.runs.size(); ++i)
    if (patches.runs[i].patch == i && size[i] < least &&
        (patches.runs[i].label == 0) == (kind == Kind::holes)) {
      slot[i] = static_cast<std::uint32_t>(owner.size());
      owner.push_back(i);
    }
  const auto rims = find_rims(image, patches, slot, owner.size());
  for (const RowRun& run : patches.runs) {
    if (slot[run.patch] == kNoRim) continue;
    const std::uint32_t after = replacement(run.label, rims[slot[run.patch]]);
    if (after == run.label) continue;
    const std::size_t row = image.index(run.row, 0);
    const LabelChange change{row + static_cast<std::size_t>(run.begin),
                             row + static_cast<std::size_t>(run.end), run.label};
    std::fill_n(labels.begin() + static_cast<std::ptrdiff_t>(change.begin), change.end - change.begin, after);
    changes.push_back(change);
  }
}

}  // namespace

std::vector<LabelChange> clean_labels(const RangeImage& image, std::vector<std::uint32_t>& labels,
                                      int least) {
  std::vector<LabelChange> changes;
  if (image.count() == 0) return changes;
  clean(image, least, Kind::specks, labels, changes);
  clean(image, least, Kind::holes, labels, changes);
  return changes;
}

void restore_labels(const std::vector<LabelChange>& changes, std::vector<std::uint32_t>& labels) {
  for (auto change = changes.rbegin(); change != changes.rend(); ++change)
    std::fill_n(labels.begin() + static_cast<std::ptrdiff_t>(change->begin), change->end - change->begin,
                change->before);
}

}  // namespace hybrid::stages
