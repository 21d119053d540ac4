// Records that arrays on the device hold. Floats are metres relative to the scene's or scan's local origin.
#ifndef HYBRID_SHARED_RECORDS_H
#define HYBRID_SHARED_RECORDS_H
#include "shared/layout.h"

// A photograph's or view's camera; model and frames as in host/geometry/camera.hpp.
#define CAMERA_POLYNOMIAL 0u  // k1, k2, p1, p2 (the rest is 0): the common case
#define CAMERA_RATIONAL 1u    // k1 to k6, p1, p2
#define CAMERA_FISHEYE 2u     // k1 to k4
#define CAMERA_SPHERICAL 3u   // panoramas: from here on no distortion
#define CAMERA_CYLINDRICAL 4u

#define CAMERA_WRAPS 1u     // a panorama of a full turn: left and right borders are one
#define CAMERA_ZENITH 2u    // a panorama whose upper border is the zenith: no border
#define CAMERA_NADIR 4u     // the same of its lower border
#define CAMERA_HAS_MASK 8u  // a photograph some of whose pixels are none: alpha 0

typedef struct CameraRecord {
  float rotation[9];     // cam_from_world, row-major
  float translation[3];  // cam_from_world
  float centre[3];       // in the world
  float fx, fy, cx, cy;
  float k1, k2, p1, p2;
  float max_radius2;  // r2 up to which the distortion is monotonic
  HYBRID_UINT width, height;
  HYBRID_UINT lens;  // CAMERA_...
  float k3, k4, k5, k6;
  HYBRID_UINT flags;  // CAMERA_WRAPS ...
} CameraRecord;
LAYOUT_CHECK(CameraRecord, 128);

// What became of one square of n x n samples (METHOD 2).
#define SQUARE_UNDERSAMPLED 0u
#define SQUARE_NON_PLANAR 1u
#define SQUARE_PLANAR 2u

typedef struct SquareRecord {
  float normal[3];  // unit, towards the scanner; plane: normal . x = offset, scan frame, metres
  float offset;
  float centroid[3];   // mean of the inliers
  float rms;           // of the inliers' orthogonal distances to the plane
  float scatter[6];    // sum over the inliers of (p - centroid)(p - centroid)^T: xx xy xz yy yz zz, m2
  float sigma_normal;  // standard deviation of the normal's direction, rad
  HYBRID_UINT valid;   // samples with a return or interpolated
  HYBRID_UINT inliers;
  HYBRID_UINT state;  // SQUARE_...; all floats are 0 unless SQUARE_PLANAR
  float pad[2];
} SquareRecord;
LAYOUT_CHECK(SquareRecord, 80);

#endif
