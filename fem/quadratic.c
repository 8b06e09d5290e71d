// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/quadratic.h"

#include <math.h>
#include <string.h>

#include "fem/cofactor.h"
#include "fem/element.h"
#include "fem/viscous.h"

enum { NODES = FEM_QUADRATIC_NODES, POINTS = FEM_QUADRATIC_POINTS, DOFS = 3 * NODES };

const int fem_quadratic_edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

void fem_quadratic_create(FemQuadratic *element, const double corners[12]) {
  const double near = (5 + 3 * sqrt(5)) / 20, far = (5 - sqrt(5)) / 20;
  FemElement linear;
  fem_element_create(&linear, corners);
  element->volume = linear.volume;
  for (int p = 0; p < POINTS; p++) {
    double L[4] = {far, far, far, far};
    L[p] = near;
    for (int c = 0; c < 3; c++) {
      for (int a = 0; a < 4; a++) element->gradient[p][a][c] = (4 * L[a] - 1) * linear.gradient[a][c];
      for (int k = 0; k < 6; k++) {
        int a = fem_quadratic_edges[k][0], b = fem_quadratic_edges[k][1];
        element->gradient[p][4 + k][c] = 4 * (L[a] * linear.gradient[b][c] + L[b] * linear.gradient[a][c]);
      }
    }
  }
}

FemPoint fem_quadratic_point(const FemQuadratic *element, int point) {
  return (FemPoint){NODES, element->gradient[point], element->volume / POINTS};
}

// ∫ N_a² over ∫ 1: 6/420 at corners, 32/420 at middles.
double fem_quadratic_mass_share(int node) {
  return (node < 4 ? 6.0 : 32.0) / (4 * 6.0 + 6 * 32.0);
}

double fem_quadratic_det(const FemQuadratic *element, int point, const double x[30]) {
  FemPoint at = fem_quadratic_point(element, point);
  double F[9];
  fem_point_deformation(&at, x, F);
  return fem_cofactor_det(F);
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

double fem_quadratic_energy(const FemQuadratic *element, FemQuadraticLaw law, const double x[30]) {
  double sum = 0, F[9];
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    sum += point.weight * fem_material_energy(law.local, F);
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

void fem_quadratic_force(const FemQuadratic *element, FemQuadraticLaw law, const double x[30],
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

void fem_quadratic_stiffness(const FemQuadratic *element, FemQuadraticLaw law, const double x[30],
                             double stiffness[900]) {
  double pressure = mean_pressure(element, law, x), F[9], dP[81], curvature[81], gradient[9];
  double change[DOFS] = {0}; // −V ∂θ̄/∂x
  memset(stiffness, 0, DOFS * DOFS * sizeof *stiffness);
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    fem_material_tangent(law.local, F, dP);
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

void fem_quadratic_damping_force(const FemQuadratic *element, const FemMaterial *material, double beta,
                                 const double x[30], const double v[30], double force[30]) {
  double F[9], rate[9], P[9];
  memset(force, 0, DOFS * sizeof *force);
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    fem_point_deformation(&point, v, rate);
    fem_viscous_stress(material, beta, F, rate, P);
    fem_point_add_force(&point, P, force);
  }
}

double fem_quadratic_damping_power(const FemQuadratic *element, const FemMaterial *material, double beta,
                                   const double x[30], const double v[30]) {
  double F[9], rate[9], power = 0;
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    fem_point_deformation(&point, v, rate);
    power += point.weight * fem_viscous_power(material, beta, F, rate);
  }
  return power;
}

void fem_quadratic_damping_matrix(const FemQuadratic *element, const FemMaterial *material, double beta,
                                  const double x[30], const double v[30], double stiffness_scale,
                                  double damping_scale, double matrix[900]) {
  double F[9], rate[9], tangent[81], geometric[81];
  memset(matrix, 0, DOFS * DOFS * sizeof *matrix);
  for (int p = 0; p < POINTS; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    fem_point_deformation(&point, v, rate);
    fem_viscous_tangent(material, beta, F, tangent);
    fem_viscous_stiffness(material, beta, F, rate, geometric);
    for (int r = 0; r < 81; r++) tangent[r] = damping_scale * tangent[r] + stiffness_scale * geometric[r];
    fem_point_add_tangent(&point, tangent, matrix);
  }
  fem_point_mirror(NODES, matrix);
}

void fem_quadratic_cauchy(const FemQuadratic *element, FemQuadraticLaw law, const double x[30], int part,
                          double stress[6]) {
  double pressure = mean_pressure(element, law, x), F[9], P[9], one[6];
  int begin = part < POINTS ? part : 0, end = part < POINTS ? part + 1 : POINTS;
  memset(stress, 0, 6 * sizeof *stress);
  for (int p = begin; p < end; p++) {
    FemPoint point = fem_quadratic_point(element, p);
    fem_point_deformation(&point, x, F);
    find_stress(law, pressure, F, P);
    fem_material_cauchy(law.local->law, F, P, one);
    for (int s = 0; s < 6; s++) stress[s] += one[s] / (end - begin);
  }
}
