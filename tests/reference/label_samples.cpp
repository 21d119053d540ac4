#include "cases/label_samples_case.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

namespace hybrid::testing {
namespace {

struct Rival {
  double residual;  // along the ray, m
  std::uint32_t label;
};

}  // namespace

LabelSamplesCase::Expected LabelSamplesCase::reference(const Input& input) {
  const auto& params = input.params;
  Expected out;
  for (std::size_t i = 0; i < input.x.size(); ++i) {
    const Eigen::Vector3d p(input.x[i], input.y[i], input.z[i]);
    const std::size_t row = params.first_row + i / params.cols, col = params.first_col + i % params.cols;
    const std::size_t square = row / params.square * params.square_cols + col / params.square;
    double margin = std::numeric_limits<double>::infinity();
    std::vector<Rival> rivals;
    const auto measure = [&](const Eigen::Vector3d& normal, double offset, std::uint32_t label, bool gated) {
      const double cosine = std::max<double>(std::abs(normal.dot(p.normalized())), params.min_cosine);
      const double distance = std::abs(normal.dot(p) - offset);
      const double slack = params.noise_m * cosine + params.waviness_m - distance;
      if (gated) margin = std::min(margin, std::abs(slack));
      if (!gated || slack >= 0) rivals.push_back({distance / cosine, label});
    };
    if (!p.hasNaN()) {
      for (int k = 0; k < LABEL_CANDIDATES; ++k) {
        const std::uint32_t id = input.candidates[square * LABEL_CANDIDATES + static_cast<std::size_t>(k)];
        if (id == 0) break;
        const LabelPlane& plane = input.planes[id - 1];
        measure(Eigen::Vector3f(plane.normal).cast<double>(), plane.offset, plane.label, true);
      }
      const auto& own = input.own_plane[square];
      if (!rivals.empty() && (own[0] != 0 || own[1] != 0 || own[2] != 0))
        measure({own[0], own[1], own[2]}, own[3], 0, false);
    }
    std::stable_sort(rivals.begin(), rivals.end(), [](auto& a, auto& b) { return a.residual < b.residual; });
    for (std::size_t k = 1; k < rivals.size(); ++k)
      if (rivals[k].label != rivals[0].label) {
        margin = std::min(margin, rivals[k].residual - rivals[0].residual);
        break;
      }
    out.labels.push_back(rivals.empty() ? 0 : rivals[0].label);
    out.margin.push_back(margin);
  }
  return out;
}

}  // namespace hybrid::testing
