// The k + 1 photographs of least penalty per surface point: unstructured lumigraph rendering (METHOD 10;
// Buehler, Bosse, McMillan, Gortler, Cohen 2001). The host launches this once per photograph, in index order,
// so their number has no limit; a photograph displaces a remembered one only if its penalty is smaller, so
// among equals the smaller index stays. blend_ranked turns penalties into weights.
//
// Penalty, in radians: the angle between the rays from X to the eye and to the photograph's centre
// + resolution_cost * how many times more of the surface a pixel of the photograph covers than one of the
//   view, less one, not below 0 (a pixel covers distance * its angle / cosine; cosines count from 0.05 up)
// + field_of_view_cost * how near X lies to the photograph's border: 0 farther than feather_px, 1 on it.
//
// A photograph sees point X when X projects inside it, the surface faces it by more than least_facing
// (samples: least_facing_sample) and the ray from its centre to X meets nothing before X
// (lib/photo_packet.h).
//
// Mapping: one work-item per packet of VW points, as in ray_cast.cl.
//
// in: the tree; surface[SURFACE_PLANES * cols * rows] and photo as in blend_photos.cl (photo is read only
// where the photograph has a mask).
//
// in/out: penalty[kept * cols * rows], ranked[kept * cols * rows]: the best so far in growing order, one
// plane per rank; ranks that nothing has hold +inf and -1. seen[cols * rows] = photographs so far that see
// the point.
//
// Defines: VW (1). Edges: a point on the very border of a photograph is seen. Cost: 28 bytes of surface and
// 8 kept + 8 bytes of ranks per seen point, one shadow ray. Reference twin: tests/reference/rank_photos.cpp.
#include "lib/photo_light.h"
#include "lib/photo_packet.h"
#include "shared/params_rank_photos.h"

static inline floatv photo_penalty(const RankPhotosParams* params, const PacketSurface* points,
                                   const PacketSight* sight, floatv column, floatv row) {
  const PacketSight from_eye = packet_sight(points, vload3(0, params->eye));
  const floatv least = (floatv)(0.05f);
  const floatv slant = max(fabs(from_eye.facing), least) / max(sight->facing, least);
  const floatv coarser = params->pixel_ratio * (sight->distance / from_eye.distance) * slant - 1.0f;
  const floatv border = 1.0f - packet_feather(&params->camera, params->feather_px, column, row);
  return packet_angle(sight, &from_eye) + params->resolution_cost * max(coarser, (floatv)(0.0f)) +
         params->field_of_view_cost * border;
}

// Inserts a photograph into the ranks of the points that see it.
static inline void insert_photo(floatv value, int photograph, intv visible, uint kept, uint count,
                                const PacketPlace* place, global float* penalty, global int* ranked) {
  intv index = (intv)(photograph);
  for (uint rank = 0u; rank < kept; ++rank) {
    global float* values = penalty + rank * count;
    global int* photos = ranked + rank * count;
    const floatv other = load_packet_float(values, place, 0.0f);
    const intv better = visible & MASK(value < other);
    if (!ANY(better)) continue;
    const intv other_index = load_packet_int(photos, place, -1);
    store_packet_float(PICK(better, value, other), place, values);
    store_packet_int(PICK(better, index, other_index), place, photos);
    value = PICK(better, other, value);
    index = PICK(better, other_index, index);
  }
}

kernel void rank_photos(const RankPhotosParams params, global const BvhNode* restrict nodes,
                        global const TriangleRecord* restrict triangles,
                        global const SphereRecord* restrict spheres, global const float* restrict surface,
                        global const uchar* restrict photo, global float* restrict penalty,
                        global int* restrict ranked, global uint* restrict seen) {
  const uint packet_x = get_global_id(0), packet_y = get_global_id(1);
  const uint2 corner = packet_pixel(packet_x, packet_y, 0u, params.rows);
  if (corner.x >= params.cols || corner.y >= params.rows) return;
  const PacketPlace place = packet_place(corner, params.cols, params.rows);
  const uint count = params.cols * params.rows;
  const PacketSurface points = load_surface(surface, count, &place);
  floatv column, row;
  intv asked = packet_project(&params.camera, points.x, points.y, points.z, &column, &row);
  const float3 centre = vload3(0, params.camera.centre);
  const PacketSight sight = packet_sight(&points, centre);
  asked &= packet_faces(&points, &sight, params.least_facing, params.least_facing_sample);
  if (!ANY(asked)) return;

  const ShadowTolerance tolerance = {params.tolerance_m, params.face_tolerance_m};
  intv visible =
      packet_unhidden(&points, &sight, centre, tolerance, nodes, triangles, spheres, params.root, asked);
  if (!ANY(visible)) return;
  if (params.camera.flags & CAMERA_HAS_MASK) {
    Bilinear around;
    bilinear_at(&params.camera, column, row, visible, &around);
    visible &= is_photograph(&params.camera, &around, photo);
  }
  const uintv so_far = load_packet_uint(seen, &place, 0u);
  store_packet_uint(so_far + PICK(visible, (uintv)(1u), (uintv)(0u)), &place, seen);
  insert_photo(photo_penalty(&params, &points, &sight, column, row), params.photograph, visible, params.kept,
               count, &place, penalty, ranked);
}
