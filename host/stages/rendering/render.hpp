#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.hpp"
#include "device/queue.hpp"
#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "geometry/polygon_model.hpp"
#include "geometry/range_image.hpp"
#include "geometry/shoulder.hpp"
#include "geometry/superclusters.hpp"
#include "stages/rendering/atlas.hpp"
#include "stages/rendering/curtains.hpp"
#include "stages/scan/sample_surface.hpp"

namespace hybrid::stages {

struct RenderOptions {
  std::string blend = "linear";    // "nearest" | "linear" | "dual" | "multi-band"
  std::string weights = "ulr";     // "angle" (Facade) | "ulr" (unstructured lumigraph)
  int ulr_k = 3;                   // photographs that mix in a pixel; the next one's penalty ends them
  double ulr_resolution = 0.05;    // penalty, rad, per time that a photograph is coarser than the view
  double ulr_field_of_view = 0.1;  // penalty, rad, at a photograph's border
  double sigma_px = 4;             // Gaussian that splits photographs into low and high frequencies
  bool auto_sigma = false;         // sigma_px = "auto": by leaving photographs out (SigmaChoice)
  int bands = 4;           // blend = "multi-band": of them, split by Gaussians of sigma_px, 2 sigma_px, ...
  int high_power = 4;      // exponent of the weights in the highest band: 1 as in the lowest, 64 the heaviest
                           // alone; of multi-band's others geometrically in between
  double feather_px = 32;  // weights fall to 0 over this distance to a photograph's border
  double surface_tolerance_m = 0.02;  // within this of a proxy face the sample wins; between samples and
                                      // faces, and between samples, shadow rays ignore hits this near (times
                                      // up to 5 at grazing angles); faces shadow each other exactly
  double grazing_deg = 2;         // a photograph that meets a surface at no more than this does not see it
  double grazing_sample_deg = 6;  // the same of samples, whose normals are estimates, where it is more
  double unseen_m = 0.1;  // so far behind its outline what is scanned hides what photographs and textured
                          // views see, where no scan has seen the place empty (curtains.hpp); 0: all that is
                          // unseen is empty
  bool equalise = true;   // gains per photograph and channel that make the photographs' overlaps agree; a
                          // view comes at the exposure of those it shows, all else at one of them all
  std::string tone = "auto";  // "linear": what is lighter than white is cut off; "shoulder": it is brought
                              // back (geometry/shoulder.hpp); "auto": the latter, but for views, whose own
                              // exposure is the photographs'
  bool levels = true;         // photographs finer than the view are halved first, as often as they are
  int photograph_mb = 4096;   // memory for photographs on the device; changes no result
  int samples_per_axis = 1;   // primary rays per pixel = n^2; all but the colour comes from the middle one
  int tile = 1024;            // side in pixels of what is rendered at once; changes no result
};
const std::vector<OptionRow<RenderOptions>>& render_option_table();
// sigma_px is a number or "auto". Throws as set_option() does.
void set_sigma(RenderOptions& options, const OptionValue& value);
// The cosine between sight and normal that goes with grazing_deg.
float least_facing(const RenderOptions& options);
// The same of samples: of the larger of grazing_deg and grazing_sample_deg.
float least_facing_sample(const RenderOptions& options);

// A retained sample as a tiny sphere (paper 2.4), world frame.
struct Splat {
  std::array<float, 3> centre_m;
  float radius_m;
  std::array<float, 3> normal;  // towards the scanner, unit; zero when unknown
  std::uint32_t scan;           // index of the scan, for plain colouring
  bool on_face = false;         // a proxy face stands for it: drawn only where the proxy is not shown
};

// Everything a view is made of, world frame.
struct RenderScene {
  PolygonModel proxy;
  PolygonModel contours;                    // of superclusters that no proxy face explains (METHOD 10)
  std::vector<std::uint32_t> contour_scan;  // per face of `contours`: index of its scan
  std::vector<Splat> splats;
  std::vector<Curtain> curtains;  // hide what is behind them from photographs and textured views
  std::vector<Vec3> scanners;     // where scans were made from
  std::vector<Photograph> photographs;
  std::vector<Image8> photograph_pixels;  // RGB or RGBA 8-bit sRGB, one per photograph; alpha 0: masked, not
                                          // part of the photograph
  // Gives the pixels of those whose image above has an extent and no pixels (RGB only), each time they are
  // asked for: photographs that do not fit in memory all together.
  std::function<std::shared_ptr<const Image8>(std::size_t index)> decode;
};
// The pixels of a photograph, wherever they are; the scene must outlive them.
std::shared_ptr<const Image8> photograph_image(const RenderScene& scene, std::size_t index);

struct ViewRequest {
  Photograph camera;          // full camera, distortion included
  std::string show = "both";  // "proxy" | "scan" | "both"
  bool texture = true;
  bool cameras = false;  // draw the photographs' positions
  std::vector<std::string> leave_out;
};

// One rendered view; all images have the camera's extent.
struct RenderedView {
  ImageF colour;  // linear RGB; red (1,0,0) where no photograph sees the surface; background black
  std::vector<float> depth_m;           // along the viewing axis (Z), of panoramas along the ray; +inf where
                                        // nothing is hit
  ImageF normal;                        // world, unit, towards the viewer
  std::vector<std::uint32_t> id;        // 0 nothing, 1 + proxy face index,
                                        // 0x80000000 + splat index,
                                        // 0x20000000 + contour face index, 0x40000000 + photograph index
                                        // where `cameras` draws one
  std::vector<std::uint32_t> coverage;  // number of photographs that see the pixel's surface point
  std::vector<std::int32_t> best;       // index of the heaviest photograph, -1 none
  std::array<double, 3> exposure{1, 1, 1};  // what the photographs' light was multiplied with besides their
                                            // gains (view_exposure); through it, views have one exposure
  Shoulder shoulder;  // what a picture of it does with light above white, where coverage is not 0
};

// What auto_sigma made of it.
struct SigmaChoice {
  struct Trial {
    double sigma_px = 0, psnr_db = 0;  // mean over photographs left out
  };
  double sigma_px = 0;
  std::vector<Trial> tried;
};

// Whether a photograph shows what the others show where it does (agreements_of).
struct PhotographAgreement {
  std::size_t points = 0;             // of the surface that it sees, of some 400,000 for all photographs
  std::optional<double> correlation;  // nothing: no overlap, or one in which nothing varies
};

// A place on a proxy face.
struct SurfacePoint {
  Vec3 position, normal;  // world; unit, towards the side that is asked about
};

// Keeps what does not change between views: the photographs and their low band on the device, the BVH. The
// scene and the queue must outlive it. Throws ErrorKind::input: photographs and their images do not match, a
// face that cannot be triangulated.
class Renderer {
 public:
  Renderer(device::Queue& queue, const RenderScene& scene, const RenderOptions& options = {});
  ~Renderer();
  const RenderOptions& options() const;  // with the sigma that was chosen
  // With auto_sigma, where photographs are split into bands and there are at least two of them.
  const std::optional<SigmaChoice>& sigma_choice() const;
  // What the photographs' linear light is multiplied with, per channel; all 1 without `equalise`.
  const std::vector<std::array<double, 3>>& gains() const;
  // One per photograph; empty without `equalise`. Measured: 0.82 and more where cameras and surfaces are
  // right, under 0.5 where the cameras' frame is turned or scaled.
  const std::vector<PhotographAgreement>& agreements() const;
  // What pictures at the one exposure of all photographs do with light above white.
  Shoulder common_shoulder() const;
  // METHOD 10. Kernels: ray_cast, blend_photos, blur_photo. Throws ErrorKind::input: a leave_out that names
  // no photograph, an unknown `show`, a camera without pixels.
  RenderedView render(const ViewRequest& request);
  // Projects the photographs onto a scan's own range-image tiles, as seen from the scanner: linear RGB and
  // coverage per measured node (NaN, 0 elsewhere). `segmentation` gives normals; it may be empty.
  struct ColouredRange {
    ImageF colour;                        // cols x rows, linear RGB; red where unseen
    std::vector<std::uint32_t> coverage;  // photographs that see the sample
    Shoulder shoulder;                    // common_shoulder()
    // Of a node that is seen, for pictures and files of bytes.
    std::array<float, 3> toned(std::size_t node) const {
      std::array<float, 3> rgb{};
      std::copy_n(colour.pixels.begin() + static_cast<std::ptrdiff_t>(3 * node), 3, rgb.begin());
      shoulder.apply(rgb.data());
      return rgb;
    }
  };
  ColouredRange colour_range_image(const RangeImage& image, const PlaneSegmentation& segmentation,
                                   const Pose& world_from_scan, int tile = 1024);
  // The face of a chart as the photographs show it, seen along its normal from far away: a texture that needs
  // no photographs any more. Of every texel that `mask` (chart_mask) has.
  struct BakedChart {
    std::vector<float> colour;            // linear RGB, interleaved; red where unseen, 0 outside the mask
    std::vector<std::uint32_t> coverage;  // photographs that see the texel
    std::vector<std::int32_t> best;       // the heaviest, -1 none
  };
  BakedChart bake(const AtlasChart& chart, const std::vector<std::uint8_t>& mask);

