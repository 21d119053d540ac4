#include "cases/decimate_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool decimate_added = add<testing::DecimateCase>("1M samples", 1'000'000);
}
