#include "batch/registration/place_sheet.hpp"

#include <algorithm>
#include <cmath>

#include "batch/picture_marks.hpp"
#include "batch/registration/landmark_sheet.hpp"
#include "batch/scene_request.hpp"
#include "core/parallel.hpp"
#include "io/output.hpp"
#include "io/picture.hpp"

namespace hybrid::batch {
namespace {

namespace fs = std::filesystem;

constexpr Ink kScanWall = {20, 80, 200}, kScanRest = {140, 180, 235}, kOtherWall = {120, 120, 120},
              kOtherRest = {205, 205, 205}, kModelEdge = {0, 0, 0}, kScannerInk = {200, 20, 20},
              kTextInk = {30, 30, 30};
constexpr int kPanel = 900, kGap = 24, kBig = 7, kSmall = 2;  // pixels; cells of digits
constexpr int kEdgeWidth = 5;                                 // samples of a wall leave its rims black
// Nodes that are drawn, about: of the scan, of all others together; samples that make small dots.
constexpr double kLooked = 6e5, kLookedOfOthers = 3e6;
constexpr std::size_t kManyDots = 100000;
// From above floors and ceilings hide the rest: planes so far from upright are left out.
constexpr double kMostLevel = 0.5;
// Samples beyond the picture; what is around it, of its size, and at least.
constexpr double kOutermost = 0.01, kMargin = 0.06, kLeastMargin_m = 2;
constexpr int kLooks = 12;  // columns that are named, about

// A sample as seen from above.
struct PlanSample {
  Vec2 at;
  bool on_plane = false;
};

// By label, whether the plane is level: floors and ceilings; 0 is none.
std::vector<char> level_planes(const PlaneSegmentation& segmentation, const Pose& pose) {
  std::vector<char> level(segmentation.superclusters.size() + 1, 0);
  for (const auto& supercluster : segmentation.superclusters)
    level[supercluster.id] = std::abs(pose.rotate(supercluster.plane.normal).z()) > kMostLevel;
  return level;
}

// Of the walls and what is of no plane, in order of the nodes.
std::vector<PlanSample> plan_of(const ScanProduct& product, const Pose& pose, double nodes) {
  const RangeImage& image = product.image;
  const auto& labels = product.segmentation.sample_label;
  const auto level = level_planes(product.segmentation, pose);
  const int step =
      std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(image.count()) / nodes))));
  std::vector<PlanSample> plan;
  for (int row = 0; row < image.rows; row += step)
    for (int col = 0; col < image.cols; col += step) {
      const std::size_t i = image.index(row, col);
      if (image.mask[i] == kMeasured && !level[labels[i]])
        plan.push_back({(pose * image.point(i)).head<2>(), labels[i] != 0});
    }
  return plan;
}

using Box2 = Eigen::AlignedBox2d;

// But for the outermost ones on each side.
Box2 box_of(const std::vector<PlanSample>& plan) {
  Box2 box;
  if (plan.empty()) return box;
  std::vector<double> values(plan.size());
  const auto skipped = static_cast<std::ptrdiff_t>(kOutermost * static_cast<double>(plan.size()));
  Vec2 least, most;
  for (int axis = 0; axis < 2; ++axis) {
    std::transform(plan.begin(), plan.end(), values.begin(),
                   [&](const PlanSample& sample) { return sample.at[axis]; });
    std::nth_element(values.begin(), values.begin() + skipped, values.end());
    least[axis] = values[static_cast<std::size_t>(skipped)];
    std::nth_element(values.begin(), values.end() - 1 - skipped, values.end());
    most[axis] = *(values.end() - 1 - skipped);
  }
  box.extend(least);
  box.extend(most);
  return box;
}

// Where on the wall the columns look that scan.png's grid names: of each, the sample at the median distance.
std::vector<std::pair<int, Vec3>> looks_of(const ScanProduct& product, const Pose& pose) {
  const RangeImage& image = product.image;
  const auto level = level_planes(product.segmentation, pose);
  int step = sheet_grid_step(image);
  while (image.cols > step * kLooks) step *= 2;
  std::vector<std::pair<int, Vec3>> looks;
  for (int col = 0; col < image.cols; col += step) {
    std::vector<std::pair<double, std::size_t>> seen;  // metres from above
    for (int row = 0; row < image.rows; ++row) {
      const std::size_t i = image.index(row, col);
      const std::uint32_t label = product.segmentation.sample_label[i];
      if (image.mask[i] != kMeasured || label == 0 || level[label]) continue;
      seen.emplace_back(pose.rotate(image.point(i)).head<2>().norm(), i);
    }
    if (seen.empty()) continue;
    const auto middle = seen.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
    std::nth_element(seen.begin(), middle, seen.end());
    looks.emplace_back(col, image.point(middle->second));
  }
  return looks;
}

