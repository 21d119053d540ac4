#include "cases/square_links_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool square_links_added = add<testing::SquareLinksCase>("1M squares", 1'000'000);
}
