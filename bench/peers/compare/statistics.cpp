#include "compare/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hybrid::compare {

double median(std::vector<double> values) {
  if (values.empty()) throw std::invalid_argument("median of no values");
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

double extrapolate(const std::vector<Sized>& known, double samples) {
  if (known.empty()) throw std::invalid_argument("extrapolation from no size");
  const Sized& last = known.back();
  double power = 1;
  if (known.size() > 1) {
    const Sized& before = known[known.size() - 2];
    if (before.samples < last.samples && before.value > 0 && last.value > 0)
      power = std::log(last.value / before.value) / std::log(last.samples / before.samples);
  }
  return last.value * std::pow(samples / last.samples, std::clamp(power, 1.0, 2.0));
}

std::string three_digits(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  const int whole = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  return fmt::format("{:.{}f}", value, std::clamp(3 - whole, 0, 9));
}

std::string ratio_text(double seconds, double ours_s) {
  return ours_s > 0 ? three_digits(seconds / ours_s) + " x" : "-";
}

}  // namespace hybrid::compare
