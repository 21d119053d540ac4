// A plane per square of n x n samples by RANSAC, refitted to its inliers (Lamond and Watson 2004,
// section 2.1; METHOD 2). Mapping: one work-item per VW neighbouring squares of a square row, lane = square;
// 1-D over the tile. in:  x, y, z [rows * cols]  points in the scan frame, metres, row-major; NaN = no sample
//      triplets[SQUARE_TRIPLETS]  three samples of a square, index row * n + col, packed a | b << 8 | c << 16
// out: records[square rows * square cols] of the tile; partial squares at the right and bottom edge included,
// their
//      missing samples count as invalid
// A sample is an inlier when |n.p - d| <= t max(|n.u|, c_min), u its ray. The test planes of a block of
// SQUARE_BLOCK squares use the same triplets, drawn without replacement from the table by (seed, block in the
// image), so that tiles change nothing; a triplet with an invalid sample or nearly in line counts for
// nothing. Scores among planes with enough inliers: paper = sum of the inliers' distances; msac = sum of
// min(distance, t) along the ray, for which the square's own |n.u| stands. The lowest wins; equal: the
// earlier plane. Refit: least squares weighted 1 / max(|n.u|, c_min)^2 on the inliers, kept unless it loses
// too many of them. fit = eigen (the paper's rejected baseline): unweighted least squares on all valid
// samples instead. Defines: VW lanes, SQUARE n (3..16). Coordinates are taken from the square's first valid
// sample, so that centimetres at 100 m keep their digits. Cost: 12 n^2 bytes read, 80 written, about n^2 (12
// K + 90) flops per square. Reference twin: tests/reference/square_planes.cpp.
#include "lib/lanes_sym3.h"
#include "lib/random.h"
#include "shared/params_square_planes.h"
#include "shared/records.h"

#ifndef SQUARE
#define SQUARE 5
#endif
#define SAMPLES (SQUARE * SQUARE)
#define PLANES 4  // test planes per pass over the samples: as many as registers hold

typedef struct Squares {
  floatv x[SAMPLES], y[SAMPLES], z[SAMPLES];  // from `origin`; NaN invalid
  floatv inverse_range[SAMPLES];
  LanesVec3 origin;
  floatv valid;
} Squares;

// normal . x = offset with x from the square's origin; `along` = normal . origin.
typedef struct Planes {
  LanesVec3 normal;
  floatv offset, along;
} Planes;

// values[at + l * SQUARE] for the first `usable` lanes l, NaN for the others.
static inline floatv gather(global const float* values, uint at, uint usable) {
  float lane[VW];
  if (usable == VW)
    for (uint l = 0; l < VW; ++l) lane[l] = values[at + l * SQUARE];
  else
    for (uint l = 0; l < VW; ++l) lane[l] = l < usable ? values[at + l * SQUARE] : NAN;
  return LOAD_LANES(lane);
}

static void load(Squares* s, global const float* x, global const float* y, global const float* z, uint rows,
                 uint cols, uint first_row, uint first_col) {
  s->origin.x = s->origin.y = s->origin.z = (floatv)(NAN);
  s->valid = (floatv)(0.0f);
  for (uint r = 0; r < SQUARE; ++r)
    for (uint c = 0; c < SQUARE; ++c) {
      const uint i = r * SQUARE + c, row = first_row + r, col = first_col + c;
      // Lanes whose column lies inside the tile come first.
      uint usable = row < rows && col < cols ? (cols - col + SQUARE - 1u) / SQUARE : 0u;
      if (usable > VW) usable = VW;
      const uint at = row * cols + col;
      const floatv px = gather(x, at, usable), py = gather(y, at, usable), pz = gather(z, at, usable);
      const intv first = (s->origin.x != s->origin.x) & (px == px);
      s->origin.x = first ? px : s->origin.x;
      s->origin.y = first ? py : s->origin.y;
      s->origin.z = first ? pz : s->origin.z;
      s->valid += px == px ? (floatv)(1.0f) : (floatv)(0.0f);
      s->x[i] = px;
      s->y[i] = py;
      s->z[i] = pz;
      s->inverse_range[i] = 1.0f / sqrt(px * px + py * py + pz * pz);
    }
  for (uint i = 0; i < SAMPLES; ++i) {
    s->x[i] -= s->origin.x;
    s->y[i] -= s->origin.y;
    s->z[i] -= s->origin.z;
  }
}

