#pragma once
#include <vector>

#include "geometry/image.hpp"
#include "stages/rendering/render_state.hpp"

namespace hybrid::stages {

// Halved so often, a photograph still has at least a pixel per pixel of the view, but for one pixel in fifty:
// one number per photograph of the scene, from a grid of rays over the whole view, so that no tile decides.
// Nothing in the way is looked at, which can only ask for more. 0 where a photograph has none of the grid's
// points, or a mask. Kernel: ray_cast.
std::vector<int> photograph_levels(RenderState& state, const DeviceBvh& shown, const Photograph& view);

// The image at half its size, sides rounded up: means of four pixels in linear light; of RGB.
Image8 half_size(const Image8& image);
// The camera of an image that was halved `levels` times.
Camera half_camera(Camera camera, int levels);

}  // namespace hybrid::stages
