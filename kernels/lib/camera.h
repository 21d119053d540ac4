// Projection and its inverse: the float twin of host/geometry/camera.cpp (same model, same conventions).
#ifndef HYBRID_LIB_CAMERA_H
#define HYBRID_LIB_CAMERA_H
#include "shared/records.h"

static inline float2 camera_distort(const CameraRecord* c, float2 p) {
  const float r2 = p.x * p.x + p.y * p.y;
  const float radial = 1.0f + r2 * (c->k1 + r2 * c->k2);
  return (float2)(p.x * radial + 2.0f * c->p1 * p.x * p.y + c->p2 * (r2 + 2.0f * p.x * p.x),
                  p.y * radial + 2.0f * c->p2 * p.x * p.y + c->p1 * (r2 + 2.0f * p.y * p.y));
}

// Pixel position of a world point (top left pixel's centre = 0.5, 0.5). Returns 0 when the camera does not
// see it.
static inline int camera_project(const CameraRecord* c, float3 point, float2* pixel, float* depth) {
  const float* m = c->rotation;
  const float x = m[0] * point.x + m[1] * point.y + m[2] * point.z + c->translation[0];
  const float y = m[3] * point.x + m[4] * point.y + m[5] * point.z + c->translation[1];
  const float z = m[6] * point.x + m[7] * point.y + m[8] * point.z + c->translation[2];
  *depth = z;
  if (!(z > 0.0f)) return 0;
  const float2 p = (float2)(x / z, y / z);
  if (!(p.x * p.x + p.y * p.y < c->max_radius2)) return 0;
  const float2 d = camera_distort(c, p);
  *pixel = (float2)(c->fx * d.x + c->cx, c->fy * d.y + c->cy);
  return pixel->x >= 0.0f && pixel->y >= 0.0f && pixel->x < (float)c->width && pixel->y < (float)c->height;
}

// Unit world direction of a pixel position: Newton's method on the distortion, as on the host. NaN where no
// direction projects there: beyond the radius at which the distortion folds back.
static inline float3 camera_ray(const CameraRecord* c, float2 pixel) {
  const float2 target = (float2)((pixel.x - c->cx) / c->fx, (pixel.y - c->cy) / c->fy);
  float2 p = target, error = camera_distort(c, p) - target;
  for (int i = 0; i < 10 && dot(error, error) > 1e-15f; ++i) {
    const float r2 = dot(p, p);
    const float radial = 1.0f + r2 * (c->k1 + r2 * c->k2), slope = 2.0f * (c->k1 + 2.0f * c->k2 * r2);
    const float xx = radial + p.x * p.x * slope + 2.0f * c->p1 * p.y + 6.0f * c->p2 * p.x;
    const float yy = radial + p.y * p.y * slope + 2.0f * c->p2 * p.x + 6.0f * c->p1 * p.y;
    const float xy = p.x * p.y * slope + 2.0f * c->p1 * p.x + 2.0f * c->p2 * p.y;
    p -= (float2)(yy * error.x - xy * error.y, xx * error.y - xy * error.x) / (xx * yy - xy * xy);
    error = camera_distort(c, p) - target;
  }
  // A thousandth of the focal length would be visible; rounding stays far below it.
  if (!(dot(error, error) < 1e-8f && dot(p, p) < c->max_radius2)) return (float3)(NAN);
  const float* m = c->rotation;  // world_from_cam is its transpose
  const float3 ray = (float3)(m[0] * p.x + m[3] * p.y + m[6], m[1] * p.x + m[4] * p.y + m[7],
                              m[2] * p.x + m[5] * p.y + m[8]);
  return normalize(ray);
}

#endif
