#pragma once

namespace hybrid::io {

// Sources in the RenderMan Shading Language (RISpec 3.2), written beside scene.rib.
extern const char* const kProjectorShader;  // hybrid_projector.sl
extern const char* const kBlendShader;      // hybrid_blend.sl

}  // namespace hybrid::io
