// Public benchmarks' layouts, on small files made here and on a real SynPEB image where there is one.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "perfect_results.hpp"
#include "places.hpp"
#include "score/benchmark_score.hpp"
#include "score/error.hpp"
#include "score/read/labelled_pcd.hpp"

namespace score_tests {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  const fs::path place = fs::path(HYBRID_E2E_DIR) / "score-benchmarks";
  fs::remove_all(place);
  fs::create_directories(place);
  return place;
}

// 20 x 20: the left half is region 10, the right half region 11, the first row noise.
std::string halves(int border) {
  std::string pixels;
  for (int row = 0; row < 20; ++row)
    for (int col = 0; col < 20; ++col)
      pixels.push_back(static_cast<char>(row == 0 ? 2 : col < border ? 10 : 11));
  return pixels;
}

void write_raster(const fs::path& file, const std::string& pixels, bool big_endian = true) {
  std::ofstream out(file, std::ios::binary);
  for (const std::uint32_t word : {0x59a66a95u, 20u, 20u, 8u, 400u, 1u, 0u, 0u})
    for (int k = 0; k < 4; ++k) out.put(static_cast<char>(word >> (8 * (big_endian ? 3 - k : k))));
  out << pixels;
}

// The cloud's own labels as a result.
void write_result(const fs::path& place, const score::LabelledPcd& cloud) {
  score::LabelledGrid grid;
  grid.rows = cloud.height;
  grid.cols = cloud.width;
  std::vector<float> range;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    grid.source.push_back(static_cast<std::uint32_t>(i));
    grid.label.push_back(cloud.label[i]);
    grid.point.push_back(cloud.points[i].cast<float>());
    range.push_back(static_cast<float>(cloud.points[i].norm()));
  }
  fs::create_directories(place);
  write_range_exr(place / "range.exr", grid, range);
  write_labels_exr(place / "labels.exr", grid);
}

std::string pcd(const std::string& data, const std::string& points) {
  return "VERSION .7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 20\nHEIGHT "
         "20\n"
         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 400\nDATA " +
         data + "\n" + points;
}

// A floor and a wall that meet at `border`.
std::string corner_points(int border, bool ascii) {
  std::string text;
  for (int i = 0; i < 400; ++i) {
    const int row = i / 20, col = i % 20;
    const bool floor = row < border;
    const float point[4] = {floor ? 0.1f * static_cast<float>(row) : 0.1f * static_cast<float>(border),
                            0.1f * static_cast<float>(col),
                            floor ? 1.0f : 1.0f + 0.1f * static_cast<float>(row - border),
                            floor ? 3.0f : 8.0f};
    if (ascii)
      text += fmt::format("{} {} {} {:.6f}\n", point[0], point[1], point[2], point[3]);
    else
      text.append(reinterpret_cast<const char*>(point), sizeof point);
  }
  return text;
}

}  // namespace

TEST(SegComp, its_own_labels_are_perfect) {
  const fs::path place = folder();
  write_raster(place / "a.gt-seg", halves(10));
  write_raster(place / "a.ms-seg", halves(10), false);  // as little-endian machines write it
  write_text(place / "a.gt-ang", "1\n10 11 60.0\n");
  write_text(place / "a.ms-nor", "2\n10 0 0 1\n11 0 0.8660254037844386 -0.5\n");
  const auto score = score::score_benchmark(place / "a.gt-seg", place / "a.ms-seg", {});
  EXPECT_EQ(score.planes.labels.planar, 380);
  EXPECT_EQ(score.planes.labels.right, 380);
  EXPECT_EQ(score.planes.hoover[6].correct, 2);
  EXPECT_EQ(score.angles_compared, 1);
  EXPECT_NEAR(score.mean_angle_error_deg, 0, 1e-9);
}

TEST(SegComp, a_shifted_border_costs_the_strict_overlaps) {
  const fs::path place = folder();
  write_raster(place / "a.gt-seg", halves(10));
  write_raster(place / "a.ms-seg", halves(12));  // 12 of 12 and 2 of 12 columns
  const auto score = score::score_benchmark(place / "a.gt-seg", place / "a.ms-seg", {});
  EXPECT_EQ(score.planes.hoover[0].correct, 2);
  EXPECT_EQ(score.planes.hoover[4].correct, 2);  // 80 %: 10 of 12, 8 of 10
  EXPECT_EQ(score.planes.hoover[5].correct, 0);
  EXPECT_DOUBLE_EQ(score.planes.boundary.displaced.median, 2);
  EXPECT_EQ(score.angles_compared, 0);
}

TEST(SegComp, other_files_are_refused) {
  const fs::path place = folder();
  write_text(place / "a.gt-seg", "this is no rasterfile, but long enough for a header");
  write_raster(place / "b.gt-seg", halves(10).substr(0, 100));
  for (const char* name : {"a.gt-seg", "b.gt-seg", "none.gt-seg"})
    EXPECT_THROW(score::score_benchmark(place / name, place, {}), score::InputError) << name;
}

TEST(SynPeb, ascii_and_binary_clouds_against_their_own_labels) {
  for (const bool ascii : {true, false}) {
    const fs::path place = folder();
    write_text(place / "a.pcd", pcd(ascii ? "ascii" : "binary", corner_points(12, ascii)));
    write_result(place / "result" / "scans" / "a", score::read_labelled_pcd(place / "a.pcd"));
    const auto score = score::score_benchmark(place / "a.pcd", place / "result", {});
    EXPECT_EQ(score.planes.labels.planes, 2);
    EXPECT_EQ(score.planes.labels.right, 400);
    EXPECT_EQ(score.planes.hoover[6].correct, 2);
    EXPECT_LT(score.planes.hoover[6].mean_angle_deg, 1e-3);
  }
}

TEST(SynPeb, a_file_is_no_folder_of_results) {
  const fs::path place = folder();
  write_text(place / "a.pcd", pcd("ascii", corner_points(12, true)));
  EXPECT_THROW(score::score_benchmark(place / "a.pcd", place / "a.pcd", {}), score::InputError);
}

TEST(SynPeb, other_clouds_are_refused) {
  const fs::path place = folder();
  write_text(place / "cut.pcd", pcd("ascii", "1 2 3 4\n"));
  write_text(place / "compressed.pcd", pcd("binary_compressed", std::string(5000, 'x')));
  write_text(place / "label.pcd", pcd("ascii", [] {
               std::string text;
               for (int i = 0; i < 400; ++i) text += "1 2 3 0.5\n";
               return text;
             }()));
  for (const char* name : {"cut.pcd", "compressed.pcd", "label.pcd"})
    EXPECT_THROW(score::read_labelled_pcd(place / name), score::InputError) << name;
}

TEST(SynPeb, a_real_image_against_its_own_labels) {
  const char* data = std::getenv("HYBRID_DATA");
  const fs::path file =
      fs::path(data ? data : HYBRID_PROJECT_DIR "/../shared/data") / "planes/synpeb/test_100.pcd";
  if (!fs::exists(file)) GTEST_SKIP() << "no real data: " << file;
  const fs::path place = folder();
  const auto cloud = score::read_labelled_pcd(file);
  write_result(place, cloud);
  const auto score = score::score_benchmark(file, place, {});
  EXPECT_EQ(score.planes.labels.planar, 10000);
  EXPECT_EQ(score.planes.labels.right, 10000);
  EXPECT_EQ(score.planes.hoover[6].correct, 10);  // of 13; three have fewer than 100 samples
}

}  // namespace score_tests
