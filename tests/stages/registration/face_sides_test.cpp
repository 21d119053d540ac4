// Faces that a model has the wrong way round are known by what scans see of their backs.
#include "stages/registration/face_sides.hpp"

#include <gtest/gtest.h>

#include "cases/trial_room.hpp"
#include "device.hpp"
#include "stages/registration/automatic.hpp"

namespace hybrid::stages::face_sides_test {
namespace {

class FaceSidesOfRoom : public ::testing::Test {
 protected:
  FaceSidesOfRoom() {
    scan_ = testing::scan_trial_room(testing::queue(), room_, 3, 1);
    evidence_ = gather_evidence(scan_.image, scan_.segmentation, AutomaticOptions().rays, 1);
  }

  // With these faces turned round.
  PolygonModel turned(const std::vector<std::size_t>& faces) const {
    PolygonModel model = room_.proxy;
    for (const std::size_t face : faces) {
      std::reverse(model.faces[face].outer.begin(), model.faces[face].outer.end());
      for (auto& hole : model.faces[face].holes) std::reverse(hole.begin(), hole.end());
    }
    return model;
  }

  FaceSides sides_of(const PolygonModel& model) const {
    return face_sides(evidence_, model, scan_.world_from_scan, 0.05);
  }

  const testing::TrialRoom room_ = testing::make_trial_room("ell", 3, 0);
  testing::TrialScan scan_;
  ScanEvidence evidence_;
};

double sum(const std::vector<double>& areas) {
  double all = 0;
  for (const double area : areas) all += area;
  return all;
}

}  // namespace

TEST_F(FaceSidesOfRoom, what_lies_on_fronts_lies_on_backs_when_they_are_turned) {
  const FaceSides right = sides_of(room_.proxy);
  EXPECT_GT(sum(right.front_m2), 0.5 * evidence_.area_m2);
  EXPECT_LT(sum(right.back_m2), 0.01 * evidence_.area_m2);
  const FaceSides one = sides_of(turned({1}));
  EXPECT_GT(right.front_m2[1], 1);
  EXPECT_NEAR(one.back_m2[1], right.front_m2[1], 1e-9);
  EXPECT_EQ(one.front_m2[1], 0);
  EXPECT_NEAR(one.front_m2[0], right.front_m2[0], 1e-9);
  const std::vector<double> least(room_.proxy.faces.size(), 0.5);
  EXPECT_EQ(turned_faces(one, least), std::vector<std::uint32_t>{1});
  EXPECT_TRUE(turned_faces(right, least).empty());
}

TEST_F(FaceSidesOfRoom, sums_of_scans_count_both) {
  FaceSides twice;
  twice += sides_of(room_.proxy);
  twice += sides_of(turned({0}));
  const FaceSides right = sides_of(room_.proxy);
  EXPECT_NEAR(twice.front_m2[0], twice.back_m2[0], 1e-9);
  EXPECT_NEAR(twice.front_m2[1], 2 * right.front_m2[1], 1e-9);
  // Seen from both sides it is not turned.
  EXPECT_TRUE(turned_faces(twice, std::vector<double>(right.front_m2.size(), 0.5)).empty());
}

TEST_F(FaceSidesOfRoom, are_named_where_a_right_pose_is_contradicted_and_nowhere_else) {
  const auto words = [&](const PolygonModel& model, const Pose& pose) {
    return diagnose_turned_faces(evidence_, model, pose, {});
  };
  EXPECT_EQ(words(room_.proxy, scan_.world_from_scan), "");
  std::vector<std::size_t> all(room_.proxy.faces.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  for (const auto& faces : {std::vector<std::size_t>{0, 1, 2}, all}) {
    const std::string found = words(turned(faces), scan_.world_from_scan);
    EXPECT_NE(found.find("corners must go counter-clockwise"), std::string::npos) << found;
    EXPECT_NE(found.find(faces.size() == 3 ? room_.proxy.faces[0].name : " more)"), std::string::npos)
        << found;
  }
  Pose away = scan_.world_from_scan;
  away.translation += Vec3(0.8, 0.7, 0.9);
  EXPECT_EQ(words(turned(all), away), "");
}

}  // namespace hybrid::stages::face_sides_test
