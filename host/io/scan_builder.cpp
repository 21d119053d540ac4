#include "io/scan_builder.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>

#include "core/error.hpp"
#include "core/free_memory.hpp"
#include "io/salvage.hpp"

namespace hybrid::io {
namespace {

constexpr double kLargeCoordinate_m = 1000;  // float resolves 0.06 mm here

bool fits_float(double value) {
  return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());  // false for NaN
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(value > 0 ? std::min(value + 0.5, 255.0) : 0.0);  // NaN: 0
}

bool is_byte(double value) {
  return value >= 0 && value <= 255 && value == std::floor(value);
}

}  // namespace

ColourKind colour_kind(ScalarType type) {
  if (is_real(type)) return ColourKind::real;
  return size_of(type) == 1 ? ColourKind::byte : ColourKind::word;
}

double colour_scale(ColourKind kind, double largest) {
  if (kind == ColourKind::real && largest <= 1) return 255;
  return largest <= 255 ? 1 : 1.0 / 257;
}

Vec3 local_origin(std::span<const std::array<double, 3>> returns) {
  Vec3 sum = Vec3::Zero();
  for (const auto& point : returns) sum += Vec3(point[0], point[1], point[2]);
  if (!(sum.norm() > kLargeCoordinate_m * static_cast<double>(returns.size()))) return Vec3::Zero();
  // 1/1024 m off the whole metre: a point that lies exactly on the origin would look like a no-return, and
  // no coordinate written with fewer than ten decimals does.
  const auto& first = returns.front();
  return {std::round(first[0]), std::round(first[1]), std::round(first[2]) + 1.0 / 1024};
}

ScanBuilder::ScanBuilder(const std::string& file, std::string name, std::uint64_t count,
                         const Options& options)
    : file_(file), options_(options) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
  if (count > kMost)
    fail_input("{}: expected at most {} points, found {}; split the file", file, kMost, count);
  scan_.name = std::move(name);
  if (options.origin) scan_.origin = *options.origin;
  origin_chosen_ = options.origin.has_value();
  if (options.part > 0) count = std::min<std::uint64_t>(count, options.part);
  try {
    scan_.points.reserve(count);
    if (options.exact) scan_.exact.reserve(count);
    if (options.intensity) scan_.intensity.reserve(count);
    if (options.colour == ColourKind::byte) scan_.rgb.reserve(count);
    if (options.colour > ColourKind::byte) colours_.reserve(count);
  } catch (const std::bad_alloc&) {
    const std::uint64_t point_bytes = 12 + (options.exact ? 24 : 0) + (options.intensity ? 4 : 0) +
                                      (options.colour == ColourKind::none   ? 0
                                       : options.colour == ColourKind::byte ? 3
                                                                            : 15);
    fail(
        ErrorKind::device,
        "{}: expected {} MiB of memory for {} points, found less free; split the file or use another machine",
        file, count * point_bytes >> 20, count);
  }
}

bool ScanBuilder::is_return(double x, double y, double z) const {
  const bool zero = x == 0 && y == 0 && z == 0;
  return !(zero && (options_.zero_is_no_return || !scan_.origin.isZero()));
}

bool ScanBuilder::are_coordinates(double x, double y, double z, std::uint64_t at, Tally& tally) {
  if (!fits_float(x) || !fits_float(y) || !fits_float(z)) {
    ++tally.not_finite;
    return false;
  }
  const double most = std::max({std::abs(x), std::abs(y), std::abs(z)});
  if (most <= kAbsurd_m) return true;
  if (tally.absurd++ == 0) {
    tally.first_absurd = at;
    tally.absurd_value = most;
  }
  return false;
}

bool ScanBuilder::is_place(const ScanSample& sample, bool zero_is_no_return) {
  Tally ignored;
  const bool zero = sample.x == 0 && sample.y == 0 && sample.z == 0;
  return are_coordinates(sample.x, sample.y, sample.z, 0, ignored) && !(zero && zero_is_no_return);
}

void ScanBuilder::start_part() {
  before_ += scan_.points.size();
  scan_.points.clear();
  scan_.exact.clear();
  scan_.intensity.clear();
  scan_.rgb.clear();
}

void ScanBuilder::Tally::add(const Tally& later) {
  not_finite += later.not_finite;
  odd_colours += later.odd_colours;
  if (absurd == 0) {
    first_absurd = later.first_absurd;
    absurd_value = later.absurd_value;
  }
  absurd += later.absurd;
}

void ScanBuilder::add_point(double x, double y, double z) {
  const bool no_return =
      !are_coordinates(x, y, z, before_ + scan_.points.size(), tally_) || !is_return(x, y, z);
  if (options_.exact) scan_.exact.push_back({x, y, z});
  if (no_return || !origin_chosen_) {
    if (!no_return) {
      waiting_index_.push_back(scan_.points.size());
      waiting_.push_back({x, y, z});
    }
    scan_.points.push_back({kNaN, kNaN, kNaN});
    if (waiting_.size() == kOriginSamples) choose_origin();
  } else {
    scan_.points.push_back(relative({x, y, z}));
  }
}

void ScanBuilder::add_lost(std::uint64_t count) {
  for (; count > 0; --count) {
    scan_.points.push_back({kNaN, kNaN, kNaN});
    if (options_.exact) scan_.exact.push_back({});
    if (options_.intensity) add_intensity(0);
    if (options_.colour != ColourKind::none) add_colour(0, 0, 0);
  }
}

