#include "stages/proxy_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "stages/bvh_collapse.hpp"

namespace hybrid::stages {
namespace {

// Roundings of a float that height, foot point and side tests may pile up.
constexpr float kRounding = 2e-6f;
constexpr float kSpanSteps = 31;  // of a normal's component in 5 bits
constexpr std::size_t kBatch = 4096;

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
// common one stands for it, and beyond an acute corner, where rounding decides which side a foot is on.
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
  const float x = t.ab[1] * t.ac[2] - t.ab[2] * t.ac[1], y = t.ab[2] * t.ac[0] - t.ab[0] * t.ac[2],
              z = t.ab[0] * t.ac[1] - t.ab[1] * t.ac[0];
  const float doubled_area = std::sqrt(x * x + y * y + z * z);
  const float acute = doubled_area > 0 ? std::min(longest2 / doubled_area, 1e6f) : 1e6f;
  return 2 * off + kRounding * (reach + std::sqrt(longest2)) * (2 + acute);
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

// Appends the nodes below `code`, depth first, with boxes and spans of their own; `box` is what all of it
// spans. Returns the final code.
std::uint32_t flatten(const BinaryTree& tree, std::uint32_t code, const std::vector<Box>& boxes,
                      std::vector<ProxyNode>& nodes, Box& box) {
  if (code & BVH_LEAF) {
    const std::size_t begin = code & BVH_FIRST_MASK;
    const std::size_t count = ((code >> BVH_COUNT_SHIFT) & BVH_COUNT_MASK) + 1;
    for (std::size_t i = begin; i < begin + count; ++i) box.add(boxes[i]);
    return code;
  }
  const std::size_t index = nodes.size();
  nodes.emplace_back();
  Box first, second;
  const std::uint32_t child0 = flatten(tree, tree.nodes[code].children[0], boxes, nodes, first),
                      child1 = flatten(tree, tree.nodes[code].children[1], boxes, nodes, second);
  ProxyNode& node = nodes[index];
  for (std::size_t k = 0; k < 3; ++k) {
    node.low0[k] = first.low[k], node.high0[k] = first.high[k];
    node.low1[k] = second.low[k], node.high1[k] = second.high[k];
  }
  node.child0 = child0, node.child1 = child1;
  node.span0 = span_of(first), node.span1 = span_of(second);
  box.add(first);
  box.add(second);
  return static_cast<std::uint32_t>(index);
}

}  // namespace

ProxyTree make_proxy_tree(const std::vector<ProxyTriangle>& triangles) {
  std::vector<TriangleRecord> corners(triangles.size());
  parallel_for(
      triangles.size(), [&](std::size_t i) { corners[i] = corners_of(triangles[i], i); }, kBatch);
  const BinaryTree binary = build_binary_tree(corners, {});
  ProxyTree tree;
  tree.triangles.resize(triangles.size());
  std::vector<Box> boxes(triangles.size());
  parallel_for(
      triangles.size(),
      [&](std::size_t i) {
        tree.triangles[i] = triangles[binary.order[i]];
        boxes[i] = box_of(tree.triangles[i]);
      },
      kBatch);
  Box whole;
  if (binary.root != BVH_EMPTY) tree.root = flatten(binary, binary.root, boxes, tree.nodes, whole);
  return tree;
}

}  // namespace hybrid::stages
