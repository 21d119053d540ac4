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

// Pixel positions of world points (top left pixel's centre = 0.5, 0.5) and which of them the camera sees, as
// a mask. NaN points are not seen; the positions of unseen points mean nothing.
static inline intv packet_project(const CameraRecord* c, floatv px, floatv py, floatv pz, floatv* column,
                                  floatv* row) {
  const float* m = c->rotation;
  const floatv x = m[0] * px + m[1] * py + m[2] * pz + c->translation[0];
  const floatv y = m[3] * px + m[4] * py + m[5] * pz + c->translation[1];
  const floatv z = m[6] * px + m[7] * py + m[8] * pz + c->translation[2];
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
