// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/rubber.h"

#include <math.h>
#include <string.h>

#include "fem/material/cofactor.h"
#include "fem/material/svd3.h"

static double dot9(const double A[9], const double B[9]) {
  double sum = 0;
  for (int r = 0; r < 9; r++) sum += A[r] * B[r];
  return sum;
}

// Mooney–Rivlin.

// κ', d of the volumetric part ½ κ' (J − 1)² − d (J − 1) beside c₁, c₂.
typedef struct Mooney {
  double c1, c2, kappa, d; // [Pa]
} Mooney;

static Mooney mooney_of(const FemMaterial *material) {
  FemLame lame = fem_material_lame(material);
  Mooney m = {.c1 = 0.5 * lame.mu * (1 - material->mooney), .c2 = 0.5 * lame.mu * material->mooney};
  m.kappa = lame.lambda + 2 * m.c1;
  m.d = 2 * m.c1 + 4 * m.c2;
  return m;
}

// I₁ − 3 = ‖F‖² − 3 and I₂ − 3 = ‖cof F‖² − 3 from G = F − I, where cof F − I = tr G I − Gᵀ + cof G.
double fem_material_mooney_energy(const FemMaterial *material, const double F[9]) {
  Mooney m = mooney_of(material);
  double G[9], H[9];
  for (int r = 0; r < 9; r++) G[r] = F[r] - (r % 4 == 0);
  fem_cofactor_find(G, H);
  double trace = G[0] + G[4] + G[8], swelling = fem_cofactor_swelling(F);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) H[3 * i + j] += (i == j ? trace : 0) - G[3 * j + i];
  double first = 2 * trace + dot9(G, G), second = 2 * (H[0] + H[4] + H[8]) + dot9(H, H);
  return m.c1 * first + m.c2 * second - m.d * swelling + 0.5 * m.kappa * swelling * swelling;
}

// P = 2c₁ F + 2c₂ D(F) cof F + (κ' (J − 1) − d) cof F with D = ∂cof/∂F, which is linear in F.
void fem_material_mooney_stress(const FemMaterial *material, const double F[9], double P[9]) {
  Mooney m = mooney_of(material);
  double C[9], D[81] = {0}, weight = m.kappa * fem_cofactor_swelling(F) - m.d;
  fem_cofactor_find(F, C);
  fem_cofactor_add_derivative(F, 1, D);
  for (int r = 0; r < 9; r++) P[r] = 2 * m.c1 * F[r] + 2 * m.c2 * dot9(D + 9 * r, C) + weight * C[r];
}

// ∂P/∂F = 2c₁ I + 2c₂ (D(cof F) + D D) + κ' cof F ⊗ cof F + (κ' (J − 1) − d) D.
void fem_material_mooney_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
  Mooney m = mooney_of(material);
  double C[9], D[81] = {0};
  fem_cofactor_find(F, C);
  fem_cofactor_add_derivative(F, 1, D);
  for (int r = 0; r < 9; r++)
    for (int c = r; c < 9; c++)
      dP[9 * r + c] = dP[9 * c + r] = 2 * m.c2 * dot9(D + 9 * r, D + 9 * c) + m.kappa * C[r] * C[c];
  for (int r = 0; r < 9; r++) dP[10 * r] += 2 * m.c1;
  fem_cofactor_add_derivative(C, 2 * m.c2, dP);
  fem_cofactor_add_derivative(F, m.kappa * fem_cofactor_swelling(F) - m.d, dP);
}

// Ogden.

// Below this stretch w goes on as its parabola, so that it is finite for σ ≤ 0.
static const double SMALLEST_STRETCH = 0.1;
// Stretches nearer than this have a common derivative: the error is its square.
static const double SAME_STRETCH = 1e-5;
// Sums of stretches below count as this: f is large where σ is small.
static const double SMALLEST_SUM = 1e-4;

// w(σ) = Σ_p μ_p/α_p (σ^α_p − 1) and its derivatives.
typedef struct Ogden {
  double w, f, slope;
} Ogden;

static Ogden ogden_power(const FemMaterial *material, double stretch) {
  double mu = fem_material_lame(material).mu, total = 0;
  Ogden sum = {0, 0, 0};
  for (int p = 0; p < 3; p++) total += material->shares[p];
  for (int p = 0; p < 3; p++) {
    double alpha = material->exponents[p], own = 2 * mu * material->shares[p] / total;
    if (own == 0) continue; // its exponent may be 0
    sum.w += own / (alpha * alpha) * expm1(alpha * log1p(stretch - 1));
    sum.f += own / alpha * pow(stretch, alpha - 1);
    sum.slope += own / alpha * (alpha - 1) * pow(stretch, alpha - 2);
  }
  return sum;
}

