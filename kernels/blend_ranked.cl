// Adds one photograph to the colours of the surface points that rank_photos ranked it for (METHOD 10; weights
// of unstructured lumigraph rendering: Buehler et al. 2001). With p the photograph's penalty and p_k that of
// rank k (the last one remembered), or 1.01 times the largest where fewer photographs see the point:
//   weight = feather * max(0, 1 - p / p_k) / (p + one pixel)
// where that is 0 for all, the best ranked alone. The first factor fades a photograph out before it drops out
// of the k best; the second is the paper's epipole consistency: a view from a photograph's own place shows
// that photograph. The host launches this once per photograph, in index order; resolve_blend makes the
// colours.
//
// Mapping: one work-item per packet of VW points, as in ray_cast.cl.
//
// in: surface, penalty, ranked as rank_photos reads and leaves them; photo, low, linear as in
// blend_photos.cl.
//
// in/out: sums[planes * cols * rows], best[cols * rows], as in blend_photos.cl.
//
// Defines: VW (1). Edges: as in rank_photos.cl, whose visibility holds here. Cost: 12 bytes of surface,
// 8 kept of ranks, 48 of photograph and 64 of sums per point that has the photograph. Reference twin:
// tests/reference/blend_ranked.cpp.
#include "lib/photo_light.h"
#include "lib/photo_packet.h"
#include "shared/params_rank_photos.h"

// Weights of the photograph before feathering; 0 where a point has it not.
static inline floatv ranked_weight(const BlendRankedParams* params, uint count, const PacketPlace* place,
                                   global const float* penalty, global const int* ranked) {
  const floatv none = (floatv)(0.0f), one = (floatv)(1.0f);
  const floatv least = load_packet_float(penalty, place, 0.0f);
  floatv worst = least, value = none, alone = none;
  intv here = (intv)(0), full = (intv)(0);
  for (uint rank = 0u; rank < params->kept; ++rank) {
    const intv photo = load_packet_int(ranked + rank * count, place, -1);
    const floatv its = load_packet_float(penalty + rank * count, place, 0.0f);
    const intv same = MASK(photo == params->photograph);
    here |= same;
    value = PICK(same, its, value);
    if (rank == 0u) alone = PICK(same, one, none);
    full = MASK(photo >= 0);
    worst = PICK(full, its, worst);
  }
  if (!ANY(here)) return none;
  const floatv fade = PICK(full, worst, 1.01f * worst);
  const floatv weight = max(none, 1.0f - value / fade) / (value + params->pixel_rad);
  return PICK(here, PICK(MASK(least < fade), weight, alone), none);
}

kernel void blend_ranked(const BlendRankedParams params, global const float* restrict surface,
                         global const float* restrict penalty, global const int* restrict ranked,
                         global const uchar* restrict photo, global const half* restrict low,
                         global const float* restrict linear, global float* restrict sums,
                         global int* restrict best) {
  const uint packet_x = get_global_id(0), packet_y = get_global_id(1);
  const uint2 corner = packet_pixel(packet_x, packet_y, 0u, params.rows);
  if (corner.x >= params.cols || corner.y >= params.rows) return;
  const PacketPlace place = packet_place(corner, params.cols, params.rows);
  const uint count = params.cols * params.rows;
  const floatv weight = ranked_weight(&params, count, &place, penalty, ranked);
  const PacketSums to = {place, count, MASK(weight > 0.0f)};
  if (!ANY(to.seen)) return;
  floatv column, row;
  packet_project(&params.camera, surface_plane(surface, SURFACE_X, count, &place),
                 surface_plane(surface, SURFACE_Y, count, &place),
                 surface_plane(surface, SURFACE_Z, count, &place), &column, &row);
  Bilinear around;
  bilinear_at(&params.camera, column, row, to.seen, &around);
  add_light(&to, &around, params.mix, params.photograph, params.camera.width * params.camera.height,
            packet_feather(&params.camera, params.feather_px, column, row) * weight, photo, low, linear, sums,
            best);
}
