#include "io/e57/e57_photographs.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "io/e57/e57_xml.hpp"
#include "io/files.hpp"
#include "io/picture.hpp"

namespace hybrid::testing {
namespace {

std::string element(const std::string& name, double value) {
  return fmt::format("<{0} type=\"Float\">{1}</{0}>", name, value);
}

// One image; 100 x 50 pixels unless said.
std::string image(const std::string& name, const std::string& kind, const std::string& numbers,
                  const std::string& more = "", int width = 100, int height = 50) {
  return fmt::format(
      "<vectorChild type=\"Structure\"><name type=\"String\">{0}</name>{1}<{2} type=\"Structure\">"
      "<jpegImage type=\"Blob\" fileOffset=\"48\" length=\"10\"/><imageWidth "
      "type=\"Integer\">{4}</imageWidth>"
      "<imageHeight type=\"Integer\">{5}</imageHeight>{3}</{2}></vectorChild>",
      name, more, kind, numbers, width, height);
}

io::E57Photographs photographs(const std::string& images) {
  return io::e57_photographs(
      io::parse_e57_xml("a.e57", "<e57Root><images2D>" + images + "</images2D></e57Root>", false));
}

const std::string kPinhole = element("focalLength", 0.02) + element("pixelWidth", 1e-4) +
                             element("pixelHeight", 2e-4) + element("principalPointX", 48) +
                             element("principalPointY", 26);
// A quarter turn about z, and moved: the image's x becomes the file's y.
const std::string kPose =
    "<pose><rotation><w>1</w><x>0</x><y>0</y><z>1</z></rotation><translation><x>10</x><y>20</y><z>30</z>"
    "</translation></pose>";

void expect_pixel(const Photograph& photograph, const Vec3& point, double column, double row) {
  const auto pixel = photograph.camera.project(photograph.cam_from_world * point);
  ASSERT_TRUE(pixel) << point.transpose();
  EXPECT_NEAR(pixel->x(), column, 1e-9);
  EXPECT_NEAR(pixel->y(), row, 1e-9);
}

std::vector<char> jpeg(int width, int height) {
  OIIO::Filesystem::IOVecOutput bytes;
  const auto out = OIIO::ImageOutput::create("jpeg", &bytes);
  const std::vector<unsigned char> grey(static_cast<std::size_t>(3 * width * height), 120);
  EXPECT_TRUE(out && out->open("a.jpg", OIIO::ImageSpec(width, height, 3, OIIO::TypeUInt8)));
  EXPECT_TRUE(out->write_image(OIIO::TypeUInt8, grey.data()) && out->close());
  return {bytes.buffer().begin(), bytes.buffer().end()};
}

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "nothing thrown";
}

}  // namespace

TEST(E57Photographs, a_pinhole_looks_along_minus_z_with_y_up) {
  const auto found = photographs(image("a", "pinholeRepresentation", kPinhole));
  ASSERT_EQ(found.photographs.size(), 1u);
  expect_pixel(found.photographs[0].photograph, {0, 0, -2}, 48, 26);
  expect_pixel(found.photographs[0].photograph, {0.1, 0, -1}, 48 + 20, 26);
  expect_pixel(found.photographs[0].photograph, {0, 0.1, -1}, 48, 26 - 10);
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_NE(found.notes[0].find("no pose"), std::string::npos) << found.notes[0];
}

TEST(E57Photographs, the_pose_leads_from_the_image_to_the_file) {
  const auto found = photographs(image("a", "pinholeRepresentation", kPinhole, kPose));
  EXPECT_TRUE(found.notes.empty());
  expect_pixel(found.photographs.at(0).photograph, Vec3(10, 20, 30) + Vec3(0, 0.1, -1), 48 + 20, 26);
}