static Ogden ogden_at(const FemMaterial *material, double stretch) {
  if (stretch >= SMALLEST_STRETCH) return ogden_power(material, stretch);
  Ogden edge = ogden_power(material, SMALLEST_STRETCH);
  double way = stretch - SMALLEST_STRETCH;
  return (Ogden){.w = edge.w + edge.f * way + 0.5 * edge.slope * way * way,
                 .f = edge.f + edge.slope * way,
                 .slope = edge.slope};
}

// d = w'(1) makes the stress at rest zero; κ' = λ + d.
static double ogden_rest(const FemMaterial *material) {
  return ogden_power(material, 1).f;
}

// With e = σ − 1: Σ (w − d e) − d (e₁e₂ + e₂e₃ + e₃e₁ + e₁e₂e₃) + …, of second order part by part.
double fem_material_ogden_energy(const FemMaterial *material, const double F[9]) {
  FemSvd3 svd;
  fem_svd3_factor(&svd, F);
  double d = ogden_rest(material), kappa = fem_material_lame(material).lambda + d;
  double swelling = fem_cofactor_swelling(F), sum = 0, e[3];
  for (int k = 0; k < 3; k++) {
    e[k] = svd.sigma[k] - 1;
    sum += ogden_at(material, svd.sigma[k]).w - d * e[k];
  }
  sum -= d * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0] + e[0] * e[1] * e[2]);
  return sum + 0.5 * kappa * swelling * swelling;
}

void fem_material_ogden_stress(const FemMaterial *material, const double F[9], double P[9]) {
  FemSvd3 svd;
  fem_svd3_factor(&svd, F);
  double d = ogden_rest(material), kappa = fem_material_lame(material).lambda + d, C[9];
  double weight = kappa * fem_cofactor_swelling(F) - d;
  fem_cofactor_find(F, C);
  for (int r = 0; r < 9; r++) P[r] = weight * C[r];
  for (int k = 0; k < 3; k++) {
    double f = ogden_at(material, svd.sigma[k]).f;
    for (int r = 0; r < 9; r++) P[r] += f * svd.U[3 * (r / 3) + k] * svd.V[3 * (r % 3) + k];
  }
}

static void add_outer(const double mode[9], double weight, double dP[81]) {
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < 9; c++) dP[9 * r + c] += weight * mode[r] * mode[c];
}

// The planes (i, j): twist u_i v_jᵀ − u_j v_iᵀ with (f_i + f_j)/(σ_i + σ_j), flip u_i v_jᵀ + u_j v_iᵀ with
// (f_i − f_j)/(σ_i − σ_j), each of length √2 (Smith, de Goes, Kim 2019).
static void add_plane(const FemMaterial *material, const FemSvd3 *svd, int i, int j, double dP[81]) {
  double a = svd->sigma[i], b = svd->sigma[j];
  double fa = ogden_at(material, a).f, fb = ogden_at(material, b).f;
  double twisting = (fa + fb) / fmax(a + b, SMALLEST_SUM);
  double flipping =
      fabs(a - b) > SAME_STRETCH ? (fa - fb) / (a - b) : ogden_at(material, 0.5 * (a + b)).slope;
  double twist[9], flip[9];
  for (int r = 0; r < 9; r++) {
    double ij = svd->U[3 * (r / 3) + i] * svd->V[3 * (r % 3) + j];
    double ji = svd->U[3 * (r / 3) + j] * svd->V[3 * (r % 3) + i];
    twist[r] = ij - ji;
    flip[r] = ij + ji;
  }
  add_outer(twist, 0.5 * twisting, dP);
  add_outer(flip, 0.5 * flipping, dP);
}

void fem_material_ogden_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
  FemSvd3 svd;
  double C[9], d = ogden_rest(material), kappa = fem_material_lame(material).lambda + d;
  fem_svd3_factor(&svd, F);
  fem_cofactor_find(F, C);
  memset(dP, 0, 81 * sizeof *dP);
  add_outer(C, kappa, dP);
  for (int k = 0; k < 3; k++) {
    double mode[9];
    for (int r = 0; r < 9; r++) mode[r] = svd.U[3 * (r / 3) + k] * svd.V[3 * (r % 3) + k];
    add_outer(mode, ogden_at(material, svd.sigma[k]).slope, dP);
    add_plane(material, &svd, k, (k + 1) % 3, dP);
  }
  fem_cofactor_add_derivative(F, kappa * fem_cofactor_swelling(F) - d, dP);
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < r; c++) dP[9 * r + c] = dP[9 * c + r];
}
