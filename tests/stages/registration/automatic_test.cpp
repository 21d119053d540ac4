// Registration without clicks: accepted poses are right, and what cannot be told is not guessed.
#include "stages/registration/automatic.hpp"
#include "geometry/angles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "cases/closest_point_case.hpp"
#include "cases/trial_room.hpp"
#include "core/error.hpp"
#include "device.hpp"
#include "stages/registration/automatic_words.hpp"
#include "stages/registration/sight_lines.hpp"
#include "stages/registration/tile_icp.hpp"

namespace hybrid::automatic_test {
namespace {

using stages::AutomaticAlignment;
using stages::AutomaticOptions;
using stages::ScanEvidence;
using testing::make_trial_room;
using testing::scan_trial_room;

struct Trial {
  testing::TrialRoom room;
  testing::TrialScan scan;
  ScanEvidence evidence;
};

Trial trial(const std::string& kind, std::uint32_t seed, double crop = 1) {
  Trial t{make_trial_room(kind, seed, 0.01), {}, {}};
  t.scan = scan_trial_room(testing::queue(), t.room, seed, crop);
  t.evidence = stages::gather_evidence(t.scan.image, t.scan.segmentation, AutomaticOptions().rays, 1);
  return t;
}

AutomaticOptions levelled() {
  AutomaticOptions options;
  options.levelled = true;
  return options;
}

AutomaticAlignment align(const ScanEvidence& evidence, const PolygonModel& proxy,
                         const AutomaticOptions& options = levelled()) {
  return stages::align_automatically(testing::queue(), evidence, proxy, options);
}

// As the issue counts: below 5 cm and 0.5 degrees before ICP.
bool is_right(const AutomaticAlignment& alignment, const Pose& truth) {
  const auto error = difference(truth, alignment.world_from_scan);
  return error.distance_m < 0.05 && error.angle_rad < 0.5 * kDegree;
}

PolygonModel scaled(PolygonModel model, double factor) {
  for (Vec3& v : model.vertices) v *= factor;
  return model;
}

PolygonModel negated_x(PolygonModel model) {
  for (Vec3& v : model.vertices) v.x() = -v.x();
  return model;
}

}  // namespace

TEST(Automatic, rooms_that_can_be_told_apart_are_aligned_and_none_wrongly) {
  int accepted = 0, count = 0;
  for (const char* kind : {"niche", "hall", "ell", "oblique"})
    for (const std::uint32_t seed : {31u, 32u, 33u}) {
      const Trial t = trial(kind, seed, seed == 33 ? 0.7 : 1);
      const auto alignment = align(t.evidence, t.room.proxy);
      ++count;
      accepted += alignment.accepted;
      EXPECT_TRUE(!alignment.accepted || is_right(alignment, t.scan.world_from_scan)) << kind << " " << seed;
    }
  EXPECT_GE(accepted, count - 2);
}

TEST(Automatic, a_symmetric_room_abstains_and_names_half_a_turn) {
  for (const std::uint32_t seed : {41u, 42u, 43u}) {
    const Trial t = trial("box", seed);
    for (const bool is_levelled : {true, false}) {
      AutomaticOptions options;
      options.levelled = is_levelled;
      const auto alignment = align(t.evidence, t.room.proxy, options);
      EXPECT_FALSE(alignment.accepted);
      EXPECT_LT(alignment.margin, 0.003);
      bool half_turn = false;
      for (const auto& rival : alignment.rivals)
        half_turn |= rival.words.find("turned by 180 degrees about the vertical") != std::string::npos;
      EXPECT_TRUE(half_turn) << seed;
      EXPECT_NE(alignment.reason.find("another pose"), std::string::npos) << alignment.reason;
    }
  }
}

TEST(Automatic, a_scan_of_another_room_abstains) {
  for (const char* kind : {"niche", "ell", "oblique"})
    for (const std::uint32_t seed : {51u, 52u}) {
      const Trial t = trial(kind, seed), other = trial(kind, seed + 100);
      const auto alignment = align(t.evidence, other.room.proxy);
      EXPECT_FALSE(alignment.accepted) << kind << " " << seed;
      EXPECT_FALSE(alignment.reason.empty());
    }
}

// Half a turn lays a recess that the proxy lacks on the one that it has, as deep by chance: its sides are
// elsewhere.
TEST(Automatic, a_recess_like_the_proxys_places_nothing_by_its_back_alone) {
  const std::pair<std::uint32_t, bool> cases[] = {
      {61079, true}, {64012, false}, {64023, true}, {64044, false}, {8014, false}};
  for (const auto& [seed, cropped] : cases) {
    const Trial t = trial("alcoves", seed, cropped ? testing::Draw(seed, 3).within(0.5, 1) : 1);
    const auto alignment = align(t.evidence, t.room.proxy);
    EXPECT_TRUE(!alignment.accepted || is_right(alignment, t.scan.world_from_scan)) << seed;
  }
}

TEST(SightLines, ARecessSpeaksForAPoseWhereItsSidesDoToo) {
  testing::RoomPlan plan{{{0, 0}, {6, 0}, {6, 4}, {0, 4}}, 3, {{0, 2, 3, 0.5, 2.1, 0.6}}};
  testing::TrialRoom room{testing::room_model(plan), testing::room_model(plan), plan};
  const auto back_of = [&](bool recesses) {
    const auto scan = scan_trial_room(testing::queue(), room, 7, 1);
    const auto evidence = stages::gather_evidence(scan.image, scan.segmentation, 20000, 1);
    stages::SightCaster caster(testing::queue(), room.proxy);
    stages::SightOptions options;
    options.recesses = recesses;
    std::map<stages::Sight, int> sights;
    for (const auto& line : caster.cast(evidence.rays, scan.world_from_scan, options))
      if (room.proxy.faces[line.face].name == "wall-0-back") ++sights[line.sight];
    return sights;
  };
  auto there = back_of(true);
  EXPECT_GT(there[stages::Sight::supported], 50);
  EXPECT_EQ(there, back_of(false));
  plan.recesses[0].from_m += 0.2;  // as deep, 20 cm along
  plan.recesses[0].to_m += 0.2;
  room.truth = testing::room_model(plan);
  EXPECT_GT(back_of(false)[stages::Sight::supported], 20);
  EXPECT_EQ(back_of(true)[stages::Sight::supported], 0);
}

TEST(SightLines, PosesCastTogetherSeeWhatEachSeesAlone) {
  const auto room = testing::make_trial_room("niche", 3);
  const auto scan = scan_trial_room(testing::queue(), room, 3, 1);
  const auto evidence = stages::gather_evidence(scan.image, scan.segmentation, 20000, 1);
  stages::SightCaster caster(testing::queue(), room.proxy);
  std::vector<Pose> poses;
  for (int k = 0; k < 40; ++k) {
    poses.push_back(testing::moved_at_random(scan.world_from_scan, 1, 20, static_cast<std::uint32_t>(k)));
    poses.back().scale = 1 + 0.01 * k;
  }
  for (const std::size_t stride : {1, 7}) {
    const auto together = caster.cast(evidence.rays, poses, {}, stride);
    ASSERT_EQ(together.size(), poses.size());
    for (std::size_t p = 0; p < poses.size(); ++p) {
      const auto alone = caster.cast(evidence.rays, poses[p], {}, stride);
      ASSERT_EQ(together[p].size(), (evidence.rays.size() + stride - 1) / stride);
      ASSERT_EQ(alone.size(), together[p].size());
      for (std::size_t k = 0; k < alone.size(); ++k) {
        EXPECT_EQ(alone[k].sight, together[p][k].sight);
        EXPECT_EQ(alone[k].face, together[p][k].face);
        EXPECT_EQ(alone[k].recess, together[p][k].recess);
      }
    }
  }
  EXPECT_TRUE(caster.cast(evidence.rays, std::vector<Pose>(), {}).empty());
  EXPECT_EQ(caster.cast({}, poses, {}).size(), poses.size());
}

// These see one corner, and rooms of the same height have such corners: all that they see fits.
TEST(Automatic, a_corner_that_would_fit_another_room_places_nothing) {
  const std::pair<const char*, std::uint32_t> cases[] = {{"niche", 15043}, {"oblique", 15049}};
  for (const auto& [kind, seed] : cases) {
    const Trial t = trial(kind, seed, testing::Draw(seed, 3).within(0.5, 1));
    const auto other = make_trial_room(kind, seed + 500000, 0.01).proxy;
    const auto alignment = align(t.evidence, other);
    EXPECT_FALSE(alignment.accepted) << kind;
    EXPECT_LT(alignment.planes, 5) << kind;
    EXPECT_NE(alignment.reason.find("another place with such a corner"), std::string::npos)
        << alignment.reason;
    AutomaticOptions careless = levelled();
    careless.least_planes = 0;
    EXPECT_TRUE(align(t.evidence, other, careless).accepted) << kind;
  }
}

// Two walls at an angle of their own are as much as three of a room with right angles.
TEST(Automatic, an_oblique_corner_tells_its_room) {
  const Trial t = trial("oblique", 2007, testing::Draw(2007, 3).within(0.5, 1));
  const auto alignment = align(t.evidence, t.room.proxy);
  EXPECT_TRUE(alignment.accepted) << alignment.reason;
  EXPECT_TRUE(is_right(alignment, t.scan.world_from_scan));
  EXPECT_EQ(alignment.planes, 5);  // floor, ceiling, two walls, and their angle
  EXPECT_LT(alignment.farthest_rad, 0.2 * kDegree);
}

// A wall or two more, which come to lie on the model's only when walls may be as far off as that.
TEST(Automatic, a_room_of_nearly_the_same_size_places_nothing) {
  const std::pair<const char*, std::uint32_t> cases[] = {{"hall", 2023}, {"ell", 48007}};
  for (const auto& [kind, seed] : cases) {
    const Trial t = trial(kind, seed, testing::Draw(seed, 3).within(0.5, 1));
    const auto alignment = align(t.evidence, make_trial_room(kind, seed + 500000, 0.01).proxy);
    EXPECT_FALSE(alignment.accepted) << kind;
    EXPECT_GE(alignment.planes, 5) << kind;
    EXPECT_GT(alignment.farthest_m, 0.05) << kind;
    EXPECT_NE(alignment.reason.find("nearly the same size"), std::string::npos) << alignment.reason;
    const auto at_home = align(t.evidence, t.room.proxy);
    EXPECT_TRUE(at_home.accepted) << at_home.reason;
    EXPECT_LT(at_home.farthest_m, 0.035) << kind;
  }
}

// Oblique walls that lie on the model's, but at another angle.
TEST(Automatic, walls_turned_by_more_than_corners_may_be_off_place_nothing) {
  const Trial t = trial("oblique", 136081, testing::Draw(136081, 3).within(0.5, 1));
  const auto alignment = align(t.evidence, make_trial_room("oblique", 136081 + 500000, 0.01).proxy);
  EXPECT_FALSE(alignment.accepted);
  EXPECT_LT(alignment.farthest_m, 0.035);
  EXPECT_GT(alignment.farthest_rad, 1 * kDegree);
  EXPECT_NE(alignment.reason.find("one of them is turned by"), std::string::npos) << alignment.reason;
  const auto at_home = align(t.evidence, t.room.proxy);
  EXPECT_LT(at_home.farthest_rad, 0.3 * kDegree);
}

// Where few planes hold a scan, what lies off the faces counts the less the better these fit.
TEST(Automatic, few_planes_may_leave_the_more_doubt_the_better_they_fit) {
  const auto doubtful = [](std::uint32_t seed, bool at_home) {
    const Trial t = trial("hall", seed, testing::Draw(seed, 3).within(0.5, 1));
    return align(t.evidence, at_home ? t.room.proxy : make_trial_room("hall", seed + 500000, 0.01).proxy);
  };
  const auto right = doubtful(2003, true), wrong = doubtful(62075, false);
  EXPECT_TRUE(right.accepted) << right.reason;
  EXPECT_FALSE(wrong.accepted);
  EXPECT_NE(wrong.reason.find("where planes that count 5 hold the scan"), std::string::npos) << wrong.reason;
  for (const auto& alignment : {right, wrong}) {
    EXPECT_EQ(alignment.planes, 5);
    EXPECT_LT(alignment.farthest_m, 0.035);
    EXPECT_GT(alignment.doubt, 0.35);
    EXPECT_LT(alignment.doubt, AutomaticOptions().most_doubt);
  }
}

// More planes that fit may leave more than another room's would.
TEST(Automatic, six_planes_that_fit_well_may_leave_more_doubt) {
  const Trial home = trial("niche", 82002), away = trial("ell", 17040);
  const auto right = align(home.evidence, home.room.proxy),
             wrong = align(away.evidence, make_trial_room("ell", 17040 + 500000, 0.01).proxy);
  EXPECT_TRUE(right.accepted) << right.reason;
  EXPECT_TRUE(is_right(right, home.scan.world_from_scan));
  EXPECT_FALSE(wrong.accepted);
  EXPECT_NE(wrong.reason.find("may where planes that count 6 hold the scan"), std::string::npos)
      << wrong.reason;
  for (const auto& alignment : {right, wrong}) {
    EXPECT_EQ(alignment.planes, 6);
    EXPECT_GT(alignment.doubt, AutomaticOptions().most_doubt);
    EXPECT_LT(alignment.doubt, 2 * AutomaticOptions().most_doubt);
  }
  EXPECT_LT(right.farthest_m, 0.02);
  EXPECT_GT(wrong.farthest_m, 0.04);
}

TEST(Automatic, the_direction_in_which_the_scanner_was_set_up_changes_nothing) {
  const Trial t = trial("hall", 31);
  const auto first = align(t.evidence, t.room.proxy);
  ASSERT_TRUE(first.accepted) << first.reason;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.1, Vec3::UnitZ()));
  const auto second = align(stages::turned(t.evidence, turn), t.room.proxy);
  ASSERT_TRUE(second.accepted) << second.reason;
  const Pose back = second.world_from_scan * Pose{1, turn, Vec3::Zero()};
  const auto apart = difference(first.world_from_scan, back);
  EXPECT_LT(apart.distance_m, 0.002);
  EXPECT_LT(apart.angle_rad, 0.02 * kDegree);
}

