#include "write/scan_stream.hpp"

#include <fmt/format.h>

#include <bit>
#include <iterator>

#include "write/e57_file.hpp"
#include "write/files.hpp"
#include "write/range_exr_file.hpp"
#include "write/truth_file.hpp"

namespace synth {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written in the machine's byte order");

class PlyFile : public ScanFile {
 public:
  explicit PlyFile(const std::filesystem::path& path) : file_(path) { file_.write(header(0)); }

  void add(const std::vector<Sample>& column) override {
    std::vector<float> numbers;
    for (const Sample& s : column)
      numbers.insert(numbers.end(),
                     {s.point_in_scan.x(), s.point_in_scan.y(), s.point_in_scan.z(), s.intensity});
    file_.write(numbers.data(), sizeof(float) * numbers.size());
    samples_ += column.size();
  }

  void finish() override {
    file_.seek(0);
    file_.write(header(samples_));
    file_.commit();
  }

 private:
  // As long whatever the number of samples: it is known last and written first.
  static std::string header(std::size_t samples) {
    const std::string count = std::to_string(samples);
    return fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment scan frame, metres; column by column, rising in "
        "each{}\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
        "end_header\n",
        std::string(16 - count.size(), ' '), count);
  }

  OutputFile file_;
  std::size_t samples_ = 0;
};

class PtxFile : public ScanFile {
 public:
  PtxFile(const std::filesystem::path& path, int columns, int rows) : file_(path), rows_(rows) {
    file_.write(fmt::format("{}\n{}\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n",
                            columns, rows));
  }

  void add(const std::vector<Sample>& column) override {
    std::string lines;
    for (const Sample& s : on_grid(column, rows_)) {
      const Eigen::Vector3f& p = s.point_in_scan;
      if (s.returned())
        fmt::format_to(std::back_inserter(lines), "{:.5f} {:.5f} {:.5f} {:.4f}\n", p.x(), p.y(), p.z(),
                       s.intensity);
      else
        lines += "0 0 0 0\n";
    }
    file_.write(lines);
  }

  void finish() override { file_.commit(); }

 private:
  OutputFile file_;
  int rows_;
};

}  // namespace

ScanFormat format_of(const ScannerPose& pose, const Options& options) {
  if (options.scan_format != ScanFormat::own) return options.scan_format;
  return pose.grid ? ScanFormat::ptx : ScanFormat::ply;
}

std::string scan_file_name(const ScannerPose& pose, const Options& options) {
  const ScanFormat format = format_of(pose, options);
  constexpr const char* kExtensions[] = {"", ".ply", ".ptx", ".exr", ".e57"};
  return pose.id + kExtensions[static_cast<std::size_t>(format)];
}

std::vector<Sample> on_grid(const std::vector<Sample>& column, int rows) {
  std::vector<Sample> placed(static_cast<std::size_t>(rows), no_return());
  for (const Sample& s : column) placed.at(static_cast<std::size_t>(s.row)) = s;
  return placed;
}

std::size_t file_samples(const ScannerPose& pose, const Options& options, std::size_t returns) {
  const ScanFormat format = format_of(pose, options);
  if (format == ScanFormat::ply || format == ScanFormat::e57) return returns;
  return static_cast<std::size_t>(options.preset.scan_columns) *
         static_cast<std::size_t>(grid_rows(pose, options.preset));
}

std::unique_ptr<ScanFile> open_scan_file(const std::filesystem::path& path, const ScannerPose& pose,
                                         const Options& options) {
  const ScanFormat format = format_of(pose, options);
  if (format == ScanFormat::exr) return open_range_exr(path, pose, options.preset);
  if (format == ScanFormat::ply) return std::make_unique<PlyFile>(path);
  if (format == ScanFormat::e57)
    return std::make_unique<E57ScanFile>(path, pose, options.preset, options.seed);
  return std::make_unique<PtxFile>(path, options.preset.scan_columns, grid_rows(pose, options.preset));
}

std::unique_ptr<ScanFile> open_truth_file(const std::filesystem::path& path, const ScannerPose& pose,
                                          const Options& options) {
  const ScanFormat format = format_of(pose, options);
  if (format == ScanFormat::exr) return open_truth_of_range_exr(path, pose, options.preset);
  return std::make_unique<TruthFile>(path, format == ScanFormat::ptx ? grid_rows(pose, options.preset) : 0);
}

}  // namespace synth
