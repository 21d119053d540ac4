#include "stages/editing/opening_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/parallel.hpp"

namespace hybrid::stages {
namespace {

constexpr double kFinest_m = 0.01, kCoarsest_m = 0.1;
constexpr double kMostCells = 4e6;
constexpr float kReach = 4;              // cells without evidence that an open area may span
constexpr double kInnerRadius_m = 0.05;  // of a circle that fits into an opening
constexpr float kFar = 1e18f;

using Mask = std::vector<std::uint8_t>;

std::size_t at(int row, int col, int cols) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
}

// Lower envelope of parabolas along one line of squared distances.
void pass_line(std::vector<float>& f, std::vector<int>& v, std::vector<float>& z, std::vector<float>& out) {
  const int n = static_cast<int>(f.size());
  int k = -1;
  const auto meet = [&](int q, int p) {
    const auto Q = static_cast<double>(q), P = static_cast<double>(p);
    return static_cast<float>(((static_cast<double>(f[static_cast<std::size_t>(q)]) + Q * Q) -
                               (static_cast<double>(f[static_cast<std::size_t>(p)]) + P * P)) /
                              (2 * Q - 2 * P));
  };
  for (int q = 0; q < n; ++q) {
    if (f[static_cast<std::size_t>(q)] >= kFar) continue;
    float s = -std::numeric_limits<float>::infinity();
    while (k >= 0 && (s = meet(q, v[static_cast<std::size_t>(k)])) <= z[static_cast<std::size_t>(k)]) --k;
    if (k < 0) s = -std::numeric_limits<float>::infinity();
    ++k;
    v[static_cast<std::size_t>(k)] = q;
    z[static_cast<std::size_t>(k)] = s;
  }
  if (k < 0) {
    std::fill(out.begin(), out.end(), kFar);
    return;
  }
  int j = 0;
  for (int q = 0; q < n; ++q) {
    while (j < k && z[static_cast<std::size_t>(j) + 1] < static_cast<float>(q)) ++j;
    const float d = static_cast<float>(q - v[static_cast<std::size_t>(j)]);
    out[static_cast<std::size_t>(q)] = d * d + f[static_cast<std::size_t>(v[static_cast<std::size_t>(j)])];
  }
}

Mask mask_of(const FaceEvidence& face, CellEvidence kind) {
  Mask mask(face.cells.size());
  std::transform(face.cells.begin(), face.cells.end(), mask.begin(),
                 [&](CellEvidence e) { return static_cast<std::uint8_t>(e == kind); });
  return mask;
}

// Cells that rays pass, and those a little behind the face that are connected to them through gaps of one
// cell: reveals belong to their opening, dents of a wall to nothing.
Mask passed_cells(const FaceEvidence& face) {
  Mask open = mask_of(face, CellEvidence::through);
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < open.size(); ++i)
    if (open[i]) front.push_back(i);
  const int most_steps = static_cast<int>(std::ceil(0.3 / face.cell_m));
  for (int step = 0; step < most_steps && !front.empty(); ++step) {
    std::vector<std::size_t> next;
    for (const std::size_t i : front) {
      const int row = static_cast<int>(i) / face.cols, col = static_cast<int>(i) % face.cols;
      for (int r = std::max(0, row - 2); r <= std::min(face.rows - 1, row + 2); ++r)
        for (int c = std::max(0, col - 2); c <= std::min(face.cols - 1, col + 2); ++c) {
          const std::size_t j = at(r, c, face.cols);
          if (open[j] || face.cells[j] != CellEvidence::behind) continue;
          open[j] = 1;
          next.push_back(j);
        }
    }
    front = std::move(next);
  }
  return open;
}

Mask rasterised(const FaceEvidence& face, const std::vector<Ring2>& rings) {
  Mask mask(face.cells.size());
  parallel_for(static_cast<std::size_t>(face.rows), [&](std::size_t row) {
    for (int col = 0; col < face.cols; ++col)
      mask[at(static_cast<int>(row), col, face.cols)] =
          on_face(rings, face.cell_m * Vec2(col + 0.5, static_cast<double>(row) + 0.5));
  });
  return mask;
}

// What is open, as a field whose zero is the border: positive inside, in cells.
struct OpenField {
  std::vector<float> height;
  Mask inside;
};