TEST(Automatic, what_a_scan_says_of_another_is_inverted_pose_by_pose) {
  const auto pose = [](double by) {
    return Pose{1, Eigen::Quaterniond(Eigen::AngleAxisd(by, Vec3(1, 2, 3).normalized())), Vec3(by, 2, -by)};
  };
  AutomaticAlignment of_a;
  of_a.accepted = true;
  of_a.seen_through = 0.01;
  of_a.world_from_scan = pose(0.1);
  of_a.by_samples = {"few planes", pose(0.2), 0.02};
  of_a.rivals = {{pose(0.3), "beside it", {}, 0.5, 0.4}};
  of_a.hypotheses = {pose(0.1), pose(0.3)};
  of_a.beaten = {pose(0.4)};
  of_a.uncontradicted = {pose(0.5), pose(0.6), pose(0.7)};
  const auto of_b = stages::inverted(of_a);
  EXPECT_TRUE(of_b.back);
  EXPECT_TRUE(of_b.accepted);
  EXPECT_EQ(of_b.seen_through, 0.01);
  const auto poses_of = [](const AutomaticAlignment& one) {
    std::vector<Pose> poses = {one.world_from_scan, one.by_samples->best_by_planes,
                               one.rivals.at(0).world_from_scan};
    for (const auto* more : {&one.hypotheses, &one.beaten, &one.uncontradicted})
      poses.insert(poses.end(), more->begin(), more->end());
    return poses;
  };
  const auto a = poses_of(of_a), b = poses_of(of_b), again = poses_of(stages::inverted(of_b));
  ASSERT_EQ(a.size(), 9u);
  ASSERT_EQ(b.size(), 9u);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_TRUE(difference(a[k] * b[k], Pose()).within(1e-9, 1e-9)) << k;
    EXPECT_TRUE(difference(a[k], again.at(k)).within(1e-9, 1e-9)) << k;
  }
  EXPECT_FALSE(stages::inverted(of_b).back);
}

