// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/field.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "contact/shape/shape.h"
#include "overlap/clip/clip.h"

// A cell as it lies.
typedef struct Side {
  Vec3 x[4];        // vertices [m]
  Vec3 slope[4];    // ∇λ [1/m]
  Vec3 g;           // ∇φ
  double depths[4]; // φ of the vertices [m]
  double s;         // rest volume over the present one
} Side;

static Side side_of(const ContactLayout *layout, int cell, const double coordinates[12]) {
  Side side;
  for (int v = 0; v < 4; v++) side.x[v] = vec3_at(coordinates + 3 * v);
  Vec3 a = vec3_sub(side.x[1], side.x[0]), b = vec3_sub(side.x[2], side.x[0]),
       c = vec3_sub(side.x[3], side.x[0]);
  Vec3 bc = vec3_cross(b, c);
  double det = vec3_dot(a, bc), inverse = 1 / det;
  side.slope[1] = vec3_scale(inverse, bc);
  side.slope[2] = vec3_scale(inverse, vec3_cross(c, a));
  side.slope[3] = vec3_scale(inverse, vec3_cross(a, b));
  side.slope[0] = vec3_scale(-1, vec3_add(side.slope[1], vec3_add(side.slope[2], side.slope[3])));
  side.g = (Vec3){0, 0, 0};
  for (int v = 0; v < 4; v++) {
    side.depths[v] = layout->mesh.depths[layout->mesh.cells[cell][v]];
    side.g = vec3_add(side.g, vec3_scale(side.depths[v], side.slope[v]));
  }
  side.s = 6 * layout->cell_volumes[cell] * fabs(inverse);
  return side;
}

// Barycentric coordinates in the cell.
static void locate(const Side *side, Vec3 x, double lambda[4]) {
  Vec3 arm = vec3_sub(x, side->x[0]);
  for (int v = 1; v < 4; v++) lambda[v] = vec3_dot(side->slope[v], arm);
  lambda[0] = 1 - lambda[1] - lambda[2] - lambda[3];
}

void contact_field_press(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                         double volume, const double centroid[3], ContactFieldPair *field,
                         double forces[24]) {
  Side sides[2];
  *field = (ContactFieldPair){.volume = volume, .centroid = {centroid[0], centroid[1], centroid[2]}};
  for (int t = 0; t < 2; t++) {
    double *weights = field->weights[t];
    sides[t] = side_of(layout, pair->cells[t], coordinates + 12 * t);
    locate(&sides[t], vec3_at(centroid), weights);
    for (int v = 0; v < 4; v++) field->depths[t] += weights[v] * sides[t].depths[v];
    contact_mesh_fold(&layout->mesh, &layout->def, pair->cells[t], weights);
    vec3_store(field->slopes[t], sides[t].g);
  }
  double stiffness = layout->interfaces[pair->interface].stiffness;
  for (int t = 0; t < 2; t++) field->weighed[t] = sides[t].s * volume;
  field->energy = stiffness * (field->weighed[0] * field->depths[1] + field->weighed[1] * field->depths[0]);
  Vec3 force = vec3_scale(-stiffness, vec3_sub(vec3_scale(field->weighed[0], sides[1].g),
                                               vec3_scale(field->weighed[1], sides[0].g)));
  vec3_store(field->force, force);
  for (int v = 0; v < 4; v++) {
    vec3_store(forces + 3 * v, vec3_scale(field->weights[0][v], force));
    vec3_store(forces + 12 + 3 * v, vec3_scale(-field->weights[1][v], force));
  }
}

// ---- Second derivatives.

// What the faces and the volume of P add up to, with the lanes of clip/polytope.h folded to the tetrahedra's
// vertices.
typedef struct Sums {
  double face[8][8][8]; // ∫_{P_f} ψ_z ψ_w dA / |S_f| of the faces asked for
  double fraction[8];   // |P_f| / |S_f|
  double first[8];      // ∫_P λ_z dx of both tetrahedra [m³]
} Sums;

