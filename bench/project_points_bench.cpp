#include "cases/project_points_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool project_points_pinhole_added =
    add<testing::ProjectPointsCase>("1M points, SIMPLE_PINHOLE", 1'000'000);
}