TEST(E57Photographs, a_spherical_image_has_x_in_its_middle_and_z_up) {
  const double pixel = 2 * M_PI / 100;
  // Six digits, as files have it: the turn still closes.
  const auto found = photographs(image("a", "sphericalRepresentation",
                                       element("pixelWidth", 0.0628319) + element("pixelHeight", pixel)));
  const Photograph& photograph = found.photographs.at(0).photograph;
  expect_pixel(photograph, {3, 0, 0}, 50, 25);
  expect_pixel(photograph, {0, 2, 0}, 25, 25);   // to the left
  expect_pixel(photograph, {0, -2, 0}, 75, 25);  // to the right
  expect_pixel(photograph, {1, 0, 1}, 50, 12.5);
  EXPECT_TRUE(photograph.camera.wraps());
  EXPECT_TRUE(photograph.camera.reaches_zenith() && photograph.camera.reaches_nadir());
}

TEST(E57Photographs, a_cylindrical_image_meets_the_plane_z_0_in_its_principal_row) {
  const auto found = photographs(image("a", "cylindricalRepresentation",
                                       element("pixelWidth", M_PI / 100) + element("pixelHeight", 0.01) +
                                           element("radius", 0.2) + element("principalPointY", 20)));
  const Photograph& photograph = found.photographs.at(0).photograph;
  expect_pixel(photograph, {3, 0, 0}, 50, 20);
  expect_pixel(photograph, {1, 1, 0}, 25, 20);
  expect_pixel(photograph, {2, 0, 1}, 50, 10);  // half a radius up: 0.1 m of 1 cm
  EXPECT_FALSE(photograph.camera.wraps());
  EXPECT_FALSE(photograph.camera.project(photograph.cam_from_world * Vec3(-1, 0.1, 0)));
}

TEST(E57Photographs, images_that_make_no_camera_are_left_out_and_say_why) {
  const auto found = photographs(image("no focus", "pinholeRepresentation", element("pixelWidth", 1), kPose) +
                                 image("visual", "visualReferenceRepresentation", "") +
                                 image("too wide", "sphericalRepresentation",
                                       element("pixelWidth", 1) + element("pixelHeight", 1), kPose) +
                                 image("flat", "cylindricalRepresentation",
                                       element("pixelWidth", 0.01) + element("pixelHeight", 1), kPose) +
                                 image("empty", "pinholeRepresentation", kPinhole, kPose, 0, 50));
  EXPECT_TRUE(found.photographs.empty());
  ASSERT_EQ(found.notes.size(), 5u);
  const char* words[] = {"focal length", "has no camera", "full turn", "radius", "at least 1 x 1"};
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_NE(found.notes[i].find(words[i]), std::string::npos) << found.notes[i];
}

TEST(E57Photographs, a_placeholder_for_the_pixels_of_a_full_panorama_is_seen_through) {
  const auto found = photographs(image("a", "sphericalRepresentation",
                                       element("pixelWidth", 5e-6) + element("pixelHeight", 5e-6), kPose));
  ASSERT_EQ(found.photographs.size(), 1u);
  EXPECT_TRUE(found.photographs[0].photograph.camera.wraps());
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_NE(found.notes[0].find("full sphere"), std::string::npos);
}

TEST(E57Photographs, names_are_unique_and_can_be_files) {
  const auto found = photographs(image("../../etc/passwd", "pinholeRepresentation", kPinhole, kPose) +
                                 image("a", "pinholeRepresentation", kPinhole, kPose) +
                                 image("a", "pinholeRepresentation", kPinhole, kPose) +
                                 image("", "pinholeRepresentation", kPinhole, kPose));
  std::vector<std::string> names;
  for (const auto& one : found.photographs) names.push_back(one.photograph.name);
  EXPECT_EQ(names, (std::vector<std::string>{".._.._etc_passwd", "a", "a-2", "image-3"}));
  EXPECT_EQ(io::safe_name("..", "b"), "b");
  EXPECT_EQ(io::safe_name(std::string(1000, 'x'), "b").size(), 100u);
}

