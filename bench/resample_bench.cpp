#include "cases/resample_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool resample_added = add<testing::ResampleCase>("1M samples", 1'000'000);
const bool resample_large_added = add<testing::ResampleCase>("20M samples", 20'000'000);
}  // namespace hybrid::bench