// A part of a picture that shows the world from above, y upwards.
class Plan {
 public:
  Plan(Image8& picture, int left, int top, int width, int height, const Box2& world)
      : picture_(picture), left_(left), top_(top), width_(width), height_(height), world_(world) {
    scale_ = std::min(width / world.sizes().x(), height / world.sizes().y());
  }
  Vec2 pixel(const Vec2& at) const {
    return Vec2(left_ + width_ / 2.0, top_ + height_ / 2.0) +
           scale_ * Vec2(at.x() - world_.center().x(), world_.center().y() - at.y());
  }
  bool shows(const Vec2& pixel) const {
    return pixel.x() >= left_ && pixel.y() >= top_ && pixel.x() < left_ + width_ &&
           pixel.y() < top_ + height_;
  }
  // Few samples make large dots.
  void dots(const std::vector<PlanSample>& plan, bool on_plane, const Ink& ink) {
    const int size = plan.size() > kManyDots ? 1 : plan.size() > kManyDots / 4 ? 2 : 3;
    for (const PlanSample& sample : plan) {
      const Vec2 p = pixel(sample.at);
      if (sample.on_plane != on_plane || !shows(p) || !shows(p + Vec2::Constant(size - 1))) continue;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
          std::copy(ink.begin(), ink.end(),
                    picture_.at(static_cast<int>(p.x()) + x, static_cast<int>(p.y()) + y));
    }
  }
  // The part of it between the panel's borders.
  void line(const Vec2& from, const Vec2& to, const Ink& ink, int width = 1) {
    Vec2 a = pixel(from), b = pixel(to);
    const Vec2 d = b - a;
    double begin = 0, end = 1;
    const Vec2 least(left_, top_), most(left_ + width_ - 1, top_ + height_ - 1);
    for (int axis = 0; axis < 2; ++axis) {
      if (d[axis] == 0) {
        if (a[axis] < least[axis] || a[axis] > most[axis]) return;
        continue;
      }
      const double first = (least[axis] - a[axis]) / d[axis], second = (most[axis] - a[axis]) / d[axis];
      begin = std::max(begin, std::min(first, second));
      end = std::min(end, std::max(first, second));
    }
    if (begin < end) draw_line(picture_, a + begin * d, a + end * d, ink, width);
  }
  void frame() {
    const Vec2 a(left_, top_), b(left_ + width_ - 1, top_ + height_ - 1);
    for (const Vec2& corner : {a, b})
      for (const Vec2& other : {Vec2(a.x(), b.y()), Vec2(b.x(), a.y())})
        draw_line(picture_, corner, other, kOtherRest);
  }
  // A bar of 1, 2, 5, 10 ... metres, at most a quarter of the width.
  void scale_bar() {
    int metres = 1;
    for (int k = 0; scale_ * metres * (k % 3 == 1 ? 2.5 : 2) <= width_ / 4.0 && metres < 100000; ++k)
      metres = metres * (k % 3 == 1 ? 5 : 4) / 2;
    const Vec2 a(left_ + 16, top_ + height_ - 16);
    draw_line(picture_, a, a + Vec2(scale_ * metres, 0), kTextInk, 3);
    draw_text(picture_, left_ + 16, top_ + height_ - 40, std::to_string(metres) + " m", kSmall, kTextInk);
  }

 private:
  Image8& picture_;
  int left_, top_, width_, height_;
  Box2 world_;
  double scale_ = 1;
};

void draw_edges(const PolygonModel& model, Plan& plan) {
  const auto ring = [&](const std::vector<std::uint32_t>& vertices) {
    for (std::size_t k = 0; k < vertices.size(); ++k)
      plan.line(model.vertices[vertices[k]].head<2>(),
                model.vertices[vertices[(k + 1) % vertices.size()]].head<2>(), kModelEdge, kEdgeWidth);
  };
  for (const Face& face : model.faces) {
    ring(face.outer);
    for (const auto& hole : face.holes) ring(hole);
  }
}

// As the scene file takes it, in the coordinates of the scan's file.
std::string pose_lines(const Pose& pose) {
  const auto m = row_major(pose);
  std::string text = "# pose = [\n";
  for (std::size_t row = 0; row < 4; ++row)
    text += fmt::format("#   {:.12g}, {:.12g}, {:.12g}, {:.12g},\n", m[4 * row], m[4 * row + 1],
                        m[4 * row + 2], m[4 * row + 3]);
  return text + "# ]\n";
}

