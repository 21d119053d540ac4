#include "write/range_exr_file.hpp"

#include <ImfDoubleAttribute.h>
#include <ImfIntAttribute.h>

#include <cstddef>
#include <limits>

#include "write/turned_exr.hpp"

namespace synth {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct ScanPixel {
  float x = kNaN, y = kNaN, z = kNaN, range = kNaN, intensity = 0;
  std::uint32_t mask = 0;

  static ScanPixel of(const Sample& s) {
    const auto& p = s.point_in_scan;
    return {p.x(), p.y(), p.z(), static_cast<float>(p.cast<double>().norm()), s.intensity, 1};
  }
  static std::vector<TurnedExr::Channel> channels() {
    return {{"x", Imf::FLOAT, offsetof(ScanPixel, x)},
            {"y", Imf::FLOAT, offsetof(ScanPixel, y)},
            {"z", Imf::FLOAT, offsetof(ScanPixel, z)},
            {"range", Imf::FLOAT, offsetof(ScanPixel, range)},
            {"intensity", Imf::FLOAT, offsetof(ScanPixel, intensity)},
            {"mask", Imf::UINT, offsetof(ScanPixel, mask)}};
  }
};

struct TruthPixel {
  std::uint32_t plane = 0, kind = 0;
  float range = kNaN;

  static TruthPixel of(const Sample& s) {
    return {s.plane_id, static_cast<std::uint32_t>(s.kind), s.true_range_m};
  }
  static std::vector<TurnedExr::Channel> channels() {
    return {{"plane", Imf::UINT, offsetof(TruthPixel, plane)},
            {"kind", Imf::UINT, offsetof(TruthPixel, kind)},
            {"range", Imf::FLOAT, offsetof(TruthPixel, range)}};
  }
};

template <typename Pixel>
class GridImage : public ScanFile {
 public:
  GridImage(const std::filesystem::path& path, const Imf::Header& header, int rows)
      : rows_(static_cast<std::size_t>(rows)), image_(path, header, sizeof(Pixel), Pixel::channels()) {}

  void add(const std::vector<Sample>& column) override {
    std::vector<Pixel> pixels(rows_);
    for (const Sample& s : column) pixels.at(static_cast<std::size_t>(s.row)) = Pixel::of(s);
    image_.add_column(pixels.data());
  }
  void finish() override { image_.finish(); }

 private:
  std::size_t rows_;
  TurnedExr image_;
};

}  // namespace

std::unique_ptr<ScanFile> open_range_exr(const std::filesystem::path& path, const ScannerPose& pose,
                                         const Preset& preset) {
  const int rows = grid_rows(pose, preset);
  Imf::Header header(preset.scan_columns, rows);
  const auto tell = [&](const char* name, double value) { header.insert(name, Imf::DoubleAttribute(value)); };
  tell("hybrid:elevation_first_rad", lowest_row_rad(preset) + (rows - 1) * row_step_rad(preset));
  tell("hybrid:elevation_step_rad", -row_step_rad(preset));
  tell("hybrid:azimuth_first_rad", first_column_rad(preset));
  tell("hybrid:azimuth_step_rad", column_step_rad(preset));
  header.insert("hybrid:wraps", Imf::IntAttribute(1));
  return std::make_unique<GridImage<ScanPixel>>(path, header, rows);
}

std::unique_ptr<ScanFile> open_truth_of_range_exr(const std::filesystem::path& path, const ScannerPose& pose,
                                                  const Preset& preset) {
  const int rows = grid_rows(pose, preset);
  return std::make_unique<GridImage<TruthPixel>>(path, Imf::Header(preset.scan_columns, rows), rows);
}

}  // namespace synth
