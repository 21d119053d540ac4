#include "report/histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hybrid::report {
namespace {

constexpr double kLeft = 10, kStep = 24, kTop = 16, kBarsHeight = 120;

std::string metres(double value_m) {
  if (value_m < 0.01 - 1e-9) return fmt::format("{:.3g} mm", value_m * 1000);
  return value_m < 1 - 1e-9 ? fmt::format("{:.3g} cm", value_m * 100) : fmt::format("{:.3g} m", value_m);
}

}  // namespace

std::string residual_plot(const Json& residuals) {
  const auto counts = residuals["counts"].get<std::vector<std::int64_t>>();
  const double from_m = residuals["from_m"].get<double>();
  const int per_decade = residuals["per_decade"].get<int>();
  std::int64_t all = residuals["without_face"].get<std::int64_t>(), most = 1;
  for (const auto count : counts) {
    all += count;
    most = std::max(most, count);
  }
  const double width = 2 * kLeft + kStep * (static_cast<double>(counts.size()) + 2);
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" role=\"img\" aria-label=\"histogram of the "
      "distances\">\n",
      width, kTop + kBarsHeight + 22);
  const auto bar = [&](double place, std::int64_t count, const std::string& name, const char* kind) {
    const double height = kBarsHeight * static_cast<double>(count) / static_cast<double>(most);
    const double share = all > 0 ? 100 * static_cast<double>(count) / static_cast<double>(all) : 0;
    svg += fmt::format(
        "<rect{} x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"><title>{}: {} samples, {:.2f} "
        "%</title></rect>\n",
        kind, place + 1, kTop + kBarsHeight - height, kStep - 2, height, name, count, share);
    if (share >= 10)
      svg += fmt::format(
          "<text class=\"quiet\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.0f}%</text>\n",
          place + kStep / 2, kTop + kBarsHeight - height - 4, share);
  };
  const auto edge = [&](std::size_t i) { return from_m * std::pow(10, static_cast<double>(i) / per_decade); };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::string name = i == 0                   ? "below " + metres(from_m)
                             : i + 1 == counts.size() ? "above " + metres(edge(i - 1))
                                                      : metres(edge(i - 1)) + " to " + metres(edge(i));
    bar(kLeft + kStep * static_cast<double>(i), counts[i], name, "");
    if (i > 0 && (i - 1) % static_cast<std::size_t>(per_decade) == 0)
      svg +=
          fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                      kLeft + kStep * static_cast<double>(i), kTop + kBarsHeight + 16, metres(edge(i - 1)));
  }
  const double last = kLeft + kStep * (static_cast<double>(counts.size()) + 1);
  bar(last, residuals["without_face"].get<std::int64_t>(), "no face of a similar direction near",
      " class=\"second\"");
  svg += fmt::format("<text class=\"quiet\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">none</text>\n",
                     last + kStep / 2, kTop + kBarsHeight + 16);
  return svg + fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/></svg>\n", kLeft,
                           width - kLeft, kTop + kBarsHeight, kTop + kBarsHeight);
}

}  // namespace hybrid::report
