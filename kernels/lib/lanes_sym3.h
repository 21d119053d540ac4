// Symmetric 3 x 3 matrices, one per lane. Structs go out through pointers: oclgrind's compiler stumbles over
// inlined functions that return them.
#ifndef HYBRID_LIB_LANES_SYM3_H
#define HYBRID_LIB_LANES_SYM3_H
#include "lib/lanes.h"

typedef struct LanesSym3 {
  floatv xx, xy, xz, yy, yz, zz;
} LanesSym3;

typedef struct LanesVec3 {
  floatv x, y, z;
} LanesVec3;

static inline floatv lanes_dot(LanesVec3 a, LanesVec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// One Jacobi rotation in the plane of axes p and q; r is the third. Golub and Van Loan, algorithm 8.5.1: the
// smaller of the two angles, so that cosine >= 1/sqrt(2); an entry already 0 turns nothing.
static inline void lanes_rotate(floatv* pp, floatv* qq, floatv* pq, floatv* rp, floatv* rq, LanesVec3* p,
                                LanesVec3* q) {
  const floatv theta = (*qq - *pp) / (2.0f * *pq);
  const floatv size = 1.0f / (fabs(theta) + sqrt(theta * theta + 1.0f));
  const floatv tangent = *pq == 0.0f ? (floatv)(0.0f) : (theta < 0.0f ? -size : size);
  const floatv cosine = 1.0f / sqrt(tangent * tangent + 1.0f), sine = tangent * cosine;
  *pp -= tangent * *pq;
  *qq += tangent * *pq;
  *pq = 0.0f;
  const floatv at_p = *rp, at_q = *rq;
  *rp = cosine * at_p - sine * at_q;
  *rq = sine * at_p + cosine * at_q;
  const LanesVec3 v = *p, w = *q;
  p->x = cosine * v.x - sine * w.x;
  p->y = cosine * v.y - sine * w.y;
  p->z = cosine * v.z - sine * w.z;
  q->x = sine * v.x + cosine * w.x;
  q->y = sine * v.y + cosine * w.y;
  q->z = sine * v.z + cosine * w.z;
}

// Unit eigenvector of the smallest eigenvalue of a positive semidefinite matrix: five cyclic Jacobi sweeps,
// which converge quadratically and need no care for equal eigenvalues.
static inline void lanes_smallest_eigenvector(LanesSym3 m, LanesVec3* v) {
  LanesVec3 a = {1.0f, 0.0f, 0.0f}, b = {0.0f, 1.0f, 0.0f}, c = {0.0f, 0.0f, 1.0f};
  for (int sweep = 0; sweep < 5; ++sweep) {
    lanes_rotate(&m.xx, &m.yy, &m.xy, &m.xz, &m.yz, &a, &b);
    lanes_rotate(&m.xx, &m.zz, &m.xz, &m.xy, &m.yz, &a, &c);
    lanes_rotate(&m.yy, &m.zz, &m.yz, &m.xy, &m.xz, &b, &c);
  }
  const intv b_less = m.yy < m.xx;
  const floatv least = b_less ? m.yy : m.xx;
  const intv c_less = m.zz < least;
  v->x = c_less ? c.x : (b_less ? b.x : a.x);
  v->y = c_less ? c.y : (b_less ? b.y : a.y);
  v->z = c_less ? c.z : (b_less ? b.z : a.z);
  const floatv length = sqrt(lanes_dot(*v, *v));
  v->x /= length;
  v->y /= length;
  v->z /= length;
}

#endif