TEST(Automatic, a_proxy_in_millimetres_inside_out_or_mirrored_is_named) {
  const Trial t = trial("ell", 31);
  ASSERT_TRUE(align(t.evidence, t.room.proxy).accepted);
  const auto reason = [&](const PolygonModel& proxy) {
    const auto alignment = align(t.evidence, proxy);
    EXPECT_FALSE(alignment.accepted);
    return alignment.reason;
  };
  EXPECT_NE(reason(scaled(t.room.proxy, 1000)).find("millimetres"), std::string::npos);
  EXPECT_NE(reason(negated_x(t.room.proxy)).find("mirrored"), std::string::npos);
  PolygonModel turned = t.room.proxy;
  for (Face& face : turned.faces) {
    std::reverse(face.outer.begin(), face.outer.end());
    for (auto& hole : face.holes) std::reverse(hole.begin(), hole.end());
  }
  EXPECT_NE(reason(turned).find("inside out"), std::string::npos) << reason(turned);
  PolygonModel mirrored = negated_x(turned);  // fronts inwards again
  EXPECT_NE(reason(mirrored).find("is mirrored"), std::string::npos) << reason(mirrored);
}

TEST(Automatic, what_cannot_fix_a_pose_is_said) {
  const Trial t = trial("ell", 31);
  ScanEvidence two = t.evidence, parallel = t.evidence;
  two.planes.resize(2);
  EXPECT_NE(align(two, t.room.proxy).reason.find("at least 3 planes, the scan has 2"), std::string::npos);
  EXPECT_NE(align({}, t.room.proxy).reason.find("the scan has 0"), std::string::npos);
  for (auto& plane : parallel.planes) plane.plane.normal = Vec3::UnitX();
  EXPECT_NE(align(parallel, t.room.proxy).reason.find("all parallel"), std::string::npos);
  PolygonModel one = t.room.proxy;
  one.faces.resize(1);
  EXPECT_NE(align(t.evidence, one).reason.find("the model has 1"), std::string::npos);
  AutomaticOptions free_scale = levelled();
  free_scale.free_scale = true;
  EXPECT_NE(align(t.evidence, t.room.proxy, free_scale).reason.find("free scale"), std::string::npos);
}

