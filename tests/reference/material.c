// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/material.h"

#include <math.h>
#include <string.h>

#include "fem/material/cofactor.h"
#include "fem/material/isochoric.h"
#include "fem/material/log.h"
#include "fem/material/rubber.h"
#include "fem/material/svd3.h"

static double dot9(const double A[9], const double B[9]) {
  double sum = 0;
  for (int r = 0; r < 9; r++) sum += A[r] * B[r];
  return sum;
}

// 2μ e + λ tr e I.
static void apply_hooke(FemLame lame, const double strain[9], double stress[9]) {
  double pressure = lame.lambda * (strain[0] + strain[4] + strain[8]);
  for (int r = 0; r < 9; r++) stress[r] = 2 * lame.mu * strain[r];
  stress[0] += pressure, stress[4] += pressure, stress[8] += pressure;
}

static void linear_tangent(FemLame lame, double dP[81]) {
  memset(dP, 0, 81 * sizeof *dP);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int r = 3 * i + j;
      dP[9 * r + r] += lame.mu;
      dP[9 * r + 3 * j + i] += lame.mu;
      dP[9 * 4 * i + 4 * j] += lame.lambda;
    }
}

// Corotational.

static double stretch_trace(const FemSvd3 *svd) {
  return (svd->sigma[0] - 1) + (svd->sigma[1] - 1) + (svd->sigma[2] - 1);
}

// u_i v_jᵀ − u_j v_iᵀ: how R moves where F is twisted in the plane (i, j).
static void find_twist(const FemSvd3 *svd, int i, int j, double twist[9]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      twist[3 * r + c] = svd->U[3 * r + i] * svd->V[3 * c + j] - svd->U[3 * r + j] * svd->V[3 * c + i];
}

// dP = 2μ dF + λ (R : dF) R + (λ tr(S − I) − 2μ) dR. With twists Q_ij = u_i v_jᵀ − u_j v_iᵀ,
// dR = Σ_{i<j} (Q_ij : dF) Q_ij / (σ_i + σ_j)   (Smith, de Goes, Kim 2019, "Analytic eigensystems for
// isotropic distortion energies").
static void corotational_tangent(FemLame lame, const double F[9], double dP[81]) {
  static const int pairs[3][2] = {{0, 1}, {1, 2}, {0, 2}};
  FemSvd3 svd;
  double modes[4][9], weights[4];
  fem_svd3_factor(&svd, F);
  fem_svd3_rotation(&svd, modes[3]);
  weights[3] = lame.lambda;
  double turning = lame.lambda * stretch_trace(&svd) - 2 * lame.mu;
  for (int k = 0; k < 3; k++) {
    double sum = svd.sigma[pairs[k][0]] + svd.sigma[pairs[k][1]];
    find_twist(&svd, pairs[k][0], pairs[k][1], modes[k]);
    weights[k] = turning / (sum < FEM_MATERIAL_SMALLEST_SUM ? FEM_MATERIAL_SMALLEST_SUM : sum);
  }
  for (int r = 0; r < 9; r++) {
    double scaled[4];
    for (int k = 0; k < 4; k++) scaled[k] = weights[k] * modes[k][r];
    for (int c = r; c < 9; c++)
      dP[9 * r + c] = dP[9 * c + r] = scaled[0] * modes[0][c] + scaled[1] * modes[1][c] +
                                      scaled[2] * modes[2][c] + scaled[3] * modes[3][c];
    dP[10 * r] += 2 * lame.mu;
  }
}

// St. Venant–Kirchhoff.

// E = ½ (G + Gᵀ + Gᵀ G) with G = F − I, which keeps small strains' digits.
static void find_green_strain(const double F[9], double strain[9]) {
  double G[9];
  for (int r = 0; r < 9; r++) G[r] = F[r] - (r % 4 == 0);
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      double product = G[i] * G[j] + G[3 + i] * G[3 + j] + G[6 + i] * G[6 + j];
      strain[3 * i + j] = strain[3 * j + i] = 0.5 * (G[3 * i + j] + G[3 * j + i] + product);
    }
}

