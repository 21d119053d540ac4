#include "cases/closest_point_tree_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
namespace {

struct Mesh196k : testing::ClosestPointTreeCase {
  static Input make(std::size_t size, std::uint32_t seed) {
    return testing::ClosestPointTreeCase::make(size, seed, 33);
  }
};

// From how many triangles on the tree is the faster one (kTreeFrom).
template <std::size_t kTriangles>
struct FewByTree : testing::ClosestPointTreeCase {
  static Input make(std::size_t size, std::uint32_t seed) {
    return testing::ClosestPointTreeCase::make(size, seed, 1, kTriangles / 2);
  }
};
template <std::size_t kTriangles>
struct FewByForce : testing::ClosestPointCase {
  static Input make(std::size_t size, std::uint32_t seed) { return FewByTree<kTriangles>::make(size, seed); }
};
template <std::size_t kTriangles>
bool add_few() {
  const std::string variant = std::to_string(kTriangles) + " triangles, 1M queries in scan order";
  return add<FewByTree<kTriangles>>(variant, 1'000'000) && add<FewByForce<kTriangles>>(variant, 1'000'000);
}

}  // namespace
const bool closest_point_tree_added = add<Mesh196k>("1M queries, 196020 triangles", 1'000'000);
const bool closest_point_few_added =
    add_few<12>() && add_few<24>() && add_few<48>() && add_few<96>() && add_few<180>();
}  // namespace hybrid::bench
