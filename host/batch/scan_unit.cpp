#include "batch/scan_unit.hpp"

#include <algorithm>
#include <cmath>

#include "batch/orthophotos.hpp"
#include "batch/planes_json.hpp"
#include "core/free_memory.hpp"
#include "core/json_text.hpp"
#include "core/log.hpp"
#include "core/median.hpp"
#include "core/parallel.hpp"
#include "core/parallel_tasks.hpp"
#include "geometry/colour.hpp"
#include "io/exr/exr.hpp"
#include "io/exr/range_exr.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"
#include "io/ply/ply.hpp"
#include "stages/contours/class_picture.hpp"
#include "stages/contours/straight_contours.hpp"
#include "stages/scan/interleaving.hpp"
#include "stages/scan/organised_grid.hpp"

namespace hybrid::batch {
namespace {

// Median of the planar squares' direction uncertainty; 0 when there are none.
double median_sigma_normal(const stages::SquarePlanes& squares) {
  std::vector<float> sigmas;
  for (const auto& square : squares.squares)
    if (square.state == SQUARE_PLANAR) sigmas.push_back(square.sigma_normal);
  if (sigmas.empty()) return 0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

// square = "auto": the paper's 5 x 5 where its normals are good to about a degree, else the side at which
// they are (the uncertainty falls with the square of the side: extent times the root of the count), at
// most 16.
stages::SquarePlanes fit_squares(device::Queue& queue, const RangeImage& image, const StageOptions& options) {
  auto squares = stages::fit_square_planes(queue, image, options.squares);
  if (!options.auto_square) return squares;
  const double wanted_rad = 0.017;
  const double ratio = median_sigma_normal(squares) / wanted_rad;
  auto larger = options.squares;
  larger.square =
      std::clamp(static_cast<int>(std::ceil(larger.square * std::sqrt(ratio))), larger.square, 16);
  if (larger.square == squares.square) return squares;
  larger.sigma_m = squares.sigma_m;  // as estimated, the noise too: smaller squares are more, and purer
  auto refitted = stages::fit_square_planes(queue, image, larger);
  refitted.noise = squares.noise;
  return refitted;
}

std::int64_t count_returns(const Scan& scan) {
  return std::count_if(scan.points.begin(), scan.points.end(), [](const auto& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
  });
}

io::PlyPoint sample_point(const Scan& scan, std::uint32_t source) {
  io::PlyPoint point;
  const Vec3 position = scan.point(source);
  point.position = {position.x(), position.y(), position.z()};
  if (!scan.intensity.empty()) point.intensity = scan.intensity[source];
  if (!scan.rgb.empty()) point.rgb = scan.rgb[source];
  return point;
}

io::PlyPoint node_point(const RangeImage& image, std::size_t i) {
  io::PlyPoint point;
  point.position = {image.x[i], image.y[i], image.z[i]};
  if (!image.intensity.empty()) point.intensity = image.intensity[i];
  if (!image.rgb.empty()) point.rgb = image.rgb[i];
  return point;
}

// Samples that no grid node took, beside range.exr, which counts them.
void write_extra(const std::filesystem::path& folder, const ScanRemains& scan) {
  const auto file = folder / "extra.ply";
  if (scan.extra.empty()) {
    std::filesystem::remove(file);  // an older run's
    return;
  }
  io::PlyContent content;
  content.intensity = scan.intensity;
  content.colour = scan.colour;
  content.double_precision = scan.georeferenced.has_value();
  io::write_ply(file, scan.extra, content);
}

ScanRemains keep_remains(Scan scan, const RangeImage& image) {
  ScanRemains remains{.intensity = !scan.intensity.empty(), .colour = !scan.rgb.empty(), .crs = scan.crs};
  for (const std::uint32_t source : image.extra) remains.extra.push_back(sample_point(scan, source));
  if (!scan.origin.isZero()) remains.georeferenced = std::move(scan);
  return remains;
}

ScanProduct describe(const std::string& id, const Scan& scan, std::uint64_t samples, std::int64_t returns) {
  ScanProduct product;
  product.id = id;
  product.input_samples = static_cast<std::int64_t>(samples);
  product.input_returns = returns;
  product.recorded_pose = scan.world_from_scan;
  product.notes = scan.notes;
  return product;
}

// What a person should know of how the file's grid lies; "" of the usual layout.
std::string layout_note(stages::GridLayout layout) {
  using stages::GridLayout;
  switch (layout) {
    case GridLayout::as_filed:
    case GridLayout::no_angles:
      return "";
    case GridLayout::transposed:
      return "the file's rows are azimuths and its columns elevations: its grid is turned";
    case GridLayout::dimensions_swapped:
      return "the file gives the numbers of rows and columns the other way round: its grid is read as its "
             "samples lie";
    case GridLayout::other_order:
      return "the file has its samples in the other order than its format says, by rows or by columns: its "
             "grid is read as they lie";
    case GridLayout::over_zenith:
      return "the file's columns go over the zenith: what lies behind the scanner has columns of its own";
  }
  return "";
}

void note_layout(stages::GridLayout layout, ScanProduct& product) {
  if (const std::string note = layout_note(layout); !note.empty()) product.notes.push_back(note);
  if (layout != stages::GridLayout::no_angles) return;
  product.notes.emplace_back(
      "rows and columns of its grid are no angles seen from its origin, so that contours and areas of planes "
      "are missing or wrong: say how a camera's axes lie (axes of [[scan]], or hybrid planes --axes), or "
      "where the scanner stood (scanner of [[scan]], or hybrid planes --scanner x,y,z)");
  log::warning("scan {}: {}", product.id, product.notes.back());
}

// Lengths of which no scanner of architecture has so many, as a file's in millimetres or centimetres are.
void doubt_unit(ScanProduct& product) {
  constexpr double kFar_m = 500, kNear_m = 0.05;
  const RangeImage& image = product.image;
  constexpr std::size_t kLookedAt = 1 << 16;
  std::vector<double> ranges;
  for (std::size_t i = 0; i < image.count(); i += image.count() / kLookedAt + 1)
    if (image.mask[i] == kMeasured) ranges.push_back(static_cast<double>(image.range_m[i]));
  if (ranges.empty()) return;
  const double middle = median(ranges);
  if (middle == 0 || (middle > kNear_m && middle < kFar_m)) return;
  product.notes.push_back(
      fmt::format("half of its returns are {} m: are the file's lengths in metres? Else say so: "
                  "unit = \"mm\", \"cm\", \"ft\" or \"us-ft\" of [[scan]], or hybrid planes --unit",
                  middle > kFar_m ? fmt::format("farther than {:.0f}", middle)
                                  : fmt::format("nearer than {:.2g}", middle)));
  log::warning("scan {}: {}", product.id, product.notes.back());
}

// What follows the range image.
void find_planes(device::Queue& queue, const StageOptions& options, Progress& progress,
                 ScanProduct& product) {
  doubt_unit(product);
  const std::string unit = "scan " + product.id;
  progress.step("square planes", unit);
  const auto squares = fit_squares(queue, product.image, options);
  product.sigma_m = squares.sigma_m;
  progress.step("superclusters", unit);
  product.segmentation = stages::grow_superclusters(queue, product.image, squares, options.superclusters);
  if (product.segmentation.interleaved > stages::kMostInterleaved) {
    product.notes.push_back(fmt::format(
        "{:.1f} % of the samples on planes lie between those of a parallel plane: walls stray farther "
        "than planes.waviness = {:g} m; raise it, or let planes.most_waviness = 0.04 double it",
        100 * product.segmentation.interleaved, product.segmentation.waviness_m));
    log::warning("{}: {}", unit, product.notes.back());
  }
  if (product.segmentation.superclusters.empty()) {
    product.notes.emplace_back(
        "no plane was found: expected walls or floors of `planes.min_squares` squares; look at range.png, "
        "whether rows and columns are in the file's order and lengths in metres");
    log::warning("{}: {}", unit, product.notes.back());
  }
  progress.step("contours", unit);
  product.boundary = stages::trace_contours(queue, product.image, product.segmentation, options.contours);
  product.intersections = stages::find_intersections(product.image, product.segmentation);
  stages::straighten_contours(product.image, product.intersections, product.segmentation);
  progress.step("decimate", unit);
  product.decimation =
      stages::decimate(queue, product.image, product.segmentation, product.boundary, options.decimate);
  product.stray = stages::find_stray_samples(queue, product.image, product.segmentation.sample_label,
                                             product.sigma_m, options.stray);
  give_back_free_memory();
}

}  // namespace

std::vector<io::PlyPoint> kept_extra(const ScanProduct& product, const ScanRemains& scan) {
  if (product.extra_clipped.empty()) return scan.extra;
  std::vector<io::PlyPoint> kept;
  for (std::size_t i = 0; i < scan.extra.size(); ++i)
    if (!product.extra_clipped[i]) kept.push_back(scan.extra[i]);
  return kept;
}

ProcessedScan process_scan(device::Queue& queue, const std::string& id, Scan scan,
                           const StageOptions& options, Progress& progress, const EditImage& edit) {
  ProcessedScan processed{describe(id, scan, scan.points.size(), count_returns(scan)), {}};
  progress.step("resample", "scan " + id);
  auto layout = stages::GridLayout::as_filed;
  processed.product.image = stages::resample_scan(queue, scan, options.resample, &layout);
  note_layout(layout, processed.product);
  if (edit) edit(processed.product.image, scan);
  processed.remains = keep_remains(std::move(scan), processed.product.image);
  find_planes(queue, options, progress, processed.product);
  return processed;
}

ProcessedScan process_scan(device::Queue& queue, const std::string& id, io::GridScan grid,
                           const StageOptions& options, Progress& progress) {
  ProcessedScan processed{
      describe(id, grid.scan, grid.samples, static_cast<std::int64_t>(grid.returns)),
      {.intensity = !grid.image.intensity.empty(), .colour = !grid.image.rgb.empty(), .crs = grid.scan.crs}};
  progress.step("resample", "scan " + id);
  if (!grid.has_tables)
    note_layout(stages::orient_grid(grid.image, grid.rows_reversed, grid.cols_reversed), processed.product);
  processed.product.image = std::move(grid.image);
  find_planes(queue, options, progress, processed.product);
  return processed;
}

void write_plane_outputs(const std::filesystem::path& folder, const ScanProduct& product,
                         const ScanRemains& scan, std::map<std::string, std::string> attributes) {
  const auto& image = product.image;
  if (product.recorded_pose)  // unless a better one is given
    attributes.try_emplace("world_from_scan", nlohmann::json(row_major(*product.recorded_pose)).dump());
  // Encoding takes longer than the disk.
  run_tasks({
      [&] {
        io::write_png(folder / "classes.png", stages::class_picture(image, product.segmentation));
        // Drawn again: keeping it costs memory at the peak.
        auto picture = stages::class_picture(image, product.segmentation);
        stages::draw_intersections(image, product.intersections, picture);
        io::write_png(folder / "intersections.png", std::move(picture));
      },
      [&] { io::write_png(folder / "range.png", stages::range_picture(image)); },
      [&] {
        io::write_exr(folder / "labels.exr", image.cols, image.rows,
                      {{"id", nullptr, product.segmentation.sample_label.data(), 1}});
      },
      [&] { io::write_text(folder / "planes.json", json_text(planes_json(product)) + "\n"); },
      [&] { io::write_text(folder / "intersections.obj", intersections_obj(product)); },
      [&] { write_extra(folder, scan); },
      [&] { write_orthophotos(folder, product); },
      [&] { io::write_range_exr(folder / "range.exr", image, attributes); },
  });
}

void write_detail(const std::filesystem::path& folder, const ScanProduct& product, const ScanRemains& scan,
                  const NodeColours* colours) {
  const auto& image = product.image;
  io::PlyContent content;
  content.intensity = scan.intensity;
  content.colour = colours != nullptr || scan.colour;
  content.stray = true;
  content.double_precision = scan.georeferenced.has_value();
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < image.count(); ++i)
    if (product.decimation.fate[i] > stages::kDiscarded) kept.push_back(static_cast<std::uint32_t>(i));
  const auto beside = kept_extra(product, scan);
  const auto point_at = [&](std::size_t k) {
    if (k >= kept.size()) {  // without a colour from photographs
      io::PlyPoint extra = beside[k - kept.size()];
      if (colours) extra.rgb = {};
      return extra;
    }
    const std::size_t i = kept[k];
    auto point =
        scan.georeferenced ? sample_point(*scan.georeferenced, image.source[i]) : node_point(image, i);
    point.stray = product.stray[i];
    if (colours) {
      const auto light = colours->coverage[i] > 0 ? colours->toned(i) : std::array{1.0f, 0.0f, 0.0f};
      for (std::size_t channel = 0; channel < 3; ++channel)
        point.rgb[channel] = srgb_byte_from_linear(static_cast<double>(light[channel]));
    }
    return point;
  };
  io::write_ply(folder / "detail.ply", kept.size() + beside.size(), point_at, content);
}

io::SampleFileSize write_samples(const std::filesystem::path& folder, const ScanProduct& product,
                                 const ScanRemains& scan) {
  const auto& image = product.image;
  std::vector<std::uint8_t> discarded(image.count());
  for (std::size_t i = 0; i < discarded.size(); ++i)
    discarded[i] = product.decimation.fate[i] == stages::kDiscarded;
  io::SampleFileInput input{.image = image,
                            .planes = product.segmentation.superclusters,
                            .label = product.segmentation.sample_label,
                            .discarded = discarded,
                            .georeferenced = scan.georeferenced ? &*scan.georeferenced : nullptr,
                            .world_from_scan = product.recorded_pose,
                            .crs = scan.crs};
  for (const io::PlyPoint& point : scan.extra) {
    input.extra.push_back(point.position);
    if (scan.intensity) input.extra_intensity.push_back(point.intensity);
    if (scan.colour) input.extra_rgb.push_back(point.rgb);
  }
  return io::write_sample_file(folder / "samples.hsf", input);
}

void write_node_colours(const std::filesystem::path& folder, const ScanProduct& product,
                        const NodeColours& colours) {
  const float* rgb = colours.colour.pixels.data();
  io::write_exr(folder / "colour.exr", product.image.cols, product.image.rows,
                {{"R", rgb, nullptr, 3},
                 {"G", rgb + 1, nullptr, 3},
                 {"B", rgb + 2, nullptr, 3},
                 {"coverage", nullptr, colours.coverage.data(), 1}});
}

}  // namespace hybrid::batch
