// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/material.h"

#include <math.h>
#include <string.h>

#include "fem/material/cofactor.h"
#include "fem/material/isochoric.h"
#include "fem/material/log.h"
#include "fem/material/rubber.h"
#include "fem/material/svd3.h"

static const struct {
  const char *name, *help;
} laws[FEM_MATERIAL_LAW_COUNT] = {
    [FEM_MATERIAL_LINEAR] = {"linear", "Hooke's law in fixed axes: small strains and small rotations"},
    [FEM_MATERIAL_COROTATIONAL] = {"corotational",
                                   "small strains, large rotations: linear in the polar stretch"},
    [FEM_MATERIAL_STVK] = {"stvk",
                           "St. Venant-Kirchhoff: large rotations; collapses under strong compression"},
    [FEM_MATERIAL_NEO_HOOKEAN] = {"neo_hookean",
                                  "stable neo-Hookean: large strains, recovers from inversion"},
    [FEM_MATERIAL_NEO_HOOKEAN_LOG] = {"neo_hookean_log",
                                      "neo-Hookean with the logarithm of the volume: bears any pressure"},
    [FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC] =
        {"neo_hookean_isochoric", "neo-Hookean as in CalculiX and Abaqus, with isochoric shear part"},
    [FEM_MATERIAL_MOONEY_RIVLIN] = {"mooney_rivlin",
                                    "Mooney-Rivlin rubber: two invariants, in proportions set by `mooney`"},
    [FEM_MATERIAL_OGDEN] = {"ogden", "Ogden rubber: up to three powers of the principal stretches"},
};

const char *fem_material_name(FemMaterialLaw law) {
  return laws[law].name;
}
const char *fem_material_help(FemMaterialLaw law) {
  return laws[law].help;
}

const char *fem_material_limit(FemMaterialLaw law) {
  switch (law) {
  case FEM_MATERIAL_STVK:
    return "St. Venant-Kirchhoff's law bears the largest pressure at 0.58 of a length, where ever less "
           "resists more compression; take law: neo_hookean or neo_hookean_log, or a smaller load";
  case FEM_MATERIAL_LINEAR:
  case FEM_MATERIAL_COROTATIONAL:
    return "its law resists compression by no more than a spring, to nothing left and beyond; take law: "
           "neo_hookean_log, or a smaller load";
  case FEM_MATERIAL_NEO_HOOKEAN_LOG:
    return "its law bears any pressure, so the mesh folds: refine it there, or take smaller steps of load "
           "(time.max_step)";
  default:
    return "the pressure that its law bears has an end as the volume vanishes; take law: neo_hookean_log, or "
           "a smaller load or impact";
  }
}

FemMaterial fem_material_with_lame(const FemMaterial *material, FemLame lame) {
  FemMaterial other = *material;
  other.young = lame.mu * (3 * lame.lambda + 2 * lame.mu) / (lame.lambda + lame.mu);
  other.poisson = lame.lambda / (2 * (lame.lambda + lame.mu));
  return other;
}

FemMaterial fem_material_with_lambda(const FemMaterial *material, double lambda) {
  return fem_material_with_lame(material, (FemLame){lambda, fem_material_lame(material).mu});
}

FemMaterial fem_material_local(const FemMaterial *material) {
  FemLame lame = fem_material_lame(material);
  double most = FEM_MATERIAL_LARGEST_LOCAL_RATIO * lame.mu;
  return lame.lambda <= most ? *material : fem_material_with_lambda(material, most);
}

static inline double dot9(const double A[9], const double B[9]) {
  double sum = 0;
  for (int r = 0; r < 9; r++) sum += A[r] * B[r];
  return sum;
}

// Linear: ε = sym F − I, P = 2μ ε + λ tr ε I.

static void find_small_strain(const double F[9], double strain[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) strain[3 * i + j] = 0.5 * (F[3 * i + j] + F[3 * j + i]) - (i == j);
}

// 2μ e + λ tr e I.
static void apply_hooke(FemLame lame, const double strain[9], double stress[9]) {
  double pressure = lame.lambda * (strain[0] + strain[4] + strain[8]);
  for (int r = 0; r < 9; r++) stress[r] = 2 * lame.mu * strain[r];
  stress[0] += pressure, stress[4] += pressure, stress[8] += pressure;
}

static void linear_stress(FemLame lame, const double F[9], double P[9]) {
  double strain[9];
  find_small_strain(F, strain);
  apply_hooke(lame, strain, P);
}

