#pragma once
#include <array>
#include <optional>

#include "stages/registration/automatic_scene.hpp"

namespace hybrid::stages {

// What a scan's own registration knows of its pose where the model's faces are right as they are: 6x6 as
// Registration::covariance. Every supercluster is one observation, off its face by what its tiles are: the
// noise of single samples averages out in it, and what lies near a face and not on it (furniture, a recess)
// says nothing. The sum of two estimates: from what all superclusters are off together, which holds for few,
// and from what each is off times what it holds (the sandwich estimate), which holds where a direction hangs
// on worse planes than the others. Directions that the planes leave open
// have a metre. Nothing where no tile lies on a face.
std::optional<std::array<double, 36>> covariance_on_exact_faces(const ScanEvidence& scan,
                                                                const ModelShapes& model, const Pose& pose);

// The covariance with what is known besides of how far the scanner at `place` (world) lies along a direction
// (world, unit).
std::array<double, 36> covariance_held_along(const std::array<double, 36>& covariance, const Vec3& place,
                                             const Vec3& direction, double sigma_m);

}  // namespace hybrid::stages
