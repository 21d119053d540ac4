#include "cases/closest_point_tree_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
namespace {
struct Mesh196k : testing::ClosestPointTreeCase {
  static Input make(std::size_t size, std::uint32_t seed) {
    return testing::ClosestPointTreeCase::make(size, seed, 33);
  }
};
}  // namespace
const bool closest_point_tree_added = add<Mesh196k>("1M queries, 196020 triangles", 1'000'000);
}  // namespace hybrid::bench
