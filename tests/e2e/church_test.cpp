// The synthetic church: its truth is true. One scene with faulty proxy and cameras, made once on one thread
// and once on two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "exr_ids.hpp"
#include "io/models/obj.hpp"
#include "io/output.hpp"
#include "io/read_scan.hpp"
#include "io/truth.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {
namespace fs = std::filesystem;

constexpr double kProxyError = 0.02;

class Church : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new Scratch;
    for (const char* threads : {"1", "2"}) {
      const auto outcome =
          run("hybrid-synth church --preset tiny --seed 3 --megapixels 0.06 --quiet --proxy-error 0.02 "
              "--camera-error 0.5 --threads " +
              std::string(threads) + " --out " + (*scratch_ / threads).string());
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    truth_ = nlohmann::json::parse(io::read_text(folder() / "truth.json"));
  }
  static void TearDownTestSuite() {
    delete scratch_;
    scratch_ = nullptr;
  }
  static fs::path folder() { return *scratch_ / "1"; }
  // A run over it that cuts its openings; made when first asked for.
  static fs::path opened() {
    const fs::path out = *scratch_ / "opened";
    if (fs::exists(out / "summary.json")) return out;
    const auto made =
        run("hybrid run " + (folder() / "scene.toml").string() +
            " --only planes,register,edit,render --set edit.openings=cut --quiet --out " + out.string());
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return out;
  }

  static Vec3 vector(const nlohmann::json& list) {
    return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
  }
  static const nlohmann::json& plane_of(const std::string& face) {
    for (const auto& plane : truth_["planes"])
      if (plane["proxy_face"] == face) return plane;
    throw std::runtime_error("no plane has the face " + face);
  }
  static double height(const nlohmann::json& plane, const Vec3& point) {
    return vector(plane["normal"]).dot(point) - plane["offset_m"].get<double>();
  }

  static inline Scratch* scratch_ = nullptr;
  static inline nlohmann::json truth_;
};

}  // namespace

TEST_F(Church, is_the_same_on_one_thread_and_two) {
  EXPECT_EQ(content_list(*scratch_ / "1"), content_list(*scratch_ / "2"));
}

TEST_F(Church, planar_samples_lie_on_their_plane_within_the_noise) {
  std::map<std::uint32_t, nlohmann::json> planes;
  for (const auto& plane : truth_["planes"]) planes[plane["id"]] = plane;
  const auto scans = io::read_truth(folder() / "truth.json").scans;
  ASSERT_EQ(scans.size(), 3u);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const auto scan = io::read_scan(folder() / truth_["scans"][s]["file"].get<std::string>(), 0);
    ASSERT_EQ(scan.points.size(), scans[s].plane.size());
    std::array<std::size_t, 4> kinds{};
    double squares = 0;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Vec3 point = scan.point(i);
      if (!point.allFinite()) continue;
      ++kinds.at(scans[s].kind[i]);
      if (scans[s].kind[i] != 0) {
        ASSERT_EQ(scans[s].plane[i], 0u) << i;
        continue;
      }
      // The generator's model with its defaults, the spread at grazing angles at its largest.
      const double range = point.norm(), sigma = 0.0015 + 0.0001 * range + 0.03 * 8 * (0.003 + 0.001 * range);
      const double off = height(planes.at(scans[s].plane[i]), scans[s].world_from_scan * point);
      ASSERT_LT(std::abs(off), 6 * sigma) << scans[s].id << " sample " << i;
      squares += off * off;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(kinds[0])), 0.004) << scans[s].id;
    for (std::size_t kind = 0; kind < 4; ++kind)
      EXPECT_GT(kinds[kind], 0u) << scans[s].id << " kind " << kind;
  }
}

TEST_F(Church, proxy_faces_err_as_stated) {
  const auto model = io::read_obj(folder() / "proxy.obj");
  double largest = 0;
  for (const auto& face : model.faces) {
    const auto& plane = plane_of(face.name);
    const double error = plane["face_error_m"];
    largest = std::max(largest, std::abs(error));
    EXPECT_LE(std::abs(error), 2 * kProxyError) << face.name;
    for (std::uint32_t v : face.outer)
      EXPECT_NEAR(height(plane, model.vertices[v]), error, 1e-6) << face.name;
    EXPECT_GT(face_plane(model, face).normal.dot(vector(plane["normal"])), 0.9999) << face.name;
  }
  EXPECT_GT(largest, kProxyError / 4);
}

