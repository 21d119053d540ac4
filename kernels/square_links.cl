// Join tests of METHOD 3 between each square and its right and lower neighbour (paper 2.1; the out-of-plane
// test is Stamos and Allen's, without which parallel steps merge).
// Linked when both squares are planar and
//   angle between normals < alpha = max(alpha0, k sigma_n),
//   distance of centroids < reach * (r cos(el) | r) / max(|n.u|, c) + k sigma  (right | lower),
//   max(|r12.n1|, |r12.n2|) < k sqrt(sigma^2 + (|r12| sigma_n)^2),
// with sigma_n of the two squares added in squares, r their mean range and n.u the more oblique one.
// Mapping: one work-item per square.
// in:  squares[rows * cols], row-major.
// out: links[2 * rows * cols]: [2i] right, [2i + 1] lower neighbour: the worse of angle and offset over its
//      limit, in [0, 1), or -1 where there is no link.
// Params: SquareLinkParams. Edges: right of the last column is the first one when wraps is set, else no link;
// below the last row no link. Cost: 240 bytes, about 120 operations per square.
// Reference twin: tests/reference/square_links.cpp.
#include "shared/params_square_links.h"
#include "shared/records.h"

static inline float link_cost(const global SquareRecord* a, const global SquareRecord* b,
                              SquareLinkParams params, int right) {
  if (a->state != SQUARE_PLANAR || b->state != SQUARE_PLANAR) return -1.0f;
  const float3 na = (float3)(a->normal[0], a->normal[1], a->normal[2]);
  const float3 nb = (float3)(b->normal[0], b->normal[1], b->normal[2]);
  const float3 ca = (float3)(a->centroid[0], a->centroid[1], a->centroid[2]);
  const float3 cb = (float3)(b->centroid[0], b->centroid[1], b->centroid[2]);
  const float3 step = cb - ca;
  const float3 turn = nb - na;
  const float distance = sqrt(dot(step, step));
  const float variance_normal = a->sigma_normal * a->sigma_normal + b->sigma_normal * b->sigma_normal;

  // The chord keeps its digits at small angles, where acos of the cosine has lost them.
  const float angle = 2.0f * asin(fmin(1.0f, 0.5f * sqrt(dot(turn, turn))));
  const float angle_limit = fmax(params.angle_rad, params.angle_sigmas * sqrt(variance_normal));

  const float range_a = sqrt(dot(ca, ca)), range_b = sqrt(dot(cb, cb));
  const float cosine = fmin(fabs(dot(na, ca)) / range_a, fabs(dot(nb, cb)) / range_b);
  const float arm = right ? 0.5f * (sqrt(ca.x * ca.x + ca.y * ca.y) + sqrt(cb.x * cb.x + cb.y * cb.y))
                          : 0.5f * (range_a + range_b);
  const float reach = arm * (right ? params.col_reach_rad : params.row_reach_rad);
  const float distance_limit =
      reach / fmax(cosine, params.min_cosine) + params.offset_sigmas * params.sigma_m;

  const float offset = fmax(fabs(dot(step, na)), fabs(dot(step, nb)));
  const float offset_limit =
      params.offset_sigmas * sqrt(params.sigma_m * params.sigma_m + distance * distance * variance_normal);
  const int linked = angle < angle_limit && distance < distance_limit && offset < offset_limit;
  return linked ? fmax(angle / angle_limit, offset / offset_limit) : -1.0f;
}

kernel void square_links(SquareLinkParams params, global const SquareRecord* restrict squares,
                         global float* restrict links) {
  const uint i = get_global_id(0);
  if (i >= params.rows * params.cols) return;
  const uint row = i / params.cols, col = i % params.cols;
  const int last = col + 1u == params.cols;
  const uint right = last ? i - col : i + 1u;
  float right_cost = -1.0f, lower_cost = -1.0f;
  if (!last || params.wraps) right_cost = link_cost(squares + i, squares + right, params, 1);
  if (row + 1u < params.rows) lower_cost = link_cost(squares + i, squares + i + params.cols, params, 0);
  links[2u * i] = right_cost;
  links[2u * i + 1u] = lower_cost;
}
