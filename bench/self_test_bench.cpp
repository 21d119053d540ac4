#include "cases/self_test_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool self_test_added = add<testing::SelfTestCase>("1M items", 1'000'000);
}
