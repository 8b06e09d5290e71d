// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/element.h"

#include <string.h>

#include "reference/material.h"

enum { NODES = FEM_QUADRATIC_NODES, POINTS = FEM_QUADRATIC_POINTS, DOFS = 3 * NODES };

// ---- Linear.

// force_a = −V P ∇N_a.
static void spread_stress(const FemElement *element, const double P[9], double force[12]) {
  for (int i = 0; i < 3; i++) {
    double sum = 0;
    for (int a = 1; a < 4; a++) {
      const double *g = element->gradient[a];
      double f = -element->volume * (P[3 * i] * g[0] + P[3 * i + 1] * g[1] + P[3 * i + 2] * g[2]);
      force[3 * a + i] = f;
      sum += f;
    }
    force[i] = -sum;
  }
}

double reference_element_energy(const FemElement *element, const FemMaterial *material, const double x[12]) {
  double F[9];
  fem_element_deformation(element, x, F);
  return element->volume * reference_energy(material, F);
}

void reference_element_force(const FemElement *element, const FemMaterial *material, const double x[12],
                             double force[12]) {
  double F[9], P[9];
  fem_element_deformation(element, x, F);
  fem_material_stress(material, F, P);
  spread_stress(element, P, force);
}

void reference_element_stiffness(const FemElement *element, const FemMaterial *material, const double x[12],
                                 double stiffness[144]) {
  double F[9], dP[81];
  fem_element_deformation(element, x, F);
  reference_tangent(material, F, dP);
  fem_element_spread_tangent(element, dP, stiffness);
}

void reference_element_damping_force(const FemElement *element, const FemMaterial *material, double beta,
                                     const double x[12], const double v[12], double force[12]) {
  double F[9], rate[9], P[9];
  fem_element_deformation(element, x, F);
  fem_element_deformation(element, v, rate);
  reference_viscous_stress(material, beta, F, rate, P);
  spread_stress(element, P, force);
}

void reference_element_damping_matrix(const FemElement *element, const FemMaterial *material, double beta,
                                      const double x[12], double matrix[144]) {
  double F[9], dP[81];
  fem_element_deformation(element, x, F);
  reference_viscous_tangent(material, beta, F, dP);
  fem_element_spread_tangent(element, dP, matrix);
}

void reference_element_damping_stiffness(const FemElement *element, const FemMaterial *material, double beta,
                                         const double x[12], const double v[12], double matrix[144]) {
  double F[9], rate[9], dP[81];
  fem_element_deformation(element, x, F);
  fem_element_deformation(element, v, rate);
  reference_viscous_stiffness(material, beta, F, rate, dP);
  fem_element_spread_tangent(element, dP, matrix);
}

// ---- Quadratic.

void reference_quadratic_create(FemQuadratic *element, const double corners[12]) {
  double nodes[DOFS];
  memcpy(nodes, corners, 12 * sizeof *nodes);
  for (int k = 0; k < 6; k++)
    for (int i = 0; i < 3; i++) {
      double a = corners[3 * fem_quadratic_edges[k][0] + i], b = corners[3 * fem_quadratic_edges[k][1] + i];
      nodes[3 * (4 + k) + i] = a + 0.5 * (b - a);
    }
  fem_quadratic_create_curved(element, nodes);
}

// V times the mean volume change, V θ̄.
static double sum_volume_change(const FemQuadratic *element, FemMaterialLaw law, const double x[30]) {
  double sum = 0, F[9], gradient[9];
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    sum += point.weight * fem_material_volume(law, F, gradient);
  }
  return sum;
}

// (λ − λ_e) θ̄ [Pa], which acts along ∂θ/∂F at every point.
static double mean_pressure(const FemQuadratic *element, FemQuadraticLaw law, const double x[30]) {
  if (law.bulk == 0) return 0;
  return law.bulk * sum_volume_change(element, law.local->law, x) / element->volume;
}

double reference_quadratic_energy(const FemQuadratic *element, FemQuadraticLaw law, const double x[30]) {
  double sum = 0, F[9];
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    sum += point.weight * reference_energy(law.local, F);
  }
  if (law.bulk == 0) return sum;
  double change = sum_volume_change(element, law.local->law, x);
  return sum + 0.5 * law.bulk * change * change / element->volume;
}

// P at a point, its share of the mean pressure included.
static void find_stress(FemQuadraticLaw law, double pressure, const double F[9], double P[9]) {
  fem_material_stress(law.local, F, P);
  if (law.bulk == 0) return;
  double gradient[9];
  fem_material_volume(law.local->law, F, gradient);
  for (int r = 0; r < 9; r++) P[r] += pressure * gradient[r];
}

void reference_quadratic_force(const FemQuadratic *element, FemQuadraticLaw law, const double x[30],
                               double force[30]) {
  double pressure = mean_pressure(element, law, x), F[9], P[9];
  memset(force, 0, DOFS * sizeof *force);
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    find_stress(law, pressure, F, P);
    fem_point_add_force(&point, P, force);
  }
}

void reference_quadratic_stiffness(const FemQuadratic *element, FemQuadraticLaw law, const double x[30],
                                   double stiffness[900]) {
  double pressure = mean_pressure(element, law, x), F[9], dP[81], curvature[81], gradient[9];
  double change[DOFS] = {0}; // −V ∂θ̄/∂x
  memset(stiffness, 0, DOFS * DOFS * sizeof *stiffness);
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    reference_tangent(law.local, F, dP);
    if (law.bulk > 0) {
      fem_material_volume(law.local->law, F, gradient);
      fem_point_add_force(&point, gradient, change);
      fem_material_volume_curvature(law.local->law, F, curvature);
      for (int r = 0; r < 81; r++) dP[r] += pressure * curvature[r];
    }
    fem_point_add_tangent(&point, dP, stiffness);
  }
  for (int r = 0; law.bulk > 0 && r < DOFS; r++)
    for (int c = r; c < DOFS; c++)
      stiffness[DOFS * r + c] += law.bulk / element->volume * change[r] * change[c];
  fem_point_mirror(NODES, stiffness);
}

void reference_quadratic_damping_force(const FemQuadratic *element, const FemMaterial *material, double beta,
                                       const double x[30], const double v[30], double force[30]) {
  double F[9], rate[9], P[9];
  memset(force, 0, DOFS * sizeof *force);
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    fem_point_deformation(&point, v, rate);
    reference_viscous_stress(material, beta, F, rate, P);
    fem_point_add_force(&point, P, force);
  }
}

void reference_quadratic_damping_matrix(const FemQuadratic *element, const FemMaterial *material, double beta,
                                        const double x[30], const double v[30], double stiffness_scale,
                                        double damping_scale, double matrix[900]) {
  double F[9], rate[9], tangent[81], geometric[81];
  memset(matrix, 0, DOFS * DOFS * sizeof *matrix);
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    fem_point_deformation(&point, v, rate);
    reference_viscous_tangent(material, beta, F, tangent);
    reference_viscous_stiffness(material, beta, F, rate, geometric);
    for (int r = 0; r < 81; r++) tangent[r] = damping_scale * tangent[r] + stiffness_scale * geometric[r];
    fem_point_add_tangent(&point, tangent, matrix);
  }
  fem_point_mirror(NODES, matrix);
}
