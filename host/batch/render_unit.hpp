#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "batch/drawn_samples.hpp"
#include "batch/photographs/photograph_set.hpp"
#include "batch/registration/registration_unit.hpp"
#include "io/scene/scene_file.hpp"

namespace hybrid::batch {

// Proxy, contour polygons and retained samples of all registered scans (as splats), photographs (METHOD 10).
// Needs products[].drawn (choose_drawn_samples, whose `contours` these are). With `unseen_m` (RenderOptions)
// above 0, curtains. `every`: as in make_splats.
stages::RenderScene build_render_scene(const PolygonModel& model, const std::vector<ScanProduct>& products,
                                       const std::vector<std::optional<ScanRegistration>>& registrations,
                                       const PhotographSet& photographs, const WorldContours& contours,
                                       double unseen_m = 0, int every = 1);

// The view's camera and what it shows. Throws ErrorKind::input when it names a photograph that does not
// exist.
stages::ViewRequest view_request(const io::SceneView& view, const PhotographSet& photographs);

// One view per photograph, seen through its own camera, made from all the others: "leave-one-out/<name>".
std::vector<io::SceneView> leave_one_out_views(const PhotographSet& photographs);

// From the figures of all views, those of leave_one_out_views: per photograph and their mean (METHOD, how
// results are scored). Null when there are none.
nlohmann::ordered_json leave_one_out_figures(const nlohmann::ordered_json& views);

// Renders, writes views/<name>.exr and .png and returns the view's figures; a view through a photograph's
// camera that leaves that photograph out is compared with it (PSNR, SSIM on the pixels seen) and written
// beside it as views/<name>-pair.png: photograph, view, and four times their difference after the gain.
nlohmann::ordered_json render_view(stages::Renderer& renderer, const io::SceneView& view,
                                   const PhotographSet& photographs, const std::filesystem::path& out);

// Gains of every photograph's channels, points of the surface that it sees, and how well it agrees with the
// other photographs there (`[render] equalise`).
nlohmann::ordered_json equalisation_figures(const stages::Renderer& renderer,
                                            const PhotographSet& photographs);

// Warnings of photographs that see nothing of the scene, or agree so little with the others on what they see
// that cameras or surfaces must be wrong. None without `[render] equalise`.
std::vector<std::string> disagreements(const stages::Renderer& renderer, const PhotographSet& photographs);

// A warning of textured views that no photograph is left for: all of them is red. "" = none.
std::string red_views(const std::vector<io::SceneView>& views, const PhotographSet& photographs);

// A warning of rendered views (render_view) in which nothing is seen. "" = none.
std::string empty_views(const nlohmann::ordered_json& views);

// sigma_px = "auto": what was chosen and what was tried; null otherwise.
nlohmann::ordered_json sigma_figures(const stages::Renderer& renderer);

// Linear RGB to an 8-bit sRGB picture.
Image8 to_picture(const ImageF& linear);
// The same of a view, with its shoulder.
Image8 to_picture(const stages::RenderedView& view);

}  // namespace hybrid::batch
