#pragma once
#include "stages/rendering/atlas.hpp"
#include "stages/rendering/render.hpp"

namespace hybrid::stages {

struct AtlasOptions {
  double texel_m = 0;           // side of a texel; 0: as fine as the photographs show each face
  double texels_per_pixel = 1;  // texel_m = 0: along a line, of the finest quarter of what is seen of a face
  int page = 8192;              // largest side of a page, texels
  int pages = 4;                // more are not made: texels grow instead
  int padding = 8;              // texels around each chart, filled with its border's colours
};
const std::vector<OptionRow<AtlasOptions>>& atlas_option_table();

// Which faces get which charts. Fronts and backs are looked at coarsely first: a side that no photograph sees
// (a back: but for a hundredth, past its edges not counted) has no chart, and a face of which both are unseen
// has its front's, as coarse as it was looked at. Charts stand in the order of the faces, proxy first, fronts
// before backs.
struct Atlas {
  std::vector<AtlasChart> charts;
  AtlasLayout layout;
  int padding = 0;
  std::size_t unseen_faces = 0;  // whose chart is red
};
// Deterministic. Throws ErrorKind::input as place_charts() does.
Atlas plan_atlas(Renderer& renderer, const RenderScene& scene, const AtlasOptions& options);

// One page of texels.
struct AtlasPage {
  Image8 colour;    // sRGB; red where no photograph sees the face; charts run on into their padding
  Image8 coverage;  // RGB: black outside the faces, red where unseen, else grey 60 + 15 * photographs (12 and
                    // more: 240)
  std::size_t texels = 0, seen = 0;  // on faces
};
AtlasPage bake_page(Renderer& renderer, const RenderScene& scene, const Atlas& atlas, int page);

}  // namespace hybrid::stages
