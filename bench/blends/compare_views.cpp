// hybrid-compare-views SCENE.toml DIR...: scores the leave-one-out views in the output folders of several
// `hybrid render --leave-one-out` runs against the scene's photographs, on the pixels that every run's view
// sees (METHOD, how results are scored). Prints one JSON document; bench/blends.sh makes the table of it.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <iostream>

#include "batch/render_unit.hpp"
#include "core/log.hpp"
#include "geometry/colour.hpp"
#include "io/output.hpp"

namespace hybrid::bench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct View {
  ImageF colour;
  std::vector<std::uint32_t> coverage;
};

// R, G, B and coverage of a view that the program wrote.
View read_view(const fs::path& file) {
  io::check_readable(file);
  Imf::InputFile input(file.string().c_str());
  const auto box = input.header().dataWindow();
  const int width = box.max.x - box.min.x + 1, height = box.max.y - box.min.y + 1;
  View view{ImageF(width, height, 3),
            std::vector<std::uint32_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  const auto columns = static_cast<std::size_t>(width);
  Imf::FrameBuffer buffer;
  const char* names[] = {"R", "G", "B"};
  for (int k = 0; k < 3; ++k)
    buffer.insert(names[k], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(view.colour.pixels.data() + k),
                                       3 * sizeof(float), 3 * sizeof(float) * columns));
  buffer.insert("coverage", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(view.coverage.data()),
                                       sizeof(std::uint32_t), sizeof(std::uint32_t) * columns));
  input.setFrameBuffer(buffer);
  input.readPixels(box.min.y, box.max.y);
  return view;
}

double srgb_green(const float* rgb, double gain) {
  return srgb_from_linear(std::clamp(gain * rgb[1], 0.0, 1.0));
}

// Energy of the differences between neighbouring pixels of the view over the photograph's, both inside the
// mask: below 1 the view is blurred, which PSNR hardly punishes. sRGB green, after the gain.
double detail(const ImageF& view, const Image8& photograph, const std::vector<std::uint8_t>& mask,
              double gain) {
  double ours = 0, theirs = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 1; x < view.width; ++x) {
      const auto i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
      if (!mask[i] || !mask[i - 1]) continue;
      const double a = srgb_green(view.at(x, y), gain) - srgb_green(view.at(x - 1, y), gain);
      const double b = (photograph.at(x, y)[1] - photograph.at(x - 1, y)[1]) / 255.0;
      ours += a * a;
      theirs += b * b;
    }
  return theirs > 0 ? ours / theirs : 1;
}

// Adds `score` to the sums of a row.
void add(Json& row, const char* key, double score) {
  row[key] = row.value(key, 0.0) + score;
}

Json compare(const fs::path& scene_file, const std::vector<fs::path>& folders) {
  const auto scene = io::read_scene_file(scene_file);
  if (!scene.photographs) fail_input("{}: no [photographs]", scene_file.string());
  const auto photographs = batch::read_photographs(*scene.photographs);
  const auto requests = batch::leave_one_out_views(photographs);
  Json rows = Json::array();
  for (const auto& folder : folders)
    rows.push_back({{"folder", folder.filename().string()},
                    {"options", Json::parse(io::read_text(folder / "summary.json"))["options"]["render"]}});
  bool same_masks = true;
  double share = 0;
  for (std::size_t v = 0; v < requests.size(); ++v) {
    std::vector<View> views;
    for (const auto& folder : folders)
      views.push_back(read_view(folder / "views" / (requests[v].name + ".exr")));
    std::vector<std::uint8_t> mask(views.front().coverage.size(), 1);
    for (const View& view : views)
      for (std::size_t i = 0; i < mask.size(); ++i) {
        const bool first = views.front().coverage[i] > 0, seen = view.coverage.at(i) > 0;
        same_masks &= first == seen;
        mask[i] &= seen;
      }
    const auto photograph = photographs.pixels->get(v);
    for (std::size_t f = 0; f < views.size(); ++f) {
      const auto quality = stages::compare_images(views[f].colour, *photograph, mask);
      add(rows[f], "psnr_db", quality.psnr_db);
      add(rows[f], "ssim", quality.ssim);
      add(rows[f], "detail", detail(views[f].colour, *photograph, mask, quality.gain[1]));
      share += quality.share_seen;
    }
  }
  const auto count = static_cast<double>(requests.size());
  for (auto& row : rows)
    for (const char* key : {"psnr_db", "ssim", "detail"}) row[key] = row[key].get<double>() / count;
  return {{"scene", scene.name},
          {"photographs", requests.size()},
          {"share_seen_by_all", share / (count * static_cast<double>(folders.size()))},
          {"masks_identical", same_masks},
          {"rows", rows}};
}

}  // namespace
}  // namespace hybrid::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: hybrid-compare-views SCENE.toml DIR...\n";
    return 2;
  }
  try {
    std::cout << hybrid::bench::compare(argv[1], {argv + 2, argv + argc}).dump(1) << "\n";
  } catch (const std::exception& error) {
    hybrid::log::error("{}", error.what());
    return 1;
  }
}
