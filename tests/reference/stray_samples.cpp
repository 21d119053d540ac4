#include "cases/stray_samples_case.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

namespace hybrid::testing {
namespace {

using Offset = std::pair<int, int>;  // rows and columns from the sample asked

// Measured points around a sample, the sample itself at (0, 0).
using Window = std::map<Offset, Eigen::Vector3d>;

double arc(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * std::min(a.norm(), b.norm());
}

// All thresholds times 1 + margin towards calling a sample stray.
bool isolated(const Window& window, const StraySamplesParams& p, double margin) {
  const Eigen::Vector3d& centre = window.at({0, 0});
  int near = 0;
  for (const auto& [offset, point] : window)
    if (offset != Offset{0, 0})
      near += std::abs(point.norm() - centre.norm()) <=
              (double{p.noise_m} + double{p.steep} * arc(centre, point)) * (1 - margin);
  const auto measured = window.size() - 1;
  return measured >= p.least_neighbours &&
         near < double{p.min_near_share} * static_cast<double>(measured) * (1 + margin * 1e-3);
}

bool between(const Window& window, const StraySamplesParams& p, double margin) {
  const Eigen::Vector3d& centre = window.at({0, 0});
  for (const Offset& step : {Offset{0, 1}, Offset{1, 0}, Offset{1, 1}, Offset{1, -1}}) {
    const auto beside = [&](int sign) {
      const auto first = window.find({sign * step.first, sign * step.second});
      return first != window.end() ? first : window.find({2 * sign * step.first, 2 * sign * step.second});
    };
    auto low = beside(-1), high = beside(1);
    if (low == window.end() || high == window.end()) continue;
    if (low->second.norm() > high->second.norm()) std::swap(low, high);
    const auto off = [&](const Eigen::Vector3d& point) {
      return (double{p.noise_m} + double{p.gap} * arc(centre, point)) * (1 - margin);
    };
    if (centre.norm() - low->second.norm() > off(low->second) &&
        high->second.norm() - centre.norm() > off(high->second))
      return true;
  }
  return false;
}

bool planar(const Window& window, const StraySamplesParams& p, double margin) {
  const Eigen::Vector3d& centre = window.at({0, 0});
  const auto beside = [](const Offset& o) { return std::max(std::abs(o.first), std::abs(o.second)) == 1; };
  for (const auto& [oa, a] : window)
    for (const auto& [ob, b] : window) {
      if (!beside(oa) || !beside(ob) || !(oa < ob)) continue;
      const Eigen::Vector3d ta = a.normalized() - centre.normalized(),
                            tb = b.normalized() - centre.normalized();
      if (ta.cross(tb).norm() < 0.3 * (1 + margin) * ta.norm() * tb.norm()) continue;
      const Eigen::Vector3d normal = (a - centre).cross(b - centre).normalized();
      int on = 0;
      for (const auto& [offset, point] : window)
        if (offset != Offset{0, 0})
          on += std::abs(normal.dot(point - centre)) <=
                p.plane_tolerance_m *
                    std::max(std::abs(normal.dot(point.normalized())), double{p.min_cosine}) * (1 - margin);
      if (on >= double{p.min_planar_share} * static_cast<double>(window.size() - 1)) return true;
    }
  return false;
}

int answer(const Window& window, const StraySamplesParams& p, double margin) {
  if (isolated(window, p, margin)) return STRAY_ISOLATED;
  return between(window, p, margin) && !planar(window, p, margin) ? STRAY_BETWEEN : STRAY_NONE;
}

}  // namespace

StraySamplesCase::Expected StraySamplesCase::reference(const Input& input) {
  const auto& p = input.params;
  const std::size_t width = p.cols + 2 * STRAY_WINDOW;
  Expected expected;
  for (std::size_t i = 0; i < input.label.size(); ++i) {
    Window window;
    for (int row = -STRAY_WINDOW; row <= STRAY_WINDOW; ++row)
      for (int col = -STRAY_WINDOW; col <= STRAY_WINDOW; ++col) {
        const std::size_t from = (i / p.cols + static_cast<std::size_t>(STRAY_WINDOW + row)) * width +
                                 i % p.cols + static_cast<std::size_t>(STRAY_WINDOW + col);
        const Eigen::Vector3d point(input.x[from], input.y[from], input.z[from]);
        if (point.allFinite()) window[{row, col}] = point;
      }
    if (input.label[i] != 0 || !window.contains({0, 0})) {
      expected.push_back(1 << STRAY_NONE);
      continue;
    }
    int answers = 0;
    for (const double margin : {-kMargin, 0.0, kMargin}) answers |= 1 << answer(window, p, margin);
    expected.push_back(static_cast<std::uint8_t>(answers));
  }
  return expected;
}

}  // namespace hybrid::testing
