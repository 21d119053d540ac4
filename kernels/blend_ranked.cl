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

// Weight of the photograph before feathering at point i of `count`; 0 where it has none.
static inline float ranked_weight(const BlendRankedParams* params, uint count, uint i,
                                  global const float* penalty, global const int* ranked) {
  uint rank = params->kept, last = params->kept - 1u;
  for (uint r = 0u; r < params->kept; ++r)
    if (ranked[r * count + i] == params->photograph) rank = r;
  if (rank == params->kept) return 0.0f;
  while (ranked[last * count + i] < 0) --last;
  const float worst = penalty[last * count + i];
  const float fade = last == params->kept - 1u ? worst : 1.01f * worst;
  const float least = penalty[i];
  if (!(least < fade)) return rank == 0u ? 1.0f : 0.0f;
  const float value = penalty[rank * count + i];
  return max(0.0f, 1.0f - value / fade) / (value + params->pixel_rad);
}

kernel void blend_ranked(const BlendRankedParams params, global const float* restrict surface,
                         global const float* restrict penalty, global const int* restrict ranked,
                         global const uchar* restrict photo, global const half* restrict low,
                         global const float* restrict linear, global float* restrict sums,
                         global int* restrict best) {
  const uint packet_x = get_global_id(0), packet_y = get_global_id(1);
  const uint2 corner = packet_pixel(packet_x, packet_y, 0u, params.rows);
  if (corner.x >= params.cols || corner.y >= params.rows) return;
  const uint count = params.cols * params.rows;
  uint index[VW];
  packet_indices(packet_x, packet_y, params.cols, params.rows, index);
  float weights[VW], columns[VW], rows[VW], feathers[VW];
  uint any = 0u;
  for (uint lane = 0u; lane < VW; ++lane) {
    weights[lane] =
        index[lane] == BVH_EMPTY ? 0.0f : ranked_weight(&params, count, index[lane], penalty, ranked);
    any |= weights[lane] > 0.0f;
  }
  if (!any) return;
  const floatv x = surface_plane(surface, SURFACE_X, count, index);
  const floatv y = surface_plane(surface, SURFACE_Y, count, index);
  const floatv z = surface_plane(surface, SURFACE_Z, count, index);
  floatv column, row;
  packet_project(&params.camera, x, y, z, &column, &row);
  STORE_LANES(column, columns);
  STORE_LANES(row, rows);
  STORE_LANES(packet_feather(&params.camera, params.feather_px, column, row), feathers);
  for (uint lane = 0u; lane < VW; ++lane) {
    if (!(weights[lane] > 0.0f)) continue;
    Bilinear around;
    bilinear_at(&params.camera, columns[lane], rows[lane], &around);
    add_light(&around, params.mix, params.photograph, params.camera.width * params.camera.height,
              feathers[lane] * weights[lane], photo, low, linear, count, index[lane], sums, best);
  }
}
