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
// Mapping: one work-item per VW neighbouring samples of a row, lane = sample; for the few whose planes are
// tried, lane = neighbour. in:  x, y, z[(rows + 4) * (cols + 4)]: measured points, scan frame, metres, with a
// halo of 2; NaN = none;
//      label[rows * cols]: supercluster id of the tile's samples, 0 = none.
// out: stray[rows * cols]: STRAY_...; STRAY_NONE where nothing was measured.
// Params: StraySamplesParams. Defines: VW lanes. Edges: the caller puts the seam's nodes into the halo, NaN
// outside the image. A neighbour that is missing is replaced by the next one in its direction. Cost: 16
// bytes, about 100 operations for an unlabelled sample on a smooth surface, 300 for another, 10 000 for one
// between two depths. Reference twin: tests/reference/stray_samples.cpp.
#include "lib/lanes_sym3.h"
#include "shared/params_stray_samples.h"

#define STRAY_SIDE (2 * STRAY_WINDOW + 1)
#define STRAY_NODES (STRAY_SIDE * STRAY_SIDE)
#define STRAY_CENTRE (STRAY_SIDE * STRAY_WINDOW + STRAY_WINDOW)

// The points of a tile and its halo.
typedef struct StrayPoints {
  global const float *x, *y, *z;
  uint width, total;
} StrayPoints;

static inline void points_at(const StrayPoints* points, uint at, LanesVec3* out) {
  out->x = load_lanes(points->x, at, points->total, NAN);
  out->y = load_lanes(points->y, at, points->total, NAN);
  out->z = load_lanes(points->z, at, points->total, NAN);
}

// The windows around the samples, row by row; range is NaN where nothing was measured.
typedef struct StrayWindows {
  floatv range[STRAY_NODES];
  floatv angle[STRAY_NODES];  // to the centre's ray: its chord, which differs by less than the noise
} StrayWindows;

// `corner`: of the first sample's window.
static inline void look_around(const StrayPoints* points, uint corner, LanesVec3 centre, floatv range,
                               StrayWindows* windows) {
  const LanesVec3 ray = {centre.x / range, centre.y / range, centre.z / range};
  for (uint k = 0u; k < STRAY_NODES; ++k) {
    LanesVec3 point;
    points_at(points, corner + k / STRAY_SIDE * points->width + k % STRAY_SIDE, &point);
    const floatv other = sqrt(lanes_dot(point, point));
    const LanesVec3 chord = {point.x / other - ray.x, point.y / other - ray.y, point.z / other - ray.z};
    windows->range[k] = other;
    windows->angle[k] = sqrt(lanes_dot(chord, chord));
  }
}

static inline intv are_isolated(const StrayWindows* windows, floatv range, StraySamplesParams params) {
  const floatv one = (floatv)(1.0f), none = (floatv)(0.0f);
  floatv measured = none, near = none;
  for (uint k = 0u; k < STRAY_NODES; ++k) {
    if (k == STRAY_CENTRE) continue;
    const floatv other = windows->range[k];
    const floatv limit = params.noise_m + params.steep * (windows->angle[k] * fmin(range, other));
    measured += PICK(MASK((other == other)), one, none);
    near += PICK(MASK((fabs(other - range) <= limit)), one, none);  // false for NaN
  }
  return MASK((measured >= (floatv)((float)params.least_neighbours))) &
         MASK((near < params.min_near_share * measured));
}

// `step`: from a node of the window to the next one in the direction asked.
static inline intv are_between(const StrayWindows* windows, floatv range, uint step,
                               StraySamplesParams params) {
  const uint a = STRAY_CENTRE - step, b = STRAY_CENTRE + step;
  const intv has_a = MASK((windows->range[a] == windows->range[a])),
             has_b = MASK((windows->range[b] == windows->range[b]));
  const floatv range_a = PICK(has_a, windows->range[a], windows->range[a - step]),
               range_b = PICK(has_b, windows->range[b], windows->range[b + step]);
  const floatv angle_a = PICK(has_a, windows->angle[a], windows->angle[a - step]),
               angle_b = PICK(has_b, windows->angle[b], windows->angle[b + step]);
  const intv rises = MASK((range_a < range_b));
  const floatv low = PICK(rises, range_a, range_b), high = PICK(rises, range_b, range_a);
  const floatv off_low = params.noise_m + params.gap * PICK(rises, angle_a, angle_b) * low,
               off_high = params.noise_m + params.gap * PICK(rises, angle_b, angle_a) * range;
  return MASK((range - low > off_low)) & MASK((high - range > off_high));  // false for NaN
}

#define STRAY_PADDED 32  // nodes of a window in whole vectors of any width