// Corotational: P = 2μ (F − R) + λ tr(S − I) R.

static double stretch_trace(const FemSvd3 *svd) {
  return (svd->sigma[0] - 1) + (svd->sigma[1] - 1) + (svd->sigma[2] - 1);
}

static void corotational_stress(FemLame lame, const double F[9], double P[9]) {
  FemSvd3 svd;
  double R[9];
  fem_svd3_factor(&svd, F);
  fem_svd3_rotation(&svd, R);
  double pressure = lame.lambda * stretch_trace(&svd);
  for (int r = 0; r < 9; r++) P[r] = 2 * lame.mu * (F[r] - R[r]) + pressure * R[r];
}

// u_i v_jᵀ − u_j v_iᵀ: how R moves where F is twisted in the plane (i, j).
static inline void find_twist(const FemSvd3 *svd, int i, int j, double twist[9]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      twist[3 * r + c] = svd->U[3 * r + i] * svd->V[3 * c + j] - svd->U[3 * r + j] * svd->V[3 * c + i];
}

// dP += ∂R/∂F, as below.
static void add_rotation_derivative(const double F[9], double dP[81]) {
  static const int pairs[3][2] = {{0, 1}, {1, 2}, {0, 2}};
  FemSvd3 svd;
  fem_svd3_factor(&svd, F);
  for (int k = 0; k < 3; k++) {
    double twist[9], sum = svd.sigma[pairs[k][0]] + svd.sigma[pairs[k][1]];
    find_twist(&svd, pairs[k][0], pairs[k][1], twist);
    double weight = 1 / fmax(sum, FEM_MATERIAL_SMALLEST_SUM);
    for (int r = 0; r < 9; r++)
      for (int c = 0; c < 9; c++) dP[9 * r + c] += weight * twist[r] * twist[c];
  }
}

// St. Venant–Kirchhoff: P = F S, S = 2μ E + λ tr E I.

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

static void stvk_stress(FemLame lame, const double F[9], double P[9]) {
  double S[9];
  second_stress(lame, F, S);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      P[3 * i + j] = F[3 * i] * S[j] + F[3 * i + 1] * S[3 + j] + F[3 * i + 2] * S[6 + j];
}

// Stable neo-Hookean. Its own parameters, such that the given λ, μ are the small-strain ones.
static FemLame neo_hookean_parameters(FemLame lame) {
  return (FemLame){.lambda = lame.lambda + 5.0 / 6.0 * lame.mu, .mu = 4.0 / 3.0 * lame.mu};
}

// The factor of cof F in P: λ' (J − α) = λ' (J − 1) − ¾ μ'.
static inline double cofactor_weight(FemLame own, const double F[9], const double C[9]) {
  double J = F[0] * C[0] + F[1] * C[1] + F[2] * C[2];
  return own.lambda * (J - 1) - 0.75 * own.mu;
}

