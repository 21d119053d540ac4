#include "io/cameras/camera_file.hpp"

#include <Eigen/SVD>
#include <algorithm>

#include "core/error.hpp"
#include "io/text/plain_text.hpp"

namespace hybrid::io {

int checked_image_size(const std::string& place, std::string_view field, std::int64_t value) {
  constexpr std::int64_t kLargest = 1 << 20;
  if (value < 1 || value > kLargest)
    fail_input("{}: {}: expected 1 to {} pixels, found {}", place, field, kLargest, value);
  return static_cast<int>(value);
}

void check_focal_length(const std::string& place, const Camera& camera) {
  if (!(camera.fx > 0 && camera.fy > 0))
    fail_input("{}: focal length: expected more than 0 px, found {} and {}", place, camera.fx, camera.fy);
}

Eigen::Quaterniond checked_rotation(const std::string& place, const Mat3& matrix) {
  const double skew = (matrix * matrix.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(skew <= kRotationTolerance))
    fail_input("{}: expected a rotation, found a matrix with R R^T off the identity by {:.3g} (at most {:g})",
               place, skew, kRotationTolerance);
  if (matrix.determinant() < 0)
    fail_input("{}: expected a rotation, found a mirrored one (determinant {:.6g}); are the axes swapped?",
               place, matrix.determinant());
  const Eigen::JacobiSVD<Mat3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(Mat3(svd.matrixU() * svd.matrixV().transpose())).normalized();
}

void sort_photographs(const std::filesystem::path& file, std::vector<Photograph>& photographs) {
  std::sort(photographs.begin(), photographs.end(),
            [](const Photograph& a, const Photograph& b) { return a.name < b.name; });
  const auto twice =
      std::adjacent_find(photographs.begin(), photographs.end(),
                         [](const Photograph& a, const Photograph& b) { return a.name == b.name; });
  if (twice != photographs.end())
    fail_input("{}: photograph {} occurs twice; remove one of the two", file.string(), excerpt(twice->name));
}

}  // namespace hybrid::io