OpenField open_field(const FaceEvidence& face, const std::vector<Ring2>& rings) {
  const Mask open = passed_cells(face);
  Mask closed = mask_of(face, CellEvidence::closed);
  const Mask attached = mask_of(face, CellEvidence::attached);
  for (std::size_t i = 0; i < closed.size(); ++i) closed[i] = closed[i] || attached[i];
  const auto to_open = distance_to_set(open, face.cols, face.rows);
  const auto to_closed = distance_to_set(closed, face.cols, face.rows);
  // Gaps between passing rays are closed where nothing speaks against it.
  Mask beyond(open.size());
  for (std::size_t i = 0; i < open.size(); ++i) beyond[i] = to_open[i] > kReach;
  const auto to_beyond = distance_to_set(beyond, face.cols, face.rows);
  const Mask on = rasterised(face, rings);
  OpenField field{std::vector<float>(open.size()), Mask(open.size())};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const float half_way = std::clamp((to_closed[i] - to_open[i]) / 2, -2.0f, 2.0f);
    const bool spanned = to_open[i] <= kReach && (to_beyond[i] > kReach || to_closed[i] <= kReach);
    const bool in = on[i] && spanned && half_way > 0;
    field.inside[i] = in;
    field.height[i] = in ? half_way : std::min(half_way, -0.5f);
  }
  return field;
}

struct Component {
  std::vector<std::size_t> cells;
};

std::vector<Component> components_of(const Mask& inside, int cols, int rows) {
  std::vector<Component> found;
  Mask seen(inside.size(), 0);
  for (std::size_t start = 0; start < inside.size(); ++start) {
    if (!inside[start] || seen[start]) continue;
    Component component{{start}};
    seen[start] = 1;
    for (std::size_t k = 0; k < component.cells.size(); ++k) {
      const int row = static_cast<int>(component.cells[k]) / cols,
                col = static_cast<int>(component.cells[k]) % cols;
      const int steps[4][2] = {{0, 1}, {0, -1}, {1, 0}, {-1, 0}};
      for (const auto& step : steps) {
        const int r = row + step[0], c = col + step[1];
        if (r < 0 || c < 0 || r >= rows || c >= cols) continue;
        const std::size_t j = at(r, c, cols);
        if (!inside[j] || seen[j]) continue;
        seen[j] = 1;
        component.cells.push_back(j);
      }
    }
    found.push_back(std::move(component));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.cells.size() > b.cells.size(); });
  return found;
}

// The longest zero line of `field` around the cells of `own` (marching squares over cell centres; outside the
// grid and in other areas the field is negative). Counter-clockwise.
Ring2 outer_zero_line(const std::vector<float>& field, const Mask& own, const FaceEvidence& face) {
  const int cols = face.cols, rows = face.rows;
  const auto height = [&](int row, int col) {
    if (row < 0 || col < 0 || row >= rows || col >= cols) return -0.5f;
    const std::size_t i = at(row, col, cols);
    return own[i] ? field[i] : std::min(field[i], -0.25f);
  };
  // Crossings are keyed by the lower left cell of their edge and its direction; each is left for one other.
  using Key = std::pair<std::int64_t, int>;  // cell, 0: to the right, 1: upwards
  const std::int64_t width = cols + 2;
  const auto key = [&](int row, int col, int direction) {
    return Key{(static_cast<std::int64_t>(row) + 1) * width + col + 1, direction};
  };
  const auto place = [&](int row, int col, int direction) {
    const float a = height(row, col), b = height(row + (direction == 1), col + (direction == 0));
    const double t = static_cast<double>(a / (a - b));
    return Vec2(face.cell_m * (col + 0.5 + (direction == 0 ? t : 0)),
                face.cell_m * (row + 0.5 + (direction == 1 ? t : 0)));
  };
  std::map<Key, std::pair<Key, Vec2>> next;  // from a crossing to the following one; its place
  for (int row = -1; row < rows; ++row)
    for (int col = -1; col < cols; ++col) {
      const bool a = height(row, col) > 0, b = height(row, col + 1) > 0, c = height(row + 1, col + 1) > 0,
                 d = height(row + 1, col) > 0;
      if (a == b && b == c && c == d) continue;
      // Edges of the square, counter-clockwise: bottom ab, right bc, top dc, left ad. The line keeps the
      // inside to its left: it enters where, walking around, outside becomes inside... and leaves at the
      // crossing that the inside corners end at.
      const std::array<bool, 4> corner = {a, b, c, d};
      const std::array<Key, 4> edge = {key(row, col, 0), key(row, col + 1, 1), key(row + 1, col, 0),
                                       key(row, col, 1)};
      const std::array<Vec2, 4> where = {place(row, col, 0), place(row, col + 1, 1), place(row + 1, col, 0),
                                         place(row, col, 1)};
      for (std::size_t k = 0; k < 4; ++k) {
        // A run of inside corners that begins after edge k: in at the run's end, out at its beginning.
        if (corner[k] || !corner[(k + 1) % 4]) continue;
        std::size_t end = (k + 1) % 4;
        while (corner[(end + 1) % 4]) end = (end + 1) % 4;
        next[edge[end]] = {edge[k], where[end]};
      }
    }
  Ring2 best;
  while (!next.empty()) {
    Ring2 ring;
    Key from = next.begin()->first;
    for (auto found = next.find(from); found != next.end(); found = next.find(from)) {
      ring.push_back(found->second.second);
      from = found->second.first;
      next.erase(found);
    }
    if (signed_area(ring) < 0) continue;  // around an island
    if (signed_area(ring) > signed_area(best)) best = std::move(ring);
  }
  return best;
}

}  // namespace