static void second_stress(FemLame lame, const double F[9], double S[9]) {
  double strain[9];
  find_green_strain(F, strain);
  apply_hooke(lame, strain, S);
}

// ∂P_ij/∂F_kl = μ ((F Fᵀ)_ik δ_jl + F_il F_kj) + λ F_ij F_kl.
void reference_pushed_stiffness(FemLame lame, const double F[9], double dP[81]) {
  double left[9]; // F Fᵀ
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      left[3 * i + k] = F[3 * i] * F[3 * k] + F[3 * i + 1] * F[3 * k + 1] + F[3 * i + 2] * F[3 * k + 2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++) {
        double *row = dP + 9 * (3 * i + j) + 3 * k;
        for (int l = 0; l < 3; l++)
          row[l] = lame.mu * (F[3 * i + l] * F[3 * k + j]) + lame.lambda * (F[3 * i + j] * F[3 * k + l]);
        row[j] += lame.mu * left[3 * i + k];
      }
}

// … + δ_ik S_jl.
static void stvk_tangent(FemLame lame, const double F[9], double dP[81]) {
  double S[9];
  second_stress(lame, F, S);
  reference_pushed_stiffness(lame, F, dP);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int l = 0; l < 3; l++) dP[9 * (3 * i + j) + 3 * i + l] += S[3 * j + l];
}

// Stable neo-Hookean. Its own parameters, such that the given λ, μ are the small-strain ones.
static FemLame neo_hookean_parameters(FemLame lame) {
  return (FemLame){.lambda = lame.lambda + 5.0 / 6.0 * lame.mu, .mu = 4.0 / 3.0 * lame.mu};
}

// The factor of cof F in P: λ' (J − α) = λ' (J − 1) − ¾ μ'.
static double cofactor_weight(FemLame own, const double F[9], const double C[9]) {
  double J = F[0] * C[0] + F[1] * C[1] + F[2] * C[2];
  return own.lambda * (J - 1) - 0.75 * own.mu;
}

// ∂P/∂F = μ' (1 − 1/(I_C + 1)) I + 2 μ'/(I_C + 1)² F ⊗ F + λ' cof F ⊗ cof F + λ' (J − α) ∂cof F/∂F.
static void neo_hookean_tangent(FemLame lame, const double F[9], double dP[81]) {
  FemLame own = neo_hookean_parameters(lame);
  double C[9], square = dot9(F, F);
  fem_cofactor_find(F, C);
  double a = own.mu * (square / (square + 1)), b = cofactor_weight(own, F, C);
  double f = 2 * own.mu / ((square + 1) * (square + 1));
  for (int r = 0; r < 9; r++) {
    for (int c = 0; c < 9; c++) dP[9 * r + c] = f * (F[r] * F[c]) + own.lambda * (C[r] * C[c]);
    dP[10 * r] += a;
  }
  fem_cofactor_add_derivative(F, b, dP);
}

// Neo-Hookean with the logarithm.

// ∂P/∂F = μ I + (λ θ'² + (λ θ − μ) θ'') cof F ⊗ cof F + (λ θ − μ) θ' ∂cof F/∂F.
static void log_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
  FemLame lame = fem_material_lame(material);
  FemMaterialLog theta = fem_material_log(fem_cofactor_swelling(F));
  double C[9], pressure = lame.lambda * theta.value - lame.mu;
  double outer = lame.lambda * theta.slope * theta.slope + pressure * theta.bend;
  fem_cofactor_find(F, C);
  for (int r = 0; r < 9; r++) {
    for (int c = 0; c < 9; c++) dP[9 * r + c] = outer * (C[r] * C[c]);
    dP[10 * r] += lame.mu;
  }
  fem_cofactor_add_derivative(F, pressure * theta.slope, dP);
}

// Isochoric.

