#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "stages/registration/icp.hpp"
#include "stages/registration/proxy_search.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kNodes = 1 << 19;  // looked at together
constexpr double kGate = 2;              // of the distances asked for: their ends count too

class Distances {
 public:
  // World axes, origin at the scanner: all samples lie around it.
  Distances(device::Queue& queue, const RangeImage& image, const PlaneSegmentation& segmentation,
            const ProxyModel& model, const Pose& world_from_scan, double normal_deg)
      : queue_(queue),
        image_(image),
        segmentation_(segmentation),
        local_from_scan_(world_from_scan),
        normal_deg_(normal_deg),
        search_(queue, model, world_from_scan.translation) {
    local_from_scan_.translation.setZero();
  }

  std::uint32_t label(std::size_t i) const {
    return segmentation_.sample_label.empty() ? 0 : segmentation_.sample_label[i];
  }

  // Of the measured nodes that `wanted` takes, to the faces within the gate; 0 = to all. Calls take(node,
  // distance, height), NaN where there is none, from any thread.
  template <typename Wanted, typename Take>
  void measure(double gate_m, const Wanted& wanted, const Take& take) {
    if (image_.cols == 0) return;
    const int rows = std::max(1, static_cast<int>(kNodes / static_cast<std::size_t>(image_.cols)));
    for (int row = 0; row < image_.rows; row += rows)
      measure_rows(row, std::min(row + rows, image_.rows), gate_m, wanted, take);
  }

 private:
  template <typename Wanted, typename Take>
  void measure_rows(int first, int end, double gate_m, const Wanted& wanted, const Take& take) {
    const auto rows = static_cast<std::size_t>(end - first);
    const auto each = [&](std::size_t row, const auto& visit) {
      const std::size_t begin = image_.index(first + static_cast<int>(row), 0);
      for (std::size_t i = begin; i < begin + static_cast<std::size_t>(image_.cols); ++i)
        if (image_.mask[i] == kMeasured && wanted(i)) visit(i);
    };
    std::vector<std::size_t> begin(rows + 1, 0);
    parallel_for(rows, [&](std::size_t row) { each(row, [&](std::size_t) { ++begin[row + 1]; }); });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    if (begin.back() == 0) return;
    for (auto& column : queries_) column.resize(begin.back());
    parallel_for(rows, [&](std::size_t row) {
      std::size_t k = begin[row];
      each(row, [&](std::size_t i) {
        queries_[0][k] = image_.x[i];
        queries_[1][k] = image_.y[i];
        queries_[2][k] = image_.z[i];
        const std::uint32_t at = label(i);
        for (int a = 0; a < 3; ++a)
          queries_[3 + a][k] =
              at == 0 ? kNaN : static_cast<float>(segmentation_.superclusters[at - 1].plane.normal(a));
        ++k;
      });
    });
    ask(gate_m);
    parallel_for(rows, [&](std::size_t row) {
      std::size_t k = begin[row];
      each(row, [&](std::size_t i) {
        take(i, distance_[k], height_[k]);
        ++k;
      });
    });
  }

  void ask(double gate_m) {
    const auto& q = queries_;
    const SearchQueries on_device{q[0].size(),        queue_.array(q[0]), queue_.array(q[1]),
                                  queue_.array(q[2]), queue_.array(q[3]), queue_.array(q[4]),
                                  queue_.array(q[5])};
    SearchAnswers answers(queue_, on_device.count);
    search_.find(on_device, local_from_scan_, gate_m, normal_deg_, answers);
    distance_.resize(on_device.count);
    height_.resize(on_device.count);
    queue_.read(answers.distance, std::span(distance_));
    queue_.read(answers.height, std::span(height_));
  }

  device::Queue& queue_;
  const RangeImage& image_;
  const PlaneSegmentation& segmentation_;
  Pose local_from_scan_;
  double normal_deg_;
  ProxySearch search_;
  std::vector<float> queries_[6], distance_, height_;  // of some rows; x y z nx ny nz
};

}  // namespace

std::vector<float> signed_distance_to_model(device::Queue& queue, const RangeImage& image,
                                            const PlaneSegmentation& segmentation, const ProxyModel& model,
                                            const Pose& world_from_scan, double normal_deg,
                                            double free_gate_m) {
  Distances distances(queue, image, segmentation, model, world_from_scan, normal_deg);
  std::vector<float> signed_m(image.count(), kNaN);
  const auto take = [&](std::size_t i, float distance, float height) {
    signed_m[i] = std::copysign(distance, height);
  };
  if (free_gate_m > 0) {
    distances.measure(
        0, [&](std::size_t i) { return distances.label(i) != 0; }, take);
    distances.measure(
        free_gate_m, [&](std::size_t i) { return distances.label(i) == 0; }, take);
  } else {
    distances.measure(
        0, [](std::size_t) { return true; }, take);
  }
  return signed_m;
}

std::vector<float> distance_to_model(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const ProxyModel& model,
                                     const Pose& world_from_scan, double normal_deg) {
  auto distances = signed_distance_to_model(queue, image, segmentation, model, world_from_scan, normal_deg);
  for (float& distance : distances) distance = std::abs(distance);
  return distances;
}

std::vector<std::uint8_t> near_faces(device::Queue& queue, const RangeImage& image,
                                     const PlaneSegmentation& segmentation, const ProxyModel& model,
                                     const Pose& world_from_scan, double normal_deg,
                                     const std::vector<float>& within_m,
                                     const std::vector<std::uint8_t>& wanted) {
  if (within_m.empty() || !(within_m.front() > 0) || wanted.size() != image.count())
    fail(ErrorKind::failed, "near_faces: {} distances, {} flags for an image of {} samples", within_m.size(),
         wanted.size(), image.count());
  Distances distances(queue, image, segmentation, model, world_from_scan, normal_deg);
  std::vector<std::uint8_t> near(image.count(), 0);
  distances.measure(
      kGate * within_m.front(), [&](std::size_t i) { return wanted[i] != 0; },
      [&](std::size_t i, float distance, float) {
        for (const float within : within_m) near[i] += distance <= within;  // false for NaN
      });
  return near;
}

}  // namespace hybrid::stages
