// How the planes of squares by RANSAC (either score) compare with those by eigenvectors of all samples, which
// the paper rejected for their wrong orientations (section 2.1): on scans whose truth is known. Prints a
// table.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.hpp"
#include "geometry/pose.hpp"
#include "io/exr/range_exr.hpp"
#include "io/output.hpp"
#include "io/truth.hpp"
#include "stages/planes/square_planes.hpp"

namespace {
using namespace hybrid;
namespace fs = std::filesystem;

constexpr double kWrong_deg = 10;
constexpr double kMostOfOne = 0.9;  // of a square's samples on one plane: a square across an edge has fewer

struct Method {
  const char* name;
  const char* fit;
  const char* score;
};
constexpr std::array kMethods = {Method{"eigenvectors", "eigen", "msac"},
                                 Method{"RANSAC, paper", "ransac", "paper"},
                                 Method{"RANSAC, MSAC", "ransac", "msac"}};

// Unit normals of the true planes, scan frame, by id.
std::map<std::uint32_t, Vec3> true_normals(const fs::path& truth, const Pose& world_from_scan) {
  std::map<std::uint32_t, Vec3> normals;
  const auto document = nlohmann::json::parse(io::read_text(truth));
  for (const auto& plane : document.at("planes")) {
    const auto n = plane.at("normal").get<std::array<double, 3>>();
    normals[plane.at("id").get<std::uint32_t>()] =
        world_from_scan.rotation.conjugate() * Vec3(n[0], n[1], n[2]);
  }
  return normals;
}

double angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))) * 180 / std::numbers::pi;
}

// Squares on one true plane, and squares across an edge of planes: how many there are, how many got a plane,
// and how far its normal is from the nearest true one among the square's samples.
struct Kind {
  std::int64_t squares = 0;
  std::vector<double> degrees;

  double quantile(double q) {
    if (degrees.empty()) return 0;
    const auto at =
        degrees.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(degrees.size() - 1));
    std::nth_element(degrees.begin(), at, degrees.end());
    return *at;
  }
  double wrong_share() const {
    const auto wrong = std::count_if(degrees.begin(), degrees.end(), [](double d) { return d > kWrong_deg; });
    return degrees.empty() ? 0 : static_cast<double>(wrong) / static_cast<double>(degrees.size());
  }
  double planar_share() const {
    return squares == 0 ? 0 : static_cast<double>(degrees.size()) / static_cast<double>(squares);
  }
};

void compare(const RangeImage& image, const stages::SquarePlanes& squares, const io::ScanTruth& truth,
             const std::map<std::uint32_t, Vec3>& normals, Kind& one_plane, Kind& edge) {
  const int n = squares.square;
  for (int square = 0; square < squares.rows * squares.cols; ++square) {
    const SquareRecord& record = squares.squares[static_cast<std::size_t>(square)];
    std::map<std::uint32_t, int> planes;
    int samples = 0;
    const int top = square / squares.cols * n, left = square % squares.cols * n;
    for (int row = top; row < std::min(top + n, image.rows); ++row)
      for (int col = left; col < std::min(left + n, image.cols); ++col) {
        const std::size_t i = image.index(row, col);
        if (image.mask[i] != kMeasured) continue;
        samples += 1;
        if (const std::uint32_t id = truth.plane.at(image.source[i]); id != 0) planes[id] += 1;
      }
    int planar = 0, most = 0;
    for (const auto& [id, count] : planes) planar += count, most = std::max(most, count);
    // Squares with curved samples, and those that the fit does not look at, say nothing of the claim.
    if (record.state == SQUARE_UNDERSAMPLED || planes.empty() || planar < kMostOfOne * samples) continue;
    Kind& kind = most >= kMostOfOne * samples ? one_plane : edge;
    kind.squares += 1;
    if (record.state != SQUARE_PLANAR) continue;
    const Vec3 normal(record.normal[0], record.normal[1], record.normal[2]);
    double nearest = 90;
    for (const auto& [id, count] : planes) nearest = std::min(nearest, angle_deg(normal, normals.at(id)));
    kind.degrees.push_back(nearest);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Planes of squares by RANSAC and by eigenvectors, against a scan's truth");
  fs::path truth_file, results;
  std::string scan;
  std::vector<int> sides = {5, 8, 12};
  app.add_option("truth", truth_file, "truth.json of hybrid-synth")->required();
  app.add_option("results", results, "output folder of hybrid run or planes, for its range.exr")->required();
  app.add_option("--scan", scan, "id of the scan")->required();
  app.add_option("--square", sides, "sides of squares")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  try {
    const auto truths = io::read_truth(truth_file).scans;
    const auto truth =
        std::find_if(truths.begin(), truths.end(), [&](const auto& t) { return t.id == scan; });
    if (truth == truths.end()) fail_input("{}: expected the scan {}, found none", truth_file.string(), scan);
    const RangeImage image = io::read_range_exr(results / "scans" / scan / "range.exr");
    const auto normals = true_normals(truth_file, truth->world_from_scan);
    device::Queue queue("");
    fmt::print(
        "| square | fit | of one plane: planar | median / 95th percentile, deg | beyond {} deg | across an "
        "edge: planar "
        "| beyond {} deg of all its planes |\n|---|---|---|---|---|---|---|\n",
        kWrong_deg, kWrong_deg);
    for (const int side : sides)
      for (const Method& method : kMethods) {
        stages::SquarePlaneOptions options;
        options.square = side;
        options.fit = method.fit;
        options.score = method.score;
        Kind one_plane, edge;
        compare(image, stages::fit_square_planes(queue, image, options), *truth, normals, one_plane, edge);
        fmt::print("| {} | {} | {:.1f} % of {} | {:.2f} / {:.2f} | {:.2f} % | {:.1f} % of {} | {:.1f} % |\n",
                   side, method.name, 100 * one_plane.planar_share(), one_plane.squares,
                   one_plane.quantile(0.5), one_plane.quantile(0.95), 100 * one_plane.wrong_share(),
                   100 * edge.planar_share(), edge.squares, 100 * edge.wrong_share());
      }
  } catch (const Error& error) {
    fmt::print(stderr, "error {}\n", error.what());
    return exit_code(error.kind());
  }
}
