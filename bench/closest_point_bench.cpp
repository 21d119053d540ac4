#include "cases/closest_point_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool closest_point_added = add<testing::ClosestPointCase>("1M queries, 180 triangles", 1'000'000);
}
