#include "batch/render_unit.hpp"

#include <algorithm>
#include <map>

#include "batch/drawn_samples.hpp"
#include "core/log.hpp"
#include "core/parallel_blocks.hpp"
#include "core/parallel_tasks.hpp"
#include "core/suggest.hpp"
#include "geometry/colour.hpp"
#include "io/exr/exr.hpp"
#include "io/picture.hpp"

namespace hybrid::batch {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLeaveOneOut = "leave-one-out/";  // what such views' names begin with
constexpr std::string_view kPair = "-pair";             // what a view's comparison adds to its name

// Photographs agree with others no worse where cameras and surfaces are right (Renderer::agreements).
constexpr double kLeastAgreement = 0.5;

bool is_doubtful(const stages::PhotographAgreement& agreement) {
  return agreement.points == 0 || (agreement.correlation && *agreement.correlation < kLeastAgreement);
}

// What a view has of the scene, of the pixels that are the photograph's own (its alpha is not 0).
std::vector<std::uint8_t> compared_mask(const stages::RenderedView& view, const Image8& photograph) {
  std::vector<std::uint8_t> mask(view.coverage.size());
  std::transform(view.coverage.begin(), view.coverage.end(), mask.begin(),
                 [](std::uint32_t photographs) { return static_cast<std::uint8_t>(photographs > 0); });
  for (std::size_t i = 0; photograph.channels == 4 && i < mask.size(); ++i)
    if (photograph.pixels[4 * i + 3] == 0) mask[i] = 0;
  return mask;
}

// kDifferenceGain times what the view's sRGB values, at the photograph's exposure, are off by; black where
// nothing was compared.
Image8 difference(const Image8& photograph, const ImageF& view, const std::array<double, 3>& gain,
                  const std::vector<std::uint8_t>& mask) {
  constexpr int kDifferenceGain = 4;
  Image8 out(view.width, view.height, 3);
  parallel_for(static_cast<std::size_t>(out.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < out.width; ++x) {
      if (!mask[row * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x)]) continue;
      for (int k = 0; k < 3; ++k) {
        const int ours = srgb_byte_from_linear(gain[static_cast<std::size_t>(k)] * view.at(x, y)[k]);
        out.at(x, y)[k] = static_cast<std::uint8_t>(
            std::min(255, kDifferenceGain * std::abs(ours - photograph.at(x, y)[k])));
      }
    }
  });
  return out;
}

// Images of one height, the first three channels of each.
Image8 side_by_side(const std::vector<Image8>& images) {
  int width = 0;
  for (const auto& image : images) width += image.width;
  Image8 row(width, images.front().height, 3);
  int left = 0;
  for (const auto& image : images) {
    for (int y = 0; y < row.height; ++y)
      for (int x = 0; x < image.width; ++x) std::copy_n(image.at(x, y), 3, row.at(left + x, y));
    left += image.width;
  }
  return row;
}

// "a/b.jpg" -> "a_b": a file name of its own for every photograph.
std::vector<std::string> leave_one_out_names(const PhotographSet& photographs) {
  std::vector<std::string> names;
  std::map<std::string, int> uses;
  const auto flat = [](std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '/' || c == '\\'; }, '_');
    return name;
  };
  for (const auto& photograph : photographs.cameras) {
    names.push_back(flat(std::filesystem::path(photograph.name).replace_extension().generic_string()));
    ++uses[names.back()];
  }
  // Some differ by extension only; "a-pair" is what view "a" calls its comparison.
  const auto is_comparison = [&](const std::string& name) {
    return name.ends_with(kPair) && uses.count(name.substr(0, name.size() - kPair.size()));
  };
  for (std::size_t i = 0; i < names.size(); ++i)
    if (uses.at(names[i]) > 1 || is_comparison(names[i])) names[i] = flat(photographs.cameras[i].name);
  return names;
}

// The EXR says what its light was multiplied with, so that views can be brought to one exposure.
void write_view_exr(const std::filesystem::path& file, const stages::RenderedView& view) {
  std::vector<std::uint32_t> best(view.best.size());  // -1 (no photograph) is stored as 2^32 - 1
  std::transform(view.best.begin(), view.best.end(), best.begin(),
                 [](std::int32_t index) { return static_cast<std::uint32_t>(index); });
  const float* rgb = view.colour.pixels.data();
  const float* normal = view.normal.pixels.data();
  io::write_exr(file, view.colour.width, view.colour.height,
                {{"R", rgb, nullptr, 3},
                 {"G", rgb + 1, nullptr, 3},
                 {"B", rgb + 2, nullptr, 3},
                 {"Z", view.depth_m.data(), nullptr, 1},
                 {"N.x", normal, nullptr, 3},
                 {"N.y", normal + 1, nullptr, 3},
                 {"N.z", normal + 2, nullptr, 3},
                 {"id", nullptr, view.id.data(), 1},
                 {"coverage", nullptr, view.coverage.data(), 1},
                 {"best", nullptr, best.data(), 1}},
                {{"exposure", Json(view.exposure).dump()}});
}