std::string stanzas(std::size_t i, const std::vector<ScanProduct>& products,
                    const Registrations& registrations, const ScanRegistration& abstained, bool has_model,
                    const io::SceneScan& entry) {
  std::string text = fmt::format(
      "# For the [[scan]] table of \"{}\" in the scene file: take the \"# \" away from the pose of the place "
      "that is\n# right in places.png, where this scan is blue, the others grey, the model black, and the "
      "scanner red, with\n# the columns of scan.png that look there. ICP starts from it.\n",
      products[i].id);
  const auto frame = std::find_if(registrations.begin(), registrations.end(),
                                  [](const auto& one) { return one.has_value(); });
  if (!has_model && frame != registrations.end() && frame != registrations.begin())
    text += fmt::format(
        "# Poses are in the frame of scan \"{}\": put its [[scan]] table first, so that it stays the "
        "frame.\n",
        products[static_cast<std::size_t>(frame - registrations.begin())].id);
  text += fmt::format("# None was taken: {}\n", reason_of(abstained));
  for (std::size_t k = 0; k < abstained.places.size(); ++k)
    text += fmt::format("\n# {}: {}\n{}", k + 1, abstained.places[k].words,
                        pose_lines(in_file_frame(entry, abstained.places[k].world_from_scan)));
  return text;
}

}  // namespace

Image8 place_sheet(std::size_t i, const std::vector<ScanProduct>& products,
                   const Registrations& registrations, const std::vector<PossiblePlace>& places,
                   const PolygonModel* model) {
  std::vector<std::vector<PlanSample>> others(products.size()), own(places.size());
  const double nodes_of_other = std::min(kLooked, kLookedOfOthers / static_cast<double>(products.size()));
  parallel_for(products.size() + places.size(), [&](std::size_t k) {
    if (k >= products.size())
      own[k - products.size()] = plan_of(products[i], places[k - products.size()].world_from_scan, kLooked);
    else if (registrations[k])
      others[k] = plan_of(products[k], registrations[k]->world_from_scan(), nodes_of_other);
  });
  Box2 world;
  for (std::size_t k = 0; k < places.size(); ++k) {
    world.extend(box_of(own[k]));
    world.extend(Vec2(places[k].world_from_scan.translation.head<2>()));
  }
  const double margin = std::max(kMargin * world.sizes().maxCoeff(), kLeastMargin_m);
  world = Box2(world.min() - Vec2::Constant(margin), world.max() + Vec2::Constant(margin));
  const double aspect = world.sizes().y() / world.sizes().x();
  const int width = aspect > 1 ? std::max(kPanel / 3, static_cast<int>(kPanel / aspect)) : kPanel;
  const int height = aspect > 1 ? kPanel : std::max(kPanel / 3, static_cast<int>(kPanel * aspect));
  const int in_row = std::min(2, static_cast<int>(places.size()));
  const int rows = (static_cast<int>(places.size()) + in_row - 1) / in_row;
  Image8 picture(in_row * (width + kGap) + kGap, rows * (height + kGap) + kGap, 3);
  std::fill(picture.pixels.begin(), picture.pixels.end(), std::uint8_t{255});
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Pose& pose = places[k].world_from_scan;
    const int left = kGap + static_cast<int>(k) % in_row * (width + kGap),
              top = kGap + static_cast<int>(k) / in_row * (height + kGap);
    Plan plan(picture, left, top, width, height, world);
    for (const bool on_plane : {false, true})
      for (const auto& other : others) plan.dots(other, on_plane, on_plane ? kOtherWall : kOtherRest);
    if (model != nullptr) draw_edges(*model, plan);
    for (const bool on_plane : {false, true}) plan.dots(own[k], on_plane, on_plane ? kScanWall : kScanRest);
    plan.frame();
    const Vec2 scanner = plan.pixel(pose.translation.head<2>());
    NumberLabels labels(picture, kSmall, kScannerInk);
    for (const auto& [col, point] : looks_of(products[i], pose)) {
      const Vec2 at = plan.pixel((pose * point).head<2>());
      if (!plan.shows(at)) continue;
      plan.line(pose.translation.head<2>(), (pose * point).head<2>(), kScannerInk);
      labels.add(at, col);
    }
    draw_disc(picture, scanner, 6, kScannerInk);
    draw_number(picture, left + 16, top + 16, static_cast<int>(k) + 1, kBig, kTextInk);
    plan.scale_bar();
  }
  return picture;
}

void write_place_sheet(const fs::path& folder, std::size_t i, const std::vector<ScanProduct>& products,
                       const Registrations& registrations, const ScanRegistration& abstained,
                       const PolygonModel* model, const io::SceneScan& entry) {
  if (abstained.places.empty()) return;
  const fs::path sheet = folder / "sheet";
  io::write_png(sheet / "places.png", place_sheet(i, products, registrations, abstained.places, model));
  io::write_text(sheet / "places.toml",
                 stanzas(i, products, registrations, abstained, model != nullptr, entry));
}

}  // namespace hybrid::batch