std::vector<float> distance_to_set(const std::vector<std::uint8_t>& set, int cols, int rows) {
  std::vector<float> squared(set.size());
  std::transform(set.begin(), set.end(), squared.begin(), [](std::uint8_t s) { return s ? 0.0f : kFar; });
  const auto lines = [&](int count, int length, int step, int apart) {
    parallel_for(static_cast<std::size_t>(count), [&](std::size_t line) {
      const auto n = static_cast<std::size_t>(length);
      std::vector<float> f(n), z(n + 1), out(n);
      std::vector<int> v(n);
      const std::size_t first = line * static_cast<std::size_t>(apart);
      for (std::size_t i = 0; i < n; ++i) f[i] = squared[first + i * static_cast<std::size_t>(step)];
      pass_line(f, v, z, out);
      for (std::size_t i = 0; i < n; ++i) squared[first + i * static_cast<std::size_t>(step)] = out[i];
    });
  };
  lines(rows, cols, 1, cols);
  lines(cols, rows, cols, 1);
  for (float& s : squared) s = s >= kFar ? std::numeric_limits<float>::infinity() : std::sqrt(s);
  return squared;
}

void fill_grid(const std::vector<EvidenceMark>& marks, const std::vector<Ring2>& rings,
               const FaceFrame& frame, double spacing_m, FaceEvidence& face) {
  face.cell_m = std::clamp(spacing_m, kFinest_m, kCoarsest_m);
  face.cell_m = std::max(face.cell_m, std::sqrt(frame.size.x() * frame.size.y() / kMostCells));
  face.cols = std::max(1, static_cast<int>(std::ceil(frame.size.x() / face.cell_m)));
  face.rows = std::max(1, static_cast<int>(std::ceil(frame.size.y() / face.cell_m)));
  const std::size_t count = static_cast<std::size_t>(face.cols) * static_cast<std::size_t>(face.rows);
  std::vector<std::array<std::uint16_t, 4>> votes(count, {0, 0, 0, 0});
  for (const EvidenceMark& mark : marks) {
    const int col = static_cast<int>(mark.at.x() / face.cell_m),
              row = static_cast<int>(mark.at.y() / face.cell_m);
    if (mark.at.x() < 0 || mark.at.y() < 0 || col >= face.cols || row >= face.rows) continue;
    auto& vote = votes[at(row, col, face.cols)][static_cast<std::size_t>(mark.kind) - 1];
    if (vote < 65535) ++vote;
  }
  face.cells.assign(count, CellEvidence::none);
  const Mask on = rasterised(face, rings);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [closed, attached, behind, through] = votes[i];
    if (!on[i]) continue;
    if (through > 0 && through + behind > closed)
      face.cells[i] = CellEvidence::through;
    else if (behind > closed)
      face.cells[i] = CellEvidence::behind;
    else if (closed > 0)
      face.cells[i] = CellEvidence::closed;
    else if (attached > 0)
      face.cells[i] = CellEvidence::attached;
  }
}

std::vector<OpenArea> open_areas(const FaceEvidence& face, const std::vector<Ring2>& rings, double least_m2) {
  const OpenField field = open_field(face, rings);
  std::vector<OpenArea> areas;
  Mask outside(field.inside.size());
  std::transform(field.inside.begin(), field.inside.end(), outside.begin(),
                 [](std::uint8_t in) { return static_cast<std::uint8_t>(!in); });
  const auto to_outside = distance_to_set(outside, face.cols, face.rows);
  for (const Component& component : components_of(field.inside, face.cols, face.rows)) {
    const bool wide = std::any_of(component.cells.begin(), component.cells.end(), [&](std::size_t i) {
      return to_outside[i] * face.cell_m >= kInnerRadius_m;
    });
    if (!wide && static_cast<double>(component.cells.size()) * face.cell_m * face.cell_m < least_m2) continue;
    Mask own(field.inside.size(), 0);
    for (const std::size_t i : component.cells) own[i] = 1;
    areas.push_back({outer_zero_line(field.height, own, face), wide});
  }
  return areas;
}

std::vector<float> distance_to_closed(const FaceEvidence& face) {
  std::vector<std::uint8_t> closed(face.cells.size());
  std::transform(face.cells.begin(), face.cells.end(), closed.begin(), [](CellEvidence e) {
    return static_cast<std::uint8_t>(e == CellEvidence::closed || e == CellEvidence::attached);
  });
  return distance_to_set(closed, face.cols, face.rows);
}

}  // namespace hybrid::stages
