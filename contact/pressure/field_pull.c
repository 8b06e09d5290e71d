// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/field_pull.h"

#include <math.h>
#include <string.h>

#include "contact/pressure/clipped.h"
#include "contact/pressure/field.h"
#include "contact/pressure/side.h"
#include "contact/shape/shape.h"

// ∂g/∂ of what the found values are functions of.
typedef struct Means {
  double moments[8]; // of m_z, by the cells' vertices
  double s[2];
  Vec3 g[2];
} Means;

// ∂g/∂V, ∂g/∂U and ∂g/∂F of a g of the area ½ V |F|/U.
typedef struct AreaSlopes {
  double volume, energy;
  Vec3 force;
} AreaSlopes;

static AreaSlopes pull_area(double volume, double energy, Vec3 force, double by_area) {
  double square = vec3_dot(force, force);
  if (!(square > 0 && energy > 0)) return (AreaSlopes){0};
  double g = by_area * 0.5 * volume * sqrt(square) / energy;
  return (AreaSlopes){g / volume, -g / energy, vec3_scale(g / square, force)};
}

// The transpose of contact_mesh_fold.
static void unfold(const ContactLayout *layout, int cell, double slopes[4]) {
  int replaced = layout->mesh.replaced[cell];
  if (replaced < 0) return;
  const double *weights =
      layout->mesh.virtuals[layout->mesh.own[cell][replaced] - layout->def.vertex_count].weights;
  double sum = 0;
  for (int v = 0; v < 4; v++) sum += weights[v] * slopes[v];
  slopes[replaced] = sum;
}

// Of λ_z(x̄) = m_z / V.
static double pull_weights(const ContactLayout *layout, const ContactPair *pair, double lambda[2][4],
                           const ContactFieldPair *field, const ContactFieldSlopes *by, Means *means) {
  double of_volume = 0;
  for (int t = 0; t < 2; t++) {
    double slopes[4];
    memcpy(slopes, by->weights[t], sizeof slopes);
    unfold(layout, pair->cells[t], slopes);
    for (int v = 0; v < 4; v++) {
      means->moments[4 * t + v] += slopes[v] / field->volume;
      of_volume -= slopes[v] * lambda[t][v] / field->volume;
    }
  }
  return of_volume;
}

static void find_means(const ContactLayout *layout, const ContactPair *pair, const ContactSide sides[2],
                       const ContactFieldPair *field, const ContactFieldSlopes *by, Means *means) {
  double c = layout->interfaces[pair->interface].stiffness, lambda[2][4], energy = 0;
  Vec3 of_force = vec3_at(by->force), force = {0, 0, 0};
  memset(means, 0, sizeof *means);
  for (int t = 0; t < 2; t++) { // F and U of the area, where σ = 1
    double share = c * field->volume * sides[t].s * sides[1 - t].sign;
    force = vec3_add(force, vec3_scale(t == 0 ? -share : share, sides[1 - t].g));
    energy += share * field->depths[1 - t];
    contact_side_locate(&sides[t], vec3_at(field->centroid), lambda[t]);
  }
  AreaSlopes area = pull_area(field->volume, energy, force, by->area);
  double of_volume =
      area.volume + (vec3_dot(of_force, vec3_at(field->force)) + vec3_dot(area.force, force)) / field->volume;
  of_volume += pull_weights(layout, pair, lambda, field, by, means);
  for (int t = 0; t < 2; t++) { // F = −c V (s₀ g₁ − s₁ g₀), U = c V (s₀ φ₁ + s₁ φ₀)
    const ContactSide *own = &sides[t], *other = &sides[1 - t];
    double sign = t == 0 ? -c : c;
    Vec3 slope = vec3_add(of_force, vec3_scale(other->sign, area.force));
    means->s[t] = field->volume *
                  (sign * vec3_dot(slope, other->g) + area.energy * c * other->sign * field->depths[1 - t]);
    means->g[1 - t] = vec3_scale(sign * own->s * field->volume, slope);
    for (int v = 0; v < 4; v++)
      means->moments[4 * t + v] += area.energy * c * other->s * own->sign * own->depths[v];
  }
  for (int v = 0; v < 4; v++) means->moments[v] += of_volume;
}

static void add_to(double slope[24], int z, Vec3 by) {
  vec3_accumulate(slope + 3 * z, by);
}

// Of s and g of both cells.
static void pull_sides(const ContactSide sides[2], const Means *means, double slope[24]) {
  for (int t = 0; t < 2; t++)
    for (int v = 0; v < 4; v++) {
      double turned = vec3_dot(means->g[t], sides[t].slope[v]);
      add_to(slope, 4 * t + v, vec3_scale(-means->s[t] * sides[t].s, sides[t].slope[v]));
      add_to(slope, 4 * t + v, vec3_scale(-turned, sides[t].g));
    }
}

// What of ∂m_a/∂x, of A's vertices, follows from the faces of B that bound P.
static void add_faces(const ContactClipped *clipped, double moments[4][24]) {
  const OverlapClipFrame *frame = &clipped->polytope.frame[1];
  for (int i = 0; i < clipped->triangle_count; i++) {
    const ContactTriangle *triangle = &clipped->triangles[i];
    if (triangle->face < 4) continue;
    double sign = frame->det < 0 ? 1 : -1, whole[8];
    const double *corner[3];
    for (int k = 0; k < 3; k++) corner[k] = clipped->polytope.vertex[triangle->vertex[k]];
    for (int z = 0; z < 8; z++) whole[z] = corner[0][z] + corner[1][z] + corner[2][z];
    Vec3 area = vec3_scale(sign * triangle->share / 24, frame->normal[triangle->face % 4]); // of S_f twice it
    for (int a = 0; a < 4; a++)
      for (int z = 0; z < 8; z++) {
        double sum = whole[a] * whole[z];
        for (int k = 0; k < 3; k++) sum += corner[k][a] * corner[k][z];
        add_to(moments[a], z, vec3_scale(z < 4 ? -sum : sum, area));
      }
  }
}