TEST(DecodePhotograph, a_black_mask_takes_pixels_out) {
  const std::vector<char> picture = jpeg(32, 16);
  OIIO::Filesystem::IOVecOutput bytes;
  std::vector<unsigned char> mask(32 * 16, 255);
  mask[5] = 0;
  const auto out = OIIO::ImageOutput::create("png", &bytes);
  ASSERT_TRUE(out->open("a.png", OIIO::ImageSpec(32, 16, 1, OIIO::TypeUInt8)));
  ASSERT_TRUE(out->write_image(OIIO::TypeUInt8, mask.data()) && out->close());
  const std::vector<char> png(bytes.buffer().begin(), bytes.buffer().end());
  const Image8 image = io::decode_photograph({picture, io::PictureFormat::jpeg},
                                             {png, io::PictureFormat::png}, "a.e57: image 0", 32, 16);
  ASSERT_EQ(image.channels, 4);
  for (int i = 0; i < 32 * 16; ++i) EXPECT_EQ(image.at(i % 32, i / 32)[3], i == 5 ? 0 : 255);
  EXPECT_NEAR(image.at(0, 0)[0], 120, 2);
  EXPECT_EQ(io::decode_photograph({picture}, {}, "a", 32, 16).channels, 3);
  const std::string wrong = message_of([&] {
    io::decode_photograph({picture}, {picture, io::PictureFormat::png}, "a.e57: image 0", 32, 16);
  });
  EXPECT_NE(wrong.find("its mask: expected a PNG"), std::string::npos) << wrong;
}

TEST(DecodePhotograph, what_its_bytes_cannot_hold_is_refused_before_it_is_allocated) {
  std::vector<char> picture = jpeg(32, 16);
  const auto decode = [&](int width, int height) {
    return message_of(
        [&] { io::decode_photograph({picture}, {}, "a.e57: image 3, byte 48", width, height); });
  };
  EXPECT_NE(decode(33, 16).find("a.e57: image 3, byte 48: expected the 33 x 16 pixels"), std::string::npos);
  // The frame header: marker, length, bits, then height and width, big-endian.
  std::size_t at = 0;
  while (!(picture[at] == '\xff' && picture[at + 1] == '\xc0')) ++at;
  for (std::size_t i : {5, 6, 7, 8}) picture[at + i] = '\x7f';
  EXPECT_NE(decode(0x7f7f, 0x7f7f).find("bytes can hold"), std::string::npos) << decode(0x7f7f, 0x7f7f);
  picture.resize(at);
  EXPECT_NE(decode(32, 16).find("expected a JPEG"), std::string::npos) << decode(32, 16);
}

// Cameras of a file that another program wrote.
TEST(E57Photographs, reads_every_kind_of_a_real_file) {
  const auto path = real_data("scans/e57-cry-inc/tiny_pc_and_images.e57");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const io::E57File file(path);
  const auto found = io::e57_photographs(file.contents());
  ASSERT_GE(found.photographs.size(), 2u);
  const auto& spherical = found.photographs[0];
  EXPECT_EQ(spherical.photograph.name, "spherical");
  EXPECT_EQ(spherical.scan, 0u);
  EXPECT_LT((spherical.photograph.centre() - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_NEAR(spherical.photograph.camera.fx, 1 / 0.0314, 1e-9);
  const auto& pinhole = found.photographs[1].photograph.camera;
  EXPECT_NEAR(pinhole.fx, 123 / 0.044, 1e-9);
  EXPECT_NEAR(pinhole.fy, 123 / 0.033, 1e-9);
  std::vector<std::string> damage;
  const Image8 picture = io::read_e57_photograph(file, spherical, damage);
  EXPECT_TRUE(damage.empty());
  EXPECT_EQ(picture.width, 100);
  EXPECT_EQ(picture.height, 100);
}

}  // namespace hybrid::testing
