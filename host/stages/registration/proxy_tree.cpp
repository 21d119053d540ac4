#include "stages/registration/proxy_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "stages/registration/proxy_triangles.hpp"

namespace hybrid::stages {
namespace {

// Roundings of a float that height, foot point and side tests may pile up.
constexpr float kRoundings = 4e-6f;
constexpr float kSpanSteps = 31;  // of a normal's component in 5 bits
struct Box {
  std::array<float, 3> low{INFINITY, INFINITY, INFINITY};
  std::array<float, 3> high{-INFINITY, -INFINITY, -INFINITY};
  std::array<float, 3> least_normal{INFINITY, INFINITY, INFINITY};
  std::array<float, 3> greatest_normal{-INFINITY, -INFINITY, -INFINITY};

  void add(const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
      least_normal[k] = std::min(least_normal[k], other.least_normal[k]);
      greatest_normal[k] = std::max(greatest_normal[k], other.greatest_normal[k]);
    }
  }
};

TriangleRecord corners_of(const ProxyTriangle& t, std::size_t index) {
  TriangleRecord record{};
  record.id = static_cast<std::uint32_t>(index);
  for (std::size_t k = 0; k < 3; ++k) {
    record.a[k] = t.a[k];
    record.b[k] = t.a[k] + t.ab[k];
    record.c[k] = t.a[k] + t.ac[k];
  }
  return record;
}

// How far the closest point that the kernel finds may lie from the triangle: off its plane, where the face's
// common one stands for it, and by rounding. Feet on the plane are surely inside (closest_triangle.h).
float margin_of(const ProxyTriangle& t, const TriangleRecord& corners) {
  float off = 0, reach = std::abs(t.offset), longest2 = 0;
  for (const float* corner : {corners.a, corners.b, corners.c}) {
    float height = -t.offset;
    for (std::size_t k = 0; k < 3; ++k) {
      height += t.normal[k] * corner[k];
      reach = std::max(reach, std::abs(corner[k]));
    }
    off = std::max(off, std::abs(height));
  }
  for (const float inverse : {t.inverse_ab2, t.inverse_bc2, t.inverse_ca2})
    longest2 = std::max(longest2, 1 / inverse);
  return 2 * off + kRoundings * (reach + std::sqrt(longest2));
}

Box box_of(const ProxyTriangle& t) {
  const TriangleRecord corners = corners_of(t, 0);
  const float margin = margin_of(t, corners);
  Box box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = std::min({corners.a[k], corners.b[k], corners.c[k]}) - margin;
    box.high[k] = std::max({corners.a[k], corners.b[k], corners.c[k]}) + margin;
    box.least_normal[k] = box.greatest_normal[k] = t.normal[k];
  }
  return box;
}

std::uint32_t span_of(const Box& box) {
  std::uint32_t span = 0;
  const auto code = [](float steps) {
    return static_cast<std::uint32_t>(std::clamp(steps, 0.0f, kSpanSteps));
  };
  // A hundredth of a step outwards, so that rounding keeps nothing out.
  for (std::size_t k = 0; k < 3; ++k) {
    const float low = (box.least_normal[k] + 1) / 2 * kSpanSteps,
                high = (box.greatest_normal[k] + 1) / 2 * kSpanSteps;
    span |= code(std::floor(low - 0.01f)) << (10 * k);
    span |= code(std::ceil(high + 0.01f)) << (10 * k + 5);
  }
  return span;
}

// Appends the nodes below `code`, depth first. Returns the final code.
std::uint32_t flatten(const BinaryTree& tree, std::uint32_t code, ProxyTreePlan& plan) {
  if (code & BVH_LEAF) return code;
  const std::size_t index = plan.children.size();
  plan.children.emplace_back();
  for (std::size_t side = 0; side < 2; ++side) {
    const std::uint32_t child = flatten(tree, tree.nodes[code].children[side], plan);
    plan.children[index][side] = child;
  }
  return static_cast<std::uint32_t>(index);
}

}  // namespace

ProxyTreePlan plan_proxy_tree(const BinaryTree& tree) {
  ProxyTreePlan plan;
  plan.order = tree.triangle_order;
  if (tree.root != BVH_EMPTY) plan.root = flatten(tree, tree.root, plan);
  return plan;
}

ProxyTree make_proxy_tree(const ProxyTreePlan& plan, std::vector<ProxyTriangle> ordered) {
  ProxyTree tree{std::move(ordered), std::vector<ProxyNode>(plan.children.size()), plan.root};
  std::vector<Box> boxes(tree.triangles.size()), of_nodes(tree.nodes.size());
  parallel_for(
      boxes.size(), [&](std::size_t i) { boxes[i] = box_of(tree.triangles[i]); }, kTriangleBatch);
  const auto box_below = [&](std::uint32_t code) {
    if (!(code & BVH_LEAF)) return of_nodes[code];
    Box box;
    const std::size_t begin = code & BVH_FIRST_MASK;
    const std::size_t count = ((code >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1;
    for (std::size_t i = begin; i < begin + count; ++i) box.add(boxes[i]);
    return box;
  };
  // Children come after their node.
  for (std::size_t k = tree.nodes.size(); k-- > 0;) {
    ProxyNode& node = tree.nodes[k];
    node.child0 = plan.children[k][0], node.child1 = plan.children[k][1];
    const Box first = box_below(node.child0), second = box_below(node.child1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      node.low0[axis] = first.low[axis], node.high0[axis] = first.high[axis];
      node.low1[axis] = second.low[axis], node.high1[axis] = second.high[axis];
    }
    node.span0 = span_of(first), node.span1 = span_of(second);
    of_nodes[k].add(first);
    of_nodes[k].add(second);
  }
  return tree;
}

ProxyTree make_proxy_tree(const std::vector<ProxyTriangle>& triangles) {
  std::vector<TriangleRecord> corners(triangles.size());
  parallel_for(
      triangles.size(), [&](std::size_t i) { corners[i] = corners_of(triangles[i], i); }, kTriangleBatch);
  const ProxyTreePlan plan = plan_proxy_tree(build_binary_tree(corners, {}));
  std::vector<ProxyTriangle> ordered(triangles.size());
  parallel_for(
      triangles.size(), [&](std::size_t i) { ordered[i] = triangles[plan.order[i]]; }, kTriangleBatch);
  return make_proxy_tree(plan, std::move(ordered));
}

}  // namespace hybrid::stages
