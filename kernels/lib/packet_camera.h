// Projection of VW points at a time: the float twin of host/geometry/camera.cpp's project (same formulas and
// frames). c->lens is one value for a whole launch, so its branches cost nothing where they are not taken.
#ifndef HYBRID_LIB_PACKET_CAMERA_H
#define HYBRID_LIB_PACKET_CAMERA_H
#include "lib/camera.h"
#include "lib/packet.h"
#include "shared/records.h"

// The factor q of a direction (x, y) = (X, Y) / Z by s = x^2 + y^2, VW at a time.
static inline floatv packet_radial(const CameraRecord* c, floatv s) {
  if (c->lens == CAMERA_FISHEYE) {
    const floatv radius = sqrt(s), angle = atan(radius), t = angle * angle;
    const floatv bent = angle * (1.0f + t * (c->k1 + t * (c->k2 + t * (c->k3 + t * c->k4))));
    return PICK(MASK(s > 0.0f), bent / radius, (floatv)(1.0f));
  }
  if (c->lens == CAMERA_RATIONAL)
    return (1.0f + s * (c->k1 + s * (c->k2 + s * c->k3))) / (1.0f + s * (c->k4 + s * (c->k5 + s * c->k6)));
  return 1.0f + s * (c->k1 + s * c->k2);
}

// Arc tangent of y / x in all quadrants, to 4e-7 (Cephes atanf): the same bits on every device and for every
// VW. 0 for (0, 0).
static inline floatv packet_atan2(floatv y, floatv x) {
  const floatv across = fabs(x), up = fabs(y);
  const floatv longer = max(across, up), shorter = min(across, up);
  const floatv ratio = shorter / PICK(MASK(longer > 0.0f), longer, (floatv)(1.0f));
  const intv steep = MASK(ratio > 0.41421356f);
  const floatv t = PICK(steep, (ratio - 1.0f) / (ratio + 1.0f), ratio);
  const floatv z = t * t;
  const floatv series =
      ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z - 3.33329491539e-1f;
  floatv angle = series * z * t + t + PICK(steep, (floatv)(0.78539816f), (floatv)(0.0f));
  angle = PICK(MASK(up > across), 1.57079633f - angle, angle);
  angle = PICK(MASK(x < 0.0f), 3.14159265f - angle, angle);
  return PICK(MASK(y < 0.0f), -angle, angle);
}

// What packet_project does, of points in a panorama's frame.
static inline intv packet_project_panorama(const CameraRecord* c, floatv x, floatv y, floatv z,
                                           floatv* column, floatv* row) {
  const float width = (float)c->width, height = (float)c->height, turn = 6.28318531f * c->fx;
  const floatv level = sqrt(x * x + z * z);
  floatv across = c->fx * packet_atan2(x, z) + c->cx;
  across = PICK(MASK(across < 0.0f), across + turn, across);
  across = PICK(MASK(across >= turn), across - turn, across);
  if (c->flags & CAMERA_WRAPS)  // rounding
    across = max(PICK(MASK(across >= width), across - width, across), (floatv)(0.0f));
  floatv down;
  intv somewhere;
  if (c->lens == CAMERA_CYLINDRICAL) {
    somewhere = MASK(level > 0.0f);
    down = c->fy * (y / PICK(somewhere, level, (floatv)(1.0f))) + c->cy;
  } else {
    somewhere = MASK(level + fabs(y) > 0.0f);
    down = c->fy * packet_atan2(y, level) + c->cy;
    if (c->flags & CAMERA_ZENITH) down = max(down, (floatv)(0.0f));
    if (c->flags & CAMERA_NADIR) down = min(down, (floatv)(nextafter(height, 0.0f)));
  }
  *column = across;
  *row = down;
  return somewhere & MASK(across >= 0.0f) & MASK(down >= 0.0f) & MASK(across < width) & MASK(down < height);
}

// Pixel positions of world points (top left pixel's centre = 0.5, 0.5) and which of them the camera sees, as
// a mask. NaN points are not seen; the positions of unseen points mean nothing.
static inline intv packet_project(const CameraRecord* c, floatv px, floatv py, floatv pz, floatv* column,
                                  floatv* row) {
  const float* m = c->rotation;
  const floatv x = m[0] * px + m[1] * py + m[2] * pz + c->translation[0];
  const floatv y = m[3] * px + m[4] * py + m[5] * pz + c->translation[1];
  const floatv z = m[6] * px + m[7] * py + m[8] * pz + c->translation[2];
  if (c->lens >= CAMERA_SPHERICAL) return packet_project_panorama(c, x, y, z, column, row);
  const intv before = MASK(z > 0.0f);
  const floatv u = x / PICK(before, z, (floatv)(1.0f)), v = y / PICK(before, z, (floatv)(1.0f));
  const floatv r2 = u * u + v * v;
  const floatv radial = packet_radial(c, r2);
  *column = c->fx * (u * radial + 2.0f * c->p1 * u * v + c->p2 * (r2 + 2.0f * u * u)) + c->cx;
  *row = c->fy * (v * radial + 2.0f * c->p2 * u * v + c->p1 * (r2 + 2.0f * v * v)) + c->cy;
  return before & MASK(r2 < c->max_radius2) & MASK(*column >= 0.0f) & MASK(*row >= 0.0f) &
         MASK(*column < (float)c->width) & MASK(*row < (float)c->height);
}

