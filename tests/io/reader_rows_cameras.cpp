#include "io/cameras/bundler.hpp"
#include "io/cameras/colmap.hpp"
#include "io/cameras/nerfstudio.hpp"
#include "io/cameras/strecha.hpp"
#include "io/colmap_bytes.hpp"
#include "io/reader_rows.hpp"

namespace hybrid::testing {
namespace {
namespace fs = std::filesystem;

void tell_photograph(std::string& text, const Photograph& photograph) {
  const Camera& c = photograph.camera;
  tell(text, photograph.name, photograph.cam_from_world.rotation.coeffs());
  tell(text, "at", photograph.cam_from_world.translation);
  text += fmt::format("{} x {}: {} {} {} {} {} {} {} {}\n", c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1,
                      c.k2, c.p1, c.p2);
}

std::string tell_cameras(const io::CameraFile& file) {
  std::string text;
  for (const auto& camera : file.cameras) text += camera.id + " " + camera.model + "\n";
  for (const auto& photograph : file.photographs) tell_photograph(text, photograph);
  return text;
}

// COLMAP text: a model is two files, each damaged beside a good other one.

const std::string kCameras =
    "1 OPENCV 1296 1936 2435.38 2435.38 648.25 968.25 -0.0336422 0.0012345 0.00012345 0.0001\n";
const std::string kImages =
    "1 0.983789 0.00113517 0.176825 -0.0298644 -7.60712 0.428157 2.75243 1 folder/a long name with "
    "blanks.jpg\n\n";

std::string tell_colmap(const fs::path& file) {
  return tell_cameras(io::read_colmap(file.parent_path()));
}

ReaderRow colmap_cameras_row() {
  ReaderRow row{.name = "colmap_cameras", .file = "cameras.txt"};
  row.good = [](const fs::path& folder) {
    write_file_beside(folder / "images.txt", kImages);
    return kCameras;
  };
  row.read = tell_colmap;
  row.free_name = false;
  row.text = true;
  row.counts_too_high = {{" OPENCV ", " FULL_OPENCV "}};
  row.counts_too_low = {{" OPENCV ", " RADIAL "}};
  row.absurd_sizes = {{"1296 1936", "2000000000 2000000000"}, {"1296 1936", "-1296 1936"}};
  row.non_finite = {{"968.25", "nan"}, {"0.0001\n", "inf\n"}};
  return row;
}

ReaderRow colmap_images_row() {
  ReaderRow row{.name = "colmap_images", .file = "images.txt"};
  row.good = [](const fs::path& folder) {
    write_file_beside(folder / "cameras.txt", kCameras);
    return kImages;
  };
  row.read = tell_colmap;
  row.free_name = false;
  row.text = true;
  row.counts_too_high = {{" 1 folder", " 2 folder"}, {"jpg\n\n", "jpg\n1 2\n"}};
  row.non_finite = {{"-7.60712", "nan"}, {"0.983789", "inf"}};
  return row;
}

// COLMAP binary.

const std::string kCamerasBin =
    bytes(std::uint64_t{1}) + colmap_camera_bytes(7, 1, 640, 480, {500, 510, 320, 240});
const std::string kImagesBin = bytes(std::uint64_t{1}) + colmap_image_bytes(3, 7, "a.jpg", 2);

ReaderRow colmap_cameras_binary_row() {
  ReaderRow row{.name = "colmap_cameras_binary", .file = "cameras.bin"};
  row.good = [](const fs::path& folder) {
    write_file_beside(folder / "images.bin", kImagesBin);
    return kCamerasBin;
  };
  row.read = tell_colmap;
  row.free_name = false;
  row.checked = false;
  row.counts_too_high = {{bytes(std::uint64_t{1}), bytes(std::uint64_t{2})}};
  row.counts_too_low = {{bytes(std::uint64_t{1}), bytes(std::uint64_t{0})}};
  row.absurd_sizes = {{bytes(std::uint64_t{1}), bytes(~std::uint64_t{0})},
                      {bytes(std::uint64_t{640}), bytes(std::uint64_t{1} << 40)}};
  row.non_finite = {{bytes(510.0), bytes(std::numeric_limits<double>::infinity())}};
  return row;
}

ReaderRow colmap_images_binary_row() {
  ReaderRow row{.name = "colmap_images_binary", .file = "images.bin"};
  row.good = [](const fs::path& folder) {
    write_file_beside(folder / "cameras.bin", kCamerasBin);
    return kImagesBin;
  };
  row.read = tell_colmap;
  row.free_name = false;
  row.checked = false;
  row.counts_too_high = {{bytes(std::uint64_t{1}), bytes(std::uint64_t{2})},
                         {bytes(std::uint64_t{2}), bytes(std::uint64_t{3})}};
  row.counts_too_low = {{bytes(std::uint64_t{1}), bytes(std::uint64_t{0})},
                        {bytes(std::uint64_t{2}), bytes(std::uint64_t{1})}};
  row.absurd_sizes = {{bytes(std::uint64_t{2}), bytes(~std::uint64_t{0} / 24)}};
  row.non_finite = {{bytes(3.0), bytes(std::numeric_limits<double>::quiet_NaN())}};
  return row;
}

ReaderRow strecha_row() {
  ReaderRow row{.name = "strecha", .file = "a.jpg.camera"};
  row.good = fixed_file("100 0 31.5\n0 110 23.5\n0 0 1\n0 0 0\n0 0 1\n-1 0 0\n0 -1 0\n1 2 3.25\n64 48\n");
  row.read = [](const fs::path& file) {
    std::string text;
    const Photograph photograph = io::read_strecha_camera(file);
    tell_photograph(text, photograph);
    return text.substr(photograph.name.size());  // named after the file
  };
  row.text = true;
  row.counts_too_high = {{"64 48\n", "64 48\n1\n"}};
  row.counts_too_low = {{"1 2 3.25\n", ""}};
  row.absurd_sizes = {{"64 48", "64000000000 48"}, {"64 48", "-64 48"}};
  row.non_finite = {{"3.25", "nan"}, {"31.5", "inf"}};
  return row;
}

// Two points, each seen by the one camera.
ReaderRow bundler_row() {
  ReaderRow row{.name = "bundler", .file = "bundle.out"};
  row.good = [](const fs::path& folder) {
    write_file_beside(folder / "list.txt", "a.jpg\n");
    return "# Bundle file v0.3\n1 2\n100 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -5.25\n1 2 3\n255 128 0\n1 0 17 1.5 "
           "-2.5\n1 2 3\n255 128 0\n1 0 18 1.5 -2.5\n";
  };
  row.read = [](const fs::path& file) { return tell_cameras(io::read_bundler(file, {})); };
  row.text = true;
  row.counts_too_high = {{"1 2\n100", "2 2\n100"}, {"1 2\n100", "1 3\n100"}, {"1 0 17", "2 0 17"}};
  row.counts_too_low = {{"1 2\n100", "0 2\n100"}, {"1 2\n100", "1 1\n100"}};
  row.absurd_sizes = {{"1 2\n100", "99999999999999 2\n100"}, {"1 0 17", "4000000000 0 17"}};
  row.non_finite = {{"-5.25", "nan"}, {"100 0 0", "inf 0 0"}};
  return row;
}

ReaderRow nerfstudio_row() {
  ReaderRow row{.name = "nerfstudio", .file = "transforms.json"};
  row.good = fixed_file(
      "{\"w\":64,\"h\":48,\"fl_x\":100,\"frames\":[{\"file_path\":\"a.jpg\",\"transform_matrix\":\n"
      "[[0,0,-1,1],[-1,0,0,2],[0,1,0,3.25],[0,0,0,1]]}]}\n");
  row.read = [](const fs::path& file) { return tell_cameras(io::read_nerfstudio(file, {})); };
  row.text = true;
  row.counts_too_high = {{"3.25]", "3.25,4]"}};
  row.counts_too_low = {{",3.25]", "]"}};
  row.absurd_sizes = {{"64", "64000000000"}, {"48", "-48"}};
  row.non_finite = {{"3.25", "NaN"}, {"3.25", "1e999"}};
  return row;
}

}  // namespace

std::vector<ReaderRow> camera_reader_rows() {
  return {colmap_cameras_row(),
          colmap_images_row(),
          colmap_cameras_binary_row(),
          colmap_images_binary_row(),
          strecha_row(),
          bundler_row(),
          nerfstudio_row()};
}

}  // namespace hybrid::testing
