// SPDX-License-Identifier: Apache-2.0
// The Hessian of clip.h: what turns with the faces, then one segment after another.
#include <math.h>
#include <string.h>

#include "overlap/clip/clip.h"

enum { SIZE = OVERLAP_PAIR_SIZE };

// Σ_f Σ_a δx_a m_fa dS_f of one face: with d the edge opposite to vertex v, δS = ½ δx_v × d.
static void add_turning(const double tet[12], int face, bool is_mirrored, const double moment[4],
                        double *block) {
  int corner[3] = {overlap_clip_t[face], overlap_clip_u[face], overlap_clip_v[face]};
  for (int v = 0; v < 3; v++) {
    Vec3 d = vec3_sub(vec3_at(tet + 3 * corner[(v + 1) % 3]), vec3_at(tet + 3 * corner[(v + 2) % 3]));
    d = vec3_scale(is_mirrored ? -0.5 : 0.5, d);
    const double turn[3][3] = {{0, d.z, -d.y}, {-d.z, 0, d.x}, {d.y, -d.x, 0}}; // turn δ = δ × d
    for (int a = 0; a < 3; a++)
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
          block[(3 * corner[a] + r) * SIZE + 3 * corner[v] + c] += moment[corner[a]] * turn[r][c];
  }
}

static Vec3 outward_normal(const OverlapClipFrame *frame, int face) {
  Vec3 n = frame->normal[face];
  return vec3_scale((frame->det < 0 ? 1 : -1) / vec3_length(n), n);
}

// A point's step in space, from the change of its coordinates in A; these sum to zero.
static Vec3 step_of(const double tet[12], const double lanes[4]) {
  Vec3 step = {0, 0, 0};
  for (int i = 1; i < 4; i++)
    step = vec3_add(step, vec3_scale(lanes[i], vec3_sub(vec3_at(tet + 3 * i), vec3_at(tet))));
  return step;
}

// n_f n_gᵀ ds / sin θ of a segment s = `step`, walked with f, the face of A, on the left. Its antisymmetric
// part, −½ [n_f × n_g]× ds / sin θ, is −½ [s]× without any division: bounding 1/sin θ touches the symmetric
// part alone.
static void couple(Vec3 normal_a, Vec3 normal_b, Vec3 step, double coupling[3][3]) {
  double sine = fmax(vec3_length(vec3_cross(normal_a, normal_b)), OVERLAP_CLIP_LEAST_SINE);
  double half = vec3_length(step) / (2 * sine);
  const double p[3] = {normal_a.x, normal_a.y, normal_a.z}, q[3] = {normal_b.x, normal_b.y, normal_b.z};
  const double turn[3][3] = {{0, step.z, -step.y}, {-step.z, 0, step.x}, {step.y, -step.x, 0}}; // −[s]×
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) coupling[r][c] = half * (p[r] * q[c] + q[r] * p[c]) + turn[r][c] / 2;
}

// Adds −∫ ψ_z ψ_w times the coupling in the rows of A, its transpose in those of B, and plus where z and w
// belong to different tetrahedra. `from` and `to` are the segment's ends in the eight coordinates ψ.
static void add_segment(const double from[8], const double to[8], double coupling[3][3], double *hessian) {
  double transposed[3][3];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) transposed[r][c] = coupling[c][r];
  for (int z = 0; z < 8; z++) {
    double(*block)[3] = z < 4 ? coupling : transposed;
    for (int w = 0; w < 8; w++) {
      double mean = (2 * (from[z] * from[w] + to[z] * to[w]) + from[z] * to[w] + to[z] * from[w]) / 6;
      if (mean == 0) continue; // ψ is zero for the vertices opposite to f and g
      double weight = (z < 4) == (w < 4) ? -mean : mean;
      double *target = hessian + 3 * z * SIZE + 3 * w;
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) target[r * SIZE + c] += weight * block[r][c];
    }
  }
}

// The two parts are symmetric only together, and that but for rounding: the mean is exactly.
static void symmetrise(double *hessian) {
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < i; j++) {
      double mean = (hessian[i * SIZE + j] + hessian[j * SIZE + i]) / 2;
      hessian[i * SIZE + j] = hessian[j * SIZE + i] = mean;
    }
}

void overlap_clip_hessian(const OverlapClipPolytope *polytope, const OverlapClipMoments *moments,
                          const double pair[24], double *hessian) {
  memset(hessian, 0, SIZE * SIZE * sizeof *hessian);
  const OverlapClipFrame *frame = polytope->frame;
  Vec3 normal[8];
  for (int f = 0; f < 8; f++) {
    int t = f / 4;
    normal[f] = outward_normal(&frame[t], f % 4);
    if (moments->fraction[f] != 0)
      add_turning(pair + 12 * t, f % 4, frame[t].det < 0, moments->moment[f], hessian + 12 * t * (SIZE + 1));
  }
  for (int e = 0; e < polytope->edge_count; e++) {
    OverlapClipEdge edge = polytope->edge[e];
    if ((edge.left < 4) == (edge.right < 4)) continue; // an edge of A or of B does not move within its faces
    const double *p = polytope->vertex[edge.from], *q = polytope->vertex[edge.to];
    double from[8], to[8], change[8];
    for (int lane = 0; lane < 8; lane++) {
      from[lane] = polytope->origin[lane] + p[lane];
      to[lane] = polytope->origin[lane] + q[lane];
      change[lane] = q[lane] - p[lane];
    }
    Vec3 step = step_of(pair, change);
    bool is_mirrored = frame[polytope->subject].det < 0, has_a_left = edge.left < 4;
    if (is_mirrored == has_a_left) step = vec3_scale(-1, step);
    double coupling[3][3];
    couple(normal[has_a_left ? edge.left : edge.right], normal[has_a_left ? edge.right : edge.left], step,
           coupling);
    add_segment(from, to, coupling, hessian);
  }
  symmetrise(hessian);
}
