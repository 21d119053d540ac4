#pragma once
#include <vector>

#include "stages/registration/automatic_scene.hpp"

namespace hybrid::stages {

// A rotation that lays many scan planes along model planes.
struct RotationGuess {
  Eigen::Quaterniond world_from_scan;
  double area_m2 = 0;  // of scan planes that lie along some model plane under it
};

// Normals of a scan plane and a model plane under one rotation: along each other within this.
inline constexpr double kAlongDeg = 6;

// Every pair of the largest scan planes against every pair of model planes with the same angle between them
// (30 to 150 degrees) gives a rotation; `levelled`: a wall on a wall gives a turn about the vertical. Refined
// on all planes that lie along model planes, equal ones once, best supported first, those with at least 60 %
// of the best's support. Fixed order.
std::vector<RotationGuess> guess_rotations(const ScanEvidence& scan, const ModelShapes& model, bool levelled);

}  // namespace hybrid::stages
