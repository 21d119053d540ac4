#include "cases/decimate_case.hpp"

namespace hybrid::testing {

DecimateCase::Output DecimateCase::reference(const Input& input) {
  const auto& p = input.params;
  const std::uint8_t kept_in[4] = {FATE_UNDERSAMPLED_SQUARE, FATE_NON_PLANAR_SQUARE, FATE_SMALL_PLANAR_SQUARE,
                                   FATE_OUTLIER};
  Output fate;
  for (std::size_t i = 0; i < input.mask.size(); ++i) {
    const std::size_t row = p.first_row + i / p.cols, col = p.first_col + i % p.cols;
    const std::uint8_t kind = input.square_class[row / p.square * p.square_cols + col / p.square];
    const bool interior = input.label[i] != 0 && (kind == CLASS_MEMBER || p.discard_in_mixed_squares);
    if (input.mask[i] != MASK_MEASURED)
      fate.push_back(FATE_NO_SAMPLE);
    else if (input.boundary[i])
      fate.push_back(FATE_BOUNDARY);
    else
      fate.push_back(interior ? std::uint8_t{FATE_DISCARDED} : kept_in[kind]);
  }
  return fate;
}

}  // namespace hybrid::testing