TEST(Automatic, broken_models_are_errors_that_name_the_face) {
  const Trial t = trial("ell", 31);
  const auto message = [&](const PolygonModel& proxy) -> std::string {
    try {
      align(t.evidence, proxy);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "";
  };
  PolygonModel flat = t.room.proxy;
  flat.faces[3].outer = {0, 1, 1};
  flat.faces[3].holes.clear();
  EXPECT_NE(message(flat).find(flat.faces[3].name), std::string::npos) << message(flat);
  PolygonModel nan = t.room.proxy;
  nan.vertices[2].y() = std::nan("");
  EXPECT_NE(message(nan).find("vertex 2"), std::string::npos) << message(nan);
  EXPECT_NE(message({}).find("at least one face"), std::string::npos);
}

// FINDINGS: from 1 m and 20 degrees; here half of it, as hypotheses are nearer.
// Walls, floor and ceiling are the room's own; wardrobes, tables and recesses are not.
TEST(AutomaticEvidence, what_reaches_from_floor_to_ceiling_is_no_furniture) {
  const Trial t = trial("niche", 1004);
  const Pose& world_from_scan = t.scan.world_from_scan;
  Eigen::AlignedBox2d walls;
  for (const Vec2& corner : t.room.proxy_plan.footprint) walls.extend(corner);
  double own = 0, spanning = 0, other = 0, taken = 0;
  for (const auto& ray : t.evidence.rays) {
    const Vec3 p = world_from_scan * (ray.range_m * ray.direction);
    const Vec2 inside = (p.head<2>() - walls.min()).cwiseMin(walls.max() - p.head<2>());
    const double height = std::min(p.z(), t.room.proxy_plan.height_m - p.z());
    const bool of_room = std::min(std::abs(inside.minCoeff()), std::abs(height)) < 0.02;
    (of_room ? own : other) += ray.area_m2;
    if (ray.spans) (of_room ? spanning : taken) += ray.area_m2;
  }
  ASSERT_GT(other, 0.03 * t.evidence.area_m2);  // there is furniture to mistake
  EXPECT_GT(spanning, 0.97 * own);
  EXPECT_LT(taken, 0.05 * other);
}

// Ten lines of sight of a square metre each, the first `few` of one plane, the others of a larger one.
struct TwoPlanes {
  using Sight = stages::Sight;
  std::vector<stages::SightRay> rays = std::vector<stages::SightRay>(10);
  std::vector<stages::SightLine> pose = std::vector<stages::SightLine>(10), other = pose;

  TwoPlanes(std::size_t few, std::pair<Sight, Sight> of_few, std::pair<Sight, Sight> of_others) {
    for (std::size_t k = 0; k < rays.size(); ++k) {
      rays[k].area_m2 = 1;
      rays[k].plane = k < few ? 1 : 0;
      pose[k].sight = (k < few ? of_few : of_others).first;
      other[k].sight = (k < few ? of_few : of_others).second;
    }
  }
};

// One plane, in front of the other pose's faces: a wardrobe's front says half; a wall's all, and firmly.
TEST(AutomaticEvidence, a_wall_before_a_face_speaks_firmly) {
  using stages::Sight;
  TwoPlanes at(4, {Sight::supported, Sight::in_front}, {Sight::supported, Sight::supported});
  const auto furniture = stages::compare(at.rays, at.pose, at.other);
  EXPECT_DOUBLE_EQ(furniture.for_it, 0.2);
  EXPECT_DOUBLE_EQ(furniture.largest_firm, 0);
  for (std::size_t k = 0; k < 4; ++k) at.rays[k].spans = true;
  const auto wall = stages::compare(at.rays, at.pose, at.other);
  EXPECT_DOUBLE_EQ(wall.for_it, 0.4);
  EXPECT_DOUBLE_EQ(wall.largest_firm, 0.4);
  EXPECT_DOUBLE_EQ(stages::compare(at.rays, at.other, at.pose).against_it, 0.4);
}

// What is seen through a wall's face speaks against the pose by half where it may be a recess's back.
TEST(AutomaticEvidence, a_recess_that_the_model_may_lack_speaks_by_half) {
  using stages::Sight;
  TwoPlanes at(2, {Sight::through, Sight::supported}, {Sight::supported, Sight::in_front});
  for (std::size_t k = 2; k < at.rays.size(); ++k) at.rays[k].spans = true;
  const stages::MarginRule rule;
  const auto wall = stages::compare(at.rays, at.pose, at.other);
  EXPECT_DOUBLE_EQ(wall.against_it, 0.2);
  EXPECT_DOUBLE_EQ(wall.against_recess, 0.2);
  EXPECT_DOUBLE_EQ(stages::strength(wall, rule), (0.8 - 0.1) / (0.8 + 0.1) / rule.least_consistency);
  for (std::size_t k = 0; k < 2; ++k) at.other[k].recess = true;  // a recess of the model's own, and it fits
  const auto niche = stages::compare(at.rays, at.pose, at.other);
  EXPECT_DOUBLE_EQ(niche.against_recess, 0);
  EXPECT_DOUBLE_EQ(stages::strength(niche, rule), (0.8 - 0.2) / (0.8 + 0.2) / rule.least_consistency);
}

TEST(TileIcp, comes_back_from_half_a_metre_and_ten_degrees) {
  const Trial t = trial("hall", 32);
  const auto shapes = stages::measure_model(make_trial_room("hall", 32).proxy);
  for (int k = 0; k < 10; ++k) {
    testing::Draw draw(7, static_cast<std::uint32_t>(k));
    const auto axis = [&] { return Vec3(draw.normal(), draw.normal(), draw.normal()).normalized(); };
    Pose start = t.scan.world_from_scan;
    start.translation += 0.5 * axis();
    start.rotation = Eigen::AngleAxisd(10 * kDegree, axis()) * start.rotation;
    const auto error =
        difference(t.scan.world_from_scan, stages::fit_tiles(t.evidence, shapes, start).world_from_scan);
    EXPECT_LT(error.distance_m, 0.002) << k;
    EXPECT_LT(error.angle_rad, 0.02 * kDegree) << k;
  }
}

TEST(AutomaticWords, motions_read_as_people_say_them) {
  Pose from, to;
  from.translation = {1, 2, 1.5};
  to = from;
  EXPECT_EQ(stages::motion_in_words(from, to), "the same place");
  to.rotation = Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitZ());
  to.translation = {4, 6, 1.5};
  EXPECT_EQ(stages::motion_in_words(from, to),
            "turned by 180 degrees about the vertical, the scanner moved by 5.00 m to (4.00, 6.00, 1.50)");
  to.rotation = Eigen::AngleAxisd(-std::numbers::pi / 2, Vec3::UnitZ());
  to.translation = from.translation;
  EXPECT_EQ(stages::motion_in_words(from, to), "turned by -90 degrees about the vertical");
}

}  // namespace hybrid::automatic_test
