#include "cases/closest_point_tree_case.hpp"

namespace hybrid::testing {

// The tree is a way to the same answer: every triangle, in double.
ClosestPointTreeCase::Output ClosestPointTreeCase::reference(const Input& input) {
  return ClosestPointCase::reference(input);
}

}  // namespace hybrid::testing
