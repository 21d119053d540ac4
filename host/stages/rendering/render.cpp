#include "stages/rendering/render.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "stages/rendering/blend_bands.hpp"
#include "stages/rendering/equalise.hpp"
#include "stages/rendering/photo_blend.hpp"
#include "stages/rendering/photograph_levels.hpp"
#include "stages/rendering/render_state.hpp"
#include "stages/rendering/sigma_choice.hpp"

namespace hybrid::stages {
namespace {

constexpr double kMarkerShare = 0.03;  // length of a photograph's marker, share of the scene's diagonal

// What the device found for the rays of one tile, on the host.
struct TilePixels {
  std::vector<float> distance, surface, colour;
  std::vector<std::uint32_t> id, seen;
  std::vector<std::int32_t> best;

  Vec3f plane_vector(std::size_t plane, std::size_t i) const {
    const std::size_t count = distance.size();
    return {surface[plane * count + i], surface[(plane + 1) * count + i], surface[(plane + 2) * count + i]};
  }
};

template <typename T>
std::vector<T> read_first(device::Queue& queue, const device::Array<T>& array, std::size_t count) {
  std::vector<T> values(count);
  queue.read(array, std::span<T>(values));
  return values;
}

TilePixels read_tile(device::Queue& queue, const SurfaceTile& tile) {
  TilePixels pixels;
  pixels.distance = read_first(queue, tile.distance, tile.count());
  pixels.id = read_first(queue, tile.id, tile.count());
  pixels.surface = read_first(queue, tile.surface, SURFACE_PLANES * tile.count());
  pixels.seen.assign(tile.count(), 0);
  pixels.best.assign(tile.count(), -1);
  pixels.colour.assign(3 * tile.count(), 0.0f);
  return pixels;
}

// Linear light of pastel_srgb: of most scans from a table, as every pixel asks.
std::array<double, 3> pastel_light(std::uint32_t scan) {
  const auto light = [](std::uint32_t index) {
    std::array<double, 3> rgb = pastel_srgb(index);
    for (double& value : rgb) value = linear_from_srgb(value);
    return rgb;
  };
  static const auto table = [&] {
    std::array<std::array<double, 3>, 256> first{};
    for (std::uint32_t index = 0; index < first.size(); ++index) first[index] = light(index);
    return first;
  }();
  return scan < table.size() ? table[scan] : light(scan);
}

std::array<double, 3> plain_light(std::uint32_t id, const RenderScene& scene) {
  if (id & kSplatId) return pastel_light(scene.splats[id & ~kSplatId].scan);
  if (id & kContourId) return pastel_light(scene.contour_scan[id & ~kContourId]);
  static const std::array<double, 3> marker = {linear_from_srgb(1), linear_from_srgb(0.55),
                                               linear_from_srgb(0.1)},
                                     face = {linear_from_srgb(0.85), linear_from_srgb(0.85),
                                             linear_from_srgb(0.85)};
  return id & kMarkerId ? marker : face;
}

// Lit by a headlight, so that shape shows without any light in the scene.
void shade_plain(TilePixels& pixels, std::size_t i, const Vec3f& eye, const RenderScene& scene) {
  const Vec3f to_eye = (eye - pixels.plane_vector(SURFACE_X, i)).normalized();
  const double facing = std::abs(pixels.plane_vector(SURFACE_NORMAL_X, i).dot(to_eye));
  const std::array<double, 3> light = plain_light(pixels.id[i], scene);
  for (std::size_t k = 0; k < 3; ++k)
    pixels.colour[3 * i + k] = static_cast<float>(light[k] * (0.2 + 0.8 * facing));
}

// Markers hide what lies behind them.
void draw_markers(TilePixels& pixels, const TilePixels& markers, const Vec3f& eye, const RenderScene& scene) {
  const std::size_t count = pixels.distance.size();
  parallel_for(
      count,
      [&](std::size_t i) {
        if (!(markers.distance[i] < pixels.distance[i])) return;
        pixels.distance[i] = markers.distance[i];
        pixels.id[i] = markers.id[i];
        pixels.seen[i] = 0;
        pixels.best[i] = -1;
        for (std::size_t plane = 0; plane < SURFACE_PLANES; ++plane)
          pixels.surface[plane * count + i] = markers.surface[plane * count + i];
        shade_plain(pixels, i, eye, scene);
      },
      4096);
}

RenderedView empty_view(const Camera& camera) {
  const std::size_t count = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  RenderedView view;
  view.colour = ImageF(camera.width, camera.height, 3);
  view.normal = ImageF(camera.width, camera.height, 3);
  view.depth_m.assign(count, std::numeric_limits<float>::infinity());
  view.id.assign(count, 0);
  view.coverage.assign(count, 0);
  view.best.assign(count, -1);
  return view;
}

// Adds a tile's colours times `share`, and with `aovs` sets all the rest.
void add_tile(const TilePixels& pixels, const Tile& tile, const CameraRecord& camera, float share, bool aovs,
              RenderedView& view) {
  const float* axis = camera.rotation + 6;
  const Vec3f eye(camera.centre[0], camera.centre[1], camera.centre[2]);
  parallel_for(static_cast<std::size_t>(tile.rows), [&](std::size_t row) {
    for (std::size_t col = 0; col < static_cast<std::size_t>(tile.cols); ++col) {
      const std::size_t from = row * static_cast<std::size_t>(tile.cols) + col;
      const std::size_t to =
          (static_cast<std::size_t>(tile.row) + row) * static_cast<std::size_t>(view.colour.width) +
          static_cast<std::size_t>(tile.col) + col;
      if (pixels.id[from] == 0) continue;
      for (std::size_t k = 0; k < 3; ++k)
        view.colour.pixels[3 * to + k] += share * pixels.colour[3 * from + k];
      if (!aovs) continue;
      const Vec3f point = pixels.plane_vector(SURFACE_X, from);
      Vec3f normal = pixels.plane_vector(SURFACE_NORMAL_X, from);
      if (normal.dot(point - eye) > 0) normal = -normal;
      view.depth_m[to] = camera.lens >= CAMERA_SPHERICAL ? (point - eye).norm()
                                                         : axis[0] * point.x() + axis[1] * point.y() +
                                                               axis[2] * point.z() + camera.translation[2];
      for (int k = 0; k < 3; ++k) view.normal.pixels[3 * to + static_cast<std::size_t>(k)] = normal[k];
      view.id[to] = pixels.id[from];
      view.coverage[to] = pixels.seen[from];
      view.best[to] = pixels.best[from];
    }
  });
}

void check_request(const ViewRequest& request) {
  const Camera& camera = request.camera.camera;
  if (camera.width < 1 || camera.height < 1)
    fail_input("view {}: expected at least 1 x 1 pixels, found {} x {}", request.camera.name, camera.width,
               camera.height);
  if (request.show != "proxy" && request.show != "scan" && request.show != "both")
    fail_input("view {}: show: expected \"proxy\", \"scan\" or \"both\", found \"{}\"", request.camera.name,
               request.show);
}

std::vector<std::size_t> used_photographs(const RenderScene& scene,
                                          const std::vector<std::string>& leave_out) {
  const auto& photographs = scene.photographs;
  for (const std::string& name : leave_out)
    if (std::none_of(photographs.begin(), photographs.end(), [&](const auto& p) { return p.name == name; }))
      fail_input("view: leave_out: no photograph is named \"{}\"; the scene has {} photographs", name,
                 photographs.size());
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < photographs.size(); ++i)
    if (std::find(leave_out.begin(), leave_out.end(), photographs[i].name) == leave_out.end())
      used.push_back(i);
  return used;
}

// What a photograph's white comes to at most.
double whitest(const std::vector<std::array<double, 3>>& gains, const std::vector<std::size_t>& used,
               const std::array<double, 3>& exposure) {
  double white = 1;
  for (const std::size_t i : used)
    for (std::size_t k = 0; k < 3; ++k) white = std::max(white, exposure[k] * gains[i][k]);
  return white;
}

// Everything the tiles of one view share.
struct ViewPass {
  ViewPass(RenderState& state, const ViewRequest& view, std::size_t capacity)
      : request(view),
        shown(state.geometry(view.show)),
        camera(camera_record(view.camera, state.origin)),
        used(used_photographs(state.scene, view.leave_out)),
        surface(state.queue, capacity),
        marker_surface(state.queue, view.cameras ? capacity : 0),
        blend(state.queue, state.options, view.texture ? capacity : 0) {
    if (view.cameras)
      markers = make_camera_markers(state.queue, state.scene, state.origin, view.camera.centre(),
                                    kMarkerShare * state.diagonal_m);
  }

