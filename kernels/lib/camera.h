// From a pixel back to its ray: the float twin of host/geometry/camera.cpp's ray (same formulas and frames).
#ifndef HYBRID_LIB_CAMERA_H
#define HYBRID_LIB_CAMERA_H
#include "shared/records.h"

// q(s) and dq/ds of the lenses that are no fisheye.
static inline float2 camera_radial_slope(const CameraRecord* c, float s) {
  const float above = 1.0f + s * (c->k1 + s * (c->k2 + s * c->k3));
  const float above_slope = c->k1 + s * (2.0f * c->k2 + 3.0f * s * c->k3);
  if (c->lens != CAMERA_RATIONAL) return (float2)(above, above_slope);
  const float below = 1.0f + s * (c->k4 + s * (c->k5 + s * c->k6));
  const float below_slope = c->k4 + s * (2.0f * c->k5 + 3.0f * s * c->k6);
  return (float2)(above / below, (above_slope - above / below * below_slope) / below);
}

// Direction in the camera's frame whose fisheye image is `target`: Newton's method on the angle, bisection
// where it would leave the bracket. NaN beyond the largest angle.
static inline float3 camera_fisheye_direction(const CameraRecord* c, float2 target) {
  const float largest = atan(sqrt(c->max_radius2)), radius = length(target);
  float low = 0.0f, high = largest, angle = min(radius, largest);
  float error = INFINITY;
  for (int i = 0; i < 20 && fabs(error) > 1e-7f * (1.0f + radius); ++i) {
    const float t = angle * angle;
    error = angle * (1.0f + t * (c->k1 + t * (c->k2 + t * (c->k3 + t * c->k4)))) - radius;
    if (error > 0.0f) high = angle;
    if (error < 0.0f) low = angle;
    angle -= error / (1.0f + t * (3.0f * c->k1 + t * (5.0f * c->k2 + t * (7.0f * c->k3 + t * 9.0f * c->k4))));
    if (!(angle >= low && angle <= high)) angle = 0.5f * (low + high);
  }
  if (!(fabs(error) < 1e-4f && angle < largest)) return (float3)(NAN);
  const float2 side = radius > 0.0f ? target * (sin(angle) / radius) : (float2)(0.0f);
  return (float3)(side.x, side.y, cos(angle));
}

static inline float2 camera_distort_error(const CameraRecord* c, float2 p, float2 radial, float2 target) {
  const float s = dot(p, p);
  return (float2)(p.x * radial.x + 2.0f * c->p1 * p.x * p.y + c->p2 * (s + 2.0f * p.x * p.x),
                  p.y * radial.x + 2.0f * c->p2 * p.x * p.y + c->p1 * (s + 2.0f * p.y * p.y)) -
         target;
}

// Direction (x, y, 1) whose image is `target`: Newton's method, kept inside the radius of growth. NaN beyond
// it.
static inline float3 camera_brown_direction(const CameraRecord* c, float2 target) {
  const float inside = 0.999f * c->max_radius2;
  float2 p = target;
  if (dot(p, p) > inside) p *= sqrt(0.8f * inside / dot(p, p));
  float2 radial = camera_radial_slope(c, dot(p, p));
  float2 error = camera_distort_error(c, p, radial, target);
  for (int i = 0; i < 20 && dot(error, error) > 1e-15f; ++i) {
    const float slope = 2.0f * radial.y;
    const float xx = radial.x + p.x * p.x * slope + 2.0f * c->p1 * p.y + 6.0f * c->p2 * p.x;
    const float yy = radial.x + p.y * p.y * slope + 2.0f * c->p2 * p.x + 6.0f * c->p1 * p.y;
    const float xy = p.x * p.y * slope + 2.0f * c->p1 * p.x + 2.0f * c->p2 * p.y;
    p -= (float2)(yy * error.x - xy * error.y, xx * error.y - xy * error.x) / (xx * yy - xy * xy);
    if (dot(p, p) > inside) p *= sqrt(inside / dot(p, p));
    radial = camera_radial_slope(c, dot(p, p));
    error = camera_distort_error(c, p, radial, target);
  }
  // A thousandth of the focal length would be visible; rounding stays far below it.
  if (!(dot(error, error) < 1e-8f && dot(p, p) < c->max_radius2)) return (float3)(NAN);
  return (float3)(p.x, p.y, 1.0f);
}

// Direction of a panorama's pixel position, `target` relative to the principal point in radians (rows of a
// cylinder: in radii). NaN above the zenith and below the nadir.
static inline float3 camera_panorama_direction(const CameraRecord* c, float2 target) {
  const float level_x = sin(target.x), level_z = cos(target.x);
  if (c->lens == CAMERA_CYLINDRICAL) return (float3)(level_x, target.y, level_z);
  if (!(fabs(target.y) <= 1.5707964f)) return (float3)(NAN);
  return (float3)(cos(target.y) * level_x, sin(target.y), cos(target.y) * level_z);
}

// Unit world direction of a pixel position. NaN where no direction projects there: beyond the radius at which
// the distortion folds back, or beyond a panorama's poles.
static inline float3 camera_ray(const CameraRecord* c, float2 pixel) {
  const float2 target = (float2)((pixel.x - c->cx) / c->fx, (pixel.y - c->cy) / c->fy);
  const float3 p = c->lens >= CAMERA_SPHERICAL ? camera_panorama_direction(c, target)
                   : c->lens == CAMERA_FISHEYE ? camera_fisheye_direction(c, target)
                                               : camera_brown_direction(c, target);
  const float* m = c->rotation;  // world_from_cam is its transpose
  return normalize((float3)(m[0] * p.x + m[3] * p.y + m[6] * p.z, m[1] * p.x + m[4] * p.y + m[7] * p.z,
                            m[2] * p.x + m[5] * p.y + m[8] * p.z));
}

#endif
