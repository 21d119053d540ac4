#include "stages/rendering/curtains.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/parallel.hpp"
#include "stages/rendering/column_backs.hpp"

namespace hybrid::stages {
namespace {

constexpr double kSteepestJump =
    10;                            // range over arc between samples of one surface: incidence of 84 degrees
constexpr int kReach = 3;          // nodes to the far surface: over mixed samples and missing ones
constexpr double kPiece_m = 0.05;  // that another scan may have seen to be empty
constexpr double kShortest_m = 0.05;  // shorter ones hide nothing
constexpr int kHiddenReach = 4;       // nodes down to what hides the foot of a thing
constexpr int kBesideHider = 32;      // nodes from it to where it may be seen beside that
constexpr double kHiddenJump = 3;     // range over arc, between the two
constexpr double kOwnHeight = 1.5;    // spacings: so far down a sample tells of its own surface
constexpr double kTallest_m = 1.5;    // of feet that are hidden
constexpr double kBeyondEnds = 1.5;   // radii: so far a column's base and head may go on
constexpr double kThinnest_m = 0.05, kThickest_m = 0.4;  // radius of what stands free and has a back
constexpr double kFlattest = 0.3;  // of the radius, by which its middle stands out at least

// What a node of a range image covers at its sample: along the columns, along the rows.
struct NodeArc {
  double high_m, wide_m;
  double longer_m() const { return std::max(high_m, wide_m); }
};

// One scan among all.
class Hanger {
 public:
  Hanger(const ScanSight& sight, const CurtainOptions& options, std::size_t own)
      : sight_(sight), options_(options), own_(own), scan_(sight.scans()[own]), image_(*scan_.image) {}

  std::vector<Curtain> row(int row) const {
    std::vector<Curtain> curtains;
    for (int col = 0; col < image_.cols; ++col)
      for (const auto& [down, across] : {std::pair{0, 1}, {0, -1}, {1, 0}, {-1, 0}})
        hang(row, col, down, across, curtains);
    for (int col = 0; col < image_.cols; ++col) {
      stand(row, col, curtains);
      close(row, col, curtains);
    }
    return curtains;
  }

  // Beyond its ends; its own back is known (column_backs.hpp).
  std::vector<Curtain> beyond_ends(const Cylinder& cylinder) const {
    std::vector<Curtain> curtains;
    if (cylinder.inside || !(cylinder.radius_m > 2 * options_.tolerance_m)) return curtains;
    const int slices = std::max(1, static_cast<int>(std::lround(cylinder.length_m / kColumnSlice_m)));
    const int more = static_cast<int>(kBeyondEnds * cylinder.radius_m * slices / cylinder.length_m);
    // What carries it, and what it carries, is as wide as it is, unless any scan says otherwise.
    const auto go_on = [&](int slice) {
      const auto pieces = ring(cylinder, slice, slices);
      for (const Curtain& piece : pieces)
        if (sight_.is_empty(centre(piece))) return false;
      curtains.insert(curtains.end(), pieces.begin(), pieces.end());
      return true;
    };
    for (int k = 1; k <= more && go_on(-k); ++k) continue;
    for (int k = 0; k < more && go_on(slices + k); ++k) continue;
    return curtains;
  }

 private:
  std::optional<std::size_t> node(int row, int col) const {
    col = image_.wrapped(col);
    if (row < 0 || col < 0 || row >= image_.rows || col >= image_.cols) return std::nullopt;
    return image_.index(row, col);
  }

  bool says(std::size_t i) const {
    const auto* stray = scan_.stray;
    return image_.mask[i] == kMeasured && (!stray || stray->empty() || !(*stray)[i]);
  }

  // The next sample that stands for a surface, in steps of one node.
  std::optional<std::size_t> beyond(int row, int col, int down, int across) const {
    for (int k = 1; k <= kReach; ++k) {
      const auto i = node(row + k * down, col + k * across);
      if (i && says(*i)) return i;
    }
    return std::nullopt;
  }

  bool one_surface(std::size_t a, std::size_t b) const {
    const auto* label = scan_.sample_label;
    return label && !label->empty() && (*label)[a] != 0 && (*label)[a] == (*label)[b];
  }

  void hang(int row, int col, int down, int across, std::vector<Curtain>& curtains) const {
    const std::size_t near = image_.index(row, col);
    if (!says(near)) return;
    const auto far = beyond(row, col, down, across);
    if (!far || one_surface(near, *far)) return;
    const Vec3 from = image_.point(near);
    const double begin_m = from.norm(), end_m = image_.point(*far).norm() - options_.tolerance_m;
    const NodeArc arc = arc_at(from);
    if (!(end_m - begin_m > std::max(kSteepestJump * arc.longer_m(), kShortest_m))) return;
    // The outline runs half-way to the next node.
    const Vec3 east = Vec3(-from.y(), from.x(), 0).normalized(), up = from.cross(east) / begin_m;
    const Vec3 node_east = arc.wide_m * east, node_up = arc.high_m * up;
    const Vec3 middle = from + 0.5 * (across * node_east - down * node_up);
    const Vec3 side = 0.5 * (across ? node_up : node_east);
    pieces(middle / begin_m, side / begin_m, begin_m, std::min(end_m, begin_m + options_.length_m), curtains);
  }

