#include "stages/editing/opening_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/parallel_blocks.hpp"

namespace hybrid::stages {
namespace {

constexpr std::size_t kMostPoints = 4'000'000;  // per scan
constexpr double kNear_m = 0.5;                 // samples this near may tell where a face's surface is
constexpr double kParallelDeg = 15;             // of their planes
constexpr double kGrazing = 0.17;               // cosine (80 degrees): flatter rays tell no place
constexpr double kAttached_m = 0.15;            // mouldings and the like stand out of a face so far
constexpr double kLeastTolerance_m = 0.02;      // about the surface, to be on it
constexpr std::size_t kLeastSamples = 100;      // parallel ones that tell where a surface is
constexpr double kLeastArea = 0.01;             // share of the face that they stand for

constexpr std::size_t kRunPoints = 128;
constexpr float kConeSlack = 1e-5f;  // of cosines, for rounding

// Every n-th row and column.
int stride_of(const RangeImage& image) {
  return static_cast<int>(
      std::ceil(std::sqrt(static_cast<double>(image.count()) / static_cast<double>(kMostPoints))));
}

EvidenceRun run_of(const EvidenceCloud& cloud, std::size_t first, std::size_t count) {
  EvidenceRun run{first, count};
  const Vec3 scanner = cloud.scanners[cloud.points[first].scan] - cloud.origin;
  const auto ray = [&](std::size_t i) -> Vec3 { return cloud.points[i].point.cast<double>() - scanner; };
  Vec3 sum = Vec3::Zero();
  double far_m = 0;
  for (std::size_t i = first; i < first + count; ++i) {
    sum += ray(i).normalized();
    far_m = std::max(far_m, ray(i).norm());
  }
  run.far_m = static_cast<float>(far_m);
  const Vec3 axis = sum.normalized();
  double cosine = 1;
  for (std::size_t i = first; i < first + count; ++i)
    cosine = std::min(cosine, axis.dot(ray(i).normalized()));
  if (!(cosine > 0)) return run;
  run.axis = axis.cast<float>();
  run.cosine = static_cast<float>(cosine);
  run.sine = static_cast<float>(std::sqrt(std::max(0.0, 1 - cosine * cosine)));
  return run;
}

// `row_end`: of each row's points, the first one's beginning at the cloud's end before this scan's.
void append_runs(const std::vector<std::size_t>& row_end, EvidenceCloud& cloud) {
  std::vector<std::pair<std::size_t, std::size_t>> parts;  // first, count
  for (std::size_t r = 1; r < row_end.size(); ++r)
    for (std::size_t first = row_end[r - 1]; first < row_end[r]; first += kRunPoints)
      parts.emplace_back(first, std::min(kRunPoints, row_end[r] - first));
  const std::size_t before = cloud.runs.size();
  cloud.first_run.push_back(before);
  cloud.runs.resize(before + parts.size());
  parallel_for(parts.size(), [&](std::size_t i) {
    cloud.runs[before + i] = run_of(cloud, parts[i].first, parts[i].second);
  });
}

// The runs with points of whose rays some may pass the face, or that may lie near it: those that reach the
// sphere about the face and what is near it. In their order.
std::vector<std::size_t> runs_towards(const EvidenceCloud& cloud, const FaceFrame& frame) {
  const Vec3 centre = frame.origin + 0.5 * frame.size.x() * frame.u + 0.5 * frame.size.y() * frame.v;
  const double radius = 0.5 * frame.size.norm() + kNear_m;
  std::vector<std::size_t> towards;
  for (std::size_t s = 0; s < cloud.scanners.size(); ++s) {
    const Vec3 to = centre - cloud.scanners[s];
    const double far_m = to.norm(), sine = radius / far_m;
    const bool is_inside = !(sine < 1);
    const Vec3f axis = (to / far_m).cast<float>();
    const auto face_sine = static_cast<float>(sine);
    const auto least_m = static_cast<float>(far_m - radius);
    const auto face_cosine = is_inside ? 0.0f : static_cast<float>(std::sqrt(1 - sine * sine));
    for (std::size_t i = cloud.first_run[s]; i < cloud.first_run[s + 1]; ++i) {
      const EvidenceRun& run = cloud.runs[i];
      if (run.far_m < least_m) continue;
      if (is_inside || axis.dot(run.axis) >= run.cosine * face_cosine - run.sine * face_sine - kConeSlack)
        towards.push_back(i);
    }
  }
  return towards;
}

void append_scan(const OpeningScan& scan, std::uint16_t index, EvidenceCloud& cloud) {
  const RangeImage& image = *scan.image;
  const int stride = std::max(1, stride_of(image));
  const double step = image.step_rad();
  cloud.step_rad.push_back(step * stride);
  cloud.scanners.push_back(scan.world_from_scan.translation);
  const double cell_sr = image.elevation_step_rad() * image.azimuth_step_rad() * stride * stride;
  const auto is_taken = [&](std::size_t i) {
    return image.mask[i] == kMeasured && !(scan.ignored && (*scan.ignored)[i]);
  };
  const auto rows = static_cast<std::size_t>((image.rows + stride - 1) / stride);
  std::vector<std::size_t> first(rows + 1, 0);  // of a row's points
  parallel_for(rows, [&](std::size_t r) {
    for (int col = 0; col < image.cols; col += stride)
      first[r + 1] += is_taken(image.index(static_cast<int>(r) * stride, col));
  });
  first[0] = cloud.points.size();
  std::partial_sum(first.begin(), first.end(), first.begin());
  cloud.points.resize(first[rows]);
  parallel_for(rows, [&](std::size_t r) {
    const int row = static_cast<int>(r) * stride;
    const double row_sr = cell_sr * std::cos(image.elevation_rad[static_cast<std::size_t>(row)]);
    EvidencePoint* next = cloud.points.data() + first[r];
    for (int col = 0; col < image.cols; col += stride) {
      const std::size_t i = image.index(row, col);
      if (!is_taken(i)) continue;
      EvidencePoint& point = *next++;
      const Vec3 own = image.point(i);
      point.point = (scan.world_from_scan * own - cloud.origin).cast<float>();
      point.scan = index;
      point.normal.setZero();
      point.area_m2 = 0;
      const std::uint32_t label = scan.segmentation->sample_label[i];
      if (label == 0) continue;
      const Vec3& normal = scan.segmentation->superclusters[label - 1].plane.normal;
      const double range = own.norm(), cosine = std::max(0.05, std::abs(normal.dot(own)) / range);
      point.normal = scan.world_from_scan.rotate(normal).cast<float>();
      point.area_m2 = static_cast<float>(row_sr * range * range / cosine);
    }
  });
  append_runs(first, cloud);
}

double median_of(std::vector<std::pair<double, double>>& weighted) {
  std::sort(weighted.begin(), weighted.end());
  double total = 0, sum = 0;
  for (const auto& [value, weight] : weighted) total += weight;
  for (const auto& [value, weight] : weighted)
    if ((sum += weight) >= total / 2) return value;
  return 0;
}

// Centre of the window of heights that holds the most area: a surface, even where panes or boards beside it
// are parallel to it.
double busiest_height(const std::vector<std::pair<double, double>>& sorted, double window_m) {
  double best = -1, sum = 0, centre = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    sum += sorted[i].second;
    while (sorted[i].first - sorted[first].first > window_m) sum -= sorted[first++].second;
    if (sum > best * (1 + 1e-9)) {
      best = sum;
      centre = 0.5 * (sorted[i].first + sorted[first].first);
    }
  }
  return centre;
}

}  // namespace

