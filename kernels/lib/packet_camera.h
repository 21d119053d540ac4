// Projection of VW points at a time: the float twin of host/geometry/camera.cpp's project (same formulas and
// frames). c->lens is one value for a whole launch, so its branches cost nothing where they are not taken.
#ifndef HYBRID_LIB_PACKET_CAMERA_H
#define HYBRID_LIB_PACKET_CAMERA_H
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

#endif
