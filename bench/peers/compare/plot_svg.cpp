#include "compare/plot_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hybrid::compare {
namespace {

constexpr double kLeft = 80, kTop = 50, kWidth = 560, kHeight = 400, kLabelGap = 15;
// Okabe and Ito's, told apart with any colour vision, and three more; black is ours.
constexpr std::array<const char*, 10> kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00",
                                                  "#56b4e9", "#7f7f7f", "#8c510a", "#54278f", "#808000"};

struct Axis {
  double low, high, start, length;
  double at(double value) const {
    return start + length * (std::log10(value) - std::log10(low)) / (std::log10(high) - std::log10(low));
  }
};

Axis axis_over(std::vector<double> values, double start, double length) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  // A little room, so that no point lies on the frame.
  return {*least / 1.3, *most * 1.3, start, length};
}

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string text_at(double x, double y, const std::string& text, const std::string& more) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, more, escaped(text));
}

std::string grid(const Axis& x, const Axis& y, const std::vector<double>& sizes) {
  std::string svg;
  for (double size : sizes) {
    svg += fmt::format("<path d=\"M{0:.1f} {1}V{2}\" class=\"grid\"/>\n", x.at(size), kTop, kTop + kHeight);
    svg += text_at(x.at(size), kTop + kHeight + 18, fmt::format("{:.3g}", size), "text-anchor=\"middle\"");
  }
  for (double decade = std::pow(10, std::floor(std::log10(y.low))); decade < y.high; decade *= 10)
    for (int step : {1, 2, 5}) {
      const double value = step * decade;
      if (value < y.low || value > y.high) continue;
      svg +=
          fmt::format("<path d=\"M{0} {1:.1f}H{2}\" class=\"grid\"/>\n", kLeft, y.at(value), kLeft + kWidth);
      svg += text_at(kLeft - 8, y.at(value) + 4,
                     value < 1 ? fmt::format("{:g}", value) : fmt::format("{:.0f}", value),
                     "text-anchor=\"end\"");
    }
  return svg;
}

std::string curve(const PlotLine& line, const std::string& colour, const Axis& x, const Axis& y) {
  std::string svg;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const auto& to = line.points[i];
    if (i > 0) {
      const auto& from = line.points[i - 1];
      svg += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n",
                         x.at(from.x), y.at(from.y), x.at(to.x), y.at(to.y), colour, line.ours ? 3.5 : 1.8,
                         to.guessed ? " stroke-dasharray=\"5 4\"" : "");
    }
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"2\"/>\n",
        x.at(to.x), y.at(to.y), line.ours ? 5 : 4, to.guessed ? "#ffffff" : colour, colour);
  }
  return svg;
}

// Labels beside the last points, moved apart where they would lie on one another.
std::string labels(const std::vector<PlotLine>& lines, const std::vector<std::string>& colours,
                   const Axis& y) {
  std::vector<std::pair<double, std::size_t>> places;
  for (std::size_t i = 0; i < lines.size(); ++i) places.emplace_back(y.at(lines[i].points.back().y), i);
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i)
    places[i].first = std::max(places[i].first, places[i - 1].first + kLabelGap);
  // Pushed past the frame's foot: back up from below.
  double limit = kTop + kHeight;
  for (std::size_t i = places.size(); i-- > 0; limit -= kLabelGap)
    places[i].first = std::min(places[i].first, limit);
  std::string svg;
  for (const auto& [place, i] : places)
    svg += text_at(kLeft + kWidth + 10, place + 4, lines[i].name,
                   fmt::format("fill=\"{}\"{}", colours[i], lines[i].ours ? " font-weight=\"bold\"" : ""));
  return svg;
}

}  // namespace

std::string svg_of(const Plot& plot) {
  std::vector<PlotLine> lines;
  for (const auto& line : plot.lines)
    if (!line.points.empty()) lines.push_back(line);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 940 520\" font-family=\"sans-serif\" "
      "font-size=\"13\">\n<style>.grid{{stroke:#dddddd;fill:none}} path{{fill:none}}</style>\n"
      "<rect width=\"940\" height=\"520\" fill=\"#ffffff\"/>\n");
  svg += text_at(kLeft, 28, plot.title, "font-size=\"17\"");
  if (lines.empty()) return svg + text_at(kLeft, 80, "nothing was measured", "") + "</svg>\n";
  std::vector<double> xs, ys;
  for (const auto& line : lines)
    for (const auto& point : line.points) xs.push_back(point.x), ys.push_back(point.y);
  const Axis x = axis_over(xs, kLeft, kWidth), y = axis_over(ys, kTop + kHeight, -kHeight);
  std::sort(xs.begin(), xs.end());
  // Sizes that nearly coincide (programs count their samples a little differently) share a grid line.
  xs.erase(std::unique(xs.begin(), xs.end(), [](double a, double b) { return b < 1.15 * a; }), xs.end());
  svg += grid(x, y, xs);
  svg +=
      fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#333333\"/>\n",
                  kLeft, kTop, kWidth, kHeight);
  svg += text_at(kLeft + kWidth / 2, kTop + kHeight + 42, plot.x_title, "text-anchor=\"middle\"");
  svg += text_at(
      0, 0, plot.y_title,
      fmt::format("text-anchor=\"middle\" transform=\"translate(22 {}) rotate(-90)\"", kTop + kHeight / 2));
  std::vector<std::string> colours;
  for (std::size_t i = 0, next = 0; i < lines.size(); ++i)
    colours.push_back(lines[i].ours ? "#000000" : kColours[next++ % kColours.size()]);
  for (std::size_t i = 0; i < lines.size(); ++i) svg += curve(lines[i], colours[i], x, y);
  return svg + labels(lines, colours, y) +
         text_at(kLeft, 508, "hollow, dashed: extrapolated from a smaller size",
                 "fill=\"#666666\" font-size=\"11\"") +
         "</svg>\n";
}

}  // namespace hybrid::compare