// Directions (x, y, 1) of a perspective lens without fisheye whose images are the targets:
// camera_brown_direction for VW positions, each lane iterating as often as it would alone. NaN where no
// direction projects there.
static inline void packet_brown(const CameraRecord* c, floatv target_x, floatv target_y, floatv* x,
                                floatv* y) {
  const float inside = 0.999f * c->max_radius2;
  floatv px = target_x, py = target_y, s = px * px + py * py;
  const floatv pull = PICK(MASK(s > inside), sqrt(0.8f * inside / s), (floatv)(1.0f));
  px *= pull, py *= pull;
  floatv error2 = (floatv)(INFINITY);
  for (int i = 0;; ++i) {
    s = px * px + py * py;
    const floatv above = 1.0f + s * (c->k1 + s * (c->k2 + s * c->k3));
    const floatv below =
        c->lens == CAMERA_RATIONAL ? 1.0f + s * (c->k4 + s * (c->k5 + s * c->k6)) : (floatv)(1.0f);
    const floatv radial = above / below;
    const floatv error_x = px * radial + 2.0f * c->p1 * px * py + c->p2 * (s + 2.0f * px * px) - target_x;
    const floatv error_y = py * radial + 2.0f * c->p2 * px * py + c->p1 * (s + 2.0f * py * py) - target_y;
    error2 = error_x * error_x + error_y * error_y;
    const intv open = MASK(error2 > 1e-15f);
    if (i == 20 || !ANY(open)) break;
    floatv slope = c->k1 + s * (2.0f * c->k2 + 3.0f * s * c->k3);
    if (c->lens == CAMERA_RATIONAL)
      slope = (slope - radial * (c->k4 + s * (2.0f * c->k5 + 3.0f * s * c->k6))) / below;
    slope *= 2.0f;
    const floatv xx = radial + px * px * slope + 2.0f * c->p1 * py + 6.0f * c->p2 * px;
    const floatv yy = radial + py * py * slope + 2.0f * c->p2 * px + 6.0f * c->p1 * py;
    const floatv xy = px * py * slope + 2.0f * c->p1 * px + 2.0f * c->p2 * py;
    const floatv determinant = xx * yy - xy * xy;
    floatv next_x = px - (yy * error_x - xy * error_y) / determinant;
    floatv next_y = py - (xx * error_y - xy * error_x) / determinant;
    s = next_x * next_x + next_y * next_y;
    const floatv back = PICK(MASK(s > inside), sqrt(inside / s), (floatv)(1.0f));
    px = PICK(open, next_x * back, px);
    py = PICK(open, next_y * back, py);
  }
  // A thousandth of the focal length would be visible; rounding stays far below it.
  const intv found = MASK(error2 < 1e-8f) & MASK(s < c->max_radius2);
  *x = PICK(found, px, (floatv)(NAN));
  *y = PICK(found, py, (floatv)(NAN));
}

// Unit world directions of pixel positions: camera_ray for VW of them. NaN where it gives NaN.
static inline void packet_camera_rays(const CameraRecord* c, floatv column, floatv row, floatv* x, floatv* y,
                                      floatv* z) {
  if (c->lens >= CAMERA_SPHERICAL || c->lens == CAMERA_FISHEYE) {
    float columns[VW], rows[VW], xs[VW], ys[VW], zs[VW];
    STORE_LANES(column, columns);
    STORE_LANES(row, rows);
    for (uint lane = 0u; lane < VW; ++lane) {
      const float3 ray = camera_ray(c, (float2)(columns[lane], rows[lane]));
      xs[lane] = ray.x, ys[lane] = ray.y, zs[lane] = ray.z;
    }
    *x = LOAD_LANES(xs);
    *y = LOAD_LANES(ys);
    *z = LOAD_LANES(zs);
    return;
  }
  floatv px, py;
  packet_brown(c, (column - c->cx) / c->fx, (row - c->cy) / c->fy, &px, &py);
  const float* m = c->rotation;  // world_from_cam is its transpose
  const floatv wx = m[0] * px + m[3] * py + m[6], wy = m[1] * px + m[4] * py + m[7],
               wz = m[2] * px + m[5] * py + m[8];
  const floatv length = sqrt(wx * wx + wy * wy + wz * wz);
  *x = wx / length;
  *y = wy / length;
  *z = wz / length;
}

#endif
