#pragma once
#include <string>
#include <vector>

namespace hybrid::compare {

struct PlotLine {
  std::string name;
  bool ours = false;
  struct Point {
    double x, y;
    bool guessed;  // extrapolated: hollow, reached by a dashed line
  };
  std::vector<Point> points;  // ascending in x; x and y positive
};

struct Plot {
  std::string title, x_title, y_title;
  std::vector<PlotLine> lines;
};

// A self-contained SVG with both axes logarithmic and every line labelled at its right end (ours thick).
std::string svg_of(const Plot& plot);

}  // namespace hybrid::compare
