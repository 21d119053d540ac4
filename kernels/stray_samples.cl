// Samples that stand for no surface: mixed pixels, whose beam hit two surfaces and whose range is a mean of
// both (Hebert and Krotkov 1992; Tuley, Vandapel and Hebert 2005), and lone samples in the air. Local
// evidence only, and only samples that belong to no plane are asked. With the arc between two samples = angle
// between their rays x the shorter range:
//   isolated: of its measured neighbours (5 x 5) fewer than min_near_share differ in range by less than
//     noise + steep x arc (at least least_neighbours must be there to say so);
//   between: along a row, a column or a diagonal its range lies between those of the two neighbours beside
//     it, by more than noise + gap x arc from either, and no plane through it fits the surroundings: of the
//     planes through it and two of the 8 neighbours (slivers apart) the best has fewer than min_planar_share
//     of the measured neighbours within plane_tolerance |n.u|.
// A surface seen at a grazing angle has steep neighbours as well, and a jamb lies between two depths; the
// plane tells them from a veil, whose ranges vary with what each beam hit.
//
// Mapping: one work-item per sample of the tile.
// in:  x, y, z[(rows + 4) * (cols + 4)]: measured points, scan frame, metres, with a halo of 2; NaN = none;
//      label[rows * cols]: supercluster id of the tile's samples, 0 = none.
// out: stray[rows * cols]: STRAY_...; STRAY_NONE where nothing was measured.
// Params: StraySamplesParams. Edges: the caller puts the seam's nodes into the halo, NaN outside the image. A
// neighbour that is missing is replaced by the next one in its direction. Cost: 16 bytes, about 100
// operations for an unlabelled sample on a smooth surface, 300 for another, 10 000 for one between two
// depths. Reference twin: tests/reference/stray_samples.cpp.
#include "shared/params_stray_samples.h"

#define STRAY_SIDE (2 * STRAY_WINDOW + 1)
#define STRAY_CENTRE (STRAY_SIDE * STRAY_WINDOW + STRAY_WINDOW)

// The window around a sample, row by row; range is NaN where nothing was measured.
typedef struct StrayWindow {
  float3 point[STRAY_SIDE * STRAY_SIDE];
  float range[STRAY_SIDE * STRAY_SIDE];
  float angle[STRAY_SIDE * STRAY_SIDE];  // to the centre's ray
} StrayWindow;

// Chord for angle: what is compared differs by less than the noise.
static inline float angle_between(float3 a, float range_a, float3 b, float range_b) {
  const float3 chord = a / range_a - b / range_b;
  return sqrt(dot(chord, chord));
}

static inline int is_isolated(const StrayWindow* window, StraySamplesParams params) {
  const float range = window->range[STRAY_CENTRE];
  uint measured = 0u, near = 0u;
  for (int k = 0; k < STRAY_SIDE * STRAY_SIDE; ++k) {
    if (k == STRAY_CENTRE || isnan(window->range[k])) continue;
    const float arc = window->angle[k] * fmin(range, window->range[k]);
    ++measured;
    near += fabs(window->range[k] - range) <= params.noise_m + params.steep * arc ? 1u : 0u;
  }
  return measured >= params.least_neighbours && (float)near < params.min_near_share * (float)measured;
}

// `step`: from a node of the window to the next one in the direction asked.
static inline int is_between(const StrayWindow* window, int step, StraySamplesParams params) {
  const float range = window->range[STRAY_CENTRE];
  int a = STRAY_CENTRE - step, b = STRAY_CENTRE + step;
  if (isnan(window->range[a])) a -= step;
  if (isnan(window->range[b])) b += step;
  const int low = window->range[a] < window->range[b] ? a : b, high = low == a ? b : a;
  const float off_low = params.noise_m + params.gap * window->angle[low] * window->range[low];
  const float off_high = params.noise_m + params.gap * window->angle[high] * range;
  return range - window->range[low] > off_low && window->range[high] - range > off_high;  // false for NaN
}

