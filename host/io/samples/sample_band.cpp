#include "io/samples/sample_band.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/samples/columns.hpp"
#include "io/samples/point_code.hpp"

namespace hybrid::io {
namespace {

enum NodeState : std::uint32_t { kNothing = 0, kByPlane = 1, kBySample = 2 };

using Column = std::vector<std::uint32_t>;

// What the next sample of a row is told apart from.
struct Before {
  double range_m = 0;
  std::uint32_t label = 0, intensity = 0;
  std::array<std::uint8_t, 3> rgb{};
};

bool usable(double range) {
  constexpr double kMost_m = 1e6;
  return range > 0 && range < kMost_m;
}

double predicted_range(const SampleHeader& header, const Vec3& ray, std::uint32_t label,
                       const Before& before) {
  const double range = label == 0 ? 0 : range_to(header.planes[label - 1], ray);
  return usable(range) ? range : before.range_m;
}

double range_of(const SampleHeader& header, const std::array<float, 3>& point) {
  const double x = static_cast<double>(point[0]) + header.origin.x(),
               y = static_cast<double>(point[1]) + header.origin.y(),
               z = static_cast<double>(point[2]) + header.origin.z();
  return std::sqrt(x * x + y * y + z * z);
}

struct Columns {
  Column state, label, by_plane[3], by_sample[3], intensity, rgb[3];
};

void take_node(const SampleHeader& header, const SampleFileInput& input, const PointCode& code, int row,
               int col, Before& before, Columns& columns) {
  const auto& image = input.image;
  const std::size_t node = image.index(row, col);
  if (image.mask[node] != kMeasured) {
    columns.state.push_back(kNothing);
    return;
  }
  const bool by_plane = input.discarded[node] != 0 && input.label[node] != 0;
  columns.state.push_back(by_plane ? kByPlane : kBySample);
  const std::uint32_t label = by_plane ? input.label[node] : 0;
  if (by_plane) {
    columns.label.push_back(fold(label - before.label));
    before.label = label;
  }
  const Vec3 ray = header.ray(row, col);
  const auto point = stored_point(input, node);
  const auto folded = code.encode(ray, predicted_range(header, ray, label, before), point);
  for (std::size_t k = 0; k < 3; ++k)
    (by_plane ? columns.by_plane : columns.by_sample)[k].push_back(folded[k]);
  before.range_m = range_of(header, point);
  if (header.intensity) {
    const std::uint32_t value = header.intensity_code.encode(image.intensity[node]);
    columns.intensity.push_back(fold(value - before.intensity));
    before.intensity = value;
  }
  if (header.colour) {
    for (std::size_t c = 0; c < 3; ++c)
      columns.rgb[c].push_back(static_cast<std::uint8_t>(image.rgb[node][c] - before.rgb[c]));
    before.rgb = image.rgb[node];
  }
}

class BandDecoder {
 public:
  BandDecoder(const SampleHeader& header, std::string_view bytes, std::string place, int rows, int scan_row)
      : header_(header), place_(std::move(place)), code_(header.point, header.origin), scan_row_(scan_row) {
    ColumnReader reader(bytes, place_);
    columns_.state = reader.take(static_cast<std::size_t>(rows) * static_cast<std::size_t>(header.cols));
    const auto counted = [&](std::uint32_t state) {
      return static_cast<std::size_t>(std::ranges::count(columns_.state, state));
    };
    const std::size_t by_plane = counted(kByPlane), by_sample = counted(kBySample);
    samples_ = by_plane + by_sample;
    if (counted(kNothing) + samples_ != columns_.state.size())
      fail_input("{}: expected states 0 to 2, found another; make the file again from the scan", place_);
    columns_.label = reader.take(by_plane);
    for (Column& column : columns_.by_plane) column = reader.take(by_plane);
    for (Column& column : columns_.by_sample) column = reader.take(by_sample);
    if (header.intensity) columns_.intensity = reader.take(samples_);
    if (header.colour)
      for (Column& column : columns_.rgb) column = reader.take(samples_);
    reader.finish();
  }

