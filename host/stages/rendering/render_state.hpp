#pragma once
#include <map>
#include <string>

#include "stages/rendering/blend_bands.hpp"
#include "stages/rendering/photograph_store.hpp"
#include "stages/rendering/render.hpp"
#include "stages/rendering/render_geometry.hpp"
#include "stages/rendering/sight_cone.hpp"

namespace hybrid::stages {

// Behind Renderer; named so that the functions of several files can work on it.
struct RenderState {
  device::Queue& queue;
  const RenderScene& scene;
  RenderOptions options;
  Vec3 origin;        // of the local frame, world
  double diagonal_m;  // of the scene's box
  PhotographStore store;
  std::vector<SightCone> sights;                // per photograph
  std::map<std::string, DeviceBvh> geometries;  // by what is shown
  std::vector<std::array<double, 3>> gains;     // per photograph and channel
  std::vector<PhotographAgreement> agreements;  // per photograph, with equalise
  std::optional<SigmaChoice> sigma;

  RenderState(device::Queue& q, const RenderScene& s, const RenderOptions& o);

  void use_sigma(double sigma_px);
  // Built when first shown. "both" of a scene that has only one of the two is that one.
  const DeviceBvh& geometry(const std::string& show);
  // Whose visibility edges the low bands respect; anything when there are none.
  const DeviceBvh& everything(const DeviceBvh& shown) {
    return !band_sigmas(options).empty() ? geometry("both") : shown;
  }
};

struct Renderer::State : RenderState {
  using RenderState::RenderState;
};

}  // namespace hybrid::stages
