#include "stages/contours/contour_faces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device.hpp"
#include "stages/box_room.hpp"
#include "stages/contours/contours.hpp"
#include "stages/planes/superclusters.hpp"

namespace hybrid::testing {
namespace {

// A room whose proxy has walls, floor and ceiling, but neither the panel on a wall nor the niche's back.
struct UnexplainedRoom {
  RoomScan scan;
  PlaneSegmentation segmentation;
  std::vector<std::uint8_t> explained, stray;
  stages::Decimation decimation;

  explicit UnexplainedRoom(const BoxRoom& room) : scan(scan_room(room)) {
    segmentation = stages::grow_superclusters(queue(), scan.image, fit_squares(scan.image, 5, room.noise_m));
    const auto boundary = stages::trace_contours(queue(), scan.image, segmentation);
    decimation = stages::decimate(queue(), scan.image, segmentation, boundary);
    for (const std::uint8_t plane : scan.truth) explained.push_back(plane != kPanel && plane != kNicheBack);
    stray.assign(scan.image.count(), 0);
    stages::keep_unexplained(explained, decimation);
  }
  const Supercluster& plane(double offset_m, const Vec3& normal) const {
    for (const Supercluster& s : segmentation.superclusters)
      if (s.plane.normal.dot(normal) > 0.999 && std::abs(s.plane.offset_m - offset_m) < 0.01) return s;
    ADD_FAILURE() << "no such plane";
    return segmentation.superclusters.front();
  }
  stages::ContourFaces contours(const stages::ContourFaceOptions& options = {}) const {
    return stages::unexplained_contours(scan.image, segmentation, {}, explained, stray, 0.002, options);
  }
};

}  // namespace

TEST(ContourFaces, what_no_face_explains_becomes_a_polygon_and_no_hole) {
  UnexplainedRoom room({});
  const auto faces = room.contours();
  ASSERT_EQ(faces.fits.size(), 2u);
  ASSERT_EQ(faces.model.faces.size(), 2u);
  const Supercluster& panel = room.plane(-3.37, {-1, 0, 0});
  const auto at = std::find(faces.supercluster.begin(), faces.supercluster.end(), panel.id);
  ASSERT_NE(at, faces.supercluster.end());
  const Face& face = faces.model.faces[static_cast<std::size_t>(at - faces.supercluster.begin())];
  EXPECT_NEAR(face_area_m2(faces.model, face), panel.area_m2, 0.06 * panel.area_m2);
  // Its samples end half a spacing within the panel's edges; the polygon does not.
  constexpr double kPanel_m2 = 1.9 * 1.5;
  const auto narrow = room.contours({.widen = 0}).model;
  EXPECT_LT(face_area_m2(narrow, narrow.faces[static_cast<std::size_t>(at - faces.supercluster.begin())]),
            0.98 * kPanel_m2);
  EXPECT_NEAR(face_area_m2(faces.model, face), kPanel_m2, 0.01 * kPanel_m2);
  EXPECT_LT(face.outer.size(), 40u);  // a rectangle: its edges were straightened
  for (const std::uint32_t v : face.outer)
    EXPECT_LT(std::abs(panel.plane.distance(faces.model.vertices[v])), 1e-6);
  // The polygon's front is the side the scanner saw.
  EXPECT_GT(face_plane(faces.model, face).normal.dot(panel.plane.normal), 0.999);
  for (const auto& fit : faces.fits) {
    EXPECT_TRUE(fit.polygon);
    EXPECT_GT(fit.coverage, 0.97);
    EXPECT_LT(fit.seen_through, 0.01);
  }

  // Only now may the interiors go: every sample of theirs is discarded, covered, or still there.
  const auto before = room.decimation.discarded;
  stages::discard_covered(faces.covered, room.decimation);
  EXPECT_GT(room.decimation.discarded, before + 500);
  std::int64_t lost = 0;
  for (std::size_t i = 0; i < faces.covered.size(); ++i)
    lost += room.decimation.fate[i] == stages::kDiscarded && !room.explained[i] && !faces.covered[i];
  EXPECT_EQ(lost, 0);
}

// A hole that shares a sample with the outline or with another hole, as one beside a bridge of one sample
// does.
TEST(ContourFaces, rings_that_meet_in_a_vertex_become_a_polygon) {
  UnexplainedRoom room({});
  const std::uint32_t id = room.plane(-3.37, {-1, 0, 0}).id;
  Supercluster& panel = room.segmentation.superclusters[id - 1];
  const auto outline = panel.contours.at(0).points;
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : outline) centre += p / static_cast<double>(outline.size());
  // Thin triangles from vertices of the outline to its middle, two of them on to a common vertex there.
  const std::size_t step = outline.size() / 7;
  double holes_m2 = 0;
  for (std::size_t k = 0; k < 7; ++k) {
    const Vec3 tip = outline[k * step], inner = k < 2 ? centre : Vec3(centre + 0.3 * (tip - centre));
    const Vec3 beside = centre + 0.5 * (tip - centre) + 0.1 * panel.plane.normal.cross(tip - centre);
    panel.contours.push_back({{tip, beside, inner}, false});
    if ((beside - tip).cross(inner - tip).dot(panel.plane.normal) > 0)
      std::reverse(panel.contours.back().points.begin(), panel.contours.back().points.end());
    holes_m2 += 0.5 * (beside - tip).cross(inner - tip).norm();
  }
  const auto faces = room.contours();
  const auto at = std::find(faces.supercluster.begin(), faces.supercluster.end(), id);
  ASSERT_NE(at, faces.supercluster.end());
  const Face& face = faces.model.faces[static_cast<std::size_t>(at - faces.supercluster.begin())];
  EXPECT_NEAR(face_area_m2(faces.model, face), panel.area_m2, 0.06 * panel.area_m2 + holes_m2);
  EXPECT_NO_THROW(triangulate(faces.model));
}