  std::size_t samples() const { return samples_; }

  void put_row(int band_row, int row, Scan& scan) {
    Before before;
    for (int col = 0; col < header_.cols; ++col) {
      const std::uint32_t state =
          columns_.state[static_cast<std::size_t>(band_row) * static_cast<std::size_t>(header_.cols) +
                         static_cast<std::size_t>(col)];
      if (state != kNothing) put_sample(state, row, col, before, scan);
    }
  }

 private:
  void put_sample(std::uint32_t state, int row, int col, Before& before, Scan& scan) {
    const std::size_t node =
        static_cast<std::size_t>(row - scan_row_) * static_cast<std::size_t>(header_.cols) +
        static_cast<std::size_t>(col);
    std::uint32_t label = 0;
    if (state == kByPlane) {
      label = before.label + unfold(columns_.label[by_plane_]);
      before.label = label;
      if (label == 0 || label > header_.planes.size())
        fail_input(
            "{}: row {}, column {}: expected a plane from 1 to {}, found {}; make the file again from "
            "the scan",
            place_, row, col, header_.planes.size(), label);
    }
    const Vec3 ray = header_.ray(row, col);
    PointCode::Folded folded;
    for (std::size_t k = 0; k < 3; ++k)
      folded[k] = state == kByPlane ? columns_.by_plane[k][by_plane_] : columns_.by_sample[k][by_sample_];
    ++(state == kByPlane ? by_plane_ : by_sample_);
    scan.points[node] = code_.decode(ray, predicted_range(header_, ray, label, before), folded);
    before.range_m = range_of(header_, scan.points[node]);
    if (header_.intensity) {
      before.intensity += unfold(columns_.intensity[taken_]);
      scan.intensity[node] = header_.intensity_code.decode(before.intensity);
    }
    if (header_.colour)
      for (std::size_t c = 0; c < 3; ++c)
        scan.rgb[node][c] = before.rgb[c] =
            static_cast<std::uint8_t>(before.rgb[c] + columns_.rgb[c][taken_]);
    ++taken_;
  }

  const SampleHeader& header_;
  std::string place_;
  PointCode code_;
  int scan_row_;
  Columns columns_;
  std::size_t samples_ = 0, by_plane_ = 0, by_sample_ = 0, taken_ = 0;
};

int rows_in_band(const SampleHeader& header, int first_row) {
  return std::min(kBandRows, header.rows - first_row);
}

}  // namespace

EncodedBand encode_band(const SampleHeader& header, const SampleFileInput& input, int first_row) {
  const PointCode code(header.point, header.origin);
  Columns columns;
  for (int row = first_row; row < first_row + rows_in_band(header, first_row); ++row) {
    Before before;
    for (int col = 0; col < header.cols; ++col) take_node(header, input, code, row, col, before, columns);
  }
  EncodedBand band;
  append_column(columns.state, band.bytes);
  band.discarded_bytes += append_column(columns.label, band.bytes);
  for (const Column& column : columns.by_plane) band.discarded_bytes += append_column(column, band.bytes);
  for (const Column& column : columns.by_sample) append_column(column, band.bytes);
  if (header.intensity) append_column(columns.intensity, band.bytes);
  if (header.colour)
    for (const Column& column : columns.rgb) append_column(column, band.bytes);
  return band;
}

std::uint64_t decode_band(const SampleHeader& header, std::string_view bytes, const std::string& place,
                          int first_row, Scan& scan, int scan_row) {
  const int rows = rows_in_band(header, first_row);
  BandDecoder decoder(header, bytes, place, rows, scan_row);
  for (int row = 0; row < rows; ++row) decoder.put_row(row, first_row + row, scan);
  return decoder.samples();
}

}  // namespace hybrid::io