// I_C − 3 from the displacement gradient.
static double stretch_of(const double F[9]) {
  double stretch = 0;
  for (int r = 0; r < 9; r++) {
    double G = F[r] - (r % 4 == 0);
    stretch += G * G + (r % 4 == 0 ? 2 * G : 0);
  }
  return stretch;
}

static double bulk_of(FemLame lame) {
  return lame.lambda + 2.0 / 3 * lame.mu;
}

// ∂P/∂F = μ g I + μ g' (F ⊗ cof F + cof F ⊗ F) + (μ/2 g'' I_C + K) cof F ⊗ cof F
//         + (μ/2 g' I_C + K (J − 1)) ∂cof F/∂F.
static void isochoric_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
  FemLame lame = fem_material_lame(material);
  double C[9], swelling = fem_cofactor_swelling(F), I = stretch_of(F) + 3;
  FemMaterialPower g = fem_material_isochoric_power(swelling);
  double outer = 0.5 * lame.mu * g.bend * I + bulk_of(lame), mixed = lame.mu * g.slope;
  fem_cofactor_find(F, C);
  for (int r = 0; r < 9; r++) {
    for (int c = 0; c < 9; c++) dP[9 * r + c] = mixed * (F[r] * C[c] + C[r] * F[c]) + outer * (C[r] * C[c]);
    dP[10 * r] += lame.mu * (1 + g.less_one);
  }
  fem_cofactor_add_derivative(F, 0.5 * lame.mu * g.slope * I + bulk_of(lame) * swelling, dP);
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

// ∂P/∂F = 2c₁ I + 2c₂ (D(cof F) + D D) + κ' cof F ⊗ cof F + (κ' (J − 1) − d) D.
static void mooney_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
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

static FemOgdenForce ogden_power(const FemOgden *law, double stretch) {
  FemOgdenForce f = {0, 0};
  for (int p = 0; p < 3; p++) {
    if (law->own[p] == 0) continue;
    double term = law->own[p] * pow(stretch, law->power[p]);
    f.value += term;
    f.slope += law->power[p] * term / stretch;
  }
  return f;
}

static FemOgdenForce ogden_force(const FemOgden *law, double stretch) {
  const double least = FEM_MATERIAL_OGDEN_SMALLEST;
  if (stretch >= least) return ogden_power(law, stretch);
  FemOgdenForce edge = ogden_power(law, least);
  return (FemOgdenForce){edge.value + edge.slope * (stretch - least), edge.slope};
}

// (f(a) − f(b))/(a − b), to all digits however near they are: a^q − b^q = b^q ((1 + (a − b)/b)^q − 1). Below
// the edge the share of the way that is above it counts.
static double ogden_quotient(const FemOgden *law, double a, double b) {
  const double least = FEM_MATERIAL_OGDEN_SMALLEST;
  double high = fmax(a, least), low = fmax(b, least), d = high - low, sum = 0;
  for (int p = 0; p < 3; p++) {
    double q = law->power[p];
    if (law->own[p] != 0)
      sum += law->own[p] * pow(low, q) * (d == 0 ? q / low : expm1(q * log1p(d / low)) / d);
  }
  if (high == a && low == b) return sum;
  double share = a == b ? 1 : d / (a - b);
  return share * sum + (1 - share) * ogden_power(law, least).slope;
}

// d = w'(1) makes the stress at rest zero; κ' = λ + d.
static double ogden_rest(const FemOgden *law) {
  return law->own[0] + law->own[1] + law->own[2];
}

static void add_outer(const double mode[9], double weight, double dP[81]) {
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < 9; c++) dP[9 * r + c] += weight * mode[r] * mode[c];
}

