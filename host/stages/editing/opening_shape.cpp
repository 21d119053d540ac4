#include "stages/editing/opening_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

namespace hybrid::stages {
namespace {

constexpr double kSpare = 0.25;        // cells between the border and the samples beside it
constexpr double kMostCost = 4;        // cells that a sample on the wrong side costs at most
constexpr double kAttached = 0.01;     // of a sample before the face: what stands there may end elsewhere
constexpr double kTight = 0.1;         // samples that it costs to be larger: least where nothing bounds it
constexpr double kWrong = 0.5;         // cells on the wrong side that contradict
constexpr double kMoreWrong = 0.01;    // of the samples beside the border: that a shape may contradict more
constexpr double kBeside = 3;          // cells
constexpr double kSimpler = 0.0025;    // of them: that a lintel may contradict more than an arch
constexpr double kFirstStep_m = 0.2;   // of the search
constexpr double kNearBorder_m = 0.4;  // of the border: samples that the last search asks
constexpr std::size_t kCoarseMarks = 3000;  // that the first ones ask
constexpr double kFinest = 1.0 / 32;        // cells
constexpr double kLeastSize_m = 0.1;        // of a shape
constexpr double kSagitta_m = 0.001;        // of a chord that stands for a part of an arc
constexpr std::array<double, 6> kLeaps_m = {-0.2, -0.15, -0.1, 0.1, 0.15, 0.2};  // tried from the last fit
constexpr int kMostRounds = 60;                                                  // of one step's size
constexpr double kHeld = 3;  // cells: another's border that fits as well so far aside is not held

using Numbers = std::array<double, 5>;

// x from `left` to `right`; straight sides from `bottom` to `springing`, an arch from there to `top`. The
// arch is as high as half the span: round; higher: two arcs about points on the springing line; lower: one.
struct Arched {
  double left, right, bottom, springing, top;

  explicit Arched(const Numbers& n) : left(n[0]), right(n[1]), bottom(n[2]), springing(n[3]), top(n[4]) {}
  bool possible() const {
    return right - left > kLeastSize_m && springing - bottom > 0 && top >= springing &&
           top - bottom > kLeastSize_m && top - springing < 2 * (right - left);
  }
  double half() const { return 0.5 * (right - left); }
  // Of the right arc's centre: to the left of the middle, below the springing line; and its radius.
  Vec2 centre() const {
    const double rise = top - springing, w = half();
    if (rise >= w) return {(rise * rise - w * w) / (2 * w), 0};
    return {0, (w * w - rise * rise) / (2 * std::max(rise, 1e-6))};
  }
  double outside(const Vec2& p) const {
    const double across = std::abs(p.x() - 0.5 * (left + right)), sides = across - half();
    const double ends = std::max(bottom - p.y(), p.y() - top);
    if (p.y() <= springing || top - springing < 1e-6) return std::max(sides, ends);
    const Vec2 c = centre();
    const double radius = std::hypot(half() + c.x(), c.y());
    return std::max({sides, ends, std::hypot(across + c.x(), p.y() - springing + c.y()) - radius});
  }
  Ring2 ring() const {
    Ring2 result = {{left, bottom}, {right, bottom}};
    const double middle = 0.5 * (left + right);
    const Vec2 c = centre();
    const double radius = std::hypot(half() + c.x(), c.y());
    const double from = std::atan2(c.y(), half() + c.x()), to = std::atan2(top - springing + c.y(), c.x());
    const double chord = 2 * std::acos(1 - std::min(kSagitta_m / radius, 1.0));
    const int parts = top - springing < 1e-6 ? 0 : static_cast<int>(std::ceil((to - from) / chord));
    const auto place = [&](int k) {
      const double angle = from + (to - from) * k / std::max(parts, 1);
      return Vec2(radius * std::cos(angle) - c.x(), radius * std::sin(angle) - c.y() + springing);
    };
    for (int k = 0; k < parts; ++k) result.push_back(place(k) + Vec2(middle, 0));
    if (parts == 0) result.push_back({right, springing});
    if (parts > 0) result.push_back({middle, top});
    for (int k = parts; k-- > 0;) result.push_back({middle - place(k).x(), place(k).y()});
    if (parts == 0) result.push_back({left, springing});
    return result;
  }
  double size() const { return right - left + top - bottom; }
  static constexpr int kNumbers = 5;
};

struct Rectangle : Arched {
  explicit Rectangle(const Numbers& n) : Arched({n[0], n[1], n[2], n[3], n[3]}) {}
  static constexpr int kNumbers = 4;
};

struct Circle {
  Vec2 centre;
  double radius;