EvidenceCloud gather_points(const PolygonModel& model, const std::vector<OpeningScan>& scans) {
  EvidenceCloud cloud;
  cloud.origin = model.vertices.empty() ? Vec3(Vec3::Zero()) : model.vertices[0];
  for (std::size_t s = 0; s < scans.size(); ++s) append_scan(scans[s], static_cast<std::uint16_t>(s), cloud);
  cloud.first_run.push_back(cloud.runs.size());
  return cloud;
}

FaceSamples samples_of_face(const EvidenceCloud& cloud, const FaceFrame& frame) {
  FaceSamples face;
  for (const Vec3& scanner : cloud.scanners) {
    face.scanner_foot.push_back(frame.flat(scanner));
    face.scanner_height_m.push_back(frame.plane.distance(scanner));
  }
  const Vec3f u = frame.u.cast<float>(), v = frame.v.cast<float>(), n = frame.plane.normal.cast<float>();
  const Vec3f shift = (cloud.origin - frame.origin).cast<float>();
  const auto parallel_cosine = static_cast<float>(std::cos(kParallelDeg * std::numbers::pi / 180));
  const std::vector<std::size_t> towards = runs_towards(cloud, frame);
  constexpr std::size_t kBlock = 512;
  std::vector<std::vector<FaceSample>> blocks((towards.size() + kBlock - 1) / kBlock);
  const auto take = [&](const EvidenceRun& run, std::vector<FaceSample>& samples) {
    for (std::size_t i = run.first; i < run.first + run.count; ++i) {
      const EvidencePoint& p = cloud.points[i];
      const Vec3f local = p.point + shift;
      const float height = n.dot(local);
      const auto scanner = static_cast<float>(face.scanner_height_m[p.scan]);
      const bool passed = (height < 0) != (scanner < 0);
      if (!passed && std::abs(height) > kNear_m) continue;
      const Vec2f foot(u.dot(local), v.dot(local));
      const Vec2f from = face.scanner_foot[p.scan].cast<float>();
      const float t = passed ? scanner / (scanner - height) : 1.0f;
      const Vec2f at = from + t * (foot - from);
      const Vec2f& judged = std::abs(height) <= kNear_m && !passed ? foot : at;
      if (judged.x() < 0 || judged.y() < 0 || judged.x() > frame.size.x() || judged.y() > frame.size.y())
        continue;
      const float length = std::hypot((foot - from).norm(), height - scanner);
      const float cosine = std::abs(scanner - height) / length;
      if (cosine < kGrazing) continue;
      const float spacing = static_cast<float>(cloud.step_rad[p.scan]) * length * t / std::sqrt(cosine);
      samples.push_back({foot.x(), foot.y(), height, p.area_m2, spacing, p.scan,
                         n.dot(p.normal) * (scanner > 0 ? 1.0f : -1.0f) > parallel_cosine});
    }
  };
  for_blocks(towards.size(), kBlock, [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) take(cloud.runs[towards[i]], blocks[block]);
  });
  for (const auto& block : blocks) face.samples.insert(face.samples.end(), block.begin(), block.end());
  return face;
}