std::vector<stages::Curtain> curtains_of(const std::vector<ScanProduct>& products,
                                         const std::vector<std::optional<ScanRegistration>>& registrations,
                                         double unseen_m) {
  stages::CurtainOptions options;
  options.length_m = unseen_m;
  return stages::hang_curtains(sight_scans(products, registrations), options);
}

}  // namespace

stages::RenderScene build_render_scene(const PolygonModel& model, const std::vector<ScanProduct>& products,
                                       const std::vector<std::optional<ScanRegistration>>& registrations,
                                       const PhotographSet& photographs, const WorldContours& contours,
                                       double unseen_m, int every) {
  stages::RenderScene scene;
  scene.proxy = model;
  scene.photographs = photographs.cameras;
  for (std::size_t i = 0; i < photographs.pixels->count(); ++i)
    scene.photograph_pixels.push_back(photographs.pixels->size(i));
  scene.decode = [kept = photographs.pixels](std::size_t index) { return kept->get(index); };
  scene.contours = contours.model;
  scene.contour_scan = contours.scan;
  if (unseen_m > 0) scene.curtains = curtains_of(products, registrations, unseen_m);
  for (std::size_t i = 0; i < products.size(); ++i) {
    if (!registrations[i]) continue;
    const auto& product = products[i];
    scene.scanners.push_back(registrations[i]->world_from_scan().translation);
    auto splats = stages::make_splats(product.image, product.segmentation, product.drawn,
                                      registrations[i]->world_from_scan(), static_cast<std::uint32_t>(i),
                                      every, product.radius_limits);
    if (scene.splats.empty())
      scene.splats = std::move(splats);
    else
      scene.splats.insert(scene.splats.end(), splats.begin(), splats.end());
  }
  return scene;
}

stages::ViewRequest view_request(const io::SceneView& view, const PhotographSet& photographs) {
  stages::ViewRequest request;
  if (view.photograph.empty()) {
    request.camera = io::camera_of(view);
  } else {
    request.camera = photographs.cameras[photograph_index(photographs.cameras, view.photograph)];
  }
  request.show = view.show;
  request.texture = view.texture;
  request.cameras = view.cameras;
  request.leave_out = view.leave_out;
  return request;
}

std::vector<io::SceneView> leave_one_out_views(const PhotographSet& photographs) {
  std::vector<io::SceneView> views;
  const auto names = leave_one_out_names(photographs);
  for (std::size_t i = 0; i < names.size(); ++i) {
    io::SceneView view;
    view.name = kLeaveOneOut + names[i];
    view.photograph = photographs.cameras[i].name;
    view.leave_out = {view.photograph};
    views.push_back(view);
  }
  return views;
}

Json leave_one_out_figures(const Json& views) {
  Json rows = Json::array();
  Json mean = {{"psnr_db", 0.0}, {"ssim", 0.0}, {"share_seen", 0.0}};
  for (const auto& view : views) {
    if (view["name"].get<std::string>().rfind(kLeaveOneOut, 0) != 0 || !view.contains("left_out")) continue;
    rows.push_back(view["left_out"]);
    for (auto& [key, sum] : mean.items()) sum = sum.get<double>() + rows.back()[key].get<double>();
  }
  if (rows.empty()) return {};
  for (auto& [key, sum] : mean.items()) sum = sum.get<double>() / static_cast<double>(rows.size());
  return {{"mean", mean}, {"photographs", rows}};
}

Json render_view(stages::Renderer& renderer, const io::SceneView& view, const PhotographSet& photographs,
                 const std::filesystem::path& out) {
  const auto request = view_request(view, photographs);
  const auto rendered = renderer.render(request);
  const std::string stem = (out / "views" / view.name).string();
  std::vector<std::function<void()>> writers = {[&] { write_view_exr(stem + ".exr", rendered); }};

  const auto hit =
      std::count_if(rendered.id.begin(), rendered.id.end(), [](std::uint32_t id) { return id != 0; });
  const auto seen =
      std::count_if(rendered.coverage.begin(), rendered.coverage.end(), [](auto n) { return n > 0; });
  const double pixels = static_cast<double>(rendered.id.size());
  Json figures = {{"name", view.name},
                  {"show", view.show},
                  {"size", {rendered.colour.width, rendered.colour.height}},
                  {"surface_share", static_cast<double>(hit) / pixels}};
  if (!view.path.empty()) figures["path"] = view.path;
  if (view.texture) figures["red_share"] = static_cast<double>(hit - seen) / pixels;
  if (view.texture && renderer.options().equalise) figures["exposure"] = rendered.exposure;

  const bool left_out =
      std::find(view.leave_out.begin(), view.leave_out.end(), view.photograph) != view.leave_out.end();
  if (view.texture && !view.photograph.empty() && left_out) {
    const auto index = photograph_index(photographs.cameras, view.photograph);
    const auto photograph = photographs.pixels->get(index);
    const auto mask = compared_mask(rendered, *photograph);
    const auto quality = stages::compare_images(rendered.colour, *photograph, mask);
    figures["left_out"] = {{"photograph", view.photograph},
                           {"psnr_db", quality.psnr_db},
                           {"ssim", quality.ssim},
                           {"share_seen", quality.share_seen}};
    writers.push_back([&rendered, photograph, mask, gain = quality.gain, stem] {
      io::write_png(fmt::format("{}{}.png", stem, kPair),
                    side_by_side({*photograph, to_picture(rendered.colour),
                                  difference(*photograph, rendered.colour, gain, mask)}));
    });
  }
  writers.push_back([&] { io::write_png(stem + ".png", to_picture(rendered)); });
  run_tasks(writers);
  return figures;
}

