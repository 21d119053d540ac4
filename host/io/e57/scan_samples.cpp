#include "io/e57/scan_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/salvage.hpp"
#include "io/scan_builder.hpp"

namespace hybrid::io {
namespace {

constexpr double kLargestFloat = static_cast<double>(std::numeric_limits<float>::max());

}  // namespace

// Coordinates of a range of records, in double, as Cartesian ones.
struct ScanSamples::Coordinates {
  std::array<std::vector<double>, 3> axis;

  void take(const E57Table& table, const ScanColumns& columns, const E57Records& records) {
    for (std::size_t k = 0; k < 3; ++k) {
      axis[k].resize(records.count);
      values_of(table.fields[columns.fields[columns.place[k]]], records, columns.place[k], axis[k]);
    }
    if (columns.spherical) to_cartesian(axis[0], axis[1], axis[2]);
  }
};

ScanSamples::ScanSamples(const std::string& where, const E57Scan& source, const E57RecordReader& reader)
    : table_(source.points), columns_(ScanColumns::of(where, table_)) {
  choose_origin(reader);
  if (columns_.colour) colours_.emplace(reader, source, columns_);
}

// Finite numbers that are no coordinates are told apart, as they mean damage.
ScanSamples::Kind ScanSamples::kind(const Coordinates& c, const std::vector<double>& state,
                                    std::size_t i) const {
  if (!state.empty() && state[i] != 0) return invalid;
  const double most = std::max({std::abs(c.axis[0][i]), std::abs(c.axis[1][i]), std::abs(c.axis[2][i])});
  const double sum = c.axis[0][i] + c.axis[1][i] + c.axis[2][i];
  if (std::isnan(sum) || most > kLargestFloat) return not_finite;
  return most > kFarthest_m ? absurd : good;
}

std::vector<double> ScanSamples::values(const E57Records& records, const ScanColumns::Slot& slot) const {
  std::vector<double> values;
  if (!slot) return values;
  values.resize(records.count);
  values_of(table_.fields[columns_.fields[*slot]], records, *slot, values);
  return values;
}

// From the first returns, as ScanBuilder does.
void ScanSamples::choose_origin(const E57RecordReader& reader) {
  std::vector<std::array<double, 3>> returns;
  ScanColumns only = columns_;
  only.fields.resize(columns_.invalid ? 4 : 3);  // ScanColumns::of takes these first
  for (std::uint64_t at = 0; at < reader.count() && returns.size() < kOriginSamples; at += kOriginSamples) {
    const std::uint64_t count = std::min<std::uint64_t>(kOriginSamples, reader.count() - at);
    std::vector<std::array<double, 3>> chunk(count, {NAN, NAN, NAN});
    reader.read(only.fields, at, count, [&](const E57Records& records) {
      Coordinates c;
      c.take(table_, columns_, records);
      const std::vector<double> state = values(records, columns_.invalid);
      for (std::size_t i = 0; i < records.count; ++i)
        if (kind(c, state, i) == good)
          chunk[records.first - at + i] = {c.axis[0][i], c.axis[1][i], c.axis[2][i]};
      for (const auto& lost : records.lost)
        for (std::uint64_t i = lost.first; i < lost.end; ++i) chunk[i - at] = {NAN, NAN, NAN};
    });
    for (const auto& point : chunk)
      if (!std::isnan(point[0]) && returns.size() < kOriginSamples) returns.push_back(point);
  }
  if (!returns.empty()) origin_ = local_origin(returns);
}

bool ScanSamples::rounds() const {
  return columns_.spherical || !origin_.isZero() ||
         std::ranges::any_of(columns_.place, [&](std::size_t slot) {
           return table_.fields[columns_.fields[slot]].type != E57Type::single_real;
         });
}

std::optional<CoordinateSteps> ScanSamples::steps() const {
  CoordinateSteps steps;
  if (columns_.spherical) return {};
  for (std::size_t k = 0; k < 3; ++k) {
    const E57Field& field = table_.fields[columns_.fields[columns_.place[k]]];
    if (!field.is_integer()) return {};
    const bool scaled = field.type == E57Type::scaled_integer;
    steps.scale[static_cast<int>(k)] = scaled ? field.scale : 1;
    steps.offset[static_cast<int>(k)] = scaled ? field.offset : 0;
  }
  return steps;
}

void ScanSamples::points(const E57Records& records, std::span<std::array<float, 3>> to, SampleTally& tally,
                         std::span<std::array<double, 3>> exact) const {
  thread_local Coordinates c;
  c.take(table_, columns_, records);
  const std::vector<double> state = values(records, columns_.invalid);
  const bool far = !origin_.isZero();
  const double ox = origin_.x(), oy = origin_.y(), oz = origin_.z();
  for (std::size_t i = 0; i < records.count; ++i) {
    const Kind found = kind(c, state, i);
    const double x = c.axis[0][i], y = c.axis[1][i], z = c.axis[2][i];
    tally.invalid += found == invalid;
    tally.not_finite += found == not_finite;
    if (found == absurd && tally.absurd++ == 0) {
      tally.first_absurd = records.first + i;
      tally.absurd_value = std::max({std::abs(x), std::abs(y), std::abs(z)});
    }
    if (!exact.empty()) exact[i] = {x, y, z};
    const bool zero = far && x == 0 && y == 0 && z == 0;
    to[i] = found == good && !zero ? std::array{static_cast<float>(x - ox), static_cast<float>(y - oy),
                                                static_cast<float>(z - oz)}
                                   : std::array{kNaN, kNaN, kNaN};
  }
}

void ScanSamples::intensities(const E57Records& records, std::span<float> to) const {
  const std::vector<double> value = values(records, columns_.intensity),
                            state = values(records, columns_.intensity_invalid);
  for (std::size_t i = 0; i < records.count; ++i)
    to[i] = state.empty() || state[i] == 0 ? static_cast<float>(value[i]) : 0.0f;
}

void ScanSamples::colours(const E57Records& records, std::span<std::array<std::uint8_t, 3>> to) const {
  const std::vector<double> state = values(records, columns_.colour_invalid);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double> value = values(records, (*columns_.colour)[k]);
    for (std::size_t i = 0; i < records.count; ++i)
      to[i][k] = state.empty() || state[i] == 0 ? colours_->byte(k, value[i]) : 0;
  }
}

}  // namespace hybrid::io
