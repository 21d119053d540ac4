#include "cases/stray_samples_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool stray_samples_added = add<testing::StraySamplesCase>("1M samples", 1'000'000);
}