typedef struct Bend {
  const ContactLayout *layout;
  const ContactPair *pair;
  OverlapClipPolytope polytope;
  double lanes[OVERLAP_CLIP_VERTICES][8]; // of the polytope's vertices, folded
  bool is_folded[OVERLAP_CLIP_VERTICES];
} Bend;

static const double *folded(Bend *bend, int vertex) {
  if (!bend->is_folded[vertex]) {
    memcpy(bend->lanes[vertex], bend->polytope.vertex[vertex], sizeof bend->lanes[vertex]);
    for (int t = 0; t < 2; t++)
      contact_mesh_fold(&bend->layout->mesh, &bend->layout->def, bend->pair->cells[t],
                        bend->lanes[vertex] + 4 * t);
    bend->is_folded[vertex] = true;
  }
  return bend->lanes[vertex];
}

// Triangle r p q of a face, r one vertex of that face's polygon: twice its area, in units of the whole face.
static double doubled_area(const double *r, const double *p, const double *q, int face) {
  int u = overlap_clip_u[face], v = overlap_clip_v[face];
  return (p[u] - r[u]) * (q[v] - r[v]) - (p[v] - r[v]) * (q[u] - r[u]);
}

static void add_triangle(Sums *sums, int face, double doubled, const double *r, const double *p,
                         const double *q) {
  double sum[8];
  sums->fraction[face] += doubled;
  for (int z = 0; z < 8; z++) sum[z] = r[z] + p[z] + q[z];
  for (int z = 0; z < 8; z++)
    for (int w = 0; w <= z; w++)
      sums->face[face][z][w] += doubled / 12 * (r[z] * r[w] + p[z] * p[w] + q[z] * q[w] + sum[z] * sum[w]);
}

// ∫ ψ_z ψ_w over the faces with a bit in `wanted`.
static void add_faces(Bend *bend, unsigned wanted, Sums *sums) {
  const OverlapClipPolytope *polytope = &bend->polytope;
  int first[8];
  memset(first, -1, sizeof first);
  bool is_mirrored = (polytope->frame[0].det < 0) != (polytope->frame[1].det < 0);
  for (int e = 0; e < polytope->edge_count; e++) {
    OverlapClipEdge edge = polytope->edge[e];
    for (int end = 0; end < 2; end++) {
      int face = end == 0 ? edge.left : edge.right, from = end == 0 ? edge.from : edge.to,
          to = end == 0 ? edge.to : edge.from;
      if (!(wanted >> face & 1)) continue;
      if (first[face] < 0) first[face] = from;
      if (first[face] == from || first[face] == to) continue;
      double doubled =
          doubled_area(polytope->vertex[first[face]], polytope->vertex[from], polytope->vertex[to], face);
      if (is_mirrored && face / 4 != polytope->subject) doubled = -doubled;
      add_triangle(sums, face, doubled, folded(bend, first[face]), folded(bend, from), folded(bend, to));
    }
  }
  for (int f = 0; f < 8; f++)
    for (int z = 0; z < 8; z++)
      for (int w = 0; w < z; w++) sums->face[f][w][z] = sums->face[f][z][w];
}

