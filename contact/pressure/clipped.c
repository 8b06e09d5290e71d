// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/clipped.h"

#include <math.h>
#include <string.h>

// Triangle r p q of a face: its area over that of the whole face, in the face's own parameters.
static double share_of(const double *r, const double *p, const double *q, int face) {
  int u = overlap_clip_u[face], v = overlap_clip_v[face];
  return (p[u] - r[u]) * (q[v] - r[v]) - (p[v] - r[v]) * (q[u] - r[u]);
}

// Each face as a fan from the first of its vertices that an edge names.
static void list_triangles(ContactClipped *clipped) {
  const OverlapClipPolytope *polytope = &clipped->polytope;
  int first[8];
  memset(first, -1, sizeof first);
  bool is_mirrored = (polytope->frame[0].det < 0) != (polytope->frame[1].det < 0);
  for (int e = 0; e < polytope->edge_count; e++) {
    OverlapClipEdge edge = polytope->edge[e];
    for (int end = 0; end < 2; end++) {
      int face = end == 0 ? edge.left : edge.right, from = end == 0 ? edge.from : edge.to,
          to = end == 0 ? edge.to : edge.from;
      if (first[face] < 0) first[face] = from;
      if (first[face] == from || first[face] == to) continue;
      double share =
          share_of(polytope->vertex[first[face]], polytope->vertex[from], polytope->vertex[to], face);
      clipped->triangles[clipped->triangle_count++] =
          (ContactTriangle){.face = (unsigned char)face,
                            .vertex = {(unsigned char)first[face], (unsigned char)from, (unsigned char)to},
                            .share = is_mirrored && face / 4 != polytope->subject ? -share : share};
    }
  }
}

bool contact_clipped_make(ContactClipped *clipped, const ContactLayout *layout, const ContactPair *pair,
                          const double coordinates[24]) {
  OverlapClipOutcome outcome = overlap_clip_polytope_make(&clipped->polytope, coordinates);
  if (outcome == OVERLAP_CLIP_DISJOINT || outcome == OVERLAP_CLIP_UNCERTAIN) return false;
  clipped->layout = layout;
  clipped->pair = pair;
  clipped->triangle_count = 0;
  memset(clipped->is_folded, 0, sizeof clipped->is_folded);
  list_triangles(clipped);
  return true;
}

const double *contact_clipped_lanes(ContactClipped *clipped, int vertex) {
  double *lanes = clipped->lanes[vertex];
  if (clipped->is_folded[vertex]) return lanes;
  memcpy(lanes, clipped->polytope.vertex[vertex], sizeof clipped->lanes[vertex]);
  for (int t = 0; t < 2; t++)
    contact_mesh_fold(&clipped->layout->mesh, &clipped->layout->def, clipped->pair->cells[t], lanes + 4 * t);
  clipped->is_folded[vertex] = true;
  return lanes;
}

// The apex is above face f by λ_f of the tetrahedron's height.
double contact_clipped_pyramid(const ContactClipped *clipped, const ContactTriangle *triangle) {
  const OverlapClipPolytope *polytope = &clipped->polytope;
  int face = triangle->face;
  double height = polytope->vertex[contact_clipped_apex(clipped)][face];
  return triangle->share * height * fabs(polytope->frame[face / 4].det) / 6;
}
