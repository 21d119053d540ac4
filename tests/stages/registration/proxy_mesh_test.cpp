// Proxies that are no handful of large faces: a million of them, one, and one without area.
#include <gtest/gtest.h>

#include <numbers>

#include "cases/closest_point_tree_case.hpp"
#include "cases/recess_room.hpp"
#include "core/error.hpp"
#include "device.hpp"
#include "stages/registration/automatic.hpp"
#include "stages/registration/face_offsets.hpp"
#include "stages/registration/icp.hpp"

namespace hybrid::stages::proxy_mesh_test {
namespace {

using namespace hybrid::testing;

const RecessRoomScan& room() {
  static const RecessRoomScan scan = scan_recess_room(150, 300, 0.002);
  return scan;
}

// The room's proxy, each wall cut into 2 x side x side triangles.
PolygonModel mesh(int side) {
  PolygonModel model = room().proxy;
  ClosestPointTreeCase::cut(model, side, 1, 0);
  return model;
}

}  // namespace

TEST(ProxyMesh, a_million_faces_give_the_pose_of_the_six_they_were_cut_from) {
  const auto samples = choose_planar_samples(room().image, room().segmentation, 20000, 1);
  const PolygonModel million = mesh(289);
  ASSERT_GT(million.faces.size(), 1'000'000u);
  const Pose start = disturbed(room().world_from_scan, 0.05, 2, 1);
  const ProxyModel model(million);
  const auto found = register_to_model(queue(), samples, model, start);
  const auto again = register_to_model(queue(), samples, model, start);  // by what the first made
  EXPECT_EQ(row_major(again.world_from_scan), row_major(found.world_from_scan));
  EXPECT_EQ(again.covariance, found.covariance);
  const auto whole = register_to_model(queue(), samples, room().proxy, start);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(difference(found.world_from_scan, room().world_from_scan).distance_m, 2e-4);
  // Samples beside an edge of two walls may go to the one or the other.
  EXPECT_LT(difference(found.world_from_scan, whole.world_from_scan).distance_m, 2e-5);
  EXPECT_TRUE(found.degenerate.empty());
}

TEST(ProxyMesh, small_faces_have_no_offsets_and_no_planes_to_match_and_it_is_said) {
  const PolygonModel model = mesh(19);
  const std::string name = fmt::format("mesh of {}", model.faces.size());
  const auto evidence = gather_evidence(room().image, room().segmentation, 1000, 1);
  const Pose start = disturbed(room().world_from_scan, 0.02, 0.5, 1);
  const Pose solved = solve_face_offsets(room().segmentation, evidence, model, start);
  EXPECT_EQ(row_major(solved), row_major(start));  // the largest of them must not pull it anywhere
  const auto offsets = measure_face_offsets(room().segmentation, evidence, model, start);
  EXPECT_TRUE(offsets.faces.empty());
  EXPECT_NE(offsets.note.find(name), std::string::npos) << offsets.note;
  const auto aligned = align_automatically(queue(), evidence, model);
  EXPECT_FALSE(aligned.accepted);
  EXPECT_NE(aligned.reason.find(name), std::string::npos) << aligned.reason;
  // A few small faces beside large ones change nothing.
  PolygonModel detailed = room().proxy;
  EXPECT_TRUE(measure_face_offsets(room().segmentation, evidence, detailed, start).note.empty());
}

TEST(ProxyMesh, a_model_kept_for_many_scans_gives_what_a_fresh_one_gives) {
  const PolygonModel mesh_of_many = mesh(19);
  const auto samples = choose_planar_samples(room().image, room().segmentation, 5000, 1);
  const auto evidence = gather_evidence(room().image, room().segmentation, 1000, 1);
  for (const PolygonModel* polygons : {&room().proxy, &mesh_of_many}) {
    const ProxyModel kept(*polygons);
    for (const std::uint32_t seed : {1u, 2u}) {
      const Pose start = disturbed(room().world_from_scan, 0.05, 2, seed);
      const auto one = register_to_model(queue(), samples, kept, start),
                 other = register_to_model(queue(), samples, *polygons, start);
      EXPECT_EQ(row_major(one.world_from_scan), row_major(other.world_from_scan));
      EXPECT_EQ(one.covariance, other.covariance);
      const auto offsets = measure_face_offsets(room().segmentation, evidence, kept, one.world_from_scan);
      EXPECT_EQ(
          offsets.disagreement_m,
          measure_face_offsets(room().segmentation, evidence, *polygons, one.world_from_scan).disagreement_m);
      const auto near = distance_to_model(queue(), room().image, room().segmentation, kept, start, 45);
      EXPECT_TRUE(same_bits(
          near, distance_to_model(queue(), room().image, room().segmentation, *polygons, start, 45)));
    }
    EXPECT_EQ(row_major(align_automatically(queue(), evidence, kept).world_from_scan),
              row_major(align_automatically(queue(), evidence, *polygons).world_from_scan));
  }
}

TEST(ProxyMesh, one_face_holds_what_it_can_and_the_rest_stays) {
  PolygonModel floor = room().proxy;
  const auto up = [&](const Face& face) { return face_plane(floor, face).normal.z() > 0.9; };
  std::erase_if(floor.faces, [&](const Face& face) { return !up(face); });
  ASSERT_EQ(floor.faces.size(), 1u);
  const auto samples = choose_planar_samples(room().image, room().segmentation, 5000, 1);
  const Pose start = disturbed(room().world_from_scan, 0.01, 0, 2);
  const auto found = register_to_model(queue(), samples, floor, start);
  EXPECT_EQ(found.degenerate.size(), 3u) << fmt::format("{}", found.degenerate.size());
  EXPECT_NEAR(found.world_from_scan.translation.z(), room().world_from_scan.translation.z(), 5e-4);
  EXPECT_NEAR(found.world_from_scan.translation.x(), start.translation.x(), 1e-3);
}

TEST(ProxyMesh, a_face_without_area_is_named) {
  PolygonModel model = room().proxy;
  model.faces[2].name = "sliver";
  model.faces[2].outer = {0, 1, 1};
  const auto samples = choose_planar_samples(room().image, room().segmentation, 1000, 1);
  try {
    register_to_model(queue(), samples, model, room().world_from_scan);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find("sliver"), std::string::npos) << error.what();
  }
}

}  // namespace hybrid::stages::proxy_mesh_test