  // What has no flat side and goes on behind something nearer below it goes down to where it stands, as far
  // as no scan knows better.
  void stand(int row, int col, std::vector<Curtain>& curtains) const {
    const std::size_t own = image_.index(row, col);
    if (!says(own) || !is_of_no_plane(own)) return;
    const Vec3 point = image_.point(own);
    const double range_m = point.norm();
    const NodeArc arc = arc_at(point);
    const double jump_m = std::max(kHiddenJump * arc.longer_m(), kShortest_m);
    const auto hides = [&](int below) {
      const auto i = node(row + below, col);
      return i && says(*i) && image_.point(*i).norm() < range_m - jump_m;
    };
    int below = 1;  // mixed samples may be between
    while (below <= kHiddenReach && !hides(below)) ++below;
    if (below > kHiddenReach || is_beside_a_plane(row, col, range_m, jump_m) ||
        goes_on_beside(row + below, col, range_m, jump_m))
      return;
    const Vec3 top = scan_.world_from_scan * point, along = top - scan_.world_from_scan.translation;
    const Vec3 side =
        arc.wide_m * Vec3(-along.y(), along.x(), 0).normalized();  // over its neighbours' halves, too
    const auto down = [&](double pieces) { return Vec3(top - pieces * kPiece_m * Vec3::UnitZ()); };
    const int first = static_cast<int>(std::ceil(kOwnHeight * arc.high_m / kPiece_m));
    int count = first;
    while (count * kPiece_m < kTallest_m && sight_.known(down(count + 0.5)) == ScanSight::Known::no) ++count;
    if (count > first) curtains.push_back({top - side, top + side, down(count) + side, down(count) - side});
  }

  // Whether what is seen on this side of a node is behind the thing that it is the last sample of.
  bool ends_at(int row, int col, int across) const {
    const Vec3 point = image_.point(image_.index(row, col));
    const auto far = beyond(row, col, 0, across);
    return far && image_.point(*far).norm() - point.norm() >
                      std::max(kSteepestJump * arc_at(point).longer_m(), kShortest_m);
  }

  NodeArc arc_at(const Vec3& point) const {
    return {point.norm() * image_.elevation_step_rad(), point.head<2>().norm() * image_.azimuth_step_rad()};
  }

  // The samples from this one on to the other outline of what stands free and has no flat side; or none.
  std::vector<Vec3> from_outline(int row, int col) const {
    std::vector<Vec3> across;
    std::size_t at = image_.index(row, col);
    if (!says(at) || !is_of_no_plane(at) || !ends_at(row, col, -1)) return across;
    while (across.size() < static_cast<std::size_t>(image_.cols)) {  // a scanner may stand inside a thing
      const Vec3 point = image_.point(at);
      across.push_back(scan_.world_from_scan * point);
      if ((across.back() - across.front()).norm() > 2 * kThickest_m) return {};
      const auto next = beyond(row, col, 0, 1);
      if (!next) return {};
      const double jump_m = image_.point(*next).norm() - point.norm(),
                   steepest_m = kSteepestJump * arc_at(point).longer_m();
      if (jump_m > steepest_m) return across;
      if (jump_m < -steepest_m || !is_of_no_plane(*next)) return {};
      at = *next;
      col = static_cast<int>(at % static_cast<std::size_t>(image_.cols));
    }
    return {};
  }

  // What stands free and is round is as deep as it is wide, and behind as it is before: a cylinder whose
  // nearest line and whose two outlines are seen is thicker by their angle.
  void close(int row, int col, std::vector<Curtain>& curtains) const {
    const std::vector<Vec3> front = from_outline(row, col);
    if (front.size() < 3) return;
    const Vec3& scanner = scan_.world_from_scan.translation;
    const auto level = [](Vec3 along) {
      along.z() = 0;
      return along;
    };
    const Vec3 left = level(front.front() - scanner).normalized(),
               right = level(front.back() - scanner).normalized(), away = (left + right).normalized();
    double nearest_m = std::numeric_limits<double>::max(), farthest_m = 0;
    for (const Vec3& point : front) {
      nearest_m = std::min(nearest_m, away.dot(point - scanner));
      farthest_m = std::max(farthest_m, away.dot(point - scanner));
    }
    const double sine = std::sin(std::acos(std::min(1.0, away.dot(left))) + 0.5 * image_.azimuth_step_rad());
    const double radius_m = nearest_m * sine / (1 - sine);
    if (radius_m < kThinnest_m || radius_m > kThickest_m || farthest_m - nearest_m < kFlattest * radius_m)
      return;
    const Vec3 centre = scanner + (nearest_m + radius_m) * away;
    const Vec3 half = 0.5 * image_.elevation_step_rad() * (front[0] - scanner).norm() * Vec3::UnitZ();
    for (std::size_t k = 0; k + 1 < front.size(); ++k) {
      const auto behind = [&](std::size_t at) -> Vec3 { return front[at] + 2 * level(centre - front[at]); };
      const Vec3 from = behind(k), to = behind(k + 1);
      if (sight_.known(0.5 * (from + to)) == ScanSight::Known::no)
        curtains.push_back({from - half, to - half, to + half, from + half});
    }
  }