  explicit Circle(const Numbers& n) : centre(n[0], n[1]), radius(n[2]) {}
  bool possible() const { return radius > kLeastSize_m / 2; }
  double outside(const Vec2& p) const { return (p - centre).norm() - radius; }
  Ring2 ring() const {
    const double chord = 2 * std::acos(1 - std::min(kSagitta_m / radius, 1.0));
    const int parts = std::max(12, static_cast<int>(std::ceil(2 * std::numbers::pi / chord)));
    Ring2 result;
    for (int k = 0; k < parts; ++k) {
      const double angle = 2 * std::numbers::pi * k / parts;
      result.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
    }
    return result;
  }
  double size() const { return 4 * radius; }
  static constexpr int kNumbers = 3;
};

double outside_of(const Ring2& ring, const Vec2& p) {
  return distance_to_border(ring, p) * (inside(ring, p) ? -1 : 1);
}

// The border of another opening, moved.
struct Moved {
  const Ring2* design;
  Box2 box;
  Vec2 by;

  bool possible() const { return true; }
  double outside(const Vec2& p) const {
    const Vec2 at = p - by;
    const double far = std::max((box.low - at).maxCoeff(), (at - box.high).maxCoeff());
    return far > kNearBorder_m ? far : outside_of(*design, at);
  }
  double size() const { return 0; }
  static constexpr int kNumbers = 2;
};

template <typename Shape>
double cost(const Shape& shape, const std::vector<EvidenceMark>& marks, double cell_m) {
  if (!shape.possible()) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const EvidenceMark& mark : marks) {
    const double outside = shape.outside(mark.at.cast<double>());
    const double wrong = (mark.passes() ? outside : -outside) + kSpare * cell_m;
    if (wrong <= 0) continue;
    sum += (mark.kind == CellEvidence::attached ? kAttached : 1) * std::min(wrong, kMostCost * cell_m);
  }
  return sum + kTight * shape.size();
}

struct Fit {
  Numbers numbers;
  double cost;
};

template <typename Shape>
struct Made {
  Shape operator()(const Numbers& numbers) const { return Shape(numbers); }
};

// One number after the other, up and down, with ever smaller steps.
template <typename Shape, typename Make = Made<Shape>>
Fit search(const Numbers& start, double first_step_m, const std::vector<EvidenceMark>& marks, double cell_m,
           const Make& make = {}) {
  Fit fit{start, cost(make(start), marks, cell_m)};
  for (double step = first_step_m; step > kFinest * cell_m; step /= 2) {
    bool better = true;
    for (int round = 0; better && round < kMostRounds; ++round) {
      better = false;
      for (std::size_t k = 0; k < Shape::kNumbers; ++k)
        for (const double by : {step, -step}) {
          Numbers tried = fit.numbers;
          tried[k] += by;
          const double its = cost(make(tried), marks, cell_m);
          if (!(its < fit.cost)) continue;
          fit = {tried, its};
          better = true;
        }
    }
  }
  return fit;
}

// Samples that lie on the wrong side of a border, those before the face left aside.
template <typename Outside>
std::size_t contradictions(const std::vector<EvidenceMark>& marks, double cell_m, const Outside& outside) {
  return static_cast<std::size_t>(std::count_if(marks.begin(), marks.end(), [&](const EvidenceMark& mark) {
    if (mark.kind == CellEvidence::attached) return false;
    const double out = outside(mark.at.template cast<double>());
    return (mark.passes() ? out : -out) > kWrong * cell_m;
  }));
}

std::vector<EvidenceMark> thinned(const std::vector<EvidenceMark>& marks) {
  const std::size_t step = std::max<std::size_t>(1, (marks.size() + kCoarseMarks - 1) / kCoarseMarks);
  std::vector<EvidenceMark> few;
  for (std::size_t i = 0; i < marks.size(); i += step) few.push_back(marks[i]);
  return few;
}

template <typename Shape>
std::vector<EvidenceMark> near_border(const Shape& shape, const std::vector<EvidenceMark>& marks) {
  std::vector<EvidenceMark> near;
  for (const EvidenceMark& mark : marks)
    if (std::abs(shape.outside(mark.at.cast<double>())) < kNearBorder_m) near.push_back(mark);
  return near;
}

// Where something hides a part of an opening, the ring is only the largest piece: the search begins from
// larger ones too.
Fit coarse_arched(const Ring2& ring, const std::vector<EvidenceMark>& marks, double cell_m) {
  const Box2 box = box_of(ring);
  const Vec2 size = box.high - box.low;
  const Numbers start = {box.low.x(), box.high.x(), box.low.y(), box.high.y(), box.high.y()};
  Fit best{start, std::numeric_limits<double>::infinity()};
  const auto attempt = [&](const Numbers& from) {
    const Fit fit = search<Arched>(from, kFirstStep_m, marks, cell_m);
    if (fit.cost < best.cost) best = fit;
  };
  for (const double rise : {0.0, 0.25, 0.5, 0.75}) {  // of the width
    Numbers from = start;
    from[3] = std::max(box.high.y() - rise * size.x(), box.low.y() + 0.1 * size.y());
    attempt(from);
  }
  const Numbers alone = best.numbers;
  for (const double by : {0.5, 1.0})
    for (const std::size_t side : {0, 1, 2, 4}) {
      Numbers from = alone;
      from[side] += side == 0 || side == 2 ? -by : by;
      if (side == 4) from[3] += by;
      attempt(from);
    }
  return best;
}

// The shape fitted to all samples beside it, and what contradicts it.
template <typename Shape>
struct Fine {
  Shape shape;
  double contradictions;
};

template <typename Shape>
Fine<Shape> fine(const Numbers& start, const std::vector<EvidenceMark>& marks, double cell_m) {
  Fit fit = search<Shape>(start, 4 * cell_m, marks, cell_m);
  // What stands before the border, a door's leaf, costs more than the few samples behind it, up to its end.
  for (std::size_t k = 0; k < Shape::kNumbers; ++k)
    for (const double by : kLeaps_m) {
      Numbers tried = fit.numbers;
      tried[k] += by;
      if (!(cost(Shape(tried), marks, cell_m) < fit.cost)) continue;
      const Fit leapt = search<Shape>(tried, 4 * cell_m, marks, cell_m);
      if (leapt.cost < fit.cost) fit = leapt;
    }
  const Shape shape(fit.numbers);
  const auto wrong = contradictions(marks, cell_m, [&](const Vec2& p) { return shape.outside(p); });
  return {shape, shape.possible() ? static_cast<double>(wrong) : std::numeric_limits<double>::infinity()};
}

template <typename Shape>
std::optional<Ring2> judged(const Fit& coarse, const Ring2& ring, const std::vector<EvidenceMark>& all,
                            double cell_m) {
  const auto marks = near_border(Shape(coarse.numbers), all);
  const auto [shape, of_shape] = fine<Shape>(coarse.numbers, marks, cell_m);
  const auto of_ring = contradictions(marks, cell_m, [&](const Vec2& p) { return outside_of(ring, p); });
  const auto beside =
      std::count_if(marks.begin(), marks.end(), [&, &shape = shape](const EvidenceMark& mark) {
        return std::abs(shape.outside(mark.at.cast<double>())) < kBeside * cell_m;
      });
  if (of_shape > static_cast<double>(of_ring) + kMoreWrong * static_cast<double>(beside)) return std::nullopt;
  if constexpr (std::is_same_v<Shape, Arched>) {
    const auto flat = fine<Rectangle>(coarse.numbers, marks, cell_m);
    if (flat.contradictions <= of_shape + kSimpler * static_cast<double>(beside)) return flat.shape.ring();
  }
  return shape.ring();
}

}  // namespace

