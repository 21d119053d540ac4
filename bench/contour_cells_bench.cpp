#include "cases/contour_cells_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool contour_cells_added = add<testing::ContourCellsCase>("1M cells", 1'000'000);
}