static inline void plane_through(const Squares* s, uint triplet, Planes* p) {
  const uint a = triplet & 255u, b = (triplet >> 8) & 255u, c = (triplet >> 16) & 255u;
  const LanesVec3 u = {s->x[b] - s->x[a], s->y[b] - s->y[a], s->z[b] - s->z[a]};
  const LanesVec3 v = {s->x[c] - s->x[a], s->y[c] - s->y[a], s->z[c] - s->z[a]};
  const LanesVec3 n = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  const floatv area = lanes_dot(n, n);
  // A triangle thinner than a thousandth has no direction worth testing: NaN, which is inlier to nothing.
  const intv sliver = area < 1e-6f * lanes_dot(u, u) * lanes_dot(v, v);
  const floatv scale = sliver ? (floatv)(NAN) : 1.0f / sqrt(area);
  p->normal.x = n.x * scale;
  p->normal.y = n.y * scale;
  p->normal.z = n.z * scale;
  p->offset = p->normal.x * s->x[a] + p->normal.y * s->y[a] + p->normal.z * s->z[a];
  p->along = lanes_dot(p->normal, s->origin);
}

// max(|n.u|, c_min) of sample i; c_min where the sample or the plane is NaN.
static inline floatv incidence(const Squares* s, const Planes* p, floatv height, uint i, float min_cosine) {
  return lanes_max(fabs(height + p->along) * s->inverse_range[i], (floatv)(min_cosine));
}

static inline floatv height(const Squares* s, const Planes* p, uint i) {
  return p->normal.x * s->x[i] + p->normal.y * s->y[i] + p->normal.z * s->z[i];
}

static inline intv is_inlier(const Squares* s, const Planes* p, uint i, const SquarePlanesParams* params) {
  const floatv h = height(s, p, i);
  return fabs(h - p->offset) <= params->threshold_m * incidence(s, p, h, i, params->min_cosine);
}

// Enough inliers: a share of the valid samples, and three. The slack covers the rounding of the share.
static inline intv qualifies(floatv inliers, floatv valid, float share) {
  return (inliers >= share * valid - 1e-3f) & (inliers >= 3.0f);
}

// The best test plane of each square, NaN where none qualifies.
static void search(const Squares* s, global const uint* triplets, uint block,
                   const SquarePlanesParams* params, Planes* best) {
  const uint start = random_bits(params->seed, block, 0u), stride = random_bits(params->seed, block, 1u) | 1u;
  best->normal.x = best->normal.y = best->normal.z = best->offset = best->along = (floatv)(NAN);
  floatv lowest = (floatv)(INFINITY);
  for (uint h = 0; h < params->hypotheses; h += PLANES) {
    Planes p[PLANES];
    floatv count[PLANES], sum[PLANES];
    for (uint k = 0; k < PLANES; ++k) {
      const uint draw = h + k < params->hypotheses ? h + k : h;  // a repeated plane cannot win
      plane_through(s, triplets[(start + draw * stride) & (SQUARE_TRIPLETS - 1u)], &p[k]);
      count[k] = sum[k] = (floatv)(0.0f);
    }
    for (uint i = 0; i < SAMPLES; ++i)
      for (uint k = 0; k < PLANES; ++k) {
        const floatv along = height(s, &p[k], i), distance = fabs(along - p[k].offset);
        const intv in = distance <= params->threshold_m * incidence(s, &p[k], along, i, params->min_cosine);
        count[k] += in ? (floatv)(1.0f) : (floatv)(0.0f);
        sum[k] += in ? distance : (floatv)(0.0f);
      }
    for (uint k = 0; k < PLANES; ++k) {
      floatv score = sum[k];
      if (params->score == SQUARE_SCORE_MSAC) {
        const floatv inverse = 1.0f / sqrt(lanes_dot(s->origin, s->origin));
        score = sum[k] / lanes_max(fabs(p[k].along) * inverse, (floatv)(params->min_cosine)) +
                (s->valid - count[k]) * params->threshold_m;
      }
      const intv wins = qualifies(count[k], s->valid, params->min_inlier_share) & (score < lowest);
      lowest = wins ? score : lowest;
      best->normal.x = wins ? p[k].normal.x : best->normal.x;
      best->normal.y = wins ? p[k].normal.y : best->normal.y;
      best->normal.z = wins ? p[k].normal.z : best->normal.z;
      best->offset = wins ? p[k].offset : best->offset;
      best->along = wins ? p[k].along : best->along;
    }
  }
}

