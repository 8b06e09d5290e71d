// SPDX-License-Identifier: Apache-2.0
#include "overlap/tpn/axis.h"

#include <math.h>
#include <string.h>

static const double SAME = 1e-9, PARALLEL = 1e-9;

// The vertices of an edge, then the other two.
static const int edges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};

// Unlike fmin and fmax one instruction.
static double smaller_of(double a, double b) {
  return a < b ? a : b;
}

static double larger_of(double a, double b) {
  return a > b ? a : b;
}

static void find_face_reaches(const double lambda[4][4], double reach[4]) {
  for (int k = 0; k < 4; k++) {
    double lowest =
        smaller_of(smaller_of(lambda[0][k], lambda[1][k]), smaller_of(lambda[2][k], lambda[3][k]));
    double highest = larger_of(larger_of(lambda[0][k], lambda[1][k]), larger_of(lambda[2][k], lambda[3][k]));
    reach[k] = highest / (1 + highest - lowest);
  }
}

static OverlapTpnAxis find_face(const OverlapTpnAxisSide *side, int tet) {
  OverlapTpnAxis best = {.tet = tet, .reach = INFINITY};
  double reach[4];
  if (!side->stands) return best;
  find_face_reaches(side->lambda, reach);
  for (int k = 0; k < 4; k++)
    if (reach[k] < best.reach) best.face = k, best.reach = reach[k];
  return best;
}

// λ along and at the edges p q of the other tetrahedron, of which u, v are the other two vertices; one after
// another, so that a loop over edges takes no branches and becomes vector instructions.
typedef struct Edges {
  double change[4][6]; // λ(q) − λ(p)
  double largest[6];   // of |change|
  double p[4][6], u[4][6], v[4][6];
} Edges;

static void find_changes(const double lambda[4][4], Edges *all) {
  for (int k = 0; k < 4; k++)
    for (int j = 0; j < 6; j++) {
      all->p[k][j] = lambda[edges[j][0]][k];
      all->u[k][j] = lambda[edges[j][2]][k], all->v[k][j] = lambda[edges[j][3]][k];
      all->change[k][j] = lambda[edges[j][1]][k] - lambda[edges[j][0]][k];
    }
  for (int j = 0; j < 6; j++) {
    double first = larger_of(fabs(all->change[0][j]), fabs(all->change[1][j]));
    all->largest[j] = larger_of(first, larger_of(fabs(all->change[2][j]), fabs(all->change[3][j])));
  }
}

// Of the edge between the two vertices other than r and s, with every edge of the other. INFINITY: the axis
// does not count.
static void find_reaches(const Edges *all, int r, int s, double reach[6]) {
  for (int j = 0; j < 6; j++) {
    double dr = all->change[r][j], ds = all->change[s][j];
    double up = ds > dr ? -1 : 1; // times h: the tetrahedron is below 0, the other is to be above its edge
    double height = up * (all->p[r][j] * ds - all->p[s][j] * dr);
    double u = up * (all->u[r][j] * ds - all->u[s][j] * dr) - height;
    double v = up * (all->v[r][j] * ds - all->v[s][j] * dr) - height;
    double width = larger_of(fabs(dr), fabs(ds));
    double support = smaller_of(smaller_of(u, v), -(dr * ds)); // not negative: both edges do
    double least = smaller_of(support, width - PARALLEL * all->largest[j]);
    double overlap = least >= 0 ? -height : INFINITY;
    reach[j] = overlap / (width + fabs(larger_of(u, v)));
  }
}

// Puts the nearer of an edge's other two vertices, at these distances from the plane, first.
static void set_edge(const int edge[4], double distance, double other, int ordered[4]) {
  memcpy(ordered, edge, 4 * sizeof *edge);
  if (distance > other) ordered[2] = edge[3], ordered[3] = edge[2];
}

static void set_edges(const Edges *all, int i, int j, OverlapTpnAxis *axis) {
  int r = edges[i][2], s = edges[i][3];
  double dr = all->change[r][j], ds = all->change[s][j];
  double height = all->p[r][j] * ds - all->p[s][j] * dr;
  double u = all->u[r][j] * ds - all->u[s][j] * dr - height;
  double v = all->v[r][j] * ds - all->v[s][j] * dr - height;
  set_edge(edges[i], fabs(ds), fabs(dr), axis->edge[axis->tet]);
  set_edge(edges[j], fabs(u), fabs(v), axis->edge[!axis->tet]);
}

static OverlapTpnAxis find_edges(const OverlapTpnAxisSide *side, int tet) {
  OverlapTpnAxis best = {.is_edges = true, .tet = tet, .reach = INFINITY};
  Edges all;
  double least[6], which[6] = {0}; // of each edge of the other: with which edge
  int other = 0;
  find_changes(side->lambda, &all);
  for (int j = 0; j < 6; j++) least[j] = INFINITY;
  for (int i = 0; i < 6; i++) {
    double reach[6], edge = i;
    find_reaches(&all, edges[i][2], edges[i][3], reach);
    for (int j = 0; j < 6; j++) {
      which[j] = reach[j] < least[j] ? edge : which[j];
      least[j] = reach[j] < least[j] ? reach[j] : least[j];
    }
  }
  for (int j = 0; j < 6; j++)
    if (least[j] < best.reach) best.reach = least[j], other = j;
  set_edges(&all, (int)which[other], other, &best);
  return best;
}

OverlapTpnAxis overlap_tpn_axis_find(const OverlapTpnAxisSide sides[2], int larger) {
  OverlapTpnAxis best = find_face(&sides[larger], larger);
  OverlapTpnAxis others = find_face(&sides[!larger], !larger);
  if (others.reach < best.reach - SAME) best = others;
  OverlapTpnAxis crossing = find_edges(&sides[larger], larger);
  return crossing.reach < best.reach - SAME ? crossing : best;
}
