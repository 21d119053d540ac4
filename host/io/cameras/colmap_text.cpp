#include <algorithm>

#include "core/error.hpp"
#include "io/cameras/colmap.hpp"
#include "io/cameras/colmap_model.hpp"
#include "io/text/text_record.hpp"

namespace hybrid::io {
namespace fs = std::filesystem;
namespace {

bool is_comment_or_blank(std::string_view line) {
  line = trim(line);
  return line.empty() || line.starts_with('#');
}

void read_camera(const fs::path& file, TextRecord record, ColmapCollector& model) {
  const std::string place = fmt::format("{}:{}", file.string(), record.line());
  const std::int64_t id = record.integer("camera id");
  const ColmapLens& lens = colmap_lens(place, record.word("camera model"));
  const std::int64_t width = record.integer("width"), height = record.integer("height");
  std::vector<double> parameters;
  const std::size_t count = lens.parameters.size();
  while (parameters.size() < count)
    parameters.push_back(
        record.number(fmt::format("parameter {} of {} of {}", parameters.size() + 1, count, lens.name)));
  record.expect_end(fmt::format("{} parameters of {}", count, lens.name));
  model.add_camera(place, id, lens, width, height, parameters);
}

// "X Y POINT3D_ID" repeated, or nothing. Only the form is checked: it tells a lost empty line from points.
void check_points(const fs::path& file, const LineReader& lines, std::string_view name) {
  std::string_view rest = lines.line();
  std::size_t count = 0;
  for (auto word = take_word(rest); !word.empty(); word = take_word(rest), ++count)
    if (!to_double(word))
      fail_at(file, lines.number(),
              "expected the 2D points of {} (X Y POINT3D_ID ..., or an empty line), found \"{}\"; every "
              "image takes two lines, was an empty one removed?",
              excerpt(name), excerpt(word));
  if (count % 3 != 0)
    fail_at(
        file, lines.number(),
        "expected the 2D points of {} in threes (X Y POINT3D_ID), found {} numbers: the line is cut short",
        excerpt(name), count);
}

// Returns the image's name.
std::string_view read_image(const fs::path& file, TextRecord record, ColmapCollector& model) {
  const std::string place = fmt::format("{}:{}", file.string(), record.line());
  const std::int64_t id = record.integer("image id");
  const double qw = record.number("QW"), qx = record.number("QX"), qy = record.number("QY"),
               qz = record.number("QZ");
  const double x = record.number("TX"), y = record.number("TY"), z = record.number("TZ");
  const std::int64_t camera = record.integer("camera id");
  model.add_image(place, id, {qw, qx, qy, qz}, {x, y, z}, camera, record.rest());
  return record.rest();
}

void read_cameras_txt(const fs::path& file, ColmapCollector& model) {
  const std::string text = read_plain_text(file);
  LineReader lines(text);
  while (lines.next())
    if (!is_comment_or_blank(lines.line())) read_camera(file, TextRecord(file, lines), model);
  if (model.file().cameras.empty())
    fail_at(file, std::max(1, lines.number()), "expected at least one camera, found none");
}

void read_images_txt(const fs::path& file, ColmapCollector& model) {
  const std::string text = read_plain_text(file);
  LineReader lines(text);
  while (lines.next()) {
    if (is_comment_or_blank(lines.line())) continue;
    const std::string_view name = read_image(file, TextRecord(file, lines), model);
    // Editors that trim files take the last image's empty line away; a line without its end was cut.
    const bool whole = lines.terminated();
    if (lines.next())
      check_points(file, lines, name);
    else if (!whole)
      fail_at(file, lines.number(),
              "expected a second line for image {}, found the end of the file: cut short?", excerpt(name));
  }
  if (model.file().photographs.empty())
    fail_at(file, std::max(1, lines.number()), "expected at least one image, found none");
}

}  // namespace

CameraFile read_colmap_text(const fs::path& folder) {
  ColmapCollector model;
  read_cameras_txt(folder / "cameras.txt", model);
  read_images_txt(folder / "images.txt", model);
  return std::move(model.file());
}

}  // namespace hybrid::io
