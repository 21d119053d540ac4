#include "stages/editing/opening_border.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hybrid::stages {
namespace {

constexpr double kCoarse = 1.5;  // cells that the border may be off an edge that is tried as straight
constexpr double kStraight_m = 0.25, kStraightCells = 7;  // an edge from this length on may be straight
constexpr double kBow = 0.5;            // cells that the border may bow over its length then
constexpr double kFine = 0.4;           // cells that curved parts may move when vertices go
constexpr int kSmooth = 3;              // vertices on either side whose mean a curve's vertex takes
constexpr double kAxisDeg = 10;         // an edge so near an axis is parallel to it
constexpr double kEdgeReach = 3;        // cells on either side that speak for an edge's place
constexpr double kWorse = 0.02;         // share of wrong samples that an axis may cost
constexpr std::size_t kLeastMarks = 8;  // on both sides together

struct Line {
  Vec2 normal;  // to the right of the edge: outwards
  double offset;
};

// Samples beside the inner part of an edge, by their distance to the right of it; true: passed.
std::vector<std::pair<double, bool>> beside(const Vec2& a, const Vec2& b, const Vec2& normal,
                                            const std::vector<EvidenceMark>& marks, double cell_m) {
  const Vec2 along(-normal.y(), normal.x()), middle = 0.5 * (a + b);
  const double half = 0.5 * std::abs(along.dot(b - a)) - cell_m;
  std::vector<std::pair<double, bool>> found;
  for (const EvidenceMark& mark : marks) {
    const Vec2 arm = mark.at.cast<double>() - middle;
    const double across = normal.dot(arm);
    if (std::abs(across) > kEdgeReach * cell_m || std::abs(along.dot(arm)) > half) continue;
    found.emplace_back(across, mark.passes());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// The distance that leaves the fewest samples on the wrong side, in the middle of the gap; and that share.
struct Split {
  double at = 0, wrong = 1;
};
std::optional<Split> best_split(const std::vector<std::pair<double, bool>>& sorted) {
  std::size_t passed = 0, closed = 0;
  for (const auto& [d, open] : sorted) (open ? passed : closed)++;
  if (passed + closed < kLeastMarks || passed < 3 || closed < 3) return std::nullopt;
  // All that passes beyond the split and all that is closed before it is wrong.
  std::size_t wrong = passed, best = sorted.size() + 1;
  double first = 0, last = 0;
  for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
    wrong = sorted[i].second ? wrong - 1 : wrong + 1;
    if (wrong < best) {
      best = wrong;
      first = sorted[i].first;
      last = sorted[i + 1].first;
    } else if (wrong == best && sorted[i].first == last) {
      last = sorted[i + 1].first;
    }
  }
  return Split{0.5 * (first + last), static_cast<double>(best) / static_cast<double>(sorted.size())};
}

Line fitted_line(const Vec2& a, const Vec2& b, const std::vector<EvidenceMark>& marks, double cell_m) {
  const Vec2 edge = b - a;
  const Vec2 own = Vec2(edge.y(), -edge.x()).normalized();  // right of the edge
  const auto own_split = best_split(beside(a, b, own, marks, cell_m));
  Vec2 axis = own;
  const double sine = std::sin(kAxisDeg * M_PI / 180);
  if (std::abs(own.x()) < sine) axis = Vec2(0, own.y() > 0 ? 1 : -1);
  if (std::abs(own.y()) < sine) axis = Vec2(own.x() > 0 ? 1 : -1, 0);
  const double middle_own = own.dot(0.5 * (a + b)), middle_axis = axis.dot(0.5 * (a + b));
  const auto split = best_split(beside(a, b, axis, marks, cell_m));
  if (split && (!own_split || split->wrong <= own_split->wrong + kWorse))
    return Line{axis, middle_axis + split->at};
  if (own_split) return Line{own, middle_own + own_split->at};
  return Line{own, middle_own};
}

Vec2 onto(const Line& line, const Vec2& p) {
  return p - (line.normal.dot(p) - line.offset) * line.normal;
}

std::optional<Vec2> meet(const Line& a, const Line& b) {
  const double cross = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
  if (std::abs(cross) < 0.3) return std::nullopt;
  return Vec2((a.offset * b.normal.y() - b.offset * a.normal.y()) / cross,
              (b.offset * a.normal.x() - a.offset * b.normal.x()) / cross);
}

// A part of the border: from one coarse vertex to the next.
struct Section {
  Ring2 points;  // with both ends
  std::optional<Line> line;
};

// Whether points along a chord neither bow nor stray: least squares of offset = a + b t + c t^2, t from -1 to
// 1; a circle's chord bows by c.
bool is_straight(const Ring2& points, double cell_m) {
  const Vec2 &from = points.front(), &to = points.back();
  const double length = (to - from).norm();
  if (length < std::max(kStraight_m, kStraightCells * cell_m) || points.size() < 6) return false;
  const Vec2 along = (to - from) / length, normal(along.y(), -along.x());
  Mat3 sums = Mat3::Zero();
  Vec3 rights = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double t = 2 * along.dot(points[i] - from) / length - 1;
    const Vec3 row(1, t, t * t);
    sums += row * row.transpose();
    rights += normal.dot(points[i] - from) * row;
  }
  const Vec3 fit = sums.ldlt().solve(rights);
  return std::abs(fit(2)) < kBow * cell_m;
}

std::vector<Section> sections_of(const Ring2& ring, const std::vector<EvidenceMark>& marks, double cell_m) {
  const auto kept = vertices_kept(ring, kCoarse * cell_m);
  std::vector<Section> sections;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    Section section;
    const std::size_t end = kept[(k + 1) % kept.size()];
    for (std::size_t i = kept[k];; i = (i + 1) % ring.size()) {
      section.points.push_back(ring[i]);
      if (i == end && section.points.size() > 1) break;
    }
    if (is_straight(section.points, cell_m)) {
      // Sampling rounds corners off: the ends say little about the line.
      const std::size_t trim = std::min<std::size_t>(2, section.points.size() / 4);
      section.line =
          fitted_line(section.points[trim], section.points[section.points.size() - 1 - trim], marks, cell_m);
    }
    sections.push_back(std::move(section));
  }
  return sections;
}

