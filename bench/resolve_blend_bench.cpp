#include "cases/resolve_blend_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool resolve_blend_added = add<testing::ResolveBlendCase>("1M points", 1'000'000);
}
