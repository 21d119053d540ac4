#include "cases/square_planes_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool square_planes_added = add<testing::SquarePlanesCase>("1M samples", 1'000'000);
const bool square_planes_large_added = add<testing::SquarePlanesCase>("20M samples", 20'000'000);
}  // namespace hybrid::bench