  // As at its border, where mixed samples are; what the plane itself does is for shadow_faces to say.
  bool is_beside_a_plane(int row, int col, double range_m, double jump_m) const {
    for (const int up : {0, 1})
      for (const int across : {-1, 0, 1}) {
        const auto i = node(row - up, col + across);
        if (i && says(*i) && !is_of_no_plane(*i) && std::abs(image_.point(*i).norm() - range_m) <= jump_m)
          return true;
      }
    return false;
  }

  // Whether what is hidden from this node down is seen beside that which hides it: a wall behind a post.
  bool goes_on_beside(int row, int col, double range_m, double jump_m) const {
    for (const int across : {-1, 1})
      for (int k = 1; k <= kBesideHider; ++k) {
        const auto i = node(row, col + k * across);
        if (!i || !says(*i)) continue;
        const double beside_m = image_.point(*i).norm();
        if (beside_m < range_m - jump_m) continue;
        if (beside_m <= range_m + jump_m && is_of_no_plane(*i)) return true;
        break;
      }
    return false;
  }

  bool is_of_no_plane(std::size_t i) const {
    const auto* label = scan_.sample_label;
    return label && !label->empty() && (*label)[i] == 0;
  }

  void pieces(const Vec3& middle, const Vec3& side, double begin_m, double end_m,
              std::vector<Curtain>& curtains) const {
    const Pose& world = scan_.world_from_scan;
    const int count = std::max(1, static_cast<int>(std::ceil((end_m - begin_m) / kPiece_m)));
    const auto at = [&](int k) { return begin_m + (end_m - begin_m) * k / count; };
    int first = 0;
    for (int k = 0; k <= count; ++k) {
      if (k < count && !sight_.is_empty(world * Vec3(0.5 * (at(k) + at(k + 1)) * middle), own_)) continue;
      if (k > first) {
        const auto corner = [&](int end, double sign) {
          return Vec3(world * Vec3(at(end) * (middle + sign * side)));
        };
        curtains.push_back({corner(first, -1), corner(first, 1), corner(k, 1), corner(k, -1)});
      }
      first = k + 1;
    }
  }

  static Vec3 centre(const Curtain& piece) { return 0.25 * (piece[0] + piece[1] + piece[2] + piece[3]); }

  // Around a cylinder between two of the heights that divide it, world frame; also below and above it.
  std::vector<Curtain> ring(const Cylinder& cylinder, int slice, int slices) const {
    const Pose& world = scan_.world_from_scan;
    const auto corner = [&](int height, double side) {
      return Vec3(world * on_cylinder(cylinder, cylinder.length_m * height / slices,
                                      2 * std::numbers::pi * side / kColumnSides, -options_.tolerance_m));
    };
    std::vector<Curtain> pieces;
    for (int side = 0; side < kColumnSides; ++side)
      pieces.push_back({corner(slice, side), corner(slice, side + 1), corner(slice + 1, side + 1),
                        corner(slice + 1, side)});
    return pieces;
  }

  const ScanSight& sight_;
  const CurtainOptions& options_;
  std::size_t own_;
  const SightScan& scan_;
  const RangeImage& image_;
};

}  // namespace

std::vector<Curtain> hang_curtains(const std::vector<SightScan>& scans, const CurtainOptions& options) {
  const ScanSight sight(scans, options.tolerance_m);
  std::vector<Curtain> curtains;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const Hanger hanger(sight, options, s);
    std::vector<std::vector<Curtain>> rows(static_cast<std::size_t>(scans[s].image->rows));
    parallel_for(rows.size(), [&](std::size_t row) { rows[row] = hanger.row(static_cast<int>(row)); });
    for (const auto& row : rows) curtains.insert(curtains.end(), row.begin(), row.end());
    if (scans[s].cylinders == nullptr) continue;
    for (const Cylinder& cylinder : *scans[s].cylinders) {
      const auto pieces = hanger.beyond_ends(cylinder);
      curtains.insert(curtains.end(), pieces.begin(), pieces.end());
    }
  }
  return curtains;
}

}  // namespace hybrid::stages