  const ViewRequest& request;
  const DeviceBvh& shown;
  CameraRecord camera;
  std::vector<std::size_t> used;
  DeviceBvh markers;
  SurfaceTile surface, marker_surface;
  PhotoBlend blend;
  std::array<double, 3> exposure{1, 1, 1};
};

void colour_from_photographs(RenderState& state, ViewPass& pass, TilePixels& pixels) {
  const auto& c = pass.camera.centre;
  const PhotoBlendView view{{c[0], c[1], c[2]}, pixel_angle_rad(pass.request.camera.camera)};
  pass.blend.blend(state.store, pass.shown, state.everything(pass.shown), pass.surface, view, pass.used,
                   state.store.linear());
  pixels.colour = read_first(state.queue, pass.blend.colour(), pixels.colour.size());
  pixels.seen = read_first(state.queue, pass.blend.seen(), pixels.seen.size());
  pixels.best = read_first(state.queue, pass.blend.best(), pixels.best.size());
  parallel_for(
      pixels.seen.size(),
      [&](std::size_t i) {
        for (std::size_t k = 0; k < 3 && pixels.seen[i] > 0; ++k)  // red stays red
          pixels.colour[3 * i + k] *= static_cast<float>(pass.exposure[k]);
      },
      4096);
}

// Red is what the view looks at through a place that no scan has seen: something may stand there.
void redden_behind_curtains(RenderState& state, ViewPass& pass, const Tile& tile,
                            const std::array<float, 2>& offset, TilePixels& pixels) {
  if (pass.shown.curtain_root == BVH_EMPTY) return;
  cast_curtains(state.queue, pass.shown, pass.camera, tile, offset, pass.surface);
  const auto curtain_m = read_first(state.queue, pass.surface.distance, pixels.distance.size());
  const auto tolerance_m = static_cast<float>(state.options.surface_tolerance_m);
  for (std::size_t i = 0; i < curtain_m.size(); ++i) {
    if (pixels.id[i] == 0 || !(curtain_m[i] < pixels.distance[i] - tolerance_m)) continue;
    pixels.seen[i] = 0;
    pixels.best[i] = -1;
    for (std::size_t k = 0; k < 3; ++k) pixels.colour[3 * i + k] = k == 0 ? 1.0f : 0.0f;
  }
}

TilePixels render_tile(RenderState& state, ViewPass& pass, const Tile& tile,
                       const std::array<float, 2>& offset) {
  const double tolerance_m = state.options.surface_tolerance_m;
  const Vec3f eye(pass.camera.centre[0], pass.camera.centre[1], pass.camera.centre[2]);
  cast_tile(state.queue, pass.shown, pass.camera, tile, offset, tolerance_m, pass.surface);
  TilePixels pixels = read_tile(state.queue, pass.surface);
  if (pass.request.texture) {
    colour_from_photographs(state, pass, pixels);
    redden_behind_curtains(state, pass, tile, offset, pixels);
  } else
    parallel_for(
        pixels.id.size(),
        [&](std::size_t i) {
          if (pixels.id[i] != 0) shade_plain(pixels, i, eye, state.scene);
        },
        4096);
  if (pass.request.cameras) {
    cast_tile(state.queue, pass.markers, pass.camera, tile, offset, tolerance_m, pass.marker_surface);
    draw_markers(pixels, read_tile(state.queue, pass.marker_surface), eye, state.scene);
  }
  return pixels;
}

}  // namespace

