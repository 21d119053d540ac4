// One scan as programs write it that call rows columns, count in other units or look along other axes: its
// planes are the same.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/vectors.hpp"
#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

// The lines of a PTX file of one scan.
struct PtxLines {
  int cols = 0, rows = 0;
  std::string pose;
  std::vector<std::string> points;  // down the columns, upwards

  explicit PtxLines(const fs::path& file) {
    std::istringstream text(io::read_text(file));
    std::string line;
    for (int k = 0; k < 10; ++k) {
      std::getline(text, line);
      if (k < 2)
        (k == 0 ? cols : rows) = std::stoi(line);
      else
        pose += line + "\n";
    }
    while (std::getline(text, line)) points.push_back(line);
  }
  const std::string& point(int row, int col) const {
    return points[static_cast<std::size_t>(col) * static_cast<std::size_t>(rows) +
                  static_cast<std::size_t>(row)];
  }
};

template <typename Point>
std::string ptx(int cols, int rows, const std::string& pose, const Point& point) {
  std::string text = fmt::format("{}\n{}\n{}", cols, rows, pose);
  for (int col = 0; col < cols; ++col)
    for (int row = 0; row < rows; ++row) text += point(row, col) + "\n";
  return text;
}

// x y z and intensity of a line, made others by `change`.
template <typename Change>
std::string changed(const std::string& line, const Change& change) {
  double x = 0, y = 0, z = 0, intensity = 0;
  std::istringstream(line) >> x >> y >> z >> intensity;
  change(x, y, z);
  return fmt::format("{} {} {} {}", x, y, z, intensity);
}

class OddGrids : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new Scratch;
    const auto made =
        run("hybrid-synth church --preset tiny --seed 5 --only-scan nave --megapixels 0.062 --quiet "
            "--format ptx --out " +
            (*scratch_ / "church").string());
    ASSERT_EQ(made.exit_code, 0) << made.err;
    lines_ = new PtxLines(*scratch_ / "church/scans/nave.ptx");
    write("plain", lines_->cols, lines_->rows, [](int row, int col) { return lines_->point(row, col); });
    plain_ = new nlohmann::json(planes("plain", "").first);
    ASSERT_GT((*plain_)["superclusters"].size(), 5u);
  }
  static void TearDownTestSuite() {
    delete plain_;
    delete lines_;
    delete scratch_;
  }
  template <typename Point>
  static void write(const std::string& name, int cols, int rows, const Point& point) {
    io::write_text(*scratch_ / (name + ".ptx"), ptx(cols, rows, lines_->pose, point));
  }
  // planes.json without the scan's name, and the scan's notes.
  static std::pair<nlohmann::json, std::string> planes(const std::string& name, const std::string& options) {
    const auto out = *scratch_ / ("out-" + name);
    const auto outcome = run("hybrid planes " + (*scratch_ / (name + ".ptx")).string() + " " + options +
                             " --quiet --force --out " + out.string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    auto json = json_of(out / "scans" / name / "planes.json");
    json.erase("scan");
    const auto summary = json_of(out / "summary.json");
    return {json, summary["scans"][0].value("notes", nlohmann::json::array()).dump()};
  }
  static void expect_same(const std::string& name, const std::string& note, const std::string& options = "") {
    SCOPED_TRACE(name);
    const auto [json, notes] = planes(name, options);
    EXPECT_EQ(json, *plain_);
    EXPECT_NE(notes.find(note), std::string::npos) << notes;
  }

  static inline Scratch* scratch_ = nullptr;
  static inline PtxLines* lines_ = nullptr;
  static inline nlohmann::json* plain_ = nullptr;
};

TEST_F(OddGrids, RowsAndColumns) {
  const PtxLines& scan = *lines_;
  write("transposed", scan.rows, scan.cols, [&](int row, int col) { return scan.point(col, row); });
  expect_same("transposed", "its grid is turned");
  const auto in_order = [&](int col_length, int row, int col) {
    return scan.points[static_cast<std::size_t>(col) * static_cast<std::size_t>(col_length) +
                       static_cast<std::size_t>(row)];
  };
  write("swapped", scan.rows, scan.cols, [&](int row, int col) { return in_order(scan.cols, row, col); });
  expect_same("swapped", "the numbers of rows and columns the other way round");
  write("by_rows", scan.cols, scan.rows, [&](int row, int col) {
    const int k = col * scan.rows + row;
    return scan.point(k / scan.cols, k % scan.cols);
  });
  expect_same("by_rows", "in the other order");
}

// Half the columns, in which the scan goes on beyond the zenith with what is half a turn away.
TEST_F(OddGrids, ColumnsOverTheZenith) {
  const PtxLines& scan = *lines_;
  ASSERT_EQ(scan.cols % 2, 0);
  write("over", scan.cols / 2, 2 * scan.rows, [&](int row, int col) {
    return row < scan.rows ? scan.point(row, col) : scan.point(2 * scan.rows - 1 - row, col + scan.cols / 2);
  });
  expect_same("over", "go over the zenith");
}

TEST_F(OddGrids, Units) {
  const PtxLines& scan = *lines_;
  write("mm", scan.cols, scan.rows, [&](int row, int col) {
    return changed(scan.point(row, col),
                   [](double& x, double& y, double& z) { x *= 1000, y *= 1000, z *= 1000; });
  });
  EXPECT_NE(planes("mm", "").second.find("are the file's lengths in metres?"), std::string::npos);
  const auto [json, notes] = planes("mm", "--unit mm");
  ASSERT_EQ(json["superclusters"].size(), (*plain_)["superclusters"].size());
  for (std::size_t i = 0; i < json["superclusters"].size(); ++i) {
    const auto &a = json["superclusters"][i], &b = (*plain_)["superclusters"][i];
    EXPECT_NEAR(a["offset_m"].get<double>(), b["offset_m"].get<double>(), 1e-5);
    EXPECT_EQ(a["samples"], b["samples"]);
  }
  EXPECT_EQ(notes.find("lengths in metres"), std::string::npos) << notes;
}

TEST_F(OddGrids, Axes) {
  const PtxLines& scan = *lines_;
  write("camera", scan.cols, scan.rows, [&](int row, int col) {
    return changed(scan.point(row, col), [](double& x, double& y, double& z) {
      const Vec3 scanner(x, y, z);
      x = -scanner.y(), y = -scanner.z(), z = scanner.x();
    });
  });
  EXPECT_NE(planes("camera", "").second.find("are no angles seen from its origin"), std::string::npos);
  expect_same("camera", "", "--axes camera");
}

}  // namespace
}  // namespace hybrid::e2e
