#pragma once
#include <optional>
#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/polygon_model.hpp"

namespace hybrid::stages {

// A place of the model that photographs show, or that lies in the frame of their cameras.
struct PhotographPick {
  std::string name;                       // for messages: "landmark 2 (line 31)"
  std::optional<std::size_t> photograph;  // with `pixel`: shows it there; alone: was taken there
  std::optional<Vec2> pixel;              // column, row, as Camera counts them: the first centre is 0.5, 0.5
  Vec3 point = Vec3::Zero();              // of no photograph: in the cameras' frame
  Vec3 point_in_model = Vec3::Zero();     // metres
  bool snap = true;                       // take the nearest model vertex within the tolerance
};

struct PhotographFit {
  Pose world_from_photographs;     // a similarity: the cameras' frame need not be in metres
  double rms_m = 0;                // of the picks that were fitted
  std::vector<double> residual_m;  // per pick: from the model's point to the pick's ray or point, metres
  // Per pick in a photograph: the angle to the model's point times the focal length, pixels; else NaN.
  std::vector<double> residual_px;
  std::optional<std::size_t> left_out{};  // the pick that all others contradict
  std::string warning;                    // names it; "" = none
};

// Where the cameras' frame (of structure from motion: turned, shifted and scaled anyhow) lies in the model's.
// A point that two photographs or more show from different directions is where their rays meet; Horn's closed
// form takes three or more such points, camera positions and points to the model. Where all picks are pixels,
// Levenberg and Marquardt then make the sum of the squares of their angles, times focal lengths, the least
// (the residuals of METHOD 5's landmarks, where their errors are made), and pixels of points that only one
// photograph shows take part. A pick that all others, which agree, contradict by 5 pixels (5 cm without
// pixels) and more is left out and named. Throws ErrorKind::input: too few points, collinear or coincident
// ones (which), a pick too far from any vertex, a pixel where the camera looks nowhere, and picks that do not
// belong together (each with its residual): rms above 25 cm and 5 % of their rms distance from their centre.
PhotographFit fit_photographs(const PolygonModel& model, const std::vector<Photograph>& photographs,
                              const std::vector<PhotographPick>& picks, double snap_tolerance_m);

}  // namespace hybrid::stages
