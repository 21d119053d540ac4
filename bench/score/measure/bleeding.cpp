#include "score/measure/bleeding.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace score {
namespace {

using FivePoints = std::array<std::optional<TrueMesh::Hit>, 5>;  // the pixel's centre first

struct Judge {
  const Camera& camera;
  const std::vector<Camera>& photographs;
  const std::vector<std::uint8_t>& usable;
  const TrueMesh& mesh;

  std::optional<TrueMesh::Hit> centre(int col, int row) const {
    return mesh.first_hit(camera.eye, camera.ray(col + 0.5, row + 0.5));
  }

  FivePoints with_corners(int col, int row, const std::optional<TrueMesh::Hit>& middle) const {
    FivePoints points{middle};
    for (int k = 0; k < 4; ++k)
      points[static_cast<std::size_t>(k + 1)] =
          mesh.first_hit(camera.eye, camera.ray(col + k % 2, row + k / 2));
    return points;
  }

  bool sees(const Camera& photograph, const std::optional<TrueMesh::Hit>& point) const {
    return point && mesh.sees(photograph, *point);
  }

  bool any_sees(const std::optional<TrueMesh::Hit>& point) const {
    for (std::size_t j = 0; j < photographs.size(); ++j)
      if (usable[j] && sees(photographs[j], point)) return true;
    return false;
  }

  bool one_sees_all(const FivePoints& points) const {
    for (std::size_t j = 0; j < photographs.size(); ++j)
      if (usable[j] && std::all_of(points.begin(), points.end(),
                                   [&](const auto& point) { return sees(photographs[j], point); }))
        return true;
    return false;
  }
};

// Whether the view shows another surface than the true one: it lacks that, or has one before it. What shows
// instead may well be what its photograph sees.
bool drawn_elsewhere(const ViewResult& view, std::size_t i, const Camera& camera,
                     const std::optional<TrueMesh::Hit>& truth) {
  if (view.depth_m.empty()) return false;
  if (!truth) return true;
  const double depth_m = camera.world_from_camera.col(2).dot(truth->point - camera.eye);
  return !(std::abs(static_cast<double>(view.depth_m[i]) - depth_m) <= kDrawnOffM + kDrawnOffShare * depth_m);
}

void add(BleedingScore& sum, const BleedingScore& row) {
  for (auto field : {&BleedingScore::pixels, &BleedingScore::painted, &BleedingScore::bleeding,
                     &BleedingScore::bleeding_elsewhere, &BleedingScore::bleeding_at_centre,
                     &BleedingScore::red, &BleedingScore::red_though_seen, &BleedingScore::truly_unseen})
    sum.*field += row.*field;
}

}  // namespace

BleedingScore score_bleeding(const ViewResult& view, const Camera& camera,
                             const std::vector<Camera>& photographs, const std::vector<std::uint8_t>& usable,
                             const TrueMesh& mesh) {
  const Judge judge{camera, photographs, usable, mesh};
  std::vector<BleedingScore> rows(static_cast<std::size_t>(view.linear.height));
  tbb::parallel_for(0, view.linear.height, [&](int row) {
    BleedingScore& score = rows[static_cast<std::size_t>(row)];
    for (int col = 0; col < view.linear.width; ++col) {
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(view.linear.width) +
                     static_cast<std::size_t>(col);
      ++score.pixels;
      const auto middle = judge.centre(col, row);
      const bool painted = view.coverage[i] > 0 && view.best[i] < photographs.size();
      // Mostly the heaviest photograph is among those that see the point: one ray settles both questions.
      const bool right = painted && judge.sees(photographs[view.best[i]], middle);
      score.truly_unseen += middle && !(right && usable[view.best[i]]) && !judge.any_sees(middle);
      score.painted += painted;
      if (painted && !right) {
        ++score.bleeding_at_centre;
        const FivePoints points = judge.with_corners(col, row, middle);
        const bool bleeds = std::none_of(points.begin(), points.end(), [&](const auto& point) {
          return judge.sees(photographs[view.best[i]], point);
        });
        score.bleeding += bleeds;
        score.bleeding_elsewhere += bleeds && drawn_elsewhere(view, i, camera, middle);
      }
      if (view.id[i] != 0 && view.coverage[i] == 0) {
        ++score.red;
        score.red_though_seen += judge.one_sees_all(judge.with_corners(col, row, middle));
      }
    }
  });
  BleedingScore total;
  for (const BleedingScore& row : rows) add(total, row);
  return total;
}

}  // namespace score