std::optional<Ring2> regular_border(const Ring2& ring, const std::vector<EvidenceMark>& marks,
                                    double cell_m) {
  const auto few = thinned(marks);
  const Box2 box = box_of(ring);
  const Vec2 middle = 0.5 * (box.low + box.high);
  const Fit arched = coarse_arched(ring, few, cell_m);
  const Fit circle = search<Circle>({middle.x(), middle.y(), 0.25 * (box.high - box.low).sum(), 0, 0},
                                    kFirstStep_m, few, cell_m);
  return circle.cost < arched.cost ? judged<Circle>(circle, ring, marks, cell_m)
                                   : judged<Arched>(arched, ring, marks, cell_m);
}

std::optional<LikeBorder> border_like(const Ring2& design, const Ring2& ring,
                                      const std::vector<EvidenceMark>& marks, double cell_m, Moves moves) {
  const Box2 box = box_of(design), piece = box_of(ring);
  const Vec2 low = piece.low - box.low, high = piece.high - box.high;
  if ((high - low).maxCoeff() > kHeld * cell_m) return std::nullopt;  // the piece is larger
  const bool level = moves == Moves::sideways;
  if (level && std::max(high.y(), -low.y()) > kHeld * cell_m) return std::nullopt;
  const auto moved = [&](const Numbers& n) { return Moved{&design, box, {n[0], level ? 0 : n[1]}}; };
  const auto few = thinned(marks);
  Fit fit{{}, std::numeric_limits<double>::infinity()};
  for (const double u : {low.x(), high.x()})
    for (const double v : {low.y(), high.y()}) {
      const Numbers start = {u, v, 0, 0, 0};
      const double its = cost(moved(start), few, cell_m);
      if (its < fit.cost) fit = {start, its};
    }
  fit = search<Moved>(fit.numbers, kFirstStep_m, few, cell_m, moved);
  std::vector<EvidenceMark> near;
  for (const EvidenceMark& mark : marks)
    if (moved(fit.numbers).outside(mark.at.cast<double>()) < kNearBorder_m) near.push_back(mark);
  fit = search<Moved>(fit.numbers, 4 * cell_m, near, cell_m, moved);
  const auto wrong = [&](const Numbers& numbers) {
    return static_cast<double>(
        contradictions(near, cell_m, [shape = moved(numbers)](const Vec2& p) { return shape.outside(p); }));
  };
  const double of_it = wrong(fit.numbers),
               of_ring = static_cast<double>(
                   contradictions(near, cell_m, [&](const Vec2&p) { return outside_of(ring, p); }));
  const double slack =
      kMoreWrong * static_cast<double>(std::count_if(near.begin(), near.end(), [&](const EvidenceMark& mark) {
        return std::abs(moved(fit.numbers).outside(mark.at.cast<double>())) < kBeside * cell_m;
      }));
  if (of_it > of_ring) return std::nullopt;
  for (std::size_t axis = 0; axis < (level ? 1 : 2); ++axis)
    for (const double by : {kHeld * cell_m, -kHeld * cell_m}) {
      Numbers aside = fit.numbers;
      aside[axis] += by;
      if (wrong(aside) <= of_it + slack) return std::nullopt;
    }
  LikeBorder like{{}, of_it};
  for (const Vec2& p : design) like.ring.push_back(p + moved(fit.numbers).by);
  return like;
}

}  // namespace hybrid::stages