// V = Σ m_a and V x̄ = Σ m_a x_a over A's vertices.
void contact_field_slopes(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                          const ContactFieldPair *field, double slopes[96]) {
  ContactClipped clipped;
  double settled[24], lambda[4], moments[4][24] = {{0}};
  const ContactSide side = contact_side_of(layout, pair->cells[0], coordinates);
  contact_side_locate(&side, vec3_at(field->centroid), lambda);
  memcpy(settled, coordinates, sizeof settled);
  contact_layout_unsettle_pair(layout, pair, settled);
  if (contact_clipped_make(&clipped, layout, pair, settled)) {
    for (int i = 0; i < 16; i++)
      add_to(moments[i / 4], i % 4, vec3_scale(lambda[i / 4] * field->volume, side.slope[i % 4]));
    add_faces(&clipped, moments);
  }
  memset(slopes, 0, 96 * sizeof *slopes);
  for (int a = 0; a < 4; a++) {
    double arm[3];
    vec3_store(arm, vec3_scale(1 / field->volume, vec3_sub(side.x[a], vec3_at(field->centroid))));
    for (int k = 0; k < 24; k++) slopes[k] += moments[a][k];
    for (int c = 0; c < 3; c++) {
      for (int k = 0; k < 24; k++) slopes[24 * (c + 1) + k] += arm[c] * moments[a][k];
      slopes[24 * (c + 1) + 3 * a + c] += lambda[a];
    }
  }
}

// From the cells' vertices to the tetrahedra's: a virtual one follows them by its weights.
static void fold_slopes(const ContactLayout *layout, const ContactPair *pair, const double own[24],
                        double slope[24]) {
  for (int t = 0; t < 2; t++)
    for (int c = 0; c < 3; c++) {
      double row[4];
      for (int v = 0; v < 4; v++) row[v] = own[12 * t + 3 * v + c];
      contact_mesh_fold(&layout->mesh, &layout->def, pair->cells[t], row);
      for (int v = 0; v < 4; v++) slope[12 * t + 3 * v + c] += row[v];
    }
}

// m_z = V λ_z(x̄), λ_z = ∇λ_z · (x̄ − x), where the cell's own vertices move with x.
static void pull_moments(const ContactSide sides[2], const double lambda[8], double volume,
                         const Means *means, const double slopes[96], double own[24], double *answer) {
  double by[4] = {0, 0, 0, 0}; // V, x̄
  for (int z = 0; z < 8; z++) {
    Vec3 turn = vec3_scale(volume * means->moments[z], sides[z / 4].slope[z % 4]);
    by[0] += means->moments[z] * lambda[z];
    vec3_accumulate(by + 1, turn);
    for (int v = 4 * (z / 4); v < 4 * (z / 4) + 4; v++) add_to(own, v, vec3_scale(-lambda[v], turn));
  }
  for (int k = 0; k < 24; k++)
    own[k] += by[0] * slopes[k] + by[1] * slopes[24 + k] + by[2] * slopes[48 + k] + by[3] * slopes[72 + k];
  for (int i = 0; i < 4 && answer; i++) answer[i] += by[i];
}

void contact_field_pull(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        const ContactFieldPair *field, const double slopes[96], const ContactFieldSlopes *by,
                        double slope[24], double answer[4]) {
  ContactSide sides[2];
  Means means;
  double own[24] = {0}, lambda[8];
  for (int t = 0; t < 2; t++) {
    sides[t] = contact_side_of(layout, pair->cells[t], coordinates + 12 * t);
    contact_side_locate(&sides[t], vec3_at(field->centroid), lambda + 4 * t);
  }
  find_means(layout, pair, sides, field, by, &means);
  pull_sides(sides, &means, own);
  pull_moments(sides, lambda, field->volume, &means, slopes, own, answer);
  fold_slopes(layout, pair, own, slope);
}

// F = Σ f_v, λ_v = f_v · F / F · F: from the forces on the vertices, whose derivatives are the Hessian.
void contact_field_pull_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                              const double tet[12], const ContactFieldPair *field, const double forces[12],
                              const ContactFieldSlopes *by, double slope[12]) {
  const ContactShape *shape = &layout->def.shapes[layout->interfaces[pair->interface].shape];
  double matrix[144], gradient[12], by_force[12], volume;
  Vec3 force = vec3_at(field->force);
  double square = vec3_dot(force, force);
  if (!(square > 0)) return;
  AreaSlopes area = pull_area(field->volume, field->energy, force, by->area);
  Vec3 force_slope = vec3_add(vec3_at(by->force), area.force);
  for (int v = 0; v < 4; v++) {
    Vec3 across = vec3_sub(vec3_at(forces + 3 * v), vec3_scale(2 * field->weights[0][v], force));
    force_slope = vec3_add(force_slope, vec3_scale(by->weights[0][v] / square, across));
  }
  for (int v = 0; v < 4; v++)
    vec3_store(by_force + 3 * v, vec3_add(force_slope, vec3_scale(by->weights[0][v] / square, force)));
  contact_field_bend_shape(layout, pair, time, tet, matrix);
  contact_shape_overlap(shape, time, tet, &volume, gradient);
  for (int i = 0; i < 12; i++) {
    double sum = 0;
    for (int k = 0; k < 12; k++) sum += matrix[12 * i + k] * by_force[k];
    slope[i] += area.volume * gradient[i] - area.energy * forces[i] - sum;
  }
}
