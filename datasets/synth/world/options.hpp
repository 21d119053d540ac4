#pragma once
#include <cstdint>
#include <string>

namespace synth {

struct Preset {
  std::string name;
  int scan_columns, scan_rows;
  int photograph_width_px, photograph_height_px;
  int view_width_px, view_height_px;
  int truth_view_samples_per_side;
  // Indirect light (church only): metres between the points where it is gathered, rays at each.
  double light_step_m = 0.25;
  int light_rays = 128;
};

// Standard deviation of a range along the ray: noise_m + noise_per_m * range + incidence_gain * the beam's
// radius * tan(incidence), the last for the spread of the footprint in depth.
struct ScannerModel {
  double noise_m = 0.002, noise_per_m = 0, incidence_gain = 0;
  double dropout_share = 0.02;  // of all samples, whatever they hit
  bool optics = false;          // dark and glossy surfaces drop out more; glass: ghosts and looks through
};

// own: PTX for a scanner that keeps a grid, else PLY. The samples are the same in every format.
// e57 holds photographs, too: a panorama from every scanner, and those of the lens, which has no distortion
// then.
enum class ScanFormat : std::uint8_t { own, ply, ptx, exr, e57 };

struct Options {
  std::uint64_t seed = 1;
  Preset preset;
  ScannerModel scanner;
  int scans = 3;  // of a church, 3 to 24; the first three are the same bytes however many follow
  ScanFormat scan_format = ScanFormat::own;
  double proxy_error_m = 0;         // standard deviation of each proxy face's displacement along its normal
  double camera_error = 0;          // pixels, standard deviation, as the written cameras' directions err
  double photograph_variation = 0;  // 1: exposure +-10 %, white balance +-4 %, corners 25 % darker
};

}  // namespace synth