// Of one sample: largest share of the measured neighbours on a plane through it and two of the 8 neighbours.
// Lane = neighbour.
static inline float planar_share(const StrayPoints* points, uint corner, StraySamplesParams params) {
  float x[STRAY_PADDED], y[STRAY_PADDED], z[STRAY_PADDED], range[STRAY_PADDED];
  uint measured = 0u, most = 0u;
  for (uint k = 0u; k < STRAY_PADDED; ++k) {
    const uint from = corner + k / STRAY_SIDE * points->width + k % STRAY_SIDE;
    const bool is_node = k < STRAY_NODES && k != STRAY_CENTRE;
    x[k] = is_node ? points->x[from] : NAN;
    y[k] = is_node ? points->y[from] : NAN;
    z[k] = is_node ? points->z[from] : NAN;
    range[k] = sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]);
    measured += isnan(range[k]) ? 0u : 1u;
  }
  const uint at = corner + STRAY_WINDOW * (points->width + 1u);
  const float3 centre = (float3)(points->x[at], points->y[at], points->z[at]);
  const float3 ray = centre / sqrt(dot(centre, centre));
  for (uint first = 0u; first < 8u; ++first)
    for (uint second = first + 1u; second < 8u; ++second) {
      const uint p = first < 4u ? first : first + 1u, q = second < 4u ? second : second + 1u;
      const uint a = (p / 3u + STRAY_WINDOW - 1u) * STRAY_SIDE + p % 3u + STRAY_WINDOW - 1u;
      const uint b = (q / 3u + STRAY_WINDOW - 1u) * STRAY_SIDE + q % 3u + STRAY_WINDOW - 1u;
      if (isnan(range[a]) || isnan(range[b])) continue;
      const float3 point_a = (float3)(x[a], y[a], z[a]), point_b = (float3)(x[b], y[b], z[b]);
      const float3 turn_a = point_a / range[a] - ray, turn_b = point_b / range[b] - ray;
      const float3 across = cross(turn_a, turn_b);
      if (dot(across, across) < 0.09f * dot(turn_a, turn_a) * dot(turn_b, turn_b)) continue;
      const float3 normal = cross(point_a - centre, point_b - centre);
      const float least = params.min_cosine * sqrt(dot(normal, normal));
      floatv on = (floatv)(0.0f);
      for (uint k = 0u; k < STRAY_PADDED; k += VW) {
        const floatv px = LOAD_LANES(x + k), py = LOAD_LANES(y + k), pz = LOAD_LANES(z + k);
        const floatv along = normal.x * px + normal.y * py + normal.z * pz;
        const floatv cosine = fmax(fabs(along) / LOAD_LANES(range + k), (floatv)(least));
        const floatv distance =
            fabs(normal.x * (px - centre.x) + normal.y * (py - centre.y) + normal.z * (pz - centre.z));
        on += PICK(MASK((distance <= params.plane_tolerance_m * cosine)), (floatv)(1.0f), (floatv)(0.0f));
      }
      most = max(most, (uint)sum_lanes(on));
    }
  return measured > 0u ? (float)most / (float)measured : 0.0f;
}

// A shorter answer for most: where the 8 neighbours are there and differ by noise alone, none is across a
// gap, and they are enough not to be alone.
static inline intv are_smooth(const StrayPoints* points, uint centre, floatv range,
                              StraySamplesParams params) {
  if (8.0f < params.min_near_share * (float)(STRAY_NODES - 1)) return (intv)(0);
  intv smooth = MASK((range == range));
  for (uint k = 0u; k < 9u; ++k) {
    LanesVec3 other;
    points_at(points, centre + k / 3u * points->width + k % 3u - points->width - 1u, &other);
    smooth &= MASK((fabs(sqrt(lanes_dot(other, other)) - range) <= params.noise_m));  // false for NaN
  }
  return smooth;
}

kernel void stray_samples(StraySamplesParams params, global const float* restrict x,
                          global const float* restrict y, global const float* restrict z,
                          global const uint* restrict label, global uchar* restrict stray) {
  const uint col = get_global_id(0) * (uint)VW, row = get_global_id(1);
  if (col >= params.cols || row >= params.rows) return;
  const uint first = row * params.cols + col, count = min((uint)VW, params.cols - col);
  StrayPoints points;
  points.x = x;
  points.y = y;
  points.z = z;
  points.width = params.cols + 2u * STRAY_WINDOW;
  points.total = points.width * (params.rows + 2u * STRAY_WINDOW);
  const uint corner = row * points.width + col, here = corner + STRAY_WINDOW * (points.width + 1u);
  int lane[VW];
  for (uint k = 0u; k < VW; ++k) lane[k] = k < count && label[first + k] == 0u ? -1 : 0;
  intv asked = LOAD_LANES(lane), isolated = (intv)(0), between = isolated;
  if (ANY(asked)) {
    LanesVec3 centre;
    points_at(&points, here, &centre);
    const floatv range = sqrt(lanes_dot(centre, centre));
    asked &= MASK((range == range));
    asked &= ~are_smooth(&points, here, range, params);
    if (ANY(asked)) {
      StrayWindows windows;
      look_around(&points, corner, centre, range, &windows);
      isolated = asked & are_isolated(&windows, range, params);
      between = asked & ~isolated &
                (are_between(&windows, range, 1u, params) | are_between(&windows, range, STRAY_SIDE, params) |
                 are_between(&windows, range, STRAY_SIDE + 1u, params) |
                 are_between(&windows, range, STRAY_SIDE - 1u, params));
    }
  }
  int alone[VW];
  STORE_LANES(isolated, alone);
  STORE_LANES(between, lane);
  for (uint k = 0u; k < count; ++k)
    stray[first + k] = alone[k] ? STRAY_ISOLATED
                       : lane[k] && planar_share(&points, corner + k, params) < params.min_planar_share
                           ? STRAY_BETWEEN
                           : STRAY_NONE;
}