const std::vector<OptionRow<RenderOptions>>& render_option_table() {
  using O = RenderOptions;
  static const std::vector<OptionRow<O>> table = {
      {"blend",
       "",
       &O::blend,
       0,
       0,
       "how photographs mix: the heaviest alone, all by weight, all in the low band, or in each band the "
       "wider "
       "the coarser it is",
       {"nearest", "linear", "dual", "multi-band"}},
      {"weights",
       "",
       &O::weights,
       0,
       0,
       "Facade's 1 / (angle + one pixel), or the k photographs of least penalty (unstructured lumigraph)",
       {"angle", "ulr"}},
      {"ulr_k", "", &O::ulr_k, 1, 64, "weights = ulr: photographs that mix in a pixel", {}},
      {"ulr_resolution",
       "rad",
       &O::ulr_resolution,
       0,
       100,
       "weights = ulr: penalty per time that a photograph is coarser than the view",
       {}},
      {"ulr_field_of_view",
       "rad",
       &O::ulr_field_of_view,
       0,
       100,
       "weights = ulr: penalty at a photograph's border, from 0 where feathering begins",
       {}},
      {"sigma_px",
       "px",
       &O::sigma_px,
       0,
       50,
       "Gaussian that splits photographs into low and high frequencies, the narrowest of multi-band; or "
       "\"auto\": by leaving photographs out",
       {}},
      {"bands", "", &O::bands, 2, BLEND_MAX_BANDS, "blend = multi-band: frequency bands, each an octave", {}},
      {"high_power",
       "",
       &O::high_power,
       1,
       64,
       "exponent of the weights in the highest band of dual and multi-band; 1 is linear, 64 nearly the "
       "heaviest alone",
       {}},
      {"feather_px",
       "px",
       &O::feather_px,
       0,
       4096,
       "weights fall to 0 over this distance to a photograph's border",
       {}},
      {"surface_tolerance_m",
       "m",
       &O::surface_tolerance_m,
       0,
       10,
       "within this of a proxy face the sample wins, and casts no shadow on it",
       {}},
      {"grazing_deg",
       "deg",
       &O::grazing_deg,
       0,
       60,
       "a photograph that meets a surface at no more than this angle does not see it",
       {}},
      {"grazing_sample_deg",
       "deg",
       &O::grazing_sample_deg,
       0,
       60,
       "the same of samples, where it is more: their normals are estimates",
       {}},
      {"unseen_m",
       "m",
       &O::unseen_m,
       0,
       100,
       "so far behind its outline, where no scan has seen the place empty, what is scanned hides what "
       "photographs and textured views see",
       {}},
      {"equalise",
       "",
       &O::equalise,
       0,
       0,
       "multiply each photograph's channels so that photographs agree where they overlap; a view has the "
       "exposure of those it shows",
       {}},
      {"tone",
       "",
       &O::tone,
       0,
       0,
       "light above white is cut off, or brought back along a curve that leaves the darker half as it is; "
       "auto: the latter where all photographs have one exposure (atlas, colours of points), not in views",
       {"auto", "linear", "shoulder"}},
      {"levels",
       "",
       &O::levels,
       0,
       0,
       "halve photographs that are finer than a view, as often as they are: less memory, nothing flickers",
       {}},
      {"photograph_mb",
       "MiB",
       &O::photograph_mb,
       16,
       1 << 20,
       "memory for photographs on the device, and a quarter of it for decoded ones; more stay only where one "
       "alone needs it",
       {}},
      {"samples_per_axis", "", &O::samples_per_axis, 1, 8, "primary rays per pixel, squared", {}},
      {"tile", "px", &O::tile, 16, 8192, "side of what is rendered at once; smaller needs less memory", {}},
  };
  return table;
}