// P as pyramids from one of its vertices o over its faces, f above which o is by λ_f(o) of the height:
// ∫ ψ_z over each is its volume times ¼ ψ_z(o) + ¾ of ψ_z's mean over P_f.
static void add_volume(Bend *bend, Sums *sums) {
  const OverlapClipPolytope *polytope = &bend->polytope;
  int o = polytope->edge[0].from, first[8];
  const double *apex = polytope->vertex[o], *at = folded(bend, o);
  bool is_mirrored = (polytope->frame[0].det < 0) != (polytope->frame[1].det < 0);
  memset(first, -1, sizeof first);
  for (int e = 0; e < polytope->edge_count; e++) {
    OverlapClipEdge edge = polytope->edge[e];
    for (int end = 0; end < 2; end++) {
      int face = end == 0 ? edge.left : edge.right, from = end == 0 ? edge.from : edge.to,
          to = end == 0 ? edge.to : edge.from;
      if (first[face] < 0) first[face] = from;
      if (first[face] == from || first[face] == to) continue;
      double doubled =
          doubled_area(polytope->vertex[first[face]], polytope->vertex[from], polytope->vertex[to], face);
      if (is_mirrored && face / 4 != polytope->subject) doubled = -doubled;
      double volume = doubled * apex[face] * fabs(polytope->frame[face / 4].det) / 6;
      const double *r = folded(bend, first[face]), *p = folded(bend, from), *q = folded(bend, to);
      for (int z = 0; z < 8; z++) sums->first[z] += volume / 4 * (at[z] + r[z] + p[z] + q[z]);
    }
  }
}

static bool is_outer(const ContactLayout *layout, const ContactPair *pair, int face) {
  return layout->mesh.outer[pair->cells[face / 4]] >> face % 4 & 1;
}

// The main term on one face: c s ∫ (u·n)(−g·u), its symmetric part; on an outer face exactly |g| (u·n)².
static void add_main(const Bend *bend, const Sums *sums, int face, double factor, const Side *own,
                     double *matrix) {
  Vec3 area = bend->polytope.frame[face / 4].normal[face % 4]; // inward for det > 0
  double length = vec3_length(area), sign = bend->polytope.frame[face / 4].det < 0 ? 1 : -1;
  Vec3 n = vec3_scale(sign / length, area), push = vec3_scale(-1, own->g);
  if (is_outer(bend->layout, bend->pair, face)) push = vec3_scale(vec3_length(own->g), n);
  const double p[3] = {n.x, n.y, n.z}, q[3] = {push.x, push.y, push.z};
  double block[3][24], scales[24];
  for (int r = 0; r < 3; r++)
    for (int k = 0; k < 24; k++) block[r][k] = p[r] * q[k % 3] + q[r] * p[k % 3];
  for (int z = 0; z < 8; z++) {
    for (int w = 0; w < 8; w++) {
      double scale = factor * length / 4 * sums->face[face][z][w] * ((z < 4) == (w < 4) ? 1 : -1);
      for (int c = 0; c < 3; c++) scales[3 * w + c] = scale;
    }
    for (int r = 0; r < 3; r++)
      for (int k = 0; k < 24; k++) matrix[72 * z + 24 * r + k] += scales[k] * block[r][k];
  }
}

// The turning terms of side t's field, felt by the points of the other: T + Tᵀ with
// T(z, w) = ± ∫ λ_z dx · ∇λ_w ⊗ g over w of side t and all z, + where z is of side t as well.
static void add_turning(const Sums *sums, int t, double factor, const Side *own, const Vec3 slopes[4],
                        double *matrix) {
  const double g[3] = {own->g.x, own->g.y, own->g.z};
  double signs[8], rows[4][24], tiles[3][12];
  for (int z = 0; z < 8; z++) signs[z] = (z / 4 == t ? factor : -factor) * sums->first[z];
  for (int w = 0; w < 4; w++) {
    const double slope[3] = {slopes[w].x, slopes[w].y, slopes[w].z};
    for (int k = 0; k < 24; k++) rows[w][k] = signs[k / 3] * slope[k % 3];
    for (int e = 0; e < 9; e++) tiles[e / 3][3 * w + e % 3] = slope[e / 3] * g[e % 3];
  }
  for (int r = 0; r < 24; r++)
    for (int k = 0; k < 12; k++) matrix[24 * r + 12 * t + k] += signs[r / 3] * tiles[r % 3][k];
  for (int r = 0; r < 12; r++)
    for (int k = 0; k < 24; k++) matrix[24 * (12 * t + r) + k] += g[r % 3] * rows[r / 3][k];
}