// Largest share of the measured neighbours on a plane through the centre and two of the 8 neighbours.
static inline float planar_share(const StrayWindow* window, StraySamplesParams params) {
  const float3 centre = window->point[STRAY_CENTRE];
  const float3 ray = centre / window->range[STRAY_CENTRE];
  uint measured = 0u, most = 0u;
  for (int k = 0; k < STRAY_SIDE * STRAY_SIDE; ++k)
    measured += k != STRAY_CENTRE && !isnan(window->range[k]) ? 1u : 0u;
  for (int first = 0; first < 8; ++first)
    for (int second = first + 1; second < 8; ++second) {
      const int p = first < 4 ? first : first + 1, q = second < 4 ? second : second + 1;
      const int a = (p / 3 + STRAY_WINDOW - 1) * STRAY_SIDE + p % 3 + STRAY_WINDOW - 1;
      const int b = (q / 3 + STRAY_WINDOW - 1) * STRAY_SIDE + q % 3 + STRAY_WINDOW - 1;
      if (isnan(window->range[a]) || isnan(window->range[b])) continue;
      const float3 turn_a = window->point[a] / window->range[a] - ray;
      const float3 turn_b = window->point[b] / window->range[b] - ray;
      const float3 across = cross(turn_a, turn_b);
      if (dot(across, across) < 0.09f * dot(turn_a, turn_a) * dot(turn_b, turn_b)) continue;
      const float3 normal = cross(window->point[a] - centre, window->point[b] - centre);
      const float length = sqrt(dot(normal, normal));
      uint on = 0u;
      for (int k = 0; k < STRAY_SIDE * STRAY_SIDE; ++k) {
        const float3 point = window->point[k];
        const float cosine = fmax(fabs(dot(normal, point)) / window->range[k], params.min_cosine * length);
        const float distance = fabs(dot(normal, point - centre));
        on += k != STRAY_CENTRE && distance <= params.plane_tolerance_m * cosine ? 1u : 0u;
      }
      most = max(most, on);
    }
  return measured > 0u ? (float)most / (float)measured : 0.0f;
}

// A shorter answer for most: where the 8 neighbours are there and differ by noise alone, none is across a
// gap, and they are enough not to be alone.
static inline int is_smooth(global const float* x, global const float* y, global const float* z, uint width,
                            uint centre, StraySamplesParams params) {
  const float3 point = (float3)(x[centre], y[centre], z[centre]);
  const float range = sqrt(dot(point, point));
  uint near = 0u;
  for (uint k = 0u; k < 9u; ++k) {
    const uint from = centre + (k / 3u) * width + k % 3u - width - 1u;
    const float3 other = (float3)(x[from], y[from], z[from]);
    near += fabs(sqrt(dot(other, other)) - range) <= params.noise_m ? 1u : 0u;  // false for NaN
  }
  return near == 9u && 8.0f >= params.min_near_share * (float)(STRAY_SIDE * STRAY_SIDE - 1);
}

kernel void stray_samples(StraySamplesParams params, global const float* restrict x,
                          global const float* restrict y, global const float* restrict z,
                          global const uint* restrict label, global uchar* restrict stray) {
  const uint col = get_global_id(0), row = get_global_id(1);
  if (col >= params.cols || row >= params.rows) return;
  const uint i = row * params.cols + col;
  const uint width = params.cols + 2u * STRAY_WINDOW;
  const uint here = (row + STRAY_WINDOW) * width + col + STRAY_WINDOW;
  stray[i] = STRAY_NONE;
  if (label[i] != 0u || isnan(x[here]) || is_smooth(x, y, z, width, here, params)) return;
  StrayWindow window;
  for (int k = 0; k < STRAY_SIDE * STRAY_SIDE; ++k) {
    const uint from = (row + (uint)(k / STRAY_SIDE)) * width + col + (uint)(k % STRAY_SIDE);
    window.point[k] = (float3)(x[from], y[from], z[from]);
    window.range[k] = sqrt(dot(window.point[k], window.point[k]));
  }
  const float3 centre = window.point[STRAY_CENTRE];
  const float range = window.range[STRAY_CENTRE];
  for (int k = 0; k < STRAY_SIDE * STRAY_SIDE; ++k)
    window.angle[k] = angle_between(window.point[k], window.range[k], centre, range);

  if (is_isolated(&window, params)) {
    stray[i] = STRAY_ISOLATED;
    return;
  }
  const int between = is_between(&window, 1, params) || is_between(&window, STRAY_SIDE, params) ||
                      is_between(&window, STRAY_SIDE + 1, params) ||
                      is_between(&window, STRAY_SIDE - 1, params);
  if (between && planar_share(&window, params) < params.min_planar_share) stray[i] = STRAY_BETWEEN;
}