void set_sigma(RenderOptions& options, const OptionValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  options.auto_sigma = text && *text == "auto";
  if (!options.auto_sigma) set_option(options, *find_option(render_option_table(), "sigma_px"), value);
}

float least_facing(const RenderOptions& options) {
  return static_cast<float>(std::sin(options.grazing_deg * M_PI / 180));
}

float least_facing_sample(const RenderOptions& options) {
  const double degrees = std::max(options.grazing_deg, options.grazing_sample_deg);
  return static_cast<float>(std::sin(degrees * M_PI / 180));
}

RenderState::RenderState(device::Queue& q, const RenderScene& s, const RenderOptions& o)
    : queue(q),
      scene(s),
      options(o),
      origin(scene_box(s).isEmpty() ? Vec3(Vec3::Zero()) : Vec3(scene_box(s).center())),
      diagonal_m(scene_box(s).isEmpty() ? 1.0 : scene_box(s).diagonal().norm()),
      store(q, s, o, origin, !band_sigmas(o).empty()),
      sights(s.photographs.begin(), s.photographs.end()) {}

void RenderState::use_sigma(double sigma_px) {
  options.sigma_px = sigma_px;
  store.use_sigmas(band_sigmas(options));
}

const DeviceBvh& RenderState::geometry(const std::string& show) {
  std::string built = show;
  if (show == "both" && scene.splats.empty() && scene.contours.faces.empty()) built = "proxy";
  if (show == "both" && scene.proxy.faces.empty()) built = "scan";
  const auto found = geometries.find(built);
  if (found != geometries.end()) return found->second;
  return geometries.emplace(built, make_render_geometry(queue, scene, built, origin)).first->second;
}