// The planes (i, j): twist u_i v_jᵀ − u_j v_iᵀ with (f_i + f_j)/(σ_i + σ_j), flip u_i v_jᵀ + u_j v_iᵀ with
// (f_i − f_j)/(σ_i − σ_j), each of length √2 (Smith, de Goes, Kim 2019).
static void add_plane(const FemOgden *law, const FemSvd3 *svd, int i, int j, double dP[81]) {
  double a = svd->sigma[i], b = svd->sigma[j];
  double forces = ogden_force(law, a).value + ogden_force(law, b).value;
  double twisting = forces / fmax(a + b, FEM_MATERIAL_OGDEN_SMALLEST_SUM);
  double flipping = ogden_quotient(law, a, b);
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

static void ogden_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
  FemSvd3 svd;
  FemOgden law = fem_material_ogden(material);
  double C[9], d = ogden_rest(&law), kappa = fem_material_lame(material).lambda + d;
  fem_svd3_factor(&svd, F);
  fem_cofactor_find(F, C);
  memset(dP, 0, 81 * sizeof *dP);
  add_outer(C, kappa, dP);
  for (int k = 0; k < 3; k++) {
    double mode[9];
    for (int r = 0; r < 9; r++) mode[r] = svd.U[3 * (r / 3) + k] * svd.V[3 * (r % 3) + k];
    add_outer(mode, ogden_force(&law, svd.sigma[k]).slope, dP);
    add_plane(&law, &svd, k, (k + 1) % 3, dP);
  }
  fem_cofactor_add_derivative(F, kappa * fem_cofactor_swelling(F) - d, dP);
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < r; c++) dP[9 * r + c] = dP[9 * c + r];
}

// Fibres along a: E_f, F a, and k, which is 0 where they buckle.
typedef struct Fibre {
  double stiffness, strain, direction[3], pushed[3];
} Fibre;

static Fibre fibre_of(const FemMaterial *material, const double F[9]) {
  const double *a = material->fibre_direction;
  double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]), G[9];
  Fibre fibre = {.stiffness = material->fibre_stiffness};
  for (int r = 0; r < 9; r++) G[r] = F[r] - (r % 4 == 0);
  for (int c = 0; c < 3; c++) fibre.direction[c] = a[c] / length;
  for (int i = 0; i < 3; i++) { // E_f = a·G a + ½ |G a|²
    const double *d = fibre.direction;
    double stretch = G[3 * i] * d[0] + G[3 * i + 1] * d[1] + G[3 * i + 2] * d[2];
    fibre.pushed[i] = d[i] + stretch;
    fibre.strain += stretch * (d[i] + 0.5 * stretch);
  }
  if (material->fibres_buckle && fibre.strain < 0) fibre.stiffness = 0;
  return fibre;
}

// ∂P_f/∂F = k (Fa ⊗ a)(Fa ⊗ a) + k E_f δ_ik a_j a_l.
static void add_fibre_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
  Fibre fibre = fibre_of(material, F);
  const double *a = fibre.direction, *b = fibre.pushed;
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < 9; c++) {
      double along = a[r % 3] * a[c % 3];
      dP[9 * r + c] += fibre.stiffness * along * (b[r / 3] * b[c / 3] + (r / 3 == c / 3 ? fibre.strain : 0));
    }
}

// Ψ by law.

static void find_small_strain(const double F[9], double strain[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) strain[3 * i + j] = 0.5 * (F[3 * i + j] + F[3 * j + i]) - (i == j);
}

static double quadratic_energy(FemLame lame, const double strain[9]) {
  double trace = strain[0] + strain[4] + strain[8];
  return lame.mu * dot9(strain, strain) + 0.5 * lame.lambda * trace * trace;
}

static double corotational_energy(FemLame lame, const double F[9]) {
  FemSvd3 svd;
  fem_svd3_factor(&svd, F);
  double squares = 0, trace = 0;
  for (int k = 0; k < 3; k++) {
    double stretch = svd.sigma[k] - 1;
    squares += stretch * stretch;
    trace += stretch;
  }
  return lame.mu * squares + 0.5 * lame.lambda * trace * trace;
}

