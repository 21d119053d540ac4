#include "stages/contour_mask.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

// Equal labels in a row, columns [begin, end).
struct Run {
  int row, begin, end;
  std::uint32_t label, patch;
};

struct Patches {
  std::vector<Run> runs;                // row by row, left to right
  std::vector<std::size_t> row_begin;   // rows + 1
  std::vector<std::uint32_t> parent;    // union-find over runs

  std::uint32_t root(std::uint32_t run) {
    while (parent[run] != run) run = parent[run] = parent[parent[run]];
    return run;
  }
  void join(std::size_t a, std::size_t b) {
    const std::uint32_t x = root(static_cast<std::uint32_t>(a)), y = root(static_cast<std::uint32_t>(b));
    parent[std::max(x, y)] = std::min(x, y);  // the root is the first run: no dependence on order
  }
};

void find_runs(const RangeImage& image, const std::vector<std::uint32_t>& labels, Patches& patches) {
  std::vector<std::vector<Run>> rows(static_cast<std::size_t>(image.rows));
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
    const Run &upper = patches.runs[a], &lower = patches.runs[b];
    const int overlap = std::min(upper.end, lower.end) - std::max(upper.begin, lower.begin);
    if (overlap > 0) body(a, b, overlap);
    if (upper.end <= lower.end) ++a;
    if (lower.end <= upper.end) ++b;
  }
}

Patches find_patches(const RangeImage& image, const std::vector<std::uint32_t>& labels) {
  Patches patches;
  find_runs(image, labels, patches);
  patches.parent.resize(patches.runs.size());
  std::iota(patches.parent.begin(), patches.parent.end(), 0u);
  for (std::size_t row = 0; row < static_cast<std::size_t>(image.rows); ++row) {
    const std::size_t first = patches.row_begin[row], last = patches.row_begin[row + 1] - 1;
    if (image.wraps && patches.runs[first].label == patches.runs[last].label) patches.join(first, last);
    if (row + 1 == static_cast<std::size_t>(image.rows)) continue;
    touching(patches, row, [&](std::size_t a, std::size_t b, int) {
      if (patches.runs[a].label == patches.runs[b].label) patches.join(a, b);
    });
  }
  for (std::size_t i = 0; i < patches.runs.size(); ++i)
    patches.runs[i].patch = patches.root(static_cast<std::uint32_t>(i));
  return patches;
}

// Rim of every small patch: edges by the label on the other side.
using Rim = std::map<std::uint32_t, std::int64_t>;

std::map<std::uint32_t, Rim> find_rims(const RangeImage& image, const Patches& patches,
                                       const std::vector<std::int64_t>& size, int least) {
  std::map<std::uint32_t, Rim> rims;
  const auto add = [&](const Run& from, std::uint32_t other, int edges) {
    if (size[from.patch] < least) rims[from.patch][other] += edges;
  };
  const auto meet = [&](const Run& a, const Run& b, int edges) {
    if (a.patch == b.patch) return;
    add(a, b.label, edges);
    add(b, a.label, edges);
  };
  for (std::size_t row = 0; row < static_cast<std::size_t>(image.rows); ++row) {
    const std::size_t first = patches.row_begin[row], last = patches.row_begin[row + 1] - 1;
    for (std::size_t i = first; i < last; ++i) meet(patches.runs[i], patches.runs[i + 1], 1);
    if (image.wraps) {
      meet(patches.runs[last], patches.runs[first], 1);
    } else {
      add(patches.runs[first], 0, 1);
      add(patches.runs[last], 0, 1);
    }
    if (row == 0 || row + 1 == static_cast<std::size_t>(image.rows))
      for (std::size_t i = first; i <= last; ++i)
        add(patches.runs[i], 0, patches.runs[i].end - patches.runs[i].begin);
    if (row + 1 < static_cast<std::size_t>(image.rows))
      touching(patches, row, [&](std::size_t a, std::size_t b, int overlap) {
        meet(patches.runs[a], patches.runs[b], overlap);
      });
  }
  return rims;
}

// What a small patch becomes; its own label when it stays.
std::uint32_t replacement(std::uint32_t label, const Rim& rim, bool holes) {
  std::uint32_t best = 0;
  std::int64_t most = 0, total = 0;
  for (const auto& [other, edges] : rim) {
    total += edges;
    if (edges > most) {
      most = edges;
      best = other;
    }
  }
  return holes && 4 * most < 3 * total ? label : best;
}

// One pass over the specks (holes = false) or over the holes.
void clean(const RangeImage& image, int least, bool holes, std::vector<std::uint32_t>& labels) {
  const Patches patches = find_patches(image, labels);
  std::vector<std::int64_t> size(patches.runs.size(), 0);
  for (const Run& run : patches.runs) size[run.patch] += run.end - run.begin;
  // Patches of the other kind are made large, so that they collect no rim.
  for (const Run& run : patches.runs)
    if ((run.label == 0) != holes) size[run.patch] = least;
  std::map<std::uint32_t, std::uint32_t> becomes;
  for (const auto& [patch, rim] : find_rims(image, patches, size, least))
    becomes[patch] = replacement(patches.runs[patch].label, rim, holes);
  for (const Run& run : patches.runs)
    if (const auto found = becomes.find(run.patch); found != becomes.end())
      std::fill_n(labels.begin() + static_cast<std::ptrdiff_t>(image.index(run.row, run.begin)),
                  run.end - run.begin, found->second);
}

}  // namespace

std::vector<std::uint32_t> clean_labels(const RangeImage& image, const std::vector<std::uint32_t>& labels,
                                        int least) {
  std::vector<std::uint32_t> cleaned = labels;
  if (image.count() == 0) return cleaned;
  clean(image, least, false, cleaned);
  clean(image, least, true, cleaned);
  return cleaned;
}

}  // namespace hybrid::stages