Renderer::Renderer(device::Queue& queue, const RenderScene& scene, const RenderOptions& options)
    : state_(std::make_unique<State>(queue, scene, options)) {
  state_->gains.assign(scene.photographs.size(), {1, 1, 1});
  if (options.equalise) {
    const PhotographOverlaps overlaps = measure_overlaps(*this, *state_);
    state_->gains = solve_gains(scene.photographs.size(), overlaps.pairs);
    state_->agreements = agreements_of(overlaps);
    state_->store.set_gains(state_->gains);
  }
  if (!options.auto_sigma || band_sigmas(options).empty() || scene.photographs.size() < 2) return;
  state_->sigma = choose_sigma(*this, *state_);
  state_->use_sigma(state_->sigma->sigma_px);
}
Renderer::~Renderer() = default;

const std::vector<std::array<double, 3>>& Renderer::gains() const {
  return state_->gains;
}

const std::vector<PhotographAgreement>& Renderer::agreements() const {
  return state_->agreements;
}

Shoulder Renderer::common_shoulder() const {
  if (state_->options.tone == "linear") return Shoulder();
  return Shoulder(whitest(state_->gains, used_photographs(state_->scene, {}), {1, 1, 1}));
}

const RenderOptions& Renderer::options() const {
  return state_->options;
}

const std::optional<SigmaChoice>& Renderer::sigma_choice() const {
  return state_->sigma;
}

RenderedView Renderer::render(const ViewRequest& request) {
  check_request(request);
  const Camera& camera = request.camera.camera;
  const int side = state_->options.tile;
  const auto capacity = static_cast<std::size_t>(std::min(side, camera.width)) *
                        static_cast<std::size_t>(std::min(side, camera.height));
  ViewPass pass(*state_, request, capacity);
  if (request.texture) state_->store.use_levels(photograph_levels(*state_, pass.shown, request.camera));
  RenderedView view = empty_view(camera);
  if (request.texture && state_->options.equalise)
    view.exposure = pass.exposure = view_exposure(*state_, request, pass.used);
  if (request.texture && state_->options.tone == "shoulder")
    view.shoulder = Shoulder(whitest(state_->gains, pass.used, view.exposure));
  const int n = state_->options.samples_per_axis;
  for (const Tile& tile : make_tiles(camera.height, camera.width, side))
    for (int sample = 0; sample < n * n; ++sample) {
      const int col = sample % n, row = sample / n;
      const std::array<float, 2> offset{(static_cast<float>(col) + 0.5f) / static_cast<float>(n),
                                        (static_cast<float>(row) + 0.5f) / static_cast<float>(n)};
      const TilePixels pixels = render_tile(*state_, pass, tile, offset);
      add_tile(pixels, tile, pass.camera, 1 / static_cast<float>(n * n), col == n / 2 && row == n / 2, view);
    }
  return view;
}

}  // namespace hybrid::stages