  // How many photographs see each point, with proxy and scans in the way. Kernel: rank_photos.
  std::vector<std::uint32_t> count_seen(const std::vector<SurfacePoint>& points);
  // Which points (indices, ascending) each of the cameras, which are none of the scene's, would see.
  std::vector<std::vector<std::uint32_t>> seen_from(const std::vector<Photograph>& cameras,
                                                    const std::vector<SurfacePoint>& points);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// How a node's sample is drawn.
enum Drawn : std::uint8_t {
  kNotDrawn = 0,
  kDrawn = 1,
  kDrawnOffFaces = 2,  // Splat::on_face
};

// Sphere radius per node as SampleSurfaces says, so that neighbouring spheres close up; metres. The measured
// nodes that `drawn` (Drawn, per node) does not rule out become splats in the world frame. scan_index colours
// plain views. After them, splats for nodes without a sample that lie between two such nodes of one surface
// in a row or a column: a dropout is no window. Of every so many rows and columns one is taken, whose spheres
// are as many times larger, and gaps stay. `limits`: ascending by node.
std::vector<Splat> make_splats(const RangeImage& image, const PlaneSegmentation& segmentation,
                               const std::vector<std::uint8_t>& drawn, const Pose& world_from_scan,
                               std::uint32_t scan_index, int every = 1,
                               const std::vector<RadiusLimit>& limits = {});

// Image quality against a reference photograph (METHOD, how results are scored).
struct ImageQuality {
  double psnr_db = 0;  // sRGB-encoded 8-bit scale, R, G and B pooled, on the mask, after one gain per channel
                       // (least squares in linear light); at most 100, 0 for an empty mask
  double ssim = 0;     // mean over the mask, luma, 11x11 Gaussian window
  double share_seen = 0;                // share of pixels in the mask
  std::array<double, 3> gain{1, 1, 1};  // that was fitted: light of the reference over ours
};
// `linear`: 3 channels; `mask`: one per pixel, 0 = ignore; pixels that are not finite are ignored too. Throws
// ErrorKind::input when the sizes differ.
ImageQuality compare_images(const ImageF& linear, const Image8& reference,
                            const std::vector<std::uint8_t>& mask);

}  // namespace hybrid::stages