// Least squares plane through the inliers of `p`, weighted by 1 / incidence^2, or unweighted through all
// valid samples when `p` is 0.
static void fit(const Squares* s, const Planes* p, const SquarePlanesParams* params, Planes* fitted) {
  floatv weights[SAMPLES], total = (floatv)(0.0f);
  LanesVec3 mean = {0.0f, 0.0f, 0.0f};
  for (uint i = 0; i < SAMPLES; ++i) {
    floatv w = s->x[i] == s->x[i] ? (floatv)(1.0f) : (floatv)(0.0f);
    if (p) {
      const floatv cosine = incidence(s, p, height(s, p, i), i, params->min_cosine);
      w = is_inlier(s, p, i, params) ? 1.0f / (cosine * cosine) : (floatv)(0.0f);
    }
    weights[i] = w;
    total += w;
    mean.x += w > 0.0f ? w * s->x[i] : (floatv)(0.0f);
    mean.y += w > 0.0f ? w * s->y[i] : (floatv)(0.0f);
    mean.z += w > 0.0f ? w * s->z[i] : (floatv)(0.0f);
  }
  mean.x /= total;
  mean.y /= total;
  mean.z /= total;
  LanesSym3 m = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  for (uint i = 0; i < SAMPLES; ++i) {
    const intv used = weights[i] > 0.0f;
    const floatv dx = used ? s->x[i] - mean.x : (floatv)(0.0f);
    const floatv dy = used ? s->y[i] - mean.y : (floatv)(0.0f);
    const floatv dz = used ? s->z[i] - mean.z : (floatv)(0.0f);
    const floatv wx = weights[i] * dx, wy = weights[i] * dy;
    m.xx += wx * dx;
    m.xy += wx * dy;
    m.xz += wx * dz;
    m.yy += wy * dy;
    m.yz += wy * dz;
    m.zz += weights[i] * dz * dz;
  }
  lanes_smallest_eigenvector(m, &fitted->normal);
  fitted->offset = lanes_dot(fitted->normal, mean);
  fitted->along = lanes_dot(fitted->normal, s->origin);
}

static floatv count_inliers(const Squares* s, const Planes* p, const SquarePlanesParams* params) {
  floatv count = (floatv)(0.0f);
  for (uint i = 0; i < SAMPLES; ++i) count += is_inlier(s, p, i, params) ? (floatv)(1.0f) : (floatv)(0.0f);
  return count;
}

// Standard deviation of the normal's direction: noise across the plane over the inliers' extent along both of
// its axes, sigma^2 (1/l1 + 1/l2) = sigma^2 (l1 + l2) / (l1 l2), l the in-plane eigenvalues of the scatter.
// The noise is what the residuals show, but no less than the range noise seen at this incidence.
static inline floatv direction_sigma(LanesSym3 m, LanesVec3 n, floatv residuals2, floatv inliers,
                                     floatv noise) {
  const floatv quadratic = n.x * n.x * m.xx + n.y * n.y * m.yy + n.z * n.z * m.zz +
                           2.0f * (n.x * n.y * m.xy + n.x * n.z * m.xz + n.y * n.z * m.yz);
  const floatv sum = m.xx + m.yy + m.zz - quadratic;
  const floatv product =
      n.x * n.x * (m.yy * m.zz - m.yz * m.yz) + n.y * n.y * (m.xx * m.zz - m.xz * m.xz) +
      n.z * n.z * (m.xx * m.yy - m.xy * m.xy) +
      2.0f * (n.x * n.y * (m.xz * m.yz - m.xy * m.zz) + n.x * n.z * (m.xy * m.yz - m.xz * m.yy) +
              n.y * n.z * (m.xy * m.xz - m.yz * m.xx));
  const floatv freedom = lanes_max(inliers - 3.0f, (floatv)(1.0f));
  const floatv variance = lanes_max(residuals2 / freedom, noise * noise) * sum / product;
  // No extent along one axis: any direction, half a turn.
  return product > 0.0f ? (variance < 10.0f ? sqrt(variance) : (floatv)(M_PI_F)) : (floatv)(M_PI_F);
}

#define PUT(member, value)                                          \
  do {                                                              \
    STORE_LANES((floatv)(planar ? (value) : (floatv)(0.0f)), lane); \
    for (uint l = 0; l < count; ++l) out[l].member = lane[l];       \
  } while (0)
#define PUT_COUNT(member, value)                                    \
  do {                                                              \
    STORE_LANES((floatv)(value), lane);                             \
    for (uint l = 0; l < count; ++l) out[l].member = (uint)lane[l]; \
  } while (0)