TEST(ContourFaces, an_explained_plane_makes_no_polygon) {
  UnexplainedRoom room({});
  std::fill(room.explained.begin(), room.explained.end(), std::uint8_t{1});
  const auto faces = room.contours();
  EXPECT_TRUE(faces.fits.empty());
  EXPECT_TRUE(faces.model.faces.empty());
  EXPECT_EQ(std::count(faces.covered.begin(), faces.covered.end(), 1), 0);
}

TEST(ContourFaces, a_contour_that_rays_pass_through_keeps_its_samples) {
  UnexplainedRoom room({});
  // A contour far larger than the panel: the wall behind it is seen through it.
  auto& panel = room.segmentation.superclusters[room.plane(-3.37, {-1, 0, 0}).id - 1];
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : panel.contours.at(0).points) centre += p;
  centre /= static_cast<double>(panel.contours[0].points.size());
  // Within the extent of the samples that are asked: a diagonal cut of the panel's neighbourhood.
  for (auto& label : room.segmentation.sample_label)
    if (label == panel.id && (&label - room.segmentation.sample_label.data()) % 3 != 0) label = 0;
  std::size_t wall = 0;
  for (std::size_t i = 0; i < room.scan.image.count(); ++i)
    if (room.scan.truth[i] == kPanel && i % 3 != 0 && room.scan.image.mask[i] == kMeasured) {
      const float back = 3.4f / 3.37f;  // the rays pass between slats to the wall
      room.scan.image.x[i] *= back, room.scan.image.y[i] *= back, room.scan.image.z[i] *= back;
      ++wall;
    }
  ASSERT_GT(wall, 500u);
  const auto faces = room.contours();
  const auto fit = std::find_if(faces.fits.begin(), faces.fits.end(),
                                [&](const auto& f) { return f.supercluster == panel.id; });
  ASSERT_NE(fit, faces.fits.end());
  EXPECT_FALSE(fit->polygon);
  EXPECT_GT(fit->seen_through, 0.5);
  EXPECT_EQ(std::count(faces.supercluster.begin(), faces.supercluster.end(), panel.id), 0);
}

TEST(ContourFaces, holes_go_to_the_ring_around_them) {
  BoxRoom without_column;
  without_column.column_radius_m = 0;
  UnexplainedRoom room(without_column);
  // As if the proxy lacked the wall behind the panel: its polygon has the panel as a hole.
  for (std::size_t i = 0; i < room.explained.size(); ++i)
    if (room.scan.truth[i] == kWallEast) room.explained[i] = 0;
  const auto faces = room.contours();
  const Supercluster& wall = room.plane(-3.4, {-1, 0, 0});
  for (std::size_t k = 0; k < faces.supercluster.size(); ++k)
    if (faces.supercluster[k] == wall.id) {
      EXPECT_EQ(faces.model.faces[k].holes.size(), 1u);
      return;
    }
  ADD_FAILURE() << "the wall made no polygon";
}

TEST(ContourFaces, flags_of_another_image_are_refused) {
  UnexplainedRoom room({});
  room.stray.pop_back();
  EXPECT_THROW(room.contours(), Error);
  EXPECT_THROW(stages::discard_covered({1, 0}, room.decimation), Error);
}

}  // namespace hybrid::testing
