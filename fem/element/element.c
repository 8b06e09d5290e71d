// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/element/element.h"

#include "base/vec3.h"

// Everything below uses nodes 1, 2, 3 only, relative to node 0: the gradients add up to zero, so node 0 takes
// minus the sum of the others.

void fem_element_create(FemElement *element, const double rest[12]) {
  Vec3 origin = vec3_at(rest), edge[3];
  for (int a = 0; a < 3; a++) edge[a] = vec3_sub(vec3_at(rest + 3 * (a + 1)), origin);
  double six_volumes = vec3_dot(edge[0], vec3_cross(edge[1], edge[2]));
  Vec3 sum = {0, 0, 0};
  for (int a = 0; a < 3; a++) {
    Vec3 face = vec3_cross(edge[(a + 1) % 3], edge[(a + 2) % 3]);
    Vec3 gradient = vec3_scale(1 / six_volumes, face);
    vec3_store(element->gradient[a + 1], gradient);
    sum = vec3_add(sum, gradient);
  }
  vec3_store(element->gradient[0], vec3_scale(-1, sum));
  element->volume = six_volumes / 6;
}

void fem_element_deformation(const FemElement *element, const double x[12], double F[9]) {
  for (int i = 0; i < 3; i++) {
    double d1 = x[3 + i] - x[i], d2 = x[6 + i] - x[i], d3 = x[9 + i] - x[i];
    for (int j = 0; j < 3; j++)
      F[3 * i + j] =
          d1 * element->gradient[1][j] + d2 * element->gradient[2][j] + d3 * element->gradient[3][j];
  }
}

// products[a − 1][3 i + j][k] = Σ_l ∂P_ij/∂F_kl ∂N_a/∂X_l: how P answers when node a moves along k.
static void contract_columns(const FemElement *element, const double dP[81], double products[3][9][3]) {
  for (int a = 0; a < 3; a++) {
    double g0 = element->gradient[a + 1][0], g1 = element->gradient[a + 1][1],
           g2 = element->gradient[a + 1][2];
    for (int r = 0; r < 9; r++) {
      const double *row = dP + 9 * r;
      for (int k = 0; k < 3; k++)
        products[a][r][k] = row[3 * k] * g0 + row[3 * k + 1] * g1 + row[3 * k + 2] * g2;
    }
  }
}

// Node 0's rows and columns: minus the sums over the others.
static void complete_matrix(double matrix[144]) {
  for (int i = 0; i < 3; i++) {
    for (int c = 3; c < 12; c++) {
      double sum = matrix[12 * (3 + i) + c] + matrix[12 * (6 + i) + c] + matrix[12 * (9 + i) + c];
      matrix[12 * i + c] = matrix[12 * c + i] = -sum;
    }
  }
  for (int i = 0; i < 3; i++)
    for (int k = i; k < 3; k++) {
      double sum = matrix[12 * i + 3 + k] + matrix[12 * i + 6 + k] + matrix[12 * i + 9 + k];
      matrix[12 * i + k] = matrix[12 * k + i] = -sum;
    }
}

// K_ai,bk = V Σ_jl ∂N_a/∂X_j ∂P_ij/∂F_kl ∂N_b/∂X_l, for symmetric dP.
void fem_element_spread_tangent(const FemElement *element, const double dP[81], double matrix[144]) {
  double products[3][9][3];
  contract_columns(element, dP, products);
  for (int a = 0; a < 3; a++) {
    const double *g = element->gradient[a + 1];
    double g0 = element->volume * g[0], g1 = element->volume * g[1], g2 = element->volume * g[2];
    for (int b = a; b < 3; b++)
      for (int i = 0; i < 3; i++)
        for (int k = a == b ? i : 0; k < 3; k++) {
          int r = 3 * (a + 1) + i, c = 3 * (b + 1) + k;
          double entry =
              g0 * products[b][3 * i][k] + g1 * products[b][3 * i + 1][k] + g2 * products[b][3 * i + 2][k];
          matrix[12 * r + c] = matrix[12 * c + r] = entry;
        }
  }
  complete_matrix(matrix);
}

void fem_element_cauchy(const FemElement *element, const FemMaterial *material, const double x[12],
                        double stress[6]) {
  double F[9], P[9];
  fem_element_deformation(element, x, F);
  fem_material_stress(material, F, P);
  fem_material_cauchy(material->law, F, P, stress);
}
