// What every reader of a scene description does with files that are not what they should be: ErrorKind::input
// that names the file and the place, never a crash and never half a result.
#include <gtest/gtest.h>

#include <cctype>
#include <functional>

#include "io/bundler.hpp"
#include "io/colmap.hpp"
#include "io/colmap_bytes.hpp"
#include "io/exr.hpp"
#include "io/files.hpp"
#include "io/nerfstudio.hpp"
#include "io/obj.hpp"
#include "io/picture.hpp"
#include "io/scene_file.hpp"
#include "io/strecha.hpp"

namespace hybrid::io {
namespace {
namespace fs = std::filesystem;
using testing::bytes_of;
using testing::error_of;
using testing::holds;
using testing::TemporaryFolder;

// A reader with a file that it accepts and that stops being acceptable wherever it is cut.
struct Reader {
  std::string name;
  std::string file;
  std::function<std::string(const TemporaryFolder&)> good;
  std::function<void(const fs::path&)> read;
  bool text = true;  // its errors carry a line
};

// The faces stand first, so that every vertex that is cut off is missed.
const std::string kObj =
    "# box lid\no lid\nf 1/1/1 2//1 3/1 4\ng rim\nf 5 6 \\\n 7 8\n"
    "v 0 0 0\nv 1.5 0 0\nv 1.5 1 0\nv 0 1 0\nv 0 0 1\nv 1.5 0 1\nv 1.5 1 1\nv 0 1 1\n";
const std::string kCameras =
    "1 OPENCV 1296 1936 2435.38 2435.38 648.25 968.25 -0.0336422 0.0012345 0.00012345 0.0001\n";
const std::string kImages =
    "1 0.983789 0.00113517 0.176825 -0.0298644 -7.60712 0.428157 2.75243 1 folder/a long name with "
    "blanks.jpg\n\n";
const std::string kCamerasBin =
    testing::bytes(std::uint64_t{1}) + testing::colmap_camera_bytes(7, 1, 640, 480, {500, 510, 320, 240});
const std::string kImagesBin =
    testing::bytes(std::uint64_t{1}) + testing::colmap_image_bytes(3, 7, "a.jpg", 2);
const std::string kStrecha = "100 0 31.5\n0 110 23.5\n0 0 1\n0 0 0\n0 0 1\n-1 0 0\n0 -1 0\n1 2 3\n64 48\n";
// Two points, each seen by the one camera.
const std::string kBundle =
    "# Bundle file v0.3\n1 2\n100 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -5\n1 2 3\n255 128 0\n1 0 17 1.5 -2.5\n"
    "1 2 3\n255 128 0\n1 0 18 1.5 -2.5\n";
const std::string kNerfstudio =
    "{\"w\":64,\"h\":48,\"fl_x\":100,\"frames\":[{\"file_path\":\"a.jpg\",\"transform_matrix\":\n"
    "[[0,0,-1,1],[-1,0,0,2],[0,1,0,3],[0,0,0,1]]}]}\n";
const std::string kScene =
    "scan = [\n  { id = \"west\", file = \"west.ply\", index = 0, landmarks = [\n"
    "    { scan = [1.0, 2.0, 3.0], model = [0.5, 0.25, 0.125] },\n    { pixel = [10, 20], vertex = 3 },\n  ] "
    "},\n"
    "  { id = \"east\", file = \"east.ply\" },\n]\n";

std::vector<Reader> readers() {
  const auto fixed = [](std::string text) { return [text](const TemporaryFolder&) { return text; }; };
  return {
      {"obj", "model.obj", fixed(kObj), [](const fs::path& file) { read_obj(file); }},
      {"scene", "scene.toml", fixed(kScene), [](const fs::path& file) { read_scene_file(file); }},
      {"cameras", "cameras.txt",
       [](const TemporaryFolder& folder) {
         folder.write("images.txt", kImages);
         return kCameras;
       },
       [](const fs::path& file) { read_colmap(file.parent_path()); }},
      {"images", "images.txt",
       [](const TemporaryFolder& folder) {
         folder.write("cameras.txt", kCameras);
         return kImages;
       },
       [](const fs::path& file) { read_colmap(file.parent_path()); }},
      {"colmap_cameras_bin", "cameras.bin",
       [](const TemporaryFolder& folder) {
         folder.write("images.bin", kImagesBin);
         return kCamerasBin;
       },
       [](const fs::path& file) { read_colmap_binary(file.parent_path()); }, false},
      {"colmap_images_bin", "images.bin",
       [](const TemporaryFolder& folder) {
         folder.write("cameras.bin", kCamerasBin);
         return kImagesBin;
       },
       [](const fs::path& file) { read_colmap_binary(file.parent_path()); }, false},
      {"strecha", "a.jpg.camera", fixed(kStrecha), [](const fs::path& file) { read_strecha_camera(file); }},
      {"bundler", "bundle.out",
       [](const TemporaryFolder& folder) {
         folder.write("list.txt", "a.jpg\n");
         return kBundle;
       },
       [](const fs::path& file) { read_bundler(file, {}); }},
      {"nerfstudio", "transforms.json", fixed(kNerfstudio),
       [](const fs::path& file) { read_nerfstudio(file, {}); }},
      {"exr_picture", "photo.exr",
       [](const TemporaryFolder& folder) {
         const std::vector<float> grey(40 * 30, 0.5f);
         write_exr(folder.path() / "made.exr", 40, 30,
                   {{"R", grey.data(), nullptr, 1},
                    {"G", grey.data(), nullptr, 1},
                    {"B", grey.data(), nullptr, 1}});
         return bytes_of(folder.path() / "made.exr");
       },
       [](const fs::path& file) { read_photograph(file, 40, 30); }, false},
      {"picture", "photo.png",
       [](const TemporaryFolder& folder) {
         write_png(folder.path() / "made.png", Image8(40, 30, 3, 77));
         return bytes_of(folder.path() / "made.png");
       },
       [](const fs::path& file) { read_photograph(file, 40, 30); }, false},
  };
}

std::string noise(std::size_t count, bool zeros) {
  std::string bytes;
  std::uint32_t state = 12345;
  while (bytes.size() < count) {
    state = state * 1664525u + 1013904223u;
    const char byte = static_cast<char>(state >> 24);
    if (byte != 0 || zeros) bytes.push_back(byte);
  }
  return bytes;
}

class BadInput : public ::testing::TestWithParam<Reader> {
 protected:
  void SetUp() override { good_ = GetParam().good(folder_); }

