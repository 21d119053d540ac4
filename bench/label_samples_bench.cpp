#include "cases/label_samples_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool label_samples_added = add<testing::LabelSamplesCase>("1M samples", 1'000'000);
}
