#pragma once
#include <string>
#include <vector>

#include "stages/registration/landmarks.hpp"

namespace hybrid::stages {

struct CheckedLandmarks {
  LandmarkFit fit;
  std::string warning;  // names a pick that was left out, or picks that seem exchanged; "" = none
  std::string refusal;  // why the picks place nothing: they cannot belong together; "" = they do
};

// fit_landmarks(), as surveyors' software does it. A pick that the others, which agree, contradict
// (outlying_pick(), by 5 cm and more when its leverage is taken out, as from a studentised residual) is left
// out of the fit and named. Picks that do not agree within 25 cm (scan metres) nor within 5 % of their rms
// distance from their centre are refused: with the two whose exchange makes all agree, with the scale or the
// mirror image in which they do, or with every residual. For 3 picks there is nothing to leave out.
CheckedLandmarks check_landmarks(const PolygonModel& model, const std::vector<LandmarkPair>& pairs,
                                 const LandmarkOptions& options = {});

}  // namespace hybrid::stages