// P = μ' (1 − 1/(I_C + 1)) F + λ' (J − α) cof F.
static void neo_hookean_stress(FemLame lame, const double F[9], double P[9]) {
  FemLame own = neo_hookean_parameters(lame);
  double C[9], square = dot9(F, F);
  fem_cofactor_find(F, C);
  double a = own.mu * (square / (square + 1)), b = cofactor_weight(own, F, C);
  for (int r = 0; r < 9; r++) P[r] = a * F[r] + b * C[r];
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

// P_f = k E_f (F a) ⊗ a.
static void add_fibre_stress(const FemMaterial *material, const double F[9], double P[9]) {
  Fibre fibre = fibre_of(material, F);
  for (int r = 0; r < 9; r++)
    P[r] += fibre.stiffness * fibre.strain * fibre.pushed[r / 3] * fibre.direction[r % 3];
}

void fem_material_stress(const FemMaterial *material, const double F[9], double P[9]) {
  FemLame lame = fem_material_lame(material);
  switch (material->law) {
  case FEM_MATERIAL_LINEAR:
    linear_stress(lame, F, P);
    break;
  case FEM_MATERIAL_COROTATIONAL:
    corotational_stress(lame, F, P);
    break;
  case FEM_MATERIAL_STVK:
    stvk_stress(lame, F, P);
    break;
  case FEM_MATERIAL_NEO_HOOKEAN:
    neo_hookean_stress(lame, F, P);
    break;
  case FEM_MATERIAL_NEO_HOOKEAN_LOG:
    fem_material_log_stress(material, F, P);
    break;
  case FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC:
    fem_material_isochoric_stress(material, F, P);
    break;
  case FEM_MATERIAL_MOONEY_RIVLIN:
    fem_material_mooney_stress(material, F, P);
    break;
  case FEM_MATERIAL_OGDEN:
    fem_material_ogden_stress(material, F, P);
    break;
  }
  if (material->fibre_stiffness > 0) add_fibre_stress(material, F, P);
}

bool fem_material_is_linear(const FemMaterial *material) {
  return material->law == FEM_MATERIAL_LINEAR && !(material->fibre_stiffness > 0);
}

FemLame fem_material_viscous(const FemMaterial *material, double beta) {
  FemLame lame = fem_material_lame(material);
  return (FemLame){.lambda = beta * lame.lambda + material->bulk_viscosity - 2.0 / 3.0 * material->viscosity,
                   .mu = beta * lame.mu + material->viscosity};
}

// θ by law.

static void volume_rotation(const double F[9], FemSvd3 *svd, double R[9]) {
  fem_svd3_factor(svd, F);
  fem_svd3_rotation(svd, R);
}

static double green_trace(const double F[9]) {
  double strain[9];
  find_green_strain(F, strain);
  return strain[0] + strain[4] + strain[8];
}

double fem_material_volume(FemMaterialLaw law, const double F[9], double gradient[9]) {
  static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  FemSvd3 svd;
  FemMaterialLog theta;
  switch (law) {
  case FEM_MATERIAL_LINEAR:
    memcpy(gradient, identity, sizeof identity);
    return (F[0] - 1) + (F[4] - 1) + (F[8] - 1);
  case FEM_MATERIAL_COROTATIONAL:
    volume_rotation(F, &svd, gradient);
    return stretch_trace(&svd);
  case FEM_MATERIAL_STVK:
    memcpy(gradient, F, 9 * sizeof *gradient);
    return green_trace(F);
  case FEM_MATERIAL_NEO_HOOKEAN_LOG:
    theta = fem_material_log(fem_cofactor_swelling(F));
    fem_cofactor_find(F, gradient);
    for (int r = 0; r < 9; r++) gradient[r] *= theta.slope;
    return theta.value;
  case FEM_MATERIAL_NEO_HOOKEAN:
  case FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC:
  case FEM_MATERIAL_MOONEY_RIVLIN:
  case FEM_MATERIAL_OGDEN:
    break;
  }
  fem_cofactor_find(F, gradient);
  return fem_cofactor_swelling(F);
}

// θ' ∂cof F/∂F + θ'' cof F ⊗ cof F.
static void log_curvature(const double F[9], double curvature[81]) {
  FemMaterialLog theta = fem_material_log(fem_cofactor_swelling(F));
  double C[9];
  fem_cofactor_find(F, C);
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < 9; c++) curvature[9 * r + c] = theta.bend * (C[r] * C[c]);
  fem_cofactor_add_derivative(F, theta.slope, curvature);
}

void fem_material_volume_curvature(FemMaterialLaw law, const double F[9], double curvature[81]) {
  memset(curvature, 0, 81 * sizeof *curvature);
  switch (law) {
  case FEM_MATERIAL_LINEAR:
    return;
  case FEM_MATERIAL_COROTATIONAL:
    add_rotation_derivative(F, curvature);
    return;
  case FEM_MATERIAL_STVK:
    for (int r = 0; r < 9; r++) curvature[10 * r] = 1;
    return;
  case FEM_MATERIAL_NEO_HOOKEAN_LOG:
    log_curvature(F, curvature);
    return;
  case FEM_MATERIAL_NEO_HOOKEAN:
  case FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC:
  case FEM_MATERIAL_MOONEY_RIVLIN:
  case FEM_MATERIAL_OGDEN:
    break;
  }
  fem_cofactor_add_derivative(F, 1, curvature);
}

void fem_material_cauchy(FemMaterialLaw law, const double F[9], const double P[9], double stress[6]) {
  static const int rows[6] = {0, 1, 2, 0, 1, 0}, columns[6] = {0, 1, 2, 1, 2, 2};
  static const double flat = 1e-12;
  double J = fem_cofactor_det(F);
  for (int s = 0; s < 6; s++) {
    const double *p = P + 3 * rows[s], *f = F + 3 * columns[s];
    if (law == FEM_MATERIAL_LINEAR)
      stress[s] = p[columns[s]];
    else
      stress[s] = fabs(J) <= flat ? 0 : (p[0] * f[0] + p[1] * f[1] + p[2] * f[2]) / J;
  }
}
