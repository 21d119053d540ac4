#include "stages/registration/proxy_search.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace hybrid::stages {
namespace {

ClosestPointParams params_of(const Pose& local_from_scan, double gate_m, double normal_deg) {
  constexpr float kNoLimit = std::numeric_limits<float>::infinity();
  const bool any_normal = normal_deg < 0 || normal_deg >= 180;
  const Mat3 linear = local_from_scan.scale * local_from_scan.rotation.toRotationMatrix();
  ClosestPointParams params{};
  for (int k = 0; k < 9; ++k) params.linear[k] = static_cast<float>(linear(k / 3, k % 3));
  for (int k = 0; k < 3; ++k) params.translation[k] = static_cast<float>(local_from_scan.translation(k));
  params.gate2 = gate_m > 0 ? static_cast<float>(gate_m * gate_m) : kNoLimit;
  params.min_facing =
      any_normal ? -kNoLimit
                 : static_cast<float>(local_from_scan.scale * std::cos(normal_deg * std::numbers::pi / 180));
  return params;
}

}  // namespace

SearchAnswers::SearchAnswers(device::Queue& queue, std::size_t count)
    : distance(queue.array<float>(count)),
      height(queue.array<float>(count)),
      near_x(queue.array<float>(count)),
      near_y(queue.array<float>(count)),
      near_z(queue.array<float>(count)),
      triangle(queue.array<std::uint32_t>(count)) {}

ProxySearch::ProxySearch(device::Queue& queue, const ProxyModel& model, const Vec3& origin) : queue_(queue) {
  const ProxyTree tree = model.tree_at(origin);
  count_ = tree.triangles.size();
  root_ = tree.root;
  triangles_ = queue.array(tree.triangles);
  if (root_ != BVH_EMPTY) nodes_ = queue.array(tree.nodes);
}

void ProxySearch::find(const SearchQueries& queries, const Pose& local_from_scan, double gate_m,
                       double normal_deg, SearchAnswers& out) {
  ClosestPointParams params = params_of(local_from_scan, gate_m, normal_deg);
  params.queries = static_cast<std::uint32_t>(queries.count);
  params.triangles = static_cast<std::uint32_t>(count_);
  params.root = root_;
  const int lanes = queue_.vector_width();
  const int run = root_ == BVH_EMPTY ? 1 : packets_in_a_run(lanes);
  const auto width = static_cast<std::size_t>(lanes) * static_cast<std::size_t>(run);
  const auto items = device::grid((queries.count + width - 1) / width);
  if (root_ == BVH_EMPTY)
    queue_.launch("closest_point", queue_.kernel("closest_point", {{"VW", lanes}}), items, params, queries.x,
                  queries.y, queries.z, queries.nx, queries.ny, queries.nz, triangles_, out.distance,
                  out.height, out.triangle, out.near_x, out.near_y, out.near_z);
  else
    queue_.launch("closest_point_tree", queue_.kernel("closest_point_tree", {{"VW", lanes}, {"RUN", run}}),
                  items, params, queries.x, queries.y, queries.z, queries.nx, queries.ny, queries.nz,
                  triangles_, nodes_, out.distance, out.height, out.triangle, out.near_x, out.near_y,
                  out.near_z);
}

}  // namespace hybrid::stages