// ∇λ of the tetrahedron's vertices from those of the cell's, which move with it.
static void unfold_slopes(const ContactLayout *layout, int cell, const Side *side, Vec3 slopes[4]) {
  double rows[3][4];
  for (int v = 0; v < 4; v++)
    rows[0][v] = side->slope[v].x, rows[1][v] = side->slope[v].y, rows[2][v] = side->slope[v].z;
  for (int c = 0; c < 3; c++) contact_mesh_fold(&layout->mesh, &layout->def, cell, rows[c]);
  for (int v = 0; v < 4; v++) slopes[v] = (Vec3){rows[0][v], rows[1][v], rows[2][v]};
}

void contact_field_bend(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        bool is_full, double matrix[576]) {
  Bend bend = {.layout = layout, .pair = pair};
  memset(matrix, 0, 576 * sizeof *matrix);
  unsigned wanted = 0;
  for (int f = 0; f < 8; f++) wanted |= (unsigned)(is_full || is_outer(layout, pair, f)) << f;
  if (!wanted) return;
  OverlapClipOutcome outcome = overlap_clip_polytope_make(&bend.polytope, coordinates);
  if (outcome == OVERLAP_CLIP_DISJOINT || outcome == OVERLAP_CLIP_UNCERTAIN) return;
  Sums sums;
  memset(&sums, 0, sizeof sums);
  add_faces(&bend, wanted, &sums);
  if (is_full) add_volume(&bend, &sums);
  Side sides[2];
  double stiffness = layout->interfaces[pair->interface].stiffness;
  for (int t = 0; t < 2; t++) sides[t] = side_of(layout, pair->cells[t], coordinates + 12 * t);
  for (int t = 0; t < 2; t++) {
    double factor = stiffness * sides[1 - t].s;
    for (int f = 4 * t; f < 4 * t + 4; f++)
      if (wanted >> f & 1 && sums.fraction[f] != 0) add_main(&bend, &sums, f, factor, &sides[t], matrix);
    if (!is_full) continue;
    Vec3 slopes[4];
    unfold_slopes(layout, pair->cells[t], &sides[t], slopes);
    add_turning(&sums, t, factor, &sides[t], slopes, matrix);
  }
}

// ---- Shapes.

void contact_field_press_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                               const double tet[12], ContactFieldPair *field, double forces[24]) {
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  double rest = contact_layout_tet_volume(layout, pair->cells[0]);
  *field = (ContactFieldPair){0};
  memset(forces, 0, 24 * sizeof *forces);
  contact_shape_press(&layout->def.shapes[interface->shape], time, tet, rest, &field->volume, &field->energy,
                      forces, NULL, true);
  if (!(field->volume > 0)) return;
  field->energy *= interface->stiffness;
  Vec3 force = {0, 0, 0};
  for (int k = 0; k < 12; k++) forces[k] *= -interface->stiffness;
  for (int v = 0; v < 4; v++) force = vec3_add(force, vec3_at(forces + 3 * v));
  double square = vec3_dot(force, force);
  vec3_store(field->force, force);
  for (int v = 0; v < 4; v++) {
    double *weight = &field->weights[0][v];
    *weight = square > 0 ? vec3_dot(vec3_at(forces + 3 * v), force) / square : 0.25;
    vec3_accumulate(field->centroid, vec3_scale(*weight, vec3_at(tet + 3 * v)));
  }
  double present = fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
  field->weighed[0] = field->volume * rest / present;
  field->depths[1] = field->energy / (interface->stiffness * field->weighed[0]);
  vec3_store(field->slopes[1], vec3_scale(-1 / (interface->stiffness * field->weighed[0]), force));
}

void contact_field_bend_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                              const double tet[12], bool is_full, double matrix[144]) {
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  double volume, energy, gradient[12];
  contact_shape_press(&layout->def.shapes[interface->shape], time, tet,
                      contact_layout_tet_volume(layout, pair->cells[0]), &volume, &energy, gradient, matrix,
                      is_full);
  for (int e = 0; e < 144; e++) matrix[e] *= interface->stiffness;
}