static double neo_hookean_energy(FemLame lame, const double F[9]) {
  FemLame own = neo_hookean_parameters(lame);
  double G[9];
  for (int r = 0; r < 9; r++) G[r] = F[r] - (r % 4 == 0);
  // I_C − 3 from the displacement gradient: no cancellation at small strain.
  double stretch = 2 * (G[0] + G[4] + G[8]) + dot9(G, G), swelling = fem_cofactor_swelling(F);
  return 0.5 * own.mu * (stretch - log1p(0.25 * stretch) - 1.5 * swelling) +
         0.5 * own.lambda * swelling * swelling;
}

// μ/2 (I_C − 3) − μ θ + λ/2 θ², I_C − 3 from the displacement gradient.
static double log_energy(const FemMaterial *material, const double F[9]) {
  FemLame lame = fem_material_lame(material);
  double stretch = stretch_of(F);
  double theta = fem_material_log(fem_cofactor_swelling(F)).value;
  return lame.mu * (0.5 * stretch - theta) + 0.5 * lame.lambda * theta * theta;
}

// μ/2 (g I_C − 3) + K/2 (J − 1)².
static double isochoric_energy(const FemMaterial *material, const double F[9]) {
  FemLame lame = fem_material_lame(material);
  double swelling = fem_cofactor_swelling(F), stretch = stretch_of(F);
  FemMaterialPower g = fem_material_isochoric_power(swelling);
  return 0.5 * lame.mu * (stretch + g.less_one * (stretch + 3)) + 0.5 * bulk_of(lame) * swelling * swelling;
}

// I₁ − 3 = ‖F‖² − 3 and I₂ − 3 = ‖cof F‖² − 3 from G = F − I, where cof F − I = tr G I − Gᵀ + cof G.
static double mooney_energy(const FemMaterial *material, const double F[9]) {
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

// w(σ) = Σ μ_p/α_p (σ^α_p − 1)
static double power_energy(const FemOgden *law, double stretch) {
  const double least = FEM_MATERIAL_OGDEN_SMALLEST, kept = fmax(stretch, least), way = stretch - kept;
  double sum = 0;
  for (int p = 0; p < 3; p++) {
    double alpha = law->power[p] + 1;
    if (law->own[p] != 0) sum += law->own[p] / alpha * expm1(alpha * log1p(kept - 1));
  }
  if (way == 0) return sum;
  FemOgdenForce edge = ogden_power(law, least);
  return sum + edge.value * way + 0.5 * edge.slope * way * way;
}

// With e = σ − 1: Σ (w − d e) − d (e₁e₂ + e₂e₃ + e₃e₁ + e₁e₂e₃) + …, of second order part by part.
static double ogden_energy(const FemMaterial *material, const double F[9]) {
  FemSvd3 svd;
  fem_svd3_factor(&svd, F);
  FemOgden law = fem_material_ogden(material);
  double d = ogden_rest(&law), kappa = fem_material_lame(material).lambda + d;
  double swelling = fem_cofactor_swelling(F), sum = 0, e[3];
  for (int k = 0; k < 3; k++) {
    e[k] = svd.sigma[k] - 1;
    sum += power_energy(&law, svd.sigma[k]) - d * e[k];
  }
  sum -= d * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0] + e[0] * e[1] * e[2]);
  return sum + 0.5 * kappa * swelling * swelling;
}

static double law_energy(const FemMaterial *material, const double F[9]) {
  FemLame lame = fem_material_lame(material);
  double strain[9];
  switch (material->law) {
  case FEM_MATERIAL_LINEAR:
    find_small_strain(F, strain);
    return quadratic_energy(lame, strain);
  case FEM_MATERIAL_COROTATIONAL:
    return corotational_energy(lame, F);
  case FEM_MATERIAL_STVK:
    find_green_strain(F, strain);
    return quadratic_energy(lame, strain);
  case FEM_MATERIAL_NEO_HOOKEAN:
    return neo_hookean_energy(lame, F);
  case FEM_MATERIAL_NEO_HOOKEAN_LOG:
    return log_energy(material, F);
  case FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC:
    return isochoric_energy(material, F);
  case FEM_MATERIAL_MOONEY_RIVLIN:
    return mooney_energy(material, F);
  case FEM_MATERIAL_OGDEN:
    return ogden_energy(material, F);
  }
  return NAN;
}