static void describe(const Squares* s, Planes p, floatv inliers, const SquarePlanesParams* params,
                     global SquareRecord* out, uint count) {
  LanesVec3 mean = {0.0f, 0.0f, 0.0f};
  for (uint i = 0; i < SAMPLES; ++i) {
    const intv in = is_inlier(s, &p, i, params);
    mean.x += in ? s->x[i] : (floatv)(0.0f);
    mean.y += in ? s->y[i] : (floatv)(0.0f);
    mean.z += in ? s->z[i] : (floatv)(0.0f);
  }
  mean.x /= inliers;
  mean.y /= inliers;
  mean.z /= inliers;
  LanesSym3 m = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  floatv residuals2 = (floatv)(0.0f);
  for (uint i = 0; i < SAMPLES; ++i) {
    const intv in = is_inlier(s, &p, i, params);
    const floatv dx = in ? s->x[i] - mean.x : (floatv)(0.0f);
    const floatv dy = in ? s->y[i] - mean.y : (floatv)(0.0f);
    const floatv dz = in ? s->z[i] - mean.z : (floatv)(0.0f);
    const floatv distance = in ? height(s, &p, i) - p.offset : (floatv)(0.0f);
    residuals2 += distance * distance;
    m.xx += dx * dx;
    m.xy += dx * dy;
    m.xz += dx * dz;
    m.yy += dy * dy;
    m.yz += dy * dz;
    m.zz += dz * dz;
  }
  // Towards the scanner, which is at 0: the offset is negative.
  const LanesVec3 centroid = {s->origin.x + mean.x, s->origin.y + mean.y, s->origin.z + mean.z};
  const floatv offset = p.offset + p.along;
  const floatv sign = offset > 0.0f ? (floatv)(-1.0f) : (floatv)(1.0f);
  const floatv cosine =
      lanes_max(fabs(offset) / sqrt(lanes_dot(centroid, centroid)), (floatv)(params->min_cosine));
  const floatv sigma = direction_sigma(m, p.normal, residuals2, inliers, params->sigma_m * cosine);

  const intv enough = s->valid >= (float)params->min_valid;
  const intv planar = enough & qualifies(inliers, s->valid, params->min_inlier_share);
  float lane[VW];
  PUT(normal[0], sign * p.normal.x);
  PUT(normal[1], sign * p.normal.y);
  PUT(normal[2], sign * p.normal.z);
  PUT(offset, sign * offset);
  PUT(centroid[0], centroid.x);
  PUT(centroid[1], centroid.y);
  PUT(centroid[2], centroid.z);
  PUT(rms, sqrt(residuals2 / inliers));
  PUT(scatter[0], m.xx);
  PUT(scatter[1], m.xy);
  PUT(scatter[2], m.xz);
  PUT(scatter[3], m.yy);
  PUT(scatter[4], m.yz);
  PUT(scatter[5], m.zz);
  PUT(sigma_normal, sigma);
  PUT_COUNT(valid, s->valid);
  PUT_COUNT(inliers, planar ? inliers : (floatv)(0.0f));
  PUT_COUNT(state,
            planar ? (floatv)((float)SQUARE_PLANAR)
                   : (enough ? (floatv)((float)SQUARE_NON_PLANAR) : (floatv)((float)SQUARE_UNDERSAMPLED)));
  for (uint l = 0; l < count; ++l) out[l].pad[0] = out[l].pad[1] = 0.0f;
}

kernel void square_planes(SquarePlanesParams params, global const float* restrict x,
                          global const float* restrict y, global const float* restrict z,
                          global const uint* restrict triplets, global SquareRecord* restrict records) {
  const uint square_rows = (params.rows + SQUARE - 1u) / SQUARE,
             square_cols = (params.cols + SQUARE - 1u) / SQUARE;
  const uint groups = (square_cols + VW - 1u) / VW;
  const uint id = get_global_id(0);
  if (id >= groups * square_rows) return;
  const uint square_row = id / groups, square_col = id % groups * VW;

  Squares s;
  load(&s, x, y, z, params.rows, params.cols, square_row * SQUARE, square_col * SQUARE);
  Planes p;
  if (params.fit == SQUARE_FIT_EIGEN) {
    fit(&s, 0, &params, &p);
  } else {
    const uint block_col = (params.first_square_col + square_col) / SQUARE_BLOCK;
    const uint block = mix_bits(params.first_square_row + square_row) + block_col;
    Planes found, refitted;
    search(&s, triplets, block, &params, &found);
    fit(&s, &found, &params, &refitted);
    const intv keep = qualifies(count_inliers(&s, &refitted, &params), s.valid, params.min_inlier_share);
    p.normal.x = keep ? refitted.normal.x : found.normal.x;
    p.normal.y = keep ? refitted.normal.y : found.normal.y;
    p.normal.z = keep ? refitted.normal.z : found.normal.z;
    p.offset = keep ? refitted.offset : found.offset;
    p.along = keep ? refitted.along : found.along;
  }
  const floatv inliers = count_inliers(&s, &p, &params);
  const uint left = square_cols - square_col;
  describe(&s, p, inliers, &params, records + square_row * square_cols + square_col, left < VW ? left : VW);
}