void ScanBuilder::grow(std::size_t count) {
  scan_.points.resize(count);
  if (options_.exact) scan_.exact.resize(count);
  if (options_.intensity) scan_.intensity.resize(count);
  if (options_.colour == ColourKind::byte) scan_.rgb.resize(count);
  if (options_.colour > ColourKind::byte) colours_.resize(count);
}

void ScanBuilder::put(std::size_t at, const ScanSample& sample, Tally& tally) {
  scan_.points[at] = are_coordinates(sample.x, sample.y, sample.z, before_ + at, tally) &&
                             is_return(sample.x, sample.y, sample.z)
                         ? relative({sample.x, sample.y, sample.z})
                         : std::array{kNaN, kNaN, kNaN};
  if (options_.exact) scan_.exact[at] = {sample.x, sample.y, sample.z};
  if (options_.intensity) scan_.intensity[at] = static_cast<float>(sample.intensity);
  const auto& [red, green, blue] = sample.rgb;
  if (options_.colour == ColourKind::byte) {
    scan_.rgb[at] = {to_byte(red), to_byte(green), to_byte(blue)};
    tally.odd_colours += !is_byte(red) || !is_byte(green) || !is_byte(blue);
  } else if (options_.colour > ColourKind::byte)
    colours_[at] = {static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)};
}

std::array<float, 3> ScanBuilder::relative(const Point& point) const {
  return {static_cast<float>(point[0] - scan_.origin.x()), static_cast<float>(point[1] - scan_.origin.y()),
          static_cast<float>(point[2] - scan_.origin.z())};
}

void ScanBuilder::choose_origin() {
  origin_chosen_ = true;
  scan_.origin = local_origin(waiting_);
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    const Point& point = waiting_[i];
    const bool zero = point[0] == 0 && point[1] == 0 && point[2] == 0;
    if (!zero || scan_.origin.isZero()) scan_.points[waiting_index_[i]] = relative(point);
  }
  free_memory(waiting_);
  free_memory(waiting_index_);
}

void ScanBuilder::add_colour(double red, double green, double blue) {
  if (options_.colour == ColourKind::byte) {
    scan_.rgb.push_back({to_byte(red), to_byte(green), to_byte(blue)});
    tally_.odd_colours += !is_byte(red) || !is_byte(green) || !is_byte(blue);
  } else
    colours_.push_back({static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)});
}

void ScanBuilder::scale_colours() {
  float largest = 0;
  for (const auto& colour : colours_) largest = std::max({largest, colour[0], colour[1], colour[2]});
  const double scale = colour_scale(options_.colour, static_cast<double>(largest));
  scan_.rgb.reserve(colours_.size());
  for (const auto& colour : colours_) {
    const auto byte = [&](int i) {
      return to_byte(scale * static_cast<double>(colour[static_cast<std::size_t>(i)]));
    };
    scan_.rgb.push_back({byte(0), byte(1), byte(2)});
  }
  free_memory(colours_);
}

void ScanBuilder::judge_absurd() {
  if (tally_.absurd == 0) return;
  const auto problem = fmt::format("point {}: expected a coordinate within {} m, found {}",
                                   tally_.first_absurd, kAbsurd_m, tally_.absurd_value);
  if (!options_.salvage)
    fail_input("{}: {}, and {} such points in all; correct it, {}", file_, problem, tally_.absurd,
               kSalvageRemedy);
  add_note(fmt::format("{} of {} points have absurd coordinates ({}): taken as no-returns", tally_.absurd,
                       before_ + scan_.points.size(), problem));
}

void ScanBuilder::note_colours() {
  if (tally_.odd_colours == 0 || options_.scaled_colours) return;
  add_note(
      fmt::format("{} of {} points have a colour that is not three whole numbers from 0 to 255: rounded, and "
                  "cut there; are its "
                  "columns in another order?",
                  tally_.odd_colours, before_ + scan_.points.size()));
}

Scan ScanBuilder::finish() {
  judge_absurd();
  note_colours();
  if (!waiting_.empty()) choose_origin();
  if (!colours_.empty()) scale_colours();
  if (holds_the_same(scan_)) free_memory(scan_.exact);
  if (tally_.not_finite > 0)
    add_note(fmt::format("{} of {} points are not finite: taken as no-returns", tally_.not_finite,
                         before_ + scan_.points.size()));
  if (before_ + scan_.points.size() == 0) add_note("no points");
  if (!scan_.origin.isZero())
    add_note(fmt::format("coordinates are large: kept relative to ({}, {}, {})", scan_.origin.x(),
                         scan_.origin.y(), scan_.origin.z()));
  return std::move(scan_);
}

bool holds_the_same(const Scan& scan) {
  constexpr std::size_t kBlock = 1 << 16;
  std::atomic<bool> same{true};
  parallel_for((scan.exact.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    for (std::size_t i = block * kBlock, end = std::min(i + kBlock, scan.exact.size()); i < end && same; ++i)
      if (std::isfinite(scan.points[i][0]) && scan.point(i) != scan.exact_point(i)) same = false;
  });
  return same;
}

bool within(const std::vector<float>& values, float least, float greatest) {
  return std::none_of(values.begin(), values.end(), [=](float v) { return v < least || v > greatest; });
}

bool names_intensity(const std::string& lower_case_name) {
  return lower_case_name == "intensity" || lower_case_name == "scalar_intensity";
}

}  // namespace hybrid::io
