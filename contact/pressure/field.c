// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/field.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "contact/pressure/clipped.h"
#include "contact/pressure/field_law.h"
#include "contact/pressure/side.h"
#include "contact/shape/shape.h"

// Loops over the vertices of two tetrahedra, also for the instructions that most processors have.
#if defined(__x86_64__) && !defined(__clang__)
#define FASTEST __attribute__((target_clones("avx2", "default")))
#else
#define FASTEST
#endif

void contact_field_press(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                         double volume, const double centroid[3], ContactFieldPair *field,
                         double forces[24]) {
  ContactSide sides[2];
  *field = (ContactFieldPair){.law = layout->interfaces[pair->interface].law,
                              .volume = volume,
                              .centroid = {centroid[0], centroid[1], centroid[2]}};
  for (int t = 0; t < 2; t++) {
    double *weights = field->weights[t];
    sides[t] = contact_side_of(layout, pair->cells[t], coordinates + 12 * t);
    contact_side_locate(&sides[t], vec3_at(centroid), weights);
    field->signs[t] = sides[t].sign;
    for (int v = 0; v < 4; v++) field->depths[t] += weights[v] * sides[t].depths[v];
    contact_mesh_fold(&layout->mesh, &layout->def, pair->cells[t], weights);
    vec3_store(field->slopes[t], sides[t].g);
  }
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  double stiffness = interface->stiffness;
  for (int t = 0; t < 2; t++) field->weighed[t] = sides[t].s * volume;
  if (interface->law) {
    contact_field_law_press(layout, pair, coordinates, sides, field, forces);
    return;
  }
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

// What the faces and the volume of P add up to, by the tetrahedra's vertices.
typedef struct Sums {
  double face[8][8][8]; // ∫_{P_f} ψ_z ψ_w dA / |S_f| of the faces asked for
  double fraction[8];   // |P_f| / |S_f|
  double first[8];      // ∫_P λ_z dx of both tetrahedra [m³]
} Sums;

// ∫ ψ_z ψ_w over a triangle of `doubled` the area, from the values at its corners.
FASTEST static void add_triangle(double squares[8][8], double doubled, const double *r, const double *p,
                                 const double *q) {
  double sum[8];
  for (int z = 0; z < 8; z++) sum[z] = r[z] + p[z] + q[z];
  for (int z = 0; z < 8; z++)
    for (int w = 0; w < 8; w++)
      squares[z][w] += doubled / 12 * (r[z] * r[w] + p[z] * p[w] + q[z] * q[w] + sum[z] * sum[w]);
}

// ∫ ψ_z ψ_w over the faces.
static void add_faces(ContactClipped *clipped, Sums *sums) {
  for (int i = 0; i < clipped->triangle_count; i++) {
    const ContactTriangle *triangle = &clipped->triangles[i];
    sums->fraction[triangle->face] += triangle->share;
    add_triangle(sums->face[triangle->face], triangle->share,
                 contact_clipped_lanes(clipped, triangle->vertex[0]),
                 contact_clipped_lanes(clipped, triangle->vertex[1]),
                 contact_clipped_lanes(clipped, triangle->vertex[2]));
  }
}

// ∫ ψ_z over each pyramid is its volume times the mean of ψ_z at its corners.
static void add_volume(ContactClipped *clipped, Sums *sums) {
  const double *at = contact_clipped_lanes(clipped, contact_clipped_apex(clipped));
  for (int i = 0; i < clipped->triangle_count; i++) {
    const ContactTriangle *triangle = &clipped->triangles[i];
    double volume = contact_clipped_pyramid(clipped, triangle);
    const double *r = contact_clipped_lanes(clipped, triangle->vertex[0]),
                 *p = contact_clipped_lanes(clipped, triangle->vertex[1]),
                 *q = contact_clipped_lanes(clipped, triangle->vertex[2]);
    for (int z = 0; z < 8; z++) sums->first[z] += volume / 4 * (at[z] + r[z] + p[z] + q[z]);
  }
}

static bool is_outer(const ContactLayout *layout, const ContactPair *pair, int face) {
  return layout->mesh.outer[pair->cells[face / 4]] >> face % 4 & 1;
}

// The main term on one face: c s ∫ (u·n)(−g·u), its symmetric part; on an outer face exactly |g| (u·n)².
// `squares`: of this face.
FASTEST static void add_main(const ContactClipped *clipped, double squares[8][8], int face, double factor,
                             const ContactSide *own, double *matrix) {
  const OverlapClipFrame *frame = &clipped->polytope.frame[face / 4];
  Vec3 area = frame->normal[face % 4]; // inward for det > 0
  double length = vec3_length(area), sign = frame->det < 0 ? 1 : -1;
  Vec3 n = vec3_scale(sign / length, area), push = vec3_scale(-1, own->g);
  if (is_outer(clipped->layout, clipped->pair, face)) push = vec3_scale(own->sign * vec3_length(own->g), n);
  const double p[3] = {n.x, n.y, n.z}, q[3] = {push.x, push.y, push.z};
  double block[3][24], scales[24];
  for (int r = 0; r < 3; r++)
    for (int k = 0; k < 24; k++) block[r][k] = p[r] * q[k % 3] + q[r] * p[k % 3];
  for (int z = 0; z < 8; z++) {
    for (int w = 0; w < 8; w++) {
      double scale = factor * length / 4 * squares[z][w] * ((z < 4) == (w < 4) ? 1 : -1);
      for (int c = 0; c < 3; c++) scales[3 * w + c] = scale;
    }
    for (int r = 0; r < 3; r++)
      for (int k = 0; k < 24; k++) matrix[72 * z + 24 * r + k] += scales[k] * block[r][k];
  }
}

// The turning terms of side t's field, felt by the points of the other: T + Tᵀ with
// T(z, w) = ± ∫ λ_z dx · ∇λ_w ⊗ g over w of side t and all z, + where z is of side t as well.
FASTEST static void add_turning(const double first[8], int t, double factor, const ContactSide *own,
                                const Vec3 slopes[4], double *matrix) {
  const double g[3] = {own->g.x, own->g.y, own->g.z};
  double signs[8], rows[4][24], tiles[3][12];
  for (int z = 0; z < 8; z++) signs[z] = (z / 4 == t ? factor : -factor) * first[z];
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
static void unfold_slopes(const ContactLayout *layout, int cell, const ContactSide *side, Vec3 slopes[4]) {
  double rows[3][4];
  for (int v = 0; v < 4; v++)
    rows[0][v] = side->slope[v].x, rows[1][v] = side->slope[v].y, rows[2][v] = side->slope[v].z;
  for (int c = 0; c < 3; c++) contact_mesh_fold(&layout->mesh, &layout->def, cell, rows[c]);
  for (int v = 0; v < 4; v++) slopes[v] = (Vec3){rows[0][v], rows[1][v], rows[2][v]};
}

static void add_turning_of(const ContactClipped *clipped, const double first[8], int t, double factor,
                           const ContactSide *own, double *matrix) {
  Vec3 slopes[4];
  unfold_slopes(clipped->layout, clipped->pair->cells[t], own, slopes);
  add_turning(first, t, factor, own, slopes, matrix);
}

static void bend_linear(ContactClipped *clipped, const ContactSide sides[2], double stiffness,
                        double *matrix) {
  Sums sums;
  memset(&sums, 0, sizeof sums);
  add_faces(clipped, &sums);
  add_volume(clipped, &sums);
  for (int t = 0; t < 2; t++) {
    double factor = stiffness * sides[1 - t].s;
    for (int f = 4 * t; f < 4 * t + 4; f++)
      if (sums.fraction[f] != 0) add_main(clipped, sums.face[f], f, factor, &sides[t], matrix);
    add_turning_of(clipped, sums.first, t, factor, &sides[t], matrix);
  }
}

// What the depth's square adds: ∫ ψ″ (g·(u_A − u_B))².
static void add_bulk(double squares[8][8], double factor, const ContactSide *own, double *matrix) {
  const double g[3] = {own->g.x, own->g.y, own->g.z};
  for (int r = 0; r < 24; r++)
    for (int k = 0; k < 24; k++)
      matrix[24 * r + k] +=
          ((r < 12) == (k < 12) ? factor : -factor) * squares[r / 3][k / 3] * g[r % 3] * g[k % 3];
}

static void bend_by_law(ContactClipped *clipped, const ContactSide sides[2], const ContactLaw *law,
                        double *matrix) {
  ContactFieldLawSums sums;
  contact_field_law_add(clipped, law, sides, &sums);
  for (int t = 0; t < 2; t++) {
    double factor = CONTACT_FIELD_HALF * sides[1 - t].s;
    for (int f = 4 * t; f < 4 * t + 4; f++) add_main(clipped, sums.face[f], f, factor, &sides[t], matrix);
    add_bulk(sums.second[t], factor, &sides[t], matrix);
    add_turning_of(clipped, sums.first[t], t, factor, &sides[t], matrix);
  }
}

void contact_field_bend(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        double matrix[576]) {
  ContactClipped clipped;
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  memset(matrix, 0, 576 * sizeof *matrix);
  if (!contact_clipped_make(&clipped, layout, pair, coordinates)) return;
  ContactSide sides[2];
  for (int t = 0; t < 2; t++) sides[t] = contact_side_of(layout, pair->cells[t], coordinates + 12 * t);
  if (interface->law)
    bend_by_law(&clipped, sides, interface->law, matrix);
  else
    bend_linear(&clipped, sides, interface->stiffness, matrix);
}

// ---- First derivatives of forces.

// Of F, row by row, by the cells' vertices.
static void change_force(const ContactSide sides[2], const ContactFieldPair *field, double stiffness,
                         const double slopes[24], double rows[3][24]) {
  const double *force = field->force;
  for (int r = 0; r < 3; r++)
    for (int k = 0; k < 24; k++) rows[r][k] = force[r] / field->volume * slopes[k];
  for (int t = 0; t < 2; t++) { // F = −c V (s₀ g₁ − s₁ g₀), δs = −s ∇·u, δg = −(∇u)ᵀ g
    double sign = t == 0 ? -stiffness : stiffness, own = sign * sides[t].s * field->volume,
           other = -sign * sides[1 - t].s * field->volume;
    const double g[3] = {sides[1 - t].g.x, sides[1 - t].g.y, sides[1 - t].g.z};
    const double turned[3] = {sides[t].g.x, sides[t].g.y, sides[t].g.z};
    for (int v = 0; v < 4; v++) {
      const double slope[3] = {sides[t].slope[v].x, sides[t].slope[v].y, sides[t].slope[v].z};
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
          rows[r][12 * t + 3 * v + c] -= own * g[r] * slope[c] + other * slope[r] * turned[c];
    }
  }
}

// λ_v = ∇λ_v · (x̄ − x), where the cell's own vertices move with x.
static void change_weights(const ContactSide *side, const double lambda[4], int t, const double slopes[72],
                           double rows[4][24]) {
  for (int v = 0; v < 4; v++) {
    const double slope[3] = {side->slope[v].x, side->slope[v].y, side->slope[v].z};
    for (int k = 0; k < 24; k++)
      rows[v][k] = slope[0] * slopes[k] + slope[1] * slopes[24 + k] + slope[2] * slopes[48 + k];
    for (int w = 0; w < 4; w++)
      for (int c = 0; c < 3; c++) rows[v][12 * t + 3 * w + c] -= lambda[w] * slope[c];
  }
}

// From the cells' vertices to the tetrahedra's.
static void fold_rows(const ContactLayout *layout, const ContactPair *pair, int t, double rows[4][24]) {
  for (int k = 0; k < 24; k++) {
    double column[4] = {rows[0][k], rows[1][k], rows[2][k], rows[3][k]};
    contact_mesh_fold(&layout->mesh, &layout->def, pair->cells[t], column);
    for (int v = 0; v < 4; v++) rows[v][k] = column[v];
  }
}

static void fold_columns(const ContactLayout *layout, const ContactPair *pair, double row[24]) {
  for (int i = 0; i < 6; i++) {
    double own[4], *first = row + 12 * (i / 3) + i % 3;
    for (int v = 0; v < 4; v++) own[v] = first[3 * v];
    contact_mesh_fold(&layout->mesh, &layout->def, pair->cells[i / 3], own);
    for (int v = 0; v < 4; v++) first[3 * v] = own[v];
  }
}

void contact_field_turn(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        const ContactFieldPair *field, const double slopes[96], double matrix[576]) {
  ContactSide sides[2];
  double force[3][24], weights[4][24], lambda[4];
  for (int t = 0; t < 2; t++) sides[t] = contact_side_of(layout, pair->cells[t], coordinates + 12 * t);
  change_force(sides, field, layout->interfaces[pair->interface].stiffness, slopes, force);
  for (int t = 0; t < 2; t++) {
    double sign = t == 0 ? -1 : 1;
    contact_side_locate(&sides[t], vec3_at(field->centroid), lambda);
    change_weights(&sides[t], lambda, t, slopes + 24, weights);
    fold_rows(layout, pair, t, weights);
    for (int v = 0; v < 4; v++)
      for (int r = 0; r < 3; r++) {
        double *row = matrix + 24 * (12 * t + 3 * v + r);
        for (int k = 0; k < 24; k++)
          row[k] = sign * (field->weights[t][v] * force[r][k] + field->force[r] * weights[v][k]);
        fold_columns(layout, pair, row);
      }
  }
}

// ---- The same with a law, by differences: its points of a pair follow P's moments.

// V, x̄ and the forces of a pair whose volume clipping finds.
static void press_anew(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                       double forces[24]) {
  ContactClipped clipped;
  ContactFieldPair field;
  double volume = 0, lanes[4] = {0, 0, 0, 0}, centroid[3] = {0, 0, 0};
  memset(forces, 0, 24 * sizeof *forces);
  if (!contact_clipped_make(&clipped, layout, pair, coordinates)) return;
  const double *apex = clipped.polytope.vertex[contact_clipped_apex(&clipped)];
  for (int i = 0; i < clipped.triangle_count; i++) {
    const ContactTriangle *triangle = &clipped.triangles[i];
    double own = contact_clipped_pyramid(&clipped, triangle);
    volume += own;
    for (int v = 0; v < 4; v++) {
      double sum = apex[v];
      for (int k = 0; k < 3; k++) sum += clipped.polytope.vertex[triangle->vertex[k]][v];
      lanes[v] += own / 4 * sum;
    }
  }
  if (!(volume > 0)) return;
  for (int v = 0; v < 4; v++)
    vec3_accumulate(centroid, vec3_scale(lanes[v] / volume, vec3_at(coordinates + 3 * v)));
  contact_field_press(layout, pair, coordinates, volume, centroid, &field, forces);
}

void contact_field_turn_law(const ContactLayout *layout, const ContactPair *pair, double time,
                            const double coordinates[24], const ContactFieldPair *field, double *matrix) {
  bool is_shape = pair->cells[1] < 0;
  int width = is_shape ? 12 : 24;
  double step = contact_field_law_step() * (fabs(field->depths[0]) + fabs(field->depths[1])), x[24],
         force[24];
  memset(matrix, 0, (size_t)(width * width) * sizeof *matrix);
  for (int k = 0; k < width && step > 0; k++) {
    double ahead = coordinates[k] + step, behind = coordinates[k] - step, way = ahead - behind; // rounded
    for (int side = 1; side >= -1 && way > 0; side -= 2) {
      ContactFieldPair moved;
      memcpy(x, coordinates, (size_t)width * sizeof *x);
      x[k] = side > 0 ? ahead : behind;
      if (is_shape)
        contact_field_press_shape(layout, pair, time, x, &moved, force);
      else
        press_anew(layout, pair, x, force);
      for (int r = 0; r < width; r++) matrix[width * r + k] -= side * force[r] / way;
    }
  }
  for (int r = 0; r < width && !is_shape; r++) fold_columns(layout, pair, matrix + width * r);
}

// ---- Shapes.

// Where the resultant acts, by the forces on the vertices.
static void find_resultant(const double tet[12], const double forces[12], ContactFieldPair *field) {
  Vec3 force = {0, 0, 0};
  for (int v = 0; v < 4; v++) force = vec3_add(force, vec3_at(forces + 3 * v));
  double square = vec3_dot(force, force);
  vec3_store(field->force, force);
  for (int v = 0; v < 4; v++) {
    double *weight = &field->weights[0][v];
    *weight = square > 0 ? vec3_dot(vec3_at(forces + 3 * v), force) / square : 0.25;
    vec3_accumulate(field->centroid, vec3_scale(*weight, vec3_at(tet + 3 * v)));
  }
}

void contact_field_press_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                               const double tet[12], ContactFieldPair *field, double forces[24]) {
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  const ContactShape *shape = &layout->def.shapes[interface->shape];
  double rest = contact_layout_tet_volume(layout, pair->cells[0]);
  *field = (ContactFieldPair){.law = interface->law, .signs = {1, 1}};
  memset(forces, 0, 24 * sizeof *forces);
  contact_shape_press(shape, time, tet, rest, &field->volume, &field->energy, forces, NULL);
  if (!(field->volume > 0)) return;
  double stiffness = interface->law ? 1 : interface->stiffness;
  field->energy *= stiffness;
  Vec3 force = {0, 0, 0};
  for (int k = 0; k < 12; k++) forces[k] *= -stiffness;
  for (int v = 0; v < 4; v++) force = vec3_add(force, vec3_at(forces + 3 * v));
  double present = fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
  field->weighed[0] = field->volume * rest / present;
  field->depths[1] = field->energy / (stiffness * field->weighed[0]);
  vec3_store(field->slopes[1], vec3_scale(-1 / (stiffness * field->weighed[0]), force));
  if (interface->law) {
    contact_field_law_press_shape(shape, interface->law, time, tet, rest, &field->energy, forces, NULL);
    for (int k = 0; k < 12; k++) forces[k] = -forces[k];
  }
  find_resultant(tet, forces, field);
}

void contact_field_bend_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                              const double tet[12], double matrix[144]) {
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  double volume, energy, gradient[12];
  if (interface->law) {
    contact_field_law_press_shape(&layout->def.shapes[interface->shape], interface->law, time, tet,
                                  contact_layout_tet_volume(layout, pair->cells[0]), &energy, gradient,
                                  matrix);
    return;
  }
  contact_shape_press(&layout->def.shapes[interface->shape], time, tet,
                      contact_layout_tet_volume(layout, pair->cells[0]), &volume, &energy, gradient, matrix);
  for (int e = 0; e < 144; e++) matrix[e] *= interface->stiffness;
}