void measure_surface(const FaceSamples& samples, const std::vector<Ring2>& rings, double displaced_m,
                     FaceEvidence& face) {
  face.samples = static_cast<std::int64_t>(samples.samples.size());
  face.status = "unseen";
  std::vector<std::pair<double, double>> heights;
  double area = 0;
  for (const FaceSample& s : samples.samples)
    if (s.parallel && samples.scanner_height_m[s.scan] > 0 && std::abs(s.height_m) < kNear_m &&
        on_face(rings, Vec2(s.u, s.v))) {
      heights.emplace_back(s.height_m, s.area_m2);
      area += s.area_m2;
    }
  double face_area = std::abs(signed_area(rings[0]));
  for (std::size_t h = 1; h < rings.size(); ++h) face_area -= std::abs(signed_area(rings[h]));
  if (heights.size() < kLeastSamples || area < kLeastArea * face_area) return;
  std::sort(heights.begin(), heights.end());
  const double window_m = 0.06, centre = busiest_height(heights, window_m);
  std::erase_if(heights, [&](const auto& h) { return std::abs(h.first - centre) > window_m; });
  face.offset_m = median_of(heights);
  for (auto& h : heights) h.first = std::abs(h.first - face.offset_m);
  face.spread_m = 1.4826 * median_of(heights);
  face.seen = true;
  face.status = std::abs(face.offset_m) >= displaced_m ? "displaced" : "as modelled";
}

std::vector<EvidenceMark> classify(const FaceSamples& samples, const FaceEvidence& face) {
  const double tolerance = std::max(kLeastTolerance_m, 4 * face.spread_m);
  std::vector<EvidenceMark> marks;
  for (const FaceSample& s : samples.samples) {
    const double scanner = samples.scanner_height_m[s.scan] - face.offset_m;
    const double height = s.height_m - face.offset_m;
    const double side = scanner > 0 ? 1 : -1;  // the side that the scanner sees
    const double depth = -side * height;
    const Vec2f foot(s.u, s.v), from = samples.scanner_foot[s.scan].cast<float>();
    EvidenceMark mark{.at = foot, .depth_m = static_cast<float>(depth), .kind = CellEvidence::none};
    const bool crosses = s.area_m2 > 0 && !s.parallel;  // a reveal's edge, a door's open leaf
    if (std::abs(height) <= tolerance)
      mark.kind = crosses ? CellEvidence::none : CellEvidence::closed;
    else if (depth < 0)
      mark.kind = -depth <= kAttached_m && side > 0 ? CellEvidence::attached : CellEvidence::none;
    else {
      mark.at = from + static_cast<float>(scanner / (scanner - height)) * (foot - from);
      mark.slope = (foot - from) / static_cast<float>(std::abs(scanner - height));
      mark.kind = depth >= face.depth_m ? CellEvidence::through : CellEvidence::behind;
    }
    if (mark.kind != CellEvidence::none) marks.push_back(mark);
  }
  return marks;
}

std::vector<EvidenceMark> marks_near(const std::vector<EvidenceMark>& marks, const Ring2& ring,
                                     double margin_m) {
  const auto [low, high] = box_of(ring);
  std::vector<EvidenceMark> near;
  for (const EvidenceMark& mark : marks) {
    const Vec2 at = mark.at.cast<double>();
    if ((at.array() >= low.array() - margin_m).all() && (at.array() <= high.array() + margin_m).all())
      near.push_back(mark);
  }
  return near;
}

}  // namespace hybrid::stages
