#include "cases/window_planes_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool window_planes_added = add<testing::WindowPlanesCase>("1M samples, most free", 1'000'000);
}
