#include "io/cameras/write_colmap.hpp"

#include <algorithm>

#include "files.hpp"
#include "io/cameras/colmap.hpp"
#include "io/output.hpp"

namespace hybrid::testing {
namespace {

Photograph photograph(const std::string& name, const Camera& camera, double turn) {
  Photograph made;
  made.name = name;
  made.camera = camera;
  made.cam_from_world.rotation =
      Eigen::AngleAxisd(turn, Vec3(1, 2, 3).normalized()) * Eigen::AngleAxisd(0.3, Vec3::UnitX());
  made.cam_from_world.translation = {turn, 1.0 / 3, -530000.123456789};
  return made;
}

Camera camera(Lens lens, std::initializer_list<double> k, double p1 = 0) {
  Camera made;
  made.width = 640;
  made.height = 481;
  made.fx = 500.1;
  made.fy = 1500.0 / 7;
  made.cx = 321.5;
  made.cy = 0.1;
  made.lens = lens;
  double Camera::*const members[] = {&Camera::k1, &Camera::k2, &Camera::k3,
                                     &Camera::k4, &Camera::k5, &Camera::k6};
  std::size_t i = 0;
  for (const double value : k) made.*members[i++] = value;
  made.p1 = p1;
  return made;
}

}  // namespace

TEST(WriteColmap, its_reader_finds_the_same_cameras) {
  const TemporaryFolder folder;
  const std::vector<Photograph> photographs = {
      photograph("a.jpg", camera(Lens::brown, {}), 0.1),
      photograph("sub/b c.jpg", camera(Lens::brown, {-0.1, 1.0 / 3}, 0.001), 0.2),
      photograph("pano.jpg", camera(Lens::spherical, {}), 0.3),
      photograph("d.jpg", camera(Lens::brown, {-0.1, 0.02, 0.003, 0.1, 0.2, 0.3}), 0.4),
      photograph("e.jpg", camera(Lens::fisheye, {0.1, 0.2, 0.3, 0.4}), 2.5),
      photograph("f.jpg", camera(Lens::brown, {}), 3.0)};
  const auto left_out = io::write_colmap(folder.path(), photographs, {{{1.5, -2.25, 3e5}, {1, 2, 255}}});
  EXPECT_EQ(left_out, std::vector<std::string>{"pano.jpg"});
  const auto read = io::read_colmap(folder.path()).photographs;
  ASSERT_EQ(read.size(), 5u);
  for (std::size_t i = 0; i < read.size(); ++i) {
    const auto same = [&](const Photograph& p) { return p.name == read[i].name; };
    const auto found = std::find_if(photographs.begin(), photographs.end(), same);
    ASSERT_NE(found, photographs.end()) << read[i].name;
    const Photograph& expected = *found;
    const Camera &a = read[i].camera, &b = expected.camera;
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.lens, b.lens);
    for (const auto member : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1, &Camera::k2,
                              &Camera::k3, &Camera::k4, &Camera::k5, &Camera::k6, &Camera::p1, &Camera::p2})
      EXPECT_EQ(a.*member, b.*member) << expected.name;
    EXPECT_EQ(read[i].cam_from_world.translation, expected.cam_from_world.translation);
    EXPECT_LT(read[i].cam_from_world.rotation.angularDistance(expected.cam_from_world.rotation), 1e-15);
  }
  EXPECT_EQ(io::number_cameras(photographs), (std::vector<std::size_t>{0, 1, 2, 3, 4, 0}));
  EXPECT_TRUE(
      holds(io::read_text(folder.path() / "points3D.txt"), "\n1 1.50000 -2.25000 300000.00000 1 2 255 0\n"));
}

}  // namespace hybrid::testing
