// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/element/quadratic.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "fem/material/cofactor.h"

enum { NODES = FEM_QUADRATIC_NODES, POINTS = FEM_QUADRATIC_POINTS, DOFS = 3 * NODES };

const int fem_quadratic_edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

// ∂N_a/∂(L₁, L₂, L₃) at a point, L₀ = 1 − L₁ − L₂ − L₃.
static void differentiate(int point, double derivative[NODES][3]) {
  static const double slope[4][3] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double near = (5 + 3 * sqrt(5)) / 20, far = (5 - sqrt(5)) / 20;
  double L[4] = {far, far, far, far};
  L[point] = near;
  for (int c = 0; c < 3; c++) {
    for (int a = 0; a < 4; a++) derivative[a][c] = (4 * L[a] - 1) * slope[a][c];
    for (int k = 0; k < 6; k++) {
      int a = fem_quadratic_edges[k][0], b = fem_quadratic_edges[k][1];
      derivative[4 + k][c] = 4 * (L[a] * slope[b][c] + L[b] * slope[a][c]);
    }
  }
}

// ∂X/∂(L₁, L₂, L₃), positions taken relative to node 0.
static void find_jacobian(const double nodes[30], double (*derivative)[3], double jacobian[9]) {
  memset(jacobian, 0, 9 * sizeof *jacobian);
  for (int a = 1; a < NODES; a++)
    for (int i = 0; i < 3; i++)
      for (int c = 0; c < 3; c++) jacobian[3 * i + c] += (nodes[3 * a + i] - nodes[i]) * derivative[a][c];
}

void fem_quadratic_create_curved(FemQuadratic *element, const double nodes[30]) {
  element->volume = 0;
  for (int p = 0; p < POINTS; p++) {
    double derivative[NODES][3], jacobian[9], cofactor[9];
    differentiate(p, derivative);
    find_jacobian(nodes, derivative, jacobian);
    fem_cofactor_find(jacobian, cofactor);
    double det = fem_cofactor_det(jacobian);
    for (int a = 0; a < NODES; a++)
      for (int i = 0; i < 3; i++)
        element->gradient[p][a][i] =
            (cofactor[3 * i] * derivative[a][0] + cofactor[3 * i + 1] * derivative[a][1] +
             cofactor[3 * i + 2] * derivative[a][2]) /
            det;
    element->weight[p] = det / (6 * POINTS);
    element->volume += element->weight[p];
  }
}

double fem_quadratic_min_jacobian(const double nodes[30]) {
  double straight = vec3_det4(vec3_at(nodes), vec3_at(nodes + 3), vec3_at(nodes + 6), vec3_at(nodes + 9));
  double smallest = INFINITY;
  for (int p = 0; p < POINTS; p++) {
    double derivative[NODES][3], jacobian[9];
    differentiate(p, derivative);
    find_jacobian(nodes, derivative, jacobian);
    smallest = fmin(smallest, fem_cofactor_det(jacobian) / straight);
  }
  return smallest;
}

FemPoint fem_quadratic_point(const FemQuadratic *element, int point) {
  return (FemPoint){NODES, element->gradient[point], element->weight[point]};
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

// P at a point, its share of the mean pressure included.
static void find_stress(FemQuadraticLaw law, double pressure, const double F[9], double P[9]) {
  fem_material_stress(law.local, F, P);
  if (law.bulk == 0) return;
  double gradient[9];
  fem_material_volume(law.local->law, F, gradient);
  for (int r = 0; r < 9; r++) P[r] += pressure * gradient[r];
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