  // The error of reading `bytes`, checked to name the file and, in text, a line.
  std::string error_for(const std::string& bytes) {
    const fs::path file = folder_.write(GetParam().file, bytes);
    const std::string message = error_of(ErrorKind::input, [&] { GetParam().read(file); });
    EXPECT_TRUE(holds(message, file.string()));
    if (GetParam().text) {
      const std::size_t after = message.find(file.string() + ":");
      const bool has_line =
          after != std::string::npos &&
          std::isdigit(static_cast<unsigned char>(message[after + file.string().size() + 1]));
      EXPECT_TRUE(has_line) << message;
    }
    return message;
  }

  TemporaryFolder folder_;
  std::string good_;
};

TEST_P(BadInput, good_file_is_read) {
  EXPECT_NO_THROW(GetParam().read(folder_.write(GetParam().file, good_)));
}

TEST_P(BadInput, carriage_returns_are_read) {
  if (!GetParam().text) GTEST_SKIP() << "not a text format";
  std::string text;
  for (char c : good_) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_NO_THROW(GetParam().read(folder_.write(GetParam().file, text)));
}

TEST_P(BadInput, utf8_mark_is_read) {
  if (!GetParam().text) GTEST_SKIP() << "not a text format";
  EXPECT_NO_THROW(GetParam().read(folder_.write(GetParam().file, "\xef\xbb\xbf" + good_)));
}

TEST_P(BadInput, missing) {
  const fs::path file = folder_.path() / GetParam().file;
  const std::string message = error_of(ErrorKind::input, [&] { GetParam().read(file); });
  EXPECT_TRUE(holds(message, file.string() + ": no such file"));
}

TEST_P(BadInput, folder) {
  const fs::path file = folder_.path() / GetParam().file;
  fs::create_directories(file);
  const std::string message = error_of(ErrorKind::input, [&] { GetParam().read(file); });
  EXPECT_TRUE(holds(message, file.string() + ": expected a file, found a folder"));
}

TEST_P(BadInput, unreadable) {
  const fs::path file = folder_.write(GetParam().file, good_);
  fs::permissions(file, fs::perms::none);
  if (access(file.c_str(), R_OK) == 0) GTEST_SKIP() << "this user may read every file";
  EXPECT_TRUE(holds(error_of(ErrorKind::input, [&] { GetParam().read(file); }), file.string()));
}

TEST_P(BadInput, empty) {
  error_for("");
}

TEST_P(BadInput, noise_with_zeros) {
  error_for(noise(4000, true));
}

TEST_P(BadInput, noise_without_zeros) {
  error_for(noise(4000, false));
}

TEST_P(BadInput, utf16) {
  if (!GetParam().text) GTEST_SKIP() << "not a text format";
  std::string text = "\xff\xfe";
  for (char c : good_) text += {c, '\0'};
  EXPECT_TRUE(holds(error_for(text), "UTF-16"));
  EXPECT_TRUE(holds(error_for(text.substr(2)), "zero byte"));  // without its mark
}

TEST_P(BadInput, cut_at_ten_places) {
  for (std::size_t tenth = 1; tenth <= 10; ++tenth) {
    SCOPED_TRACE(tenth);
    error_for(good_.substr(0, good_.size() * tenth / 11));
  }
}

INSTANTIATE_TEST_SUITE_P(readers, BadInput, ::testing::ValuesIn(readers()),
                         [](const auto& reader) { return reader.param.name; });

}  // namespace
}  // namespace hybrid::io
