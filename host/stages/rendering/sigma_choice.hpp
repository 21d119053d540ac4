#pragma once
#include "stages/rendering/render_state.hpp"

namespace hybrid::stages {

// sigma_px = "auto": the scene's own photographs, left out and made from the others by every candidate in
// turn, say which is best (mean PSNR; the smallest of equals). Eight of them at most, no panoramas, evenly
// spread, and of each its middle, at full size: what a proxy misplaces is so many of the photograph's own
// pixels. Candidates whose widest Gaussian exceeds 64 px are left out. The renderer has the last candidate
// when this returns; no trial, and the sigma as it was, where no left-out photograph is seen by another.
SigmaChoice choose_sigma(Renderer& renderer, RenderState& state);

}  // namespace hybrid::stages
