// Scan files that have poses, as a survey leaves them that was registered before, through the program.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "geometry/pose.hpp"
#include "io/output.hpp"
#include "program.hpp"

namespace hybrid::e2e {
namespace {

namespace fs = std::filesystem;

// Stations of a small church, front, nave, chancel, porch, corner, aisle; the model knows nothing of the
// frame of the poses in their files.
class RecordedSurvey {
 public:
  explicit RecordedSurvey(int scans) {
    const auto made =
        run("hybrid-synth church --seed 5 --preset tiny --megapixels 0.1 --format ptx --quiet --scans " +
            std::to_string(scans) + " --out " + folder().string());
    EXPECT_EQ(made.exit_code, 0) << made.err;
    scene_ = io::read_text(folder() / "scene.toml");
    scene_.resize(scene_.find("[photographs]"));
    const auto truth = json_of(folder() / "truth.json");
    for (const auto& scan : truth["scans"])
      truth_[scan["id"]] = pose_from_row_major(scan["world_from_scan"].get<std::array<double, 16>>());
  }

  // Writes into each file what `moved` makes of its pose in the survey's frame.
  void record(const std::function<Pose(const std::string&, const Pose&)>& moved) {
    const Pose survey{1, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3::UnitZ())), {400, -30, 12}};
    for (const auto& [id, pose] : truth_) {
      recorded_[id] = moved(id, survey * pose);
      record(id, recorded_[id]);
    }
  }
  void keep_landmarks_of(const std::string& scan) {
    for (auto at = scene_.find("landmarks = ["); at != std::string::npos;
         at = scene_.find("landmarks = [", at + 1)) {
      const auto id = scene_.rfind("id = \"", at) + 6;
      if (scene_.compare(id, scan.size() + 1, scan + "\"") == 0) continue;
      scene_.erase(at, scene_.find("\n]\n", at) + 3 - at);
      --at;
    }
  }
  // On the model's corners opposite, about the middle between those that were picked.
  void turn_landmarks_by_half(const std::string& scan) {
    const std::string pick = "model = [";
    const auto begin = scene_.find("id = \"" + scan + "\""), end = scene_.find("[[scan]]", begin);
    std::vector<Vec3> corners;
    std::vector<std::size_t> places;
    for (auto at = scene_.find(pick, begin); at < std::min(end, scene_.find("[model]"));
         at = scene_.find(pick, at + 1)) {
      Vec3 p;
      char comma = 0;
      std::istringstream(scene_.substr(at + pick.size())) >> p.x() >> comma >> p.y() >> comma >> p.z();
      corners.push_back(p);
      places.push_back(at + pick.size());
    }
    ASSERT_FALSE(corners.empty());
    const auto by_y = [](const Vec3& a, const Vec3& b) { return a.y() < b.y(); };
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end(), by_y);
    const double both = low->y() + high->y();
    for (std::size_t k = corners.size(); k-- > 0;) {
      std::ostringstream text;
      text.precision(12);
      text << -corners[k].x() << ", " << both - corners[k].y() << ", " << corners[k].z();
      scene_.replace(places[k], scene_.find(']', places[k]) - places[k], text.str());
    }
  }
  // As another program shows them, which puts the scan where its file has it.
  void pick_in_file_coordinates(const std::string& scan) {
    const Pose pose = recorded_.at(scan);
    const std::string pick = "{ scan = [";
    for (auto at = scene_.find(pick); at != std::string::npos; at = scene_.find(pick, at + 1)) {
      const auto begin = at + pick.size();
      Vec3 p;
      char comma = 0;
      std::istringstream(scene_.substr(begin)) >> p.x() >> comma >> p.y() >> comma >> p.z();
      const Vec3 there = pose * p;
      std::ostringstream text;
      text.precision(12);
      text << there.x() << ", " << there.y() << ", " << there.z();
      scene_.replace(begin, scene_.find(']', begin) - begin, text.str());
    }
  }
  void take_model_out() {
    keep_landmarks_of("none");
    const auto at = scene_.find("[model]");
    scene_.erase(at, scene_.find("\n\n", at) - at);
  }
  Outcome register_all(const std::string& options = "") const {
    io::write_text(folder() / "scene.toml", scene_);
    return run("hybrid register " + (folder() / "scene.toml").string() + " --quiet --force --out " +
               out().string() + " " + options);
  }
  nlohmann::json pose(const std::string& id) const { return json_of(out() / "scans" / id / "pose.json"); }
  // Of every scan that has a pose, by the truth.
  std::map<std::string, double> errors_mm() const {
    const auto summary = json_of(out() / "summary.json");
    std::map<std::string, double> errors;
    for (const auto& scan : summary["scans"])
      if (scan["registration"]["status"] == "accepted")
        errors[scan["id"]] = scan["truth"]["pose_error_mm"].get<double>();
    return errors;
  }

 private:
  fs::path folder() const { return scratch_ / "church"; }
  fs::path out() const { return scratch_ / "out"; }
  // The header has the scanner's position and axes, and the matrix that row vectors are multiplied by.
  void record(const std::string& id, const Pose& pose) const {
    const fs::path file = folder() / "scans" / (id + ".ptx");
    std::istringstream from(io::read_text(file));
    std::ostringstream to;
    to.precision(17);
    std::string line;
    for (int k = 0; std::getline(from, line); ++k) {
      if (k < 2 || k > 9) {
        to << line << '\n';
        continue;
      }
      const int row = k < 6 ? k - 2 : k - 6;  // of position and axes, or of the matrix
      const bool is_place = k < 6 ? row == 0 : row == 3;
      const Vec3 v = is_place ? pose.translation : pose.rotate(Vec3::Unit(k < 6 ? row - 1 : row));
      to << v.x() << ' ' << v.y() << ' ' << v.z();
      if (k >= 6) to << (is_place ? " 1" : " 0");
      to << '\n';
    }
    io::write_text(file, to.str());
  }

  Scratch scratch_;
  std::string scene_;
  std::map<std::string, Pose> truth_, recorded_;
};