TEST_F(Church, openings_lie_on_faces) {
  ASSERT_GE(truth_["openings"].size(), 10u);
  for (const auto& opening : truth_["openings"]) {
    EXPECT_GT(opening["depth_m"], 0.1);
    EXPECT_LT(opening["depth_m"], 0.65);
    const auto& plane = plane_of(opening["face"]);
    Vec3 area = Vec3::Zero();
    const auto& ring = opening["ring"];
    for (std::size_t k = 0; k < ring.size(); ++k) {
      EXPECT_NEAR(height(plane, vector(ring[k])), 0, 1e-6) << opening["name"];
      area += vector(ring[k]).cross(vector(ring[(k + 1) % ring.size()])) / 2;
    }
    EXPECT_GT(area.dot(vector(plane["normal"])), 0.3) << opening["name"];  // square metres, counter-clockwise
  }
}

// In the front of this one several bridges between holes of a wall meet in one corner.
TEST_F(Church, of_a_seed_whose_holes_meet_in_a_corner_is_made) {
  const Scratch scratch;
  const auto made =
      run("hybrid-synth church --preset tiny --seed 22 --megapixels 0.05 --only-scan nave --quiet --out " +
          (scratch / "church").string());
  EXPECT_EQ(made.exit_code, 0) << made.err;
}

TEST_F(Church, erring_cameras_differ_from_the_truth) {
  const auto written = io::read_text(folder() / "cameras" / "images.txt");
  EXPECT_EQ(truth_["cameras"].size(), 10u);
  for (const auto& camera : truth_["cameras"])
    EXPECT_NE(written.find(camera["name"].get<std::string>()), std::string::npos);
  EXPECT_EQ(truth_["camera_error_px"], 0.5);
}

TEST_F(Church, panes_close_its_windows_in_views_and_what_is_measured_behind_them_is_stray) {
  const auto summary = nlohmann::json::parse(io::read_text(opened() / "summary.json"));
  const auto model = io::read_obj(opened() / "model/edited.obj");
  std::size_t panes = 0;
  for (const auto& face : model.faces) panes += face.name.find("-pane-") != std::string::npos;
  EXPECT_EQ(summary["edit"]["openings"]["panes"], panes);
  EXPECT_GE(panes, 4u);  // measured: 8
  for (const auto& scan : summary["scans"])
    EXPECT_GT(scan["decimation"]["stray"]["through_glass"], 0) << scan["id"];  // 51, 102, 395
  // The view from outside shows them: an id is 1 + the index of a face.
  const auto ids = ids_of(opened() / "views/front-textured.exr");
  const auto shown = std::count_if(ids.begin(), ids.end(), [&](std::uint32_t id) {
    return id > 0 && id <= model.faces.size() && model.faces[id - 1].name.find("-pane-") != std::string::npos;
  });
  EXPECT_GT(shown, 50);  // 120
}

// Photographs inside are exposed longer than those outside, and the open door joins them.
TEST_F(Church, views_have_the_exposure_of_the_photographs_they_show) {
  const auto summary = nlohmann::json::parse(io::read_text(opened() / "summary.json"));
  const auto of = [](const nlohmann::json& rows, const char* key, const char* name, const char* value) {
    for (const auto& row : rows)
      if (row[key] == name) return row[value][1].get<double>();
    throw std::runtime_error(name);
  };
  const auto &gains = summary["equalisation"], &views = summary["views"];
  const double outside = of(gains, "photograph", "000.jpg", "gain"),
               inside = of(gains, "photograph", "005.jpg", "gain");
  EXPECT_GT(outside / inside, 2);  // measured: 2.24 / 0.59
  EXPECT_NEAR(of(views, "name", "front-textured", "exposure") * outside, 1, 0.05);
  EXPECT_NEAR(of(views, "name", "nave-textured", "exposure") * inside, 1, 0.05);
}

TEST(Archive, holds_as_many_scenes_as_asked_and_goes_on_where_it_was_interrupted) {
  const Scratch scratch;
  const auto make = [&](const std::string& which) {
    const auto outcome = run("hybrid-synth archive " + which + " --seed 7 --megapixels 0.05 --quiet --out " +
                             (scratch / "a").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  make("1");
  const fs::path first = scratch / "a/scene-0000/proxy.obj";
  const std::string proxy = io::read_text(first);
  io::write_text(first, "as it was");
  make("2 --from 1");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(scratch / "a")) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"scene-0000", "scene-0001"}));
  EXPECT_EQ(io::read_text(first), "as it was");
  EXPECT_NE(io::read_text(scratch / "a/scene-0001/proxy.obj"), proxy);
  EXPECT_NE(io::read_text(scratch / "a/scene-0001/scene.toml").find("seed 8"), std::string::npos);
}

}  // namespace hybrid::e2e