double reference_energy(const FemMaterial *material, const double F[9]) {
  double own = law_energy(material, F);
  if (!(material->fibre_stiffness > 0)) return own;
  Fibre fibre = fibre_of(material, F);
  return own + 0.5 * fibre.stiffness * fibre.strain * fibre.strain;
}

void reference_tangent(const FemMaterial *material, const double F[9], double dP[81]) {
  FemLame lame = fem_material_lame(material);
  switch (material->law) {
  case FEM_MATERIAL_LINEAR:
    linear_tangent(lame, dP);
    break;
  case FEM_MATERIAL_COROTATIONAL:
    corotational_tangent(lame, F, dP);
    break;
  case FEM_MATERIAL_STVK:
    stvk_tangent(lame, F, dP);
    break;
  case FEM_MATERIAL_NEO_HOOKEAN:
    neo_hookean_tangent(lame, F, dP);
    break;
  case FEM_MATERIAL_NEO_HOOKEAN_LOG:
    log_tangent(material, F, dP);
    break;
  case FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC:
    isochoric_tangent(material, F, dP);
    break;
  case FEM_MATERIAL_MOONEY_RIVLIN:
    mooney_tangent(material, F, dP);
    break;
  case FEM_MATERIAL_OGDEN:
    ogden_tangent(material, F, dP);
    break;
  }
  if (material->fibre_stiffness > 0) add_fibre_tangent(material, F, dP);
}

// Damping.

// The law linear does not tell the two configurations apart: its F is I.
static const double *damped_deformation(const FemMaterial *material, const double F[9]) {
  static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return fem_material_is_linear(material) ? identity : F;
}

// Ė = sym(Fᵀ Ḟ) and the viscous second Piola–Kirchhoff stress Σ = 2μ_v Ė + λ_v tr Ė I.
static void find_viscous_stress(const FemMaterial *material, double beta, const double F[9],
                                const double rate[9], double strain_rate[9], double stress[9]) {
  FemLame lame = fem_material_viscous(material, beta);
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      double sum = 0;
      for (int m = 0; m < 9; m += 3) sum += F[m + i] * rate[m + j] + rate[m + i] * F[m + j];
      strain_rate[3 * i + j] = strain_rate[3 * j + i] = 0.5 * sum;
    }
  double pressure = lame.lambda * (strain_rate[0] + strain_rate[4] + strain_rate[8]);
  for (int r = 0; r < 9; r++) stress[r] = 2 * lame.mu * strain_rate[r] + (r % 4 == 0 ? pressure : 0);
}

void reference_viscous_stress(const FemMaterial *material, double beta, const double F[9],
                              const double rate[9], double P[9]) {
  double strain_rate[9], stress[9];
  F = damped_deformation(material, F);
  find_viscous_stress(material, beta, F, rate, strain_rate, stress);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      P[3 * i + j] = F[3 * i] * stress[j] + F[3 * i + 1] * stress[3 + j] + F[3 * i + 2] * stress[6 + j];
}

void reference_viscous_tangent(const FemMaterial *material, double beta, const double F[9], double dP[81]) {
  reference_pushed_stiffness(fem_material_viscous(material, beta), damped_deformation(material, F), dP);
}

// P_v = F Σ(F, Ḟ), so ∂P_v = ∂F Σ + F C_v : sym(Ḟᵀ ∂F). The first term is this.
void reference_viscous_stiffness(const FemMaterial *material, double beta, const double F[9],
                                 const double rate[9], double dP[81]) {
  double strain_rate[9], stress[9];
  memset(dP, 0, 81 * sizeof *dP);
  if (fem_material_is_linear(material)) return;
  find_viscous_stress(material, beta, F, rate, strain_rate, stress);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int l = 0; l < 3; l++) dP[9 * (3 * i + j) + 3 * i + l] += stress[3 * j + l];
}