Pose as_it_is(const std::string&, const Pose& pose) {
  return pose;
}

Pose by(double metres, const Pose& pose) {
  Pose moved = pose;
  moved.translation += metres * Vec3(0.6, -0.8, 0);
  return moved;
}

}  // namespace

TEST(RecordedPoses, landmarks_of_one_scan_place_a_survey_that_was_registered_before) {
  RecordedSurvey survey(3);
  survey.record(as_it_is);
  survey.keep_landmarks_of("nave");
  const auto outcome = survey.register_all();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto errors = survey.errors_mm();
  ASSERT_EQ(errors.size(), 3u);
  for (const auto& [id, error] : errors) EXPECT_LT(error, 0.5) << id;
  for (const char* id : {"front", "chancel"}) {
    EXPECT_EQ(survey.pose(id)["how"], "recorded") << id;
    EXPECT_FALSE(survey.pose(id)["recorded"].contains("kept")) << id;
  }
  EXPECT_EQ(survey.pose("chancel")["recorded"]["beside"], "nave");
  EXPECT_NE(outcome.out.find("from its file's pose beside scan nave"), std::string::npos) << outcome.out;

  // That nothing else is asked is no reason to warn.
  const auto by_files = survey.register_all("--set register.automatic=never");
  EXPECT_EQ(by_files.exit_code, 0) << by_files.err;
  EXPECT_EQ(by_files.err.find("no landmarks and no pose"), std::string::npos) << by_files.err;
  EXPECT_EQ(survey.pose("front")["how"], "recorded");
}

// They may be picked where the file has the scan, as most programs show it.
TEST(RecordedPoses, landmarks_may_be_in_the_coordinates_of_the_file) {
  RecordedSurvey survey(3);
  survey.record(as_it_is);
  survey.keep_landmarks_of("nave");
  survey.pick_in_file_coordinates("nave");
  const auto outcome = survey.register_all();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("scan nave: its landmarks are not in the scan's frame"), std::string::npos)
      << outcome.err;
  const auto errors = survey.errors_mm();
  ASSERT_EQ(errors.size(), 3u);
  for (const auto& [id, error] : errors) EXPECT_LT(error, 0.5) << id;
  EXPECT_EQ(survey.pose("nave")["how"], "landmarks");
  ASSERT_EQ(survey.pose("nave")["warnings"].size(), 1u);
}

// Of a church that fits itself turned by half no plane tells that landmarks were picked on the wrong side.
TEST(RecordedPoses, a_scan_that_landmarks_turn_by_half_is_told) {
  RecordedSurvey survey(3);
  survey.record(as_it_is);
  survey.turn_landmarks_by_half("chancel");
  const auto outcome = survey.register_all();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto warnings = survey.pose("chancel")["warnings"].dump();
  EXPECT_NE(warnings.find("180.0 degrees from there, beside scan nave"), std::string::npos) << warnings;
  EXPECT_FALSE(survey.pose("front").dump().find("degrees from there, beside") != std::string::npos);
}

// Without the pose that they go with, ICP from hundreds of metres off finds the church turned by half.
TEST(RecordedPoses, landmarks_that_lead_far_away_place_nothing) {
  RecordedSurvey survey(3);
  survey.record(as_it_is);
  survey.keep_landmarks_of("nave");
  survey.pick_in_file_coordinates("nave");
  survey.record([](const std::string&, const Pose&) { return Pose(); });
  EXPECT_EQ(survey.register_all().exit_code, 3);
  EXPECT_EQ(survey.pose("nave")["status"], "abstained");
  EXPECT_NE(survey.pose("nave")["reason"].get<std::string>().find("more than 2 m or 40 degrees"),
            std::string::npos)
      << survey.pose("nave")["reason"];
}

// All identities say nothing: as if there were none.
TEST(RecordedPoses, a_survey_that_never_was_registered_has_none) {
  RecordedSurvey survey(3);
  survey.keep_landmarks_of("nave");
  EXPECT_EQ(survey.register_all().exit_code, 3);
  const auto front = survey.pose("front");
  EXPECT_EQ(front["status"], "abstained");
  EXPECT_EQ(front["reason"].get<std::string>().find("its file's pose"), std::string::npos);
}

