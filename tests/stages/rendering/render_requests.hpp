#pragma once
#include "device.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::testing {

inline stages::RenderedView render(const stages::RenderScene& scene, const stages::ViewRequest& request,
                                   const stages::RenderOptions& options = {}) {
  return stages::Renderer(queue(), scene, options).render(request);
}

inline stages::ViewRequest view(const Vec3& eye, const Vec3& target, int width = 160, int height = 120) {
  stages::ViewRequest request;
  request.camera = look_at(eye, target, {0, 0, 1}, 65, width, height);
  return request;
}

}  // namespace hybrid::testing
