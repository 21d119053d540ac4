#include "archive/kept_scan.hpp"

#include "archive/kept_file.hpp"

// One pass() per record. Each takes its record apart by a structured binding, which does not compile when a
// member is added: what is not kept here is lost for the scenes of an archive.
namespace hybrid::archive {
namespace {

using archive::pass;

template <typename File>
void pass(File& file, Vec3& v) {
  for (int k = 0; k < 3; ++k) pass(file, v[k]);
}

template <typename File>
void pass(File& file, Pose& pose) {
  auto& [scale, rotation, translation] = pose;
  pass(file, scale);
  for (int k = 0; k < 4; ++k) pass(file, rotation.coeffs()[k]);
  pass(file, translation);
}

template <typename File>
void pass(File& file, Plane& plane) {
  auto& [normal, offset_m] = plane;
  pass(file, normal);
  pass(file, offset_m);
}

// What std::vector<bool> is not: elements one by one.
template <typename File, typename T, typename PassOne>
void pass_each(File& file, std::vector<T>& values, const PassOne& pass_one) {
  const std::size_t count = file.count(values.size());
  for (std::size_t i = 0; i < count; ++i) {
    if constexpr (File::kReads) values.emplace_back();
    pass_one(values[i]);
  }
}

template <typename File, typename T, typename PassOne>
void pass_optional(File& file, std::optional<T>& value, const PassOne& pass_one) {
  bool there = value.has_value();
  pass(file, there);
  if (!there) return;
  if constexpr (File::kReads) value.emplace();
  pass_one(*value);
}

template <typename File>
void pass_points(File& file, std::vector<Vec3>& points) {
  pass_each(file, points, [&](Vec3& point) { pass(file, point); });
}

template <typename File>
void pass(File& file, RangeImage& image) {
  auto& [rows, cols, elevation_rad, azimuth_rad, wraps, range_m, x, y, z, mask, source, intensity, rgb, extra,
         duplicates] = image;
  const auto all = [&](auto&... members) { (pass(file, members), ...); };
  all(rows, cols, elevation_rad, azimuth_rad, wraps, range_m, x, y, z, mask, source, intensity, rgb, extra,
      duplicates);
}

template <typename File>
void pass(File& file, Supercluster& supercluster) {
  auto& [id, plane, centroid_m, rms_m, area_m2, squares, samples, contours] = supercluster;
  pass(file, id);
  pass(file, plane);
  pass(file, centroid_m);
  pass(file, rms_m);
  pass(file, area_m2);
  pass(file, squares);
  pass(file, samples);
  pass_each(file, contours, [&](ContourRing& ring) {
    auto& [points, outer] = ring;
    pass_points(file, points);
    pass(file, outer);
  });
}

template <typename File>
void pass(File& file, Cylinder& cylinder) {
  auto& [id, foot, axis, length_m, radius_m, taper, rms_m, sigma_radius_m, arc_deg, samples, inside] =
      cylinder;
  const auto all = [&](auto&... members) { (pass(file, members), ...); };
  all(id, foot, axis, length_m, radius_m, taper, rms_m, sigma_radius_m, arc_deg, samples, inside);
}

template <typename File>
void pass(File& file, PlaneSegmentation& segmentation) {
  auto& [square, waviness_m, interleaved, square_rows, square_cols, square_class, square_label, sample_label,
         superclusters, cylinders] = segmentation;
  pass(file, square);
  pass(file, waviness_m);
  pass(file, interleaved);
  pass(file, square_rows);
  pass(file, square_cols);
  pass(file, square_class);
  pass(file, square_label);
  pass(file, sample_label);
  pass_each(file, superclusters, [&](Supercluster& one) { pass(file, one); });
  pass_each(file, cylinders, [&](Cylinder& one) { pass(file, one); });
}

template <typename File>
void pass(File& file, stages::Intersection& segment) {
  auto& [planes, from, to, angle_deg, samples] = segment;
  for (std::uint32_t& plane : planes) pass(file, plane);
  pass(file, from);
  pass(file, to);
  pass(file, angle_deg);
  pass(file, samples);
}

template <typename File>
void pass(File& file, stages::Decimation& decimation) {
  auto& [fate, measured, discarded] = decimation;
  pass(file, fate);
  pass(file, measured);
  pass(file, discarded);
}

template <typename File>
void pass(File& file, batch::ScanProduct& product) {
  auto& [id, input_samples, input_returns, image, segmentation, boundary, intersections, decimation, stray,
         contour_faces, drawn, radius_limits, drawn_counts, clipped, extra_clipped, sigma_m, recorded_pose,
         sample_file, notes] = product;
  if (!contour_faces.fits.empty() || !drawn.empty() || !radius_limits.empty() || drawn_counts.retained != 0 ||
      !clipped.empty() || !extra_clipped.empty() || sample_file)
    fail(ErrorKind::failed, "scan {}: registered or written already; a scan is kept before", id);
  pass(file, id);
  pass(file, input_samples);
  pass(file, input_returns);
  pass(file, image);
  pass(file, segmentation);
  pass(file, boundary);
  pass_each(file, intersections, [&](stages::Intersection& one) { pass(file, one); });
  pass(file, decimation);
  pass(file, stray);
  pass(file, sigma_m);
  pass_optional(file, recorded_pose, [&](Pose& pose) { pass(file, pose); });
  pass_each(file, notes, [&](std::string& note) { pass(file, note); });
}

template <typename File>
void pass(File& file, Scan& scan) {
  auto& [name, points, origin, exact, steps, intensity, rgb, grid_rows, grid_cols, row_by_row, range_grid,
         node, scanner_is_known, world_from_scan, intensity_limits, crs, crs_records, notes] = scan;
  pass(file, name);
  pass(file, points);
  pass(file, origin);
  const auto all = [&](auto&... members) { (pass(file, members), ...); };
  all(exact);
  pass_optional(file, steps, [&](CoordinateSteps& of_file) {
    auto& [scale, offset] = of_file;
    pass(file, scale);
    pass(file, offset);
  });
  all(intensity, rgb, grid_rows, grid_cols, row_by_row, scanner_is_known);
  pass_optional(file, range_grid, [&](RangeGrid& grid) {
    auto& [elevation_rad, azimuth_rad, wraps, interpolated, interpolated_point] = grid;
    all(elevation_rad, azimuth_rad, wraps, interpolated, interpolated_point);
  });
  pass(file, node);
  pass_optional(file, world_from_scan, [&](Pose& pose) { pass(file, pose); });
  pass_optional(file, intensity_limits, [&](auto& limits) { pass(file, limits); });
  pass(file, crs);
  pass_each(file, crs_records, [&](CrsRecord& record) {
    auto& [id, bytes] = record;
    pass(file, id);
    pass(file, bytes);
  });
  pass_each(file, notes, [&](std::string& note) { pass(file, note); });
}

template <typename File>
void pass(File& file, batch::ScanRemains& remains) {
  auto& [intensity, colour, crs, extra, georeferenced] = remains;
  pass(file, intensity);
  pass(file, colour);
  pass(file, crs);
  static_assert(sizeof(io::PlyPoint) == 32);  // without gaps
  pass_array(file, extra, 4);
  pass_optional(file, georeferenced, [&](Scan& scan) { pass(file, scan); });
}

template <typename File>
void pass(File& file, batch::ProcessedScan& scan) {
  auto& [product, remains] = scan;
  pass(file, product);
  pass(file, remains);
}

}  // namespace

void write_kept_scan(const std::filesystem::path& file, batch::ProcessedScan& scan) {
  KeptWriter writer;
  pass(writer, scan);
  writer.save(file);
}

batch::ProcessedScan read_kept_scan(const std::filesystem::path& file) {
  batch::ProcessedScan scan;
  KeptReader reader(file);
  pass(reader, scan);
  reader.finish();
  return scan;
}

}  // namespace hybrid::archive
