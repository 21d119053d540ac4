#include "cases/blur_photo_case.hpp"
#include "harness.hpp"

namespace hybrid::bench {
const bool blur_photo_added = add<testing::BlurPhotoCase>("1 MP, sigma 4", 1'000'000);
}
