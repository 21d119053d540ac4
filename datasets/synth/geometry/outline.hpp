#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace synth {

using Vec2 = Eigen::Vector2d;

// How far a chord may lie off its arc: what is called curved must not be facets that a scan can tell apart.
inline constexpr double kSagitta_m = 0.0002;
// Chords for `angle` radians of an arc.
int pieces_of_arc(double radius, double angle);

// A simple ring, counter-clockwise. curve[k] tells the edge from point k on: 0 straight, else the number of
// the arc it is a piece of.
struct Outline {
  std::vector<Vec2> points;
  std::vector<int> curve;

  void line_to(const Vec2& p) {
    points.push_back(p);
    curve.push_back(0);
  }
  // Appends the arc's points from angle `from` to `to`, the last one left out; its edges are pieces of `arc`.
  void arc(const Vec2& centre, double radius, double from, double to, int arc);
};

Outline rectangle(double left, double bottom, double right, double top);
Outline circle(const Vec2& centre, double radius);
// Straight sides up to `springing`, closed by two arcs whose radius is `sharpness` times the width (0.5: one
// half circle).
Outline arched(double middle, double half_width, double bottom, double springing, double sharpness);
double apex(double half_width, double springing, double sharpness);

// Moved outwards everywhere (inwards where negative) with mitred corners.
Outline grown(const Outline&, double distance);
// Outward unit normals at the points, lengthened so that neighbours' offsets meet.
std::vector<Vec2> mitres(const std::vector<Vec2>& points, bool closed);

// Ear clipping; holes as counter-clockwise rings inside. Indices count the outline's points, then each
// hole's.
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Vec2>& outline,
                                                      const std::vector<std::vector<Vec2>>& holes);

}  // namespace synth
