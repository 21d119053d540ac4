// Adds one photograph to the colours of surface points: view-dependent projection of photographs (METHOD 10;
// weights of Facade: Debevec, Taylor, Malik 1996; two frequency bands, the paper's reference 13; more of
// them: Burt and Adelson 1983, whose transitions are as wide as the band is coarse: here by a power of the
// weights). A photograph sees point X when X projects inside it, the surface faces it by more than
// least_facing (samples: least_facing_sample) and the ray from its centre to X meets nothing before X
// (lib/photo_packet.h). Its weight is feather / (angle + one pixel), the angle between the rays from X to the
// eye and to the photograph's centre. The host launches this once per photograph, in index order, so their
// number has no limit; resolve_blend makes the colours.
//
// Mapping: one work-item per packet of VW points, as in ray_cast.cl.
//
// in: the tree; surface[SURFACE_PLANES * cols * rows] as ray_cast writes it (x NaN = no surface; radius > 0:
// a splat with a known normal, < 0: one without, which faces everything, 0: a face);
// photo[4 * width * height]: sRGB bytes, the fourth 0 where the photograph's mask says so (CAMERA_HAS_MASK):
// what lies there is not seen; low[4 * width * height * (bands - 1)]: half, linear light, an image per
// Gaussian, the narrowest first (BLEND_BANDS only);
// linear[3 * 256]: light of an sRGB byte, of red, green and blue: the photograph's own, gains included.
//
// in/out: sums[planes * cols * rows] (shared/params_blend_photos.h); seen[cols * rows] = photographs so far
// that see the point; best[cols * rows] = the heaviest so far (-1 none).
//
// Defines: VW (1). Edges: a point at the photograph's very border weighs almost nothing but counts as seen.
// Cost: 28 bytes of surface, 48 of photograph and 72 of sums per seen point, one shadow ray.
// Reference twin: tests/reference/blend_photos.cpp.
#include "lib/photo_light.h"
#include "lib/photo_packet.h"

kernel void blend_photos(const BlendPhotosParams params, global const BvhNode* restrict nodes,
                         global const TriangleRecord* restrict triangles,
                         global const SphereRecord* restrict spheres, global const float* restrict surface,
                         global const uchar* restrict photo, global const half* restrict low,
                         global const float* restrict linear, global float* restrict sums,
                         global uint* restrict seen, global int* restrict best) {
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

  Bilinear around;
  bilinear_at(&params.camera, column, row, asked, &around);
  const uint photo_pixels = params.camera.width * params.camera.height;
  fetch_light(&around, params.mix, photo_pixels, photo, low);
  const ShadowTolerance tolerance = {params.tolerance_m, params.face_tolerance_m};
  intv visible =
      packet_unhidden(&points, &sight, centre, tolerance, nodes, triangles, spheres, params.root, asked);
  if (!ANY(visible)) return;
  visible &= is_photograph(&params.camera, &around, photo);
  const uintv so_far = load_packet_uint(seen, &place, 0u);
  store_packet_uint(so_far + PICK(visible, (uintv)(1u), (uintv)(0u)), &place, seen);

  const PacketSight from_eye = packet_sight(&points, vload3(0, params.eye));
  const floatv weight = packet_feather(&params.camera, params.feather_px, column, row) /
                        (packet_angle(&sight, &from_eye) + params.pixel_rad);
  const PacketSums to = {place, count, visible};
  add_light(&to, &around, params.mix, params.photograph, photo_pixels, weight, photo, low, linear, sums,
            best);
}
