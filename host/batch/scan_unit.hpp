#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "batch/progress.hpp"
#include "batch/stage_options.hpp"
#include "device/queue.hpp"
#include "geometry/image.hpp"
#include "geometry/scan.hpp"
#include "io/grid_scan.hpp"
#include "io/ply/ply.hpp"
#include "io/samples/sample_file.hpp"
#include "stages/contours/contour_faces.hpp"
#include "stages/contours/intersections.hpp"
#include "stages/scan/sample_surface.hpp"
#include "stages/scan/stray_samples.hpp"

namespace hybrid::batch {

// What becomes of a registered scan's retained samples when it is drawn (choose_drawn_samples).
struct DrawnCounts {
  std::int64_t retained = 0;     // without strays and those of planes that were written as contours
  std::int64_t on_contours = 0;  // of these not drawn: they lie on a contour polygon
  std::int64_t in_the_air = 0;   // nor these: another scan looks through them
  std::int64_t seen_finer = 0;   // nor these: another scan has closer samples of the surface
  std::int64_t on_faces = 0;     // drawn only where the proxy is not

  DrawnCounts& operator+=(const DrawnCounts& other) {
    retained += other.retained;
    on_contours += other.on_contours;
    in_the_air += other.in_the_air;
    seen_finer += other.seen_finer;
    on_faces += other.on_faces;
    return *this;
  }
};

// What the planes stages make of one scan, kept for registration and rendering.
struct ScanProduct {
  std::string id;
  std::int64_t input_samples = 0;  // points in the file
  std::int64_t input_returns = 0;  // of these, with a finite point
  RangeImage image;
  PlaneSegmentation segmentation;
  std::vector<std::uint8_t> boundary;  // per node, from trace_contours
  std::vector<stages::Intersection> intersections;
  stages::Decimation decimation;
  std::vector<std::uint8_t> stray;                   // per node: stages::Stray
  stages::ContourFaces contour_faces;                // after registration: what no proxy face explains
  std::vector<std::uint8_t> drawn;                   // per node: stages::Drawn; after registration
  std::vector<stages::RadiusLimit> radius_limits{};  // of drawn nodes, ascending
  DrawnCounts drawn_counts{};                        // of them
  std::vector<std::uint8_t> clipped{};               // per node, 1: dropped by [edit] clip; or empty
  std::vector<std::uint8_t> extra_clipped{};         // the same per extra sample of the image
  double sigma_m = 0;                                // range noise used
  std::optional<Pose> recorded_pose;                 // as the file gave it
  std::optional<io::SampleFileSize> sample_file;     // lossless = true
  std::vector<std::string> notes;
};

// What detail.ply needs of a scan and its range image does not hold. A georeferenced scan stays whole: the
// image's floats are too coarse for its coordinates.
struct ScanRemains {
  bool intensity = false, colour = false;
  std::string crs{};
  std::vector<io::PlyPoint> extra{};  // the image's extra samples, in their order
  std::optional<Scan> georeferenced{};
};

// Samples that no grid node took are data too: those of them that are kept.
std::vector<io::PlyPoint> kept_extra(const ScanProduct& product, const ScanRemains& scan);

// METHOD 1-4 on one scan: resample, squares, superclusters, contours, decimation; then the samples that stand
// for no surface. The scan itself goes as soon as its range image stands, georeferenced ones excepted: half
// of the memory that the stages need. `edit`, where given, changes the range image, and the scan with it,
// before planes are looked for.
using EditImage = std::function<void(RangeImage&, Scan&)>;
struct ProcessedScan {
  ScanProduct product;
  ScanRemains remains;
};
ProcessedScan process_scan(device::Queue& queue, const std::string& id, Scan scan,
                           const StageOptions& options, Progress& progress, const EditImage& edit = {});

// The same of a scan whose samples are in their nodes already, as arranged by the input's own grid; for
// options without min_range_m, which needs the samples that it sets aside.
ProcessedScan process_scan(device::Queue& queue, const std::string& id, io::GridScan grid,
                           const StageOptions& options, Progress& progress);

// Colours of the range image's nodes, when photographs were projected on them.
using NodeColours = stages::Renderer::ColouredRange;

// scans/<id>/: range.exr, extra.ply (where samples lie beside the grid), range.png, classes.png, labels.exr,
// planes.json, intersections.obj and .png, planes/ (orthophotos). `attributes` and the recorded pose go to
// range.exr's header.
void write_plane_outputs(const std::filesystem::path& folder, const ScanProduct& product,
                         const ScanRemains& scan, std::map<std::string, std::string> attributes);
// scans/<id>/detail.ply: the retained measured samples and the input's extra samples, scan frame; colours
// when given. The property `stray` says why a sample is not drawn (stages::Stray), 0 for the others.
void write_detail(const std::filesystem::path& folder, const ScanProduct& product, const ScanRemains& scan,
                  const NodeColours* colours);
// scans/<id>/samples.hsf: every sample of the input that has a point, exactly.
io::SampleFileSize write_samples(const std::filesystem::path& folder, const ScanProduct& product,
                                 const ScanRemains& scan);
// scans/<id>/colour.exr.
void write_node_colours(const std::filesystem::path& folder, const ScanProduct& product,
                        const NodeColours& colours);

}  // namespace hybrid::batch