// Curves as the mean of neighbouring vertices, so that single samples do not show.
Ring2 smoothed(const Ring2& ring) {
  Ring2 result;
  const auto n = static_cast<int>(ring.size());
  for (int i = 0; i < n; ++i) {
    Vec2 sum = Vec2::Zero();
    for (int k = -kSmooth; k <= kSmooth; ++k) sum += ring[static_cast<std::size_t>((i + k + n) % n)];
    result.push_back(sum / (2 * kSmooth + 1));
  }
  return result;
}

// Corner of two lines with `between` left out, where it lies near what it replaces.
std::optional<Vec2> corner(const Line& a, const Line& b, const Vec2& near, double cell_m) {
  const auto point = meet(a, b);
  return point && (*point - near).norm() < 5 * cell_m ? point : std::nullopt;
}

double length_of(const Ring2& points) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) length += (points[i + 1] - points[i]).norm();
  return length;
}

// Whether a short section between two lines is what sampling left of their corner, or a notch in one line
// that nothing but missing samples speaks for.
bool is_remnant(const Section& before, const Section& section, const Section& after,
                const std::vector<EvidenceMark>& marks, double cell_m) {
  const Vec2 middle = 0.5 * (section.points.front() + section.points.back());
  if (corner(*before.line, *after.line, middle, cell_m)) return length_of(section.points) < 6 * cell_m;
  const bool same_line = before.line->normal.dot(after.line->normal) > 0.99 &&
                         std::abs(before.line->offset - after.line->offset) < 2 * cell_m;
  if (!same_line || length_of(section.points) > 1.0) return false;
  Ring2 notch = section.points;
  const bool inwards = signed_area(notch) < 0;  // the straight way would add the notch to the opening
  const auto contrary = std::count_if(marks.begin(), marks.end(), [&](const EvidenceMark& mark) {
    return mark.passes() != inwards && inside(notch, mark.at.cast<double>());
  });
  return contrary <= 2;
}

void drop_remnants(std::vector<Section>& sections, const std::vector<EvidenceMark>& marks, double cell_m) {
  for (std::size_t i = 0; sections.size() > 3 && i < sections.size();) {
    const std::size_t n = sections.size();
    const Section &before = sections[(i + n - 1) % n], &after = sections[(i + 1) % n];
    if (!sections[i].line && before.line && after.line &&
        is_remnant(before, sections[i], after, marks, cell_m))
      sections.erase(sections.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
}

// The sections joined: lines meet in corners, curves begin and end on the lines beside them.
Ring2 joined(const std::vector<Section>& sections, double cell_m) {
  Ring2 result;
  const std::size_t n = sections.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Section &in = sections[(i + n - 1) % n], &out = sections[i];
    const Vec2 joint = 0.5 * (in.points.back() + out.points.front());
    if (in.line && out.line) {
      if (const auto point = corner(*in.line, *out.line, joint, cell_m)) {
        result.push_back(*point);
      } else {
        result.push_back(onto(*in.line, in.points.back()));
        result.push_back(onto(*out.line, out.points.front()));
      }
    } else if (in.line || out.line) {
      result.push_back(onto(in.line ? *in.line : *out.line, joint));
    } else {
      result.push_back(joint);
    }
    if (out.line) continue;
    Ring2 curve = out.points;
    for (const std::size_t k : vertices_kept(curve, kFine * cell_m))
      if (k > 0 && k + 1 < curve.size()) result.push_back(curve[k]);
  }
  return result;
}

}  // namespace

Ring2 straightened_border(const Ring2& ring, const std::vector<EvidenceMark>& marks, double cell_m) {
  // What is straight is told from the border itself, what is curved is drawn without its noise.
  auto sections = sections_of(ring, marks, cell_m);
  const Ring2 soft = smoothed(ring);
  const auto kept = vertices_kept(ring, kCoarse * cell_m);
  for (std::size_t k = 0; k < sections.size(); ++k)
    if (!sections[k].line)
      for (std::size_t i = 0; i < sections[k].points.size(); ++i)
        sections[k].points[i] = soft[(kept[k] + i) % ring.size()];
  drop_remnants(sections, marks, cell_m);
  Ring2 result = sections.size() < 2 ? simplified(soft, kFine * cell_m) : joined(sections, cell_m);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  if (result.size() > 1 && result.front() == result.back()) result.pop_back();
  if (result.size() >= 3 && !self_crossing(result) && signed_area(result) > 0) return result;
  const Ring2 simple = simplified(ring, kFine * cell_m);
  return simple.size() < 3 || self_crossing(simple) ? ring : simple;
}

}  // namespace hybrid::stages
