#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.hpp"
#include "stages/planes/ray_equations.hpp"
#include "stages/planes/sample_labels.hpp"
#include "stages/scan/noise_model.hpp"

namespace hybrid::stages {
namespace {

constexpr double kWeightCosine = 0.2;  // c of the weights: a weight of 25 at most, for beams are not lines
constexpr int kStrideBeforeLast = 3;
constexpr std::size_t kMany = 4'000'000;  // samples; of fewer all are seen
constexpr std::size_t kGroup = kVectorLanes;
constexpr double kAreaCosine = 0.02;  // c of the area: grazing samples cover no infinite area

using Labels = std::vector<std::uint32_t>;

// Sums over the measured samples of one band of rows, one entry per label that occurs there.
template <typename Sum>
struct Band {
  std::vector<std::uint32_t> labels;
  std::vector<Sum> sums;
};

// Adds the measured samples of the label among `count` nodes, one by one where the sum cannot do better.
template <typename Sum, typename Of>
void add_nodes(const RangeImage& image, const Labels& labels, std::size_t first, std::size_t count,
               std::uint32_t label, const Of& of, Sum& sum) {
  if constexpr (requires { sum.add_nodes(image, labels, first, count, label, of); })
    sum.add_nodes(image, labels, first, count, label, of);
  else
    for (std::size_t i = first; i < first + count; ++i)
      if (labels[i] == label && image.mask[i] == kMeasured) sum.add(image, labels, i, of);
}

// Whether a group has this label and no other, as most have.
bool has_only(const std::uint32_t* of_group, std::uint32_t label) {
  std::uint32_t others = 0, own = 0;
  for (std::size_t k = 0; k < kGroup; ++k) {
    others |= static_cast<std::uint32_t>(of_group[k] != label) & static_cast<std::uint32_t>(of_group[k] != 0);
    own |= static_cast<std::uint32_t>(of_group[k] == label);
  }
  return own != 0 && others == 0;
}

// Adds the measured samples with a label among the nodes from `first` to `end`, which are of one row, by
// add(first, count, label): those of a label in groups of kGroup nodes, and groups side by side that have but
// one label, together.
template <typename Add>
void add_groups(const RangeImage& image, const Labels& labels, std::size_t first, std::size_t end,
                const Add& add) {
  const auto label_of = [&](std::size_t i) { return image.mask[i] == kMeasured ? labels[i] : 0; };
  std::size_t begin = first;
  std::uint32_t of_groups = 0;  // from `begin` on
  const auto add_until = [&](std::size_t group) {
    if (of_groups != 0) add(begin, group - begin, of_groups);
    of_groups = 0;
  };
  for (std::size_t group = first; group < end; group += kGroup) {
    if (group + kGroup <= end && has_only(&labels[group], of_groups)) continue;
    std::array<std::uint32_t, kGroup> found;
    std::size_t count = 0;
    for (std::size_t i = group; i < std::min(end, group + kGroup); ++i) {
      const std::uint32_t label = label_of(i);
      if (label == 0 || (count > 0 && found[count - 1] == label)) continue;
      if (std::find(found.begin(), found.begin() + count, label) == found.begin() + count)
        found[count++] = label;
    }
    if (count == 1 && found[0] == of_groups) continue;
    add_until(group);
    if (count == 1) {
      begin = group;
      of_groups = found[0];
    } else {
      for (std::size_t k = 0; k < count; ++k) add(group, std::min(end - group, kGroup), found[k]);
    }
  }
  add_until(end);
}

// Forms the sums per band of `square` rows anchored at row 0 and label, of
// every `stride`th row, then merges the bands from top to bottom: the same bits for any number of threads.
template <typename Sum, typename Planes>
std::vector<Sum> sum_by_label(const RangeImage& image, int square, const std::vector<std::uint32_t>& labels,
                              const Planes& planes, int stride = 1) {
  const int count = (image.rows + square - 1) / square;
  std::vector<Band<Sum>> bands(static_cast<std::size_t>(count));
  parallel_for(bands.size(), [&](std::size_t b) {
    std::vector<int> slot(planes.size() + 1, -1);
    Band<Sum>& band = bands[b];
    const auto sum_of = [&](std::uint32_t label) -> Sum& {
      if (slot[label] < 0) {
        slot[label] = static_cast<int>(band.sums.size());
        band.labels.push_back(label);
        band.sums.emplace_back();
      }
      return band.sums[static_cast<std::size_t>(slot[label])];
    };
    const int first = static_cast<int>(b) * square;
    for (int row = (first + stride - 1) / stride * stride; row < std::min(first + square, image.rows);
         row += stride) {
      const std::size_t end = image.index(row, 0) + static_cast<std::size_t>(image.cols);
      add_groups(image, labels, image.index(row, 0), end,
                 [&](std::size_t from, std::size_t nodes, std::uint32_t label) {
                   add_nodes(image, labels, from, nodes, label, planes[label - 1], sum_of(label));
                 });
    }
  });
  std::vector<Sum> total(planes.size());
  for (const auto& band : bands)
    for (std::size_t k = 0; k < band.sums.size(); ++k) total[band.labels[k] - 1].merge(band.sums[k]);
  return total;
}

double cosine(const Vec3& point, const Plane& plane) {
  return std::abs(plane.normal.dot(point)) / point.norm();
}

// Moments about the plane's foot point, so that nothing cancels: weight, first, second (xx xy xz yy yz zz).
struct WeightedMoments {
  std::array<double, 10> sum{};