Json equalisation_figures(const stages::Renderer& renderer, const PhotographSet& photographs) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < photographs.cameras.size(); ++i) {
    const auto& agreement = renderer.agreements()[i];
    Json row = {{"photograph", photographs.cameras[i].name},
                {"gain", renderer.gains()[i]},
                {"points", agreement.points},
                {"agreement", agreement.correlation ? Json(*agreement.correlation) : Json()}};
    if (is_doubtful(agreement)) row["doubtful"] = true;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::string> disagreements(const stages::Renderer& renderer, const PhotographSet& photographs) {
  std::vector<std::string> blind, odd;
  double worst = 1;
  for (std::size_t i = 0; i < renderer.agreements().size(); ++i) {
    const auto& agreement = renderer.agreements()[i];
    if (agreement.points == 0) blind.push_back(photographs.cameras[i].name);
    if (!agreement.correlation || !is_doubtful(agreement)) continue;
    odd.push_back(photographs.cameras[i].name);
    worst = std::min(worst, *agreement.correlation);
  }
  const bool most = 2 * (blind.size() + odd.size()) > photographs.cameras.size();
  const std::string remedy =
      most ? "the cameras' frame may be another than the model's: give [photographs] landmarks, or "
             "world_from_photographs (host/io/scene/README.md)" +
                 photographs.frame_hint
           : "check these cameras, and whether model and scans have what they show";
  std::vector<std::string> warnings;
  if (!blind.empty())
    warnings.push_back(fmt::format("{} of {} photographs see nothing of model and scans ({}); {}",
                                   blind.size(), photographs.cameras.size(), some_of(blind), remedy));
  if (!odd.empty())
    warnings.push_back(
        fmt::format("{} of {} photographs ({}) do not show what others show of the same surface (agreement "
                    "down to {:.2f}, "
                    "expected {} and more), which comes out in wrong colours; {}",
                    odd.size(), photographs.cameras.size(), some_of(odd), worst, kLeastAgreement, remedy));
  return warnings;
}

std::string empty_views(const Json& views) {
  std::vector<std::string> empty;
  for (const Json& view : views)
    if (view["surface_share"] == 0) empty.push_back(view["name"]);
  if (empty.empty()) return "";
  return fmt::format(
      "{} of {} views show nothing of model and scans ({}): check where they look from, and to", empty.size(),
      views.size(), some_of(empty));
}

std::string red_views(const std::vector<io::SceneView>& views, const PhotographSet& photographs) {
  std::vector<std::string> red;
  for (const io::SceneView& view : views) {
    const auto is_left_out = [&](const Photograph& photograph) {
      return std::find(view.leave_out.begin(), view.leave_out.end(), photograph.name) != view.leave_out.end();
    };
    const std::string& name = view.path.empty() ? view.name : view.path;
    if (view.texture && (red.empty() || red.back() != name) &&
        std::all_of(photographs.cameras.begin(), photographs.cameras.end(), is_left_out))
      red.push_back(name);
  }
  if (red.empty()) return "";
  const bool one = red.size() == 1;
  return fmt::format(
      "{} textured {} no photographs and {} all red ({}); texture = false shows surfaces plain", red.size(),
      one ? "view has" : "views have", one ? "is" : "are", some_of(red));
}

Json sigma_figures(const stages::Renderer& renderer) {
  const auto& choice = renderer.sigma_choice();
  if (!choice) return {};
  Json tried = Json::array();
  for (const auto& trial : choice->tried)
    tried.push_back({{"sigma_px", trial.sigma_px}, {"psnr_db", trial.psnr_db}});
  return {{"sigma_px", choice->sigma_px}, {"tried", tried}};
}

Image8 to_picture(const ImageF& linear) {
  Image8 picture(linear.width, linear.height, linear.channels);
  for_blocks(linear.pixels.size(), 1 << 16, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) picture.pixels[i] = srgb_byte_from_linear(linear.pixels[i]);
  });
  return picture;
}

Image8 to_picture(const stages::RenderedView& view) {
  if (!view.shoulder.bends()) return to_picture(view.colour);
  ImageF toned = view.colour;
  for_blocks(view.coverage.size(), 1 << 14, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (view.coverage[i] > 0) view.shoulder.apply(toned.pixels.data() + 3 * i);
  });
  return to_picture(toned);
}

}  // namespace hybrid::batch
