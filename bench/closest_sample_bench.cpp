#include "cases/closest_sample_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool closest_sample_added = add<testing::ClosestSampleCase>("200k queries, gate 15 cm", 200'000);
}  // namespace hybrid::bench