  void add(const RangeImage& image, const Labels&, std::size_t i, const Plane& plane) {
    const Vec3 point = image.point(i);
    const double along = plane.normal.dot(point);
    const double w = 1 / std::max(along * along / point.squaredNorm(), kWeightCosine * kWeightCosine);
    const double x = point.x() - plane.offset_m * plane.normal.x();
    const double y = point.y() - plane.offset_m * plane.normal.y();
    const double z = point.z() - plane.offset_m * plane.normal.z();
    const double terms[10] = {1, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
    for (std::size_t k = 0; k < 10; ++k) sum[k] += w * terms[k];
  }
  void merge(const WeightedMoments& other) {
    for (std::size_t k = 0; k < 10; ++k) sum[k] += other.sum[k];
  }
  PlaneMoments about(const Vec3& foot) const {
    PlaneMoments moments;
    moments.weight = sum[0];
    const Vec3 mean(sum[1] / sum[0], sum[2] / sum[0], sum[3] / sum[0]);
    Mat3 second;
    second << sum[4], sum[5], sum[6], sum[5], sum[7], sum[8], sum[6], sum[8], sum[9];
    moments.scatter = second - sum[0] * mean * mean.transpose();
    moments.mean = mean + foot;
    return moments;
  }
};

struct Measures {
  struct Frame {
    Plane plane;
    const std::vector<double>* solid_angle;  // of a node of each row
  };

  std::int64_t samples = 0;
  Vec3 first = Vec3::Zero();
  double squares = 0, area = 0;

