#include "io/cameras/bundler.hpp"

#include "core/error.hpp"
#include "io/picture.hpp"
#include "io/text/text_record.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kTitle = "# Bundle file v0.3";

fs::path list_file(const fs::path& bundle) {
  std::vector<fs::path> candidates;
  const std::string name = bundle.filename().string();
  constexpr std::string_view kEnding = ".bundle.out";
  if (name.size() > kEnding.size() && name.ends_with(kEnding))
    candidates.push_back(bundle.parent_path() / (name.substr(0, name.size() - kEnding.size()) + ".list.txt"));
  candidates.push_back(bundle.string() + ".list.txt");
  candidates.push_back(bundle.parent_path() / "list.txt");
  candidates.push_back(bundle.parent_path() / ".." / "list.txt");
  std::error_code code;
  for (const fs::path& candidate : candidates)
    if (fs::exists(candidate, code)) return candidate;
  fail_input("{}: expected the photographs' names in {}, found no such file; put Bundler's list there",
             bundle.string(), candidates.front().string());
}

// "name", or Bundler's "name 0 focal" with the focal length from EXIF, which the bundle itself refines.
std::string_view listed_name(std::string_view line) {
  line = trim(line);
  const std::size_t focal = line.find_last_of(" \t");
  if (focal == std::string_view::npos || !to_double(line.substr(focal + 1))) return line;
  const std::string_view before = trim(line.substr(0, focal));
  if (before.size() < 2 || !before.ends_with('0') ||
      (before[before.size() - 2] != ' ' && before[before.size() - 2] != '\t'))
    return line;
  return trim(before.substr(0, before.size() - 1));
}

std::vector<std::string> read_names(const fs::path& file) {
  const std::string text = read_plain_text(file);
  LineReader lines(text);
  std::vector<std::string> names;
  while (lines.next())
    if (const auto name = listed_name(lines.line()); !name.empty())
      names.push_back(fs::path(name).lexically_normal().generic_string());
  return names;
}

struct BundlerCamera {
  std::string place;
  double focal_px, k1, k2;
  Mat3 rotation;
  Vec3 translation;
};

BundlerCamera read_camera(FilledLines& text, std::size_t index) {
  const std::string what = fmt::format("f k1 k2 of camera {}", index);
  TextRecord record = text.line(what);
  BundlerCamera result;
  result.place = text.place();
  result.focal_px = record.number(what), result.k1 = record.number(what), result.k2 = record.number(what);
  record.expect_end(what);
  result.rotation = text.matrix(fmt::format("R of camera {}", index));
  result.translation = text.row(fmt::format("t of camera {}", index));
  return result;
}

Photograph make_photograph(const BundlerCamera& read, const std::string& name, const fs::path& images) {
  Photograph result;
  result.name = name;
  Camera& camera = result.camera;
  camera.fx = camera.fy = read.focal_px;
  camera.k1 = read.k1, camera.k2 = read.k2;
  check_focal_length(read.place, camera);
  if (!images.empty()) {
    const PictureSize size = picture_size(images / name);
    camera.width = size.width, camera.height = size.height;
  }
  camera.cx = 0.5 * camera.width, camera.cy = 0.5 * camera.height;
  const Vec3 flip(1, -1, -1);  // from x right, y up, z backward
  result.cam_from_world.rotation = checked_rotation(read.place + ": R", flip.asDiagonal() * read.rotation);
  result.cam_from_world.translation = flip.asDiagonal() * read.translation;
  return result;
}

// Position, colour, and the list of views: their number, then camera, key, x and y of each.
void check_point(FilledLines& text, std::size_t index) {
  text.row(fmt::format("the position of point {}", index));
  text.row(fmt::format("the colour of point {}", index));
  const std::string what = fmt::format("the views of point {}", index);
  TextRecord views = text.line(what);
  const std::int64_t count = views.integer(what);
  for (std::int64_t i = 0; i < count; ++i)
    for (int k = 0; k < 4; ++k) views.number(what);
  views.expect_end(what);
}

}  // namespace

CameraFile read_bundler(const fs::path& file, const fs::path& images) {
  const std::string bytes = read_plain_text(file);
  FilledLines text(file, bytes);
  if (const auto title = text.line(kTitle).rest(); title != kTitle)
    fail_at(file, 1, "expected \"{}\", found \"{}\"; export it as Bundler v0.3", kTitle, excerpt(title));
  TextRecord counts = text.line("the counts of cameras and points");
  const std::int64_t cameras = counts.integer("the count of cameras"),
                     points = counts.integer("the count of points");
  counts.expect_end("two counts");
  const fs::path list = list_file(file);
  const std::vector<std::string> names = read_names(list);
  if (cameras < 1 || points < 0 || static_cast<std::uint64_t>(cameras) != names.size())
    fail_input("{}: expected as many cameras as {} names, found {} (and {} points)", text.place(),
               list.string(), cameras, points);
  CameraFile result;
  std::size_t unregistered = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const BundlerCamera camera = read_camera(text, i);
    if (camera.focal_px == 0) {
      ++unregistered;
      continue;
    }
    result.photographs.push_back(make_photograph(camera, names[i], images));
    result.cameras.push_back({names[i], "Bundler", result.photographs.back().camera});
  }
  for (std::int64_t i = 0; i < points; ++i) check_point(text, static_cast<std::size_t>(i));
  text.expect_end("the last point");
  if (unregistered > 0)
    result.notes.push_back(
        fmt::format("{} of {} cameras were not registered (f = 0): left out", unregistered, names.size()));
  if (result.photographs.empty())
    fail_input("{}: expected at least one registered camera (f more than 0), found none", file.string());
  sort_photographs(file, result.photographs);
  return result;
}

}  // namespace hybrid::io
