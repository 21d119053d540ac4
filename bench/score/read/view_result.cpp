#include "score/read/view_result.hpp"

#include <OpenImageIO/imageio.h>

#include "score/error.hpp"
#include "score/read/exr_file.hpp"
#include "score/read/files.hpp"

namespace score {

Picture read_picture(const std::filesystem::path& file) {
  check_file(file);
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input)
    bad_input("{}: expected a picture, found something else ({}); write it again", file.string(),
              OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.nchannels < 3)
    bad_input("{}: expected red, green and blue, found {} channels", file.string(), spec.nchannels);
  Picture picture{spec.width, spec.height, {}};
  picture.rgb.resize(3 * picture.pixels());
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, picture.rgb.data()))
    bad_input("{}: the picture is damaged ({}); write it again", file.string(), input->geterror());
  for (float& value : picture.rgb) value *= 255;
  return picture;
}

ViewResult read_view_result(const std::filesystem::path& file) {
  ExrFile image(file);
  ViewResult view;
  view.linear.width = image.width();
  view.linear.height = image.height();
  view.linear.rgb.resize(3 * image.pixels());
  for (std::size_t k = 0; k < 3; ++k) {
    const auto plane = image.floats(std::string(1, "RGB"[k]));
    for (std::size_t i = 0; i < plane.size(); ++i) view.linear.rgb[3 * i + k] = plane[i];
  }
  view.id = image.uints("id");
  view.coverage = image.uints("coverage");
  view.best = image.uints("best");
  if (image.has("Z")) view.depth_m = image.floats("Z");
  return view;
}

}  // namespace score