  void add(const RangeImage& image, const Labels&, std::size_t i, const Frame& frame) {
    const Vec3 point = image.point(i);
    const double distance = frame.plane.distance(point);
    const double solid_angle = (*frame.solid_angle)[i / static_cast<std::size_t>(image.cols)];
    samples += 1;
    first += point;
    squares += distance * distance;
    area += solid_angle * point.squaredNorm() / std::max(cosine(point, frame.plane), kAreaCosine);
  }
  void merge(const Measures& other) {
    samples += other.samples;
    first += other.first;
    squares += other.squares;
    area += other.area;
  }
  // Half the way to the neighbouring rows; columns by their mean step.
  static std::vector<double> solid_angles(const RangeImage& image) {
    const auto at = [&](int r) {
      return image.elevation_rad[static_cast<std::size_t>(std::clamp(r, 0, image.rows - 1))];
    };
    std::vector<double> angles;
    for (int row = 0; row < image.rows; ++row) {
      const double rows = row > 0 && row + 1 < image.rows ? 2 : 1;
      const double height = std::abs(at(row - 1) - at(row + 1)) / rows;
      angles.push_back(height * std::abs(image.azimuth_step_rad()) * std::cos(at(row)));
    }
    return angles;
  }
};

}  // namespace

void refit_planes(const RangeImage& image, int square, const std::vector<std::uint32_t>& labels,
                  std::vector<Plane>& planes) {
  const auto sums = sum_by_label<WeightedMoments>(image, square, labels, planes);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!(sums[i].sum[0] >= 3)) continue;  // no weight is below 1
    const auto moments = sums[i].about(planes[i].offset_m * planes[i].normal);
    planes[i] = fit_plane(moments).plane;
  }
}

void polish_planes(const RangeImage& image, int square, const std::vector<std::uint32_t>& labels,
                   const RangeNoise& noise, std::vector<Plane>& planes, PolishRounds rounds,
                   const std::vector<std::uint32_t>& only) {
  std::vector<bool> wanted(planes.size(), only.empty());
  for (const std::uint32_t label : only) wanted[label - 1] = true;
  const int last = rounds == PolishRounds::both ? 1 : 0;
  for (int round = 0; round <= last; ++round) {
    std::vector<RayEquations::Frame> frames(planes.size());
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const Vec3 across = planes[i].normal.unitOrthogonal();
      frames[i].axes.row(0) = planes[i].normal;
      frames[i].axes.row(1) = across;
      frames[i].axes.row(2) = planes[i].normal.cross(across);
      frames[i].m = planes[i].normal / planes[i].offset_m;
      frames[i].noise = wanted[i] ? &noise : nullptr;
    }
    // A round before the last need not see every sample: what it leaves is little to the next one.
    const bool is_last = round == last && rounds != PolishRounds::first;
    const int stride = is_last || image.count() < kMany ? 1 : kStrideBeforeLast;
    const auto sums = sum_by_label<RayEquations>(image, square, labels, frames, stride);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const auto sum = sums[i].weighted(stride);
      const auto& s = sum.of;
      Mat3 matrix;
      matrix << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
      const Eigen::LDLT<Mat3> solver(matrix);
      const Vec3 pivots = solver.vectorD();
      if (!(pivots.minCoeff() > 1e-9 * pivots.maxCoeff())) continue;
      const Vec3 m =
          frames[i].m + frames[i].axes.transpose() * (sum.step() * solver.solve(Vec3(s[6], s[7], s[8])));
      const double length = m.norm();
      if (!std::isfinite(length) || !(length > 0)) continue;
      const double side = planes[i].offset_m < 0 ? -1 : 1;
      planes[i] = {side * m / length, side / length};
    }
  }
}

std::vector<Supercluster> measure_planes(const RangeImage& image, int square,
                                         const std::vector<std::uint32_t>& labels,
                                         const std::vector<Plane>& planes) {
  const auto solid_angles = Measures::solid_angles(image);
  std::vector<Measures::Frame> frames;
  for (const Plane& plane : planes) frames.push_back({plane, &solid_angles});
  const auto sums = sum_by_label<Measures>(image, square, labels, frames);
  std::vector<Supercluster> result(planes.size());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    result[i].plane = planes[i];
    result[i].samples = sums[i].samples;
    if (sums[i].samples == 0) continue;
    const auto count = static_cast<double>(sums[i].samples);
    result[i].centroid_m = sums[i].first / count;
    result[i].rms_m = std::sqrt(sums[i].squares / count);
    result[i].area_m2 = sums[i].area;
  }
  return result;
}

}  // namespace hybrid::stages