// By satellites and compass, say: none is believed where neither the model nor the samples confirm it.
TEST(RecordedPoses, rough_ones_are_starts_and_no_more) {
  RecordedSurvey survey(3);
  double metres = -0.4;
  survey.record([&](const std::string&, const Pose& pose) { return by(metres += 0.4, pose); });
  survey.keep_landmarks_of("nave");
  EXPECT_EQ(survey.register_all().exit_code, 3);
  for (const auto& [id, error] : survey.errors_mm()) EXPECT_LT(error, 2) << id;
  EXPECT_NE(survey.pose("front")["status"], "accepted");
}

TEST(RecordedPoses, without_a_model_what_little_holds_stays_where_its_file_has_it) {
  RecordedSurvey survey(3);
  survey.record(as_it_is);
  survey.take_model_out();
  const auto outcome = survey.register_all();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto errors = survey.errors_mm();
  ASSERT_EQ(errors.size(), 3u);
  for (const auto& [id, error] : errors) EXPECT_LT(error, 1) << id;
  // Through the door the front sees a sample every decimetre of the nave.
  const auto nave = survey.pose("nave");
  EXPECT_EQ(nave["how"], "recorded");
  EXPECT_EQ(nave["recorded"]["beside"], "front");
  EXPECT_EQ(nave["recorded"]["kept"]["scans_that_agree"], 2);
  EXPECT_EQ(nave["recorded"]["kept"]["scans_that_differ"], 0);
  EXPECT_LT(nave["recorded"]["kept"]["farthest_m"], 0.005);
  ASSERT_EQ(nave["warnings"].size(), 1u);
  EXPECT_NE(nave["warnings"][0].get<std::string>().find("as nothing else holds it"), std::string::npos);
  EXPECT_EQ(survey.pose("chancel")["how"], "scan-icp");
  EXPECT_EQ(survey.pose("chancel")["on_scans"]["start"], "recorded");
}

TEST(RecordedPoses, one_that_others_contradict_is_led_to_where_they_have_it) {
  RecordedSurvey survey(6);
  survey.record(
      [](const std::string& id, const Pose& pose) { return id == "chancel" ? by(0.4, pose) : pose; });
  survey.take_model_out();
  const auto outcome = survey.register_all();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto errors = survey.errors_mm();
  ASSERT_EQ(errors.size(), 6u);
  for (const auto& [id, error] : errors) EXPECT_LT(error, 1) << id;
  EXPECT_EQ(survey.pose("chancel")["how"], "scan-icp");
}

// A grid of elevations times azimuths, each node on the box of these half sides around the scanner.
void write_box(const fs::path& file, double degrees, int rows, int cols, double half_m) {
  std::ostringstream text;
  text << cols << '\n' << rows << "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  for (int col = 0; col < cols; ++col)
    for (int row = 0; row < rows; ++row) {
      const double azimuth = (col - 0.5 * (cols - 1)) * degrees * M_PI / 180,
                   elevation = (row - 0.5 * (rows - 1)) * degrees * M_PI / 180;
      const Vec3 ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                     std::sin(elevation));
      const Vec3 point = ray * (half_m / ray.cwiseAbs().maxCoeff());
      text << point.x() << ' ' << point.y() << ' ' << point.z() << " 0.5\n";
    }
  io::write_text(file, text.str());
}

// Nothing of it lies on surfaces of the other, which is no reason to believe it: all of it is seen through.
TEST(RecordedPoses, a_given_pose_where_nothing_lies_and_all_is_seen_through_is_refused) {
  const Scratch scratch;
  write_box(scratch / "room.ptx", 1, 120, 360, 6);
  write_box(scratch / "wall.ptx", 0.5, 60, 80, 2.5);
  const auto registered = [&](const char* pose) {
    io::write_text(scratch / "scene.toml",
                   std::string("[scene]\nname = \"two\"\n[[scan]]\nid = \"room\"\nfile = \"room.ptx\"\n"
                               "[[scan]]\nid = \"wall\"\nfile = \"wall.ptx\"\n") +
                       pose);
    return run("hybrid register " + (scratch / "scene.toml").string() + " --quiet --force --out " +
               (scratch / "out").string());
  };
  const auto outcome = registered("pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("the other scans contradict the given pose: "), std::string::npos)
      << outcome.err;
  const auto pose = json_of(scratch / "out/scans/wall/pose.json");
  EXPECT_EQ(pose["status"], "abstained");
  EXPECT_GT(pose["refused"]["on_scans"]["seen_through"], 0.9);
  // Outside the room nobody can tell.
  const auto outside = registered("pose = [1, 0, 0, 20, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n");
  EXPECT_EQ(outside.exit_code, 0) << outside.err;
  EXPECT_NE(outside.err.find("its given pose is as it was"), std::string::npos) << outside.err;
}

}  // namespace hybrid::e2e
