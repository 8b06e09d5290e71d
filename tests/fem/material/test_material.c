// SPDX-License-Identifier: GPL-3.0-or-later
// fem/material: every law against closed forms, its own energy, small-strain theory and rotations.
#include "suite.h"

#include <float.h>
#include <string.h>

#include "base/random.h"
#include "reference/material.h"

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static FemMaterial make_material(FemMaterialLaw law) {
  return (FemMaterial){.law = law,
                       .young = 1.3,
                       .poisson = 0.37,
                       .density = 1000,
                       .mooney = 0.3,
                       .exponents = {1.8, -2.3, 5},
                       .shares = {0.6, 0.3, 0.1}};
}

static void multiply(const double A[9], const double B[9], double AB[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      AB[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

static double determinant(const double A[9]) {
  return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
         A[2] * (A[3] * A[7] - A[4] * A[6]);
}

// Q diag(σ) Wᵀ with random rotations.
static void compose(Random *random, const double sigma[3], double F[9]) {
  double Q[9], W[9], stretched[9];
  random_rotation(random, Q);
  random_rotation(random, W);
  for (int r = 0; r < 9; r++) stretched[r] = Q[r] * sigma[r % 3];
  double transposed[9] = {W[0], W[3], W[6], W[1], W[4], W[7], W[2], W[5], W[8]};
  multiply(stretched, transposed, F);
}

// Stretches by kind: random ones, inverted ones, nearly singular, equal singular values, at rest, large.
// (corotational jumps where σ₂ = −σ₃: inverted ones keep clear of it.)
static void draw_stretches(Random *random, int kind, double sigma[3]) {
  for (int i = 0; i < 3; i++) sigma[i] = random_between(random, 0.5, 2);
  switch (kind) {
  case 1:
    sigma[2] = -random_between(random, 0.05, 0.35);
    break;
  case 2:
    sigma[2] = random_between(random, -1e-9, 1e-9);
    break;
  case 3:
    sigma[0] = sigma[1] = sigma[2];
    break;
  case 4:
    sigma[1] = sigma[2];
    break;
  case 5:
    sigma[0] = sigma[1] = sigma[2] = 1;
    break;
  case 6:
    sigma[0] = 8;
    break;
  case 7:
    sigma[0] = 0.3, sigma[1] = 0.2, sigma[2] = -0.1;
    break;
  default:
    break;
  }
}
enum { STRETCH_KINDS = 8, SAMPLES = 100 };

static double largest_entry(const double *values, int count) {
  double largest = 0;
  for (int r = 0; r < count; r++) largest = fmax(largest, fabs(values[r]));
  return largest;
}

// Fourth-order central difference of f at 0, given f(±h), f(±2h).
static double differentiate(double plus, double minus, double plus_two, double minus_two, double h) {
  return (8 * (plus - minus) - (plus_two - minus_two)) / (12 * h);
}

static void check_stress_at(const FemMaterial *material, const double F[9], double h) {
  double P[9], moved[9];
  fem_material_stress(material, F, P);
  double scale = fmax(1, largest_entry(P, 9));
  for (int r = 0; r < 9; r++) {
    double energy[4];
    for (int k = 0; k < 4; k++) {
      static const double steps[4] = {1, -1, 2, -2};
      memcpy(moved, F, sizeof moved);
      moved[r] += steps[k] * h;
      energy[k] = reference_energy(material, moved);
    }
    ck_assert_near(P[r], differentiate(energy[0], energy[1], energy[2], energy[3], h), 2e-9 * scale);
  }
}

static void check_tangent_at(const FemMaterial *material, const double F[9], double h) {
  double dP[81], stress[4][9], moved[9];
  reference_tangent(material, F, dP);
  double scale = fmax(1, largest_entry(dP, 81));
  for (int c = 0; c < 9; c++) {
    for (int k = 0; k < 4; k++) {
      static const double steps[4] = {1, -1, 2, -2};
      memcpy(moved, F, sizeof moved);
      moved[c] += steps[k] * h;
      fem_material_stress(material, moved, stress[k]);
    }
    for (int r = 0; r < 9; r++)
      ck_assert_near(dP[9 * r + c], differentiate(stress[0][r], stress[1][r], stress[2][r], stress[3][r], h),
                     2e-9 * scale);
  }
}

// Uniaxial tension of incompressible Mooney–Rivlin: P = 2 (c₁ + c₂/λ)(λ − 1/λ²) (Treloar, The Physics of
// Rubber Elasticity); at ν = 0.4999 the sides are found by bisection of their stress.
START_TEST(mooney_rivlin_and_ogden_pull_as_rubber_does) {
  FemMaterial mooney = make_material(FEM_MATERIAL_MOONEY_RIVLIN), ogden = make_material(FEM_MATERIAL_OGDEN);
  mooney.young = ogden.young = 3, mooney.poisson = ogden.poisson = 0.49999; // μ = 1
  for (double stretch = 0.6; stretch < 3; stretch += 0.4) {
    double expected[2] = {(0.7 + 0.3 / stretch) * (stretch - 1 / (stretch * stretch)), 0};
    for (int p = 0; p < 3; p++) { // Σ μ_p (λ^{α−1} − λ^{−α/2−1})
      double alpha = ogden.exponents[p], mu = 2 * ogden.shares[p] / alpha;
      expected[1] += mu * (pow(stretch, alpha - 1) - pow(stretch, -0.5 * alpha - 1));
    }
    const FemMaterial *materials[2] = {&mooney, &ogden};
    for (int m = 0; m < 2; m++) {
      double low = 0.5 / sqrt(stretch), high = 2 / sqrt(stretch), P[9];
      for (int k = 0; k < 60; k++) {
        double side = 0.5 * (low + high), F[9] = {stretch, 0, 0, 0, side, 0, 0, 0, side};
        fem_material_stress(materials[m], F, P);
        *(P[4] > 0 ? &high : &low) = side;
      }
      ck_assert_near(P[0], expected[m], 1e-3 * (1 + fabs(expected[m])));
    }
  }
}
END_TEST

START_TEST(fibres_resist_along_their_direction_only) {
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN), plain = material;
  material.fibre_stiffness = 7, material.fibre_direction[2] = 2;
  const double along[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1.2}, across[9] = {1.2, 0, 0, 0, 1, 0, 0, 0, 1};
  double P[9], Q[9], strain = 0.5 * (1.44 - 1);
  fem_material_stress(&material, along, P);
  fem_material_stress(&plain, along, Q);
  ck_assert_near(P[8] - Q[8], 7 * strain * 1.2, 1e-14);
  ck_assert_near(reference_energy(&material, along) - reference_energy(&plain, along), 3.5 * strain * strain,
                 1e-14);
  fem_material_stress(&material, across, P);
  fem_material_stress(&plain, across, Q);
  for (int r = 0; r < 9; r++) ck_assert_near(P[r], Q[r], 0);
  material.fibres_buckle = true;
  const double shorter[9] = {1, 0, 0, 0, 1, 0, 0, 0, 0.8};
  ck_assert_near(reference_energy(&material, shorter), reference_energy(&plain, shorter), 0);
}
END_TEST

START_TEST(fibres_have_consistent_derivatives) {
  FemMaterial material = make_material(FEM_MATERIAL_STVK);
  material.fibre_stiffness = 2, material.fibre_direction[0] = 1, material.fibre_direction[1] = -2;
  Random random = random_seeded(5, 0);
  for (int k = 0; k < 20; k++) {
    double sigma[3], F[9];
    draw_stretches(&random, k % 6, sigma);
    compose(&random, sigma, F);
    check_tangent_at(&material, F, 1e-3);
  }
}
END_TEST

START_TEST(names_are_the_ones_that_scenes_use) {
  static const char *const names[] = {
      "linear",          "corotational",          "stvk",          "neo_hookean",
      "neo_hookean_log", "neo_hookean_isochoric", "mooney_rivlin", "ogden"};
  for (int law = 0; law < FEM_MATERIAL_LAW_COUNT; law++) {
    ck_assert_str_eq(fem_material_name((FemMaterialLaw)law), names[law]);
    ck_assert_uint_gt(strlen(fem_material_help((FemMaterialLaw)law)), 10);
  }
}
END_TEST

START_TEST(lame_parameters_of_a_textbook_case) {
  FemMaterial material = {.young = 2.5, .poisson = 0.25};
  FemLame lame = fem_material_lame(&material);
  ck_assert_near(lame.mu, 1, 1e-15);
  ck_assert_near(lame.lambda, 1, 1e-15);
}
END_TEST

START_TEST(rest_has_no_energy_and_no_stress) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  double P[9];
  fem_material_stress(&material, identity, P);
  ck_assert_double_eq(reference_energy(&material, identity), 0);
  for (int r = 0; r < 9; r++) ck_assert_near(P[r], 0, 2 * DBL_EPSILON * material.young);
}
END_TEST

START_TEST(rotations_cost_nothing) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(21, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double Q[9], P[9];
    random_rotation(&random, Q);
    ck_assert_near(reference_energy(&material, Q), 0, 1e-14);
    fem_material_stress(&material, Q, P);
    for (int r = 0; r < 9; r++) ck_assert_near(P[r], 0, 2e-14);
  }
}
END_TEST

START_TEST(turning_the_deformed_body_turns_the_stress) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(22, 0);
  for (int kind = 0; kind < STRETCH_KINDS; kind++)
    for (int k = 0; k < SAMPLES; k++) {
      double sigma[3], F[9], Q[9], QF[9], P[9], QP[9], turned[9];
      draw_stretches(&random, kind, sigma);
      compose(&random, sigma, F);
      random_rotation(&random, Q);
      multiply(Q, F, QF);
      double energy = reference_energy(&material, F);
      ck_assert_near(reference_energy(&material, QF), energy, 1e-13 * fmax(1, energy));
      fem_material_stress(&material, F, P);
      fem_material_stress(&material, QF, turned);
      multiply(Q, P, QP);
      for (int r = 0; r < 9; r++) ck_assert_near(turned[r], QP[r], 1e-12 * fmax(1, largest_entry(P, 9)));
    }
}
END_TEST

// Isotropy: Ψ(F Q) = Ψ(F), and P Fᵀ is symmetric (no torque in the material).
START_TEST(the_material_has_no_preferred_direction) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(23, 0);
  for (int kind = 0; kind < STRETCH_KINDS; kind++)
    for (int k = 0; k < SAMPLES; k++) {
      double sigma[3], F[9], Q[9], FQ[9], P[9];
      draw_stretches(&random, kind, sigma);
      compose(&random, sigma, F);
      random_rotation(&random, Q);
      multiply(F, Q, FQ);
      double energy = reference_energy(&material, F);
      ck_assert_near(reference_energy(&material, FQ), energy, 1e-13 * fmax(1, energy));
      fem_material_stress(&material, F, P);
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < i; j++) {
          double ij = P[3 * i] * F[3 * j] + P[3 * i + 1] * F[3 * j + 1] + P[3 * i + 2] * F[3 * j + 2];
          double ji = P[3 * j] * F[3 * i] + P[3 * j + 1] * F[3 * i + 1] + P[3 * j + 2] * F[3 * i + 2];
          ck_assert_near(ij, ji, 1e-13 * fmax(1, largest_entry(P, 9)) * fmax(1, fabs(sigma[0])));
        }
    }
}
END_TEST

START_TEST(stress_is_the_derivative_of_energy) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(24, 0);
  for (int kind = 0; kind < STRETCH_KINDS; kind++)
    for (int k = 0; k < SAMPLES; k++) {
      double sigma[3], F[9];
      draw_stretches(&random, kind, sigma);
      compose(&random, sigma, F);
      check_stress_at(&material, F, 1e-3 * (kind == 7 ? 0.1 : 1));
    }
}
END_TEST

START_TEST(tangent_is_the_derivative_of_stress) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(25, 0);
  int inverted_count = 0;
  for (int kind = 0; kind < STRETCH_KINDS; kind++)
    for (int k = 0; k < SAMPLES; k++) {
      double sigma[3], F[9];
      draw_stretches(&random, kind, sigma);
      compose(&random, sigma, F);
      inverted_count += determinant(F) < 0;
      check_tangent_at(&material, F, 1e-3 * (kind == 7 ? 0.1 : 1));
    }
  ck_assert_int_ge(inverted_count, 2 * SAMPLES);
}
END_TEST

START_TEST(tangent_is_symmetric_to_the_last_bit) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(26, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double F[9], dP[81];
    for (int r = 0; r < 9; r++) F[r] = suite_normal(&random);
    reference_tangent(&material, F, dP);
    for (int r = 0; r < 9; r++)
      for (int c = 0; c < r; c++) ck_assert_double_eq(dP[9 * r + c], dP[9 * c + r]);
  }
}
END_TEST

// C_ijkl = λ δ_ij δ_kl + μ (δ_ik δ_jl + δ_il δ_jk), over the range of Poisson's ratio.
START_TEST(at_rest_every_law_has_the_given_isotropic_stiffness) {
  static const double ratios[] = {-0.5, 0, 0.2, 0.3, 0.45, 0.499};
  for (size_t n = 0; n < sizeof ratios / sizeof *ratios; n++) {
    FemMaterial material = make_material((FemMaterialLaw)_i);
    material.young = 2e6, material.poisson = ratios[n];
    double mu = 2e6 / (2 * (1 + ratios[n])), lambda = 2 * mu * ratios[n] / (1 - 2 * ratios[n]), dP[81];
    reference_tangent(&material, identity, dP);
    for (int r = 0; r < 9; r++)
      for (int c = 0; c < 9; c++) {
        int i = r / 3, j = r % 3, k = c / 3, l = c % 3;
        double expected = lambda * (i == j && k == l) + mu * ((i == k && j == l) + (i == l && j == k));
        ck_assert_near(dP[9 * r + c], expected, 1e-14 * (fabs(lambda) + 2 * mu));
      }
  }
}
END_TEST

// Ψ(I + h G) / h² → the linear law's, with an error of order h.
START_TEST(small_strain_energy_is_the_linear_one) {
  FemMaterial material = make_material((FemMaterialLaw)_i), linear = make_material(FEM_MATERIAL_LINEAR);
  Random random = random_seeded(27, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double F[9], h = 1e-6;
    for (int r = 0; r < 9; r++) F[r] = identity[r] + h * suite_normal(&random);
    double expected = reference_energy(&linear, F);
    ck_assert_near(reference_energy(&material, F), expected, 1e-4 * expected);
  }
}
END_TEST

START_TEST(linear_law_in_uniaxial_stress_obeys_young_and_poisson) {
  FemMaterial material = make_material(FEM_MATERIAL_LINEAR);
  double e = 0.01, side = 1 - material.poisson * e, P[9];
  fem_material_stress(&material, (const double[9]){1 + e, 0, 0, 0, side, 0, 0, 0, side}, P);
  ck_assert_near(P[0], material.young * e, 1e-15);
  for (int r = 1; r < 9; r++) ck_assert_near(P[r], 0, 1e-15);
}
END_TEST

// Sides at E_22 = −ν E_11, so S_11 = E E_11 alone: P_11 = l E (l² − 1)/2.
START_TEST(stvk_in_uniaxial_stress_is_a_cubic) {
  FemMaterial material = make_material(FEM_MATERIAL_STVK);
  for (double l = 0.4; l < 1.8; l += 0.2) {
    double side = sqrt(1 - material.poisson * (l * l - 1)), P[9];
    fem_material_stress(&material, (const double[9]){l, 0, 0, 0, side, 0, 0, 0, side}, P);
    ck_assert_near(P[0], l * material.young * (l * l - 1) / 2, 1e-14);
    for (int r = 1; r < 9; r++) ck_assert_near(P[r], 0, 1e-14);
  }
}
END_TEST

START_TEST(stvk_confined_and_sheared_has_its_closed_form) {
  FemMaterial material = make_material(FEM_MATERIAL_STVK);
  FemLame lame = fem_material_lame(&material);
  double l = 1.7, s = 0.6;
  double confined = reference_energy(&material, (const double[9]){l, 0, 0, 0, 1, 0, 0, 0, 1});
  ck_assert_near(confined, (lame.lambda + 2 * lame.mu) * pow(l * l - 1, 2) / 8, 1e-14);
  // Simple shear: E_12 = s/2, E_22 = s²/2.
  double sheared = reference_energy(&material, (const double[9]){1, s, 0, 0, 1, 0, 0, 0, 1});
  double square = s * s / 2;
  ck_assert_near(sheared, lame.mu * (s * s / 2 + square * square) + lame.lambda / 2 * square * square, 1e-14);
}
END_TEST

// With ordered stretches it is Hooke's law in the principal stretches, turned.
START_TEST(corotational_stress_is_the_linear_one_turned) {
  FemMaterial material = make_material(FEM_MATERIAL_COROTATIONAL),
              linear = make_material(FEM_MATERIAL_LINEAR);
  Random random = random_seeded(28, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double S[9] = {random_between(&random, 0.2, 2), 0, 0, 0, random_between(&random, 0.2, 2), 0, 0, 0,
                   random_between(&random, -0.1, 2)};
    double Q[9], F[9], P[9], P_linear[9], expected[9];
    random_rotation(&random, Q);
    multiply(Q, S, F);
    fem_material_stress(&material, F, P);
    fem_material_stress(&linear, S, P_linear);
    multiply(Q, P_linear, expected);
    for (int r = 0; r < 9; r++) ck_assert_near(P[r], expected[r], 1e-13);
  }
}
END_TEST

// The paper's form: μ'/2 (I_C − 3) + λ'/2 (J − α)² − μ'/2 log(I_C + 1), α = 1 + μ'/λ' − μ'/(4λ').
static double published_energy(FemLame lame, const double F[9]) {
  double mu = 4.0 / 3.0 * lame.mu, lambda = lame.lambda + 5.0 / 6.0 * lame.mu;
  double alpha = 1 + mu / lambda - mu / (4 * lambda), J = determinant(F), square = 0;
  for (int r = 0; r < 9; r++) square += F[r] * F[r];
  return mu / 2 * (square - 3) + lambda / 2 * (J - alpha) * (J - alpha) - mu / 2 * log(square + 1);
}

START_TEST(neo_hookean_energy_is_the_published_one_less_its_rest_value) {
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN);
  FemLame lame = fem_material_lame(&material);
  Random random = random_seeded(29, 0);
  double rest = published_energy(lame, identity);
  for (int k = 0; k < SAMPLES; k++) {
    double F[9];
    for (int r = 0; r < 9; r++) F[r] = suite_normal(&random);
    double expected = published_energy(lame, F) - rest;
    ck_assert_near(reference_energy(&material, F), expected, 1e-13 * fmax(1, fabs(expected)));
  }
}
END_TEST

// Rest is the only state of least energy: an inverted or collapsed element is pushed back.
START_TEST(no_state_has_less_energy_than_rest) {
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(30, 0);
  for (int k = 0; k < 20000; k++) {
    double F[9];
    for (int r = 0; r < 9; r++) F[r] = suite_normal(&random);
    ck_assert(reference_energy(&material, F) > 0);
  }
  ck_assert(reference_energy(&material, (const double[9]){0}) > 0);
}
END_TEST

START_TEST(a_mirrored_state_is_pushed_back_by_the_laws_that_say_so) {
  static const FemMaterialLaw pushing[] = {FEM_MATERIAL_NEO_HOOKEAN, FEM_MATERIAL_COROTATIONAL,
                                           FEM_MATERIAL_NEO_HOOKEAN_LOG};
  for (int k = 0; k < 3; k++) {
    FemMaterial material = make_material(pushing[k]);
    for (double height = -0.9; height < 1; height += 0.1) {
      double P[9];
      fem_material_stress(&material, (const double[9]){1, 0, 0, 0, 1, 0, 0, 0, height}, P);
      ck_assert(P[8] < 0);
    }
  }
}
END_TEST

// F = s I: P = (μ s² + λ ln J − μ)/s I with J = s³. The pressure −P/s² of the stable law has an end as J → 0.
START_TEST(the_logarithm_resists_any_pressure_and_the_stable_law_does_not) {
  FemMaterial barrier = make_material(FEM_MATERIAL_NEO_HOOKEAN_LOG),
              stable = make_material(FEM_MATERIAL_NEO_HOOKEAN);
  FemLame lame = fem_material_lame(&barrier);
  double P[9], highest = 0;
  for (double J = 3; J > 0.051; J *= 0.97) {
    double s = cbrt(J), F[9] = {s, 0, 0, 0, s, 0, 0, 0, s};
    fem_material_stress(&barrier, F, P);
    double expected = (lame.mu * s * s + lame.lambda * log(J) - lame.mu) / s;
    for (int r = 0; r < 9; r++)
      ck_assert_near(P[r], r % 4 == 0 ? expected : 0, 1e-13 * fmax(1, fabs(expected)));
    fem_material_stress(&stable, F, P);
    highest = fmax(highest, -P[0] / (s * s));
  }
  ck_assert(highest < 3 * stable.young);
  ck_assert(-P[0] < 3 * stable.young);
  fem_material_stress(&barrier, (const double[9]){0.38, 0, 0, 0, 0.38, 0, 0, 0, 0.38}, P); // J = 0.055
  ck_assert(-P[0] / (0.38 * 0.38) > 30 * barrier.young);
}
END_TEST

// Abaqus and CalculiX: σ = μ J^(−5/3) dev b + 2/D₁ (J − 1) I with D₁ = 2/K, b = F Fᵀ.
START_TEST(the_isochoric_law_is_that_of_calculix_and_abaqus) {
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC);
  FemLame lame = fem_material_lame(&material);
  double bulk = material.young / (3 * (1 - 2 * material.poisson));
  const double F[9] = {1.4, 0.3, -0.1, 0.2, 0.7, 0.1, 0, -0.4, 1.1};
  double P[9], sigma[6], b[9] = {0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++) b[3 * i + j] += F[3 * i + k] * F[3 * j + k];
  double J = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
             F[2] * (F[3] * F[7] - F[4] * F[6]);
  double shear = lame.mu * pow(J, -5.0 / 3), mean = (b[0] + b[4] + b[8]) / 3;
  fem_material_stress(&material, F, P);
  fem_material_cauchy(material.law, F, P, sigma);
  static const int places[6] = {0, 4, 8, 1, 5, 2};
  for (int r = 0; r < 6; r++) {
    double expected = shear * (b[places[r]] - (r < 3 ? mean : 0)) + (r < 3 ? bulk * (J - 1) : 0);
    ck_assert_near(sigma[r], expected, 1e-12 * material.young);
  }
}
END_TEST

// Energy, stress and tangent on both sides of the J where the logarithm ends.
START_TEST(the_logarithm_goes_on_with_two_continuous_derivatives) {
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN_LOG);
  double F[2][9], energy[2], P[2][9], dP[2][81];
  for (int side = 0; side < 2; side++) {
    double J = 0.05 * (1 + (side ? 1e-10 : -1e-10));
    memcpy(F[side], (const double[9]){1, 0.2, 0, 0, 0.5, 0, 0, -0.3, 2 * J}, sizeof F[side]);
    energy[side] = reference_energy(&material, F[side]);
    fem_material_stress(&material, F[side], P[side]);
    reference_tangent(&material, F[side], dP[side]);
  }
  ck_assert_near(energy[0], energy[1], 1e-8 * energy[0]);
  for (int r = 0; r < 9; r++) ck_assert_near(P[0][r], P[1][r], 1e-8 * largest_entry(P[0], 9));
  for (int r = 0; r < 81; r++) ck_assert_near(dP[0][r], dP[1][r], 1e-8 * largest_entry(dP[0], 81));
}
END_TEST

static void check_finite(const FemMaterial *material, const double F[9]) {
  double P[9], dP[81];
  fem_material_stress(material, F, P);
  reference_tangent(material, F, dP);
  ck_assert(isfinite(reference_energy(material, F)));
  for (int r = 0; r < 9; r++) ck_assert(isfinite(P[r]));
  for (int r = 0; r < 81; r++) {
    ck_assert(isfinite(dP[r]));
    ck_assert(fabs(dP[r]) <= 1e8 * material->young);
  }
}

// Collapsed to a point, a line, a plane; mirrored; turned inside out, where corotational's R is not unique.
START_TEST(degenerate_states_have_finite_values) {
  static const double stretches[][3] = {{0, 0, 0},  {1, 0, 0},   {1, 1, 0},    {1, 1, -1},
                                        {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}, {2, 1, -1}};
  FemMaterial material = make_material((FemMaterialLaw)_i);
  Random random = random_seeded(31, 0);
  for (size_t s = 0; s < sizeof stretches / sizeof *stretches; s++) {
    const double *t = stretches[s];
    check_finite(&material, (const double[9]){t[0], 0, 0, 0, t[1], 0, 0, 0, t[2]});
    for (int k = 0; k < SAMPLES; k++) {
      double F[9];
      compose(&random, t, F);
      check_finite(&material, F);
    }
  }
}
END_TEST

START_TEST(smooth_laws_are_differentiable_at_collapse) {
  static const FemMaterialLaw smooth[] = {FEM_MATERIAL_LINEAR, FEM_MATERIAL_STVK, FEM_MATERIAL_NEO_HOOKEAN};
  static const double flat[][9] = {{0}, {1, 2, 3, 2, 4, 6, -1, -2, -3}, {1, 0, 0, 0, 1, 0, 0, 0, -1}};
  for (int k = 0; k < 3; k++) {
    FemMaterial material = make_material(smooth[k]);
    for (int s = 0; s < 3; s++) {
      check_stress_at(&material, flat[s], 1e-3);
      check_tangent_at(&material, flat[s], 1e-3);
    }
  }
}
END_TEST

// Turned, squeezed, sheared: F C Fᵀ must be stvk's tangent less the geometric part δ_ik S_jl.
START_TEST(pushed_stiffness_is_the_material_part_of_the_tangent) {
  FemMaterial material = make_material(FEM_MATERIAL_STVK);
  Random random = random_seeded(32, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double F[9], dP[81], here[81];
    for (int r = 0; r < 9; r++) F[r] = suite_normal(&random);
    reference_pushed_stiffness(fem_material_lame(&material), F, here);
    reference_tangent(&material, F, dP);
    for (int r = 0; r < 9; r++)
      for (int c = 0; c < 9; c++) {
        if (r / 3 != c / 3) ck_assert_double_eq(here[9 * r + c], dP[9 * r + c]);
        int shifted = 9 * ((r + 3) % 9) + (c + 3) % 9;
        if (r / 3 == c / 3)
          ck_assert_near(dP[9 * r + c] - here[9 * r + c], dP[shifted] - here[shifted], 1e-12);
      }
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("material");
  tcase_add_test(cases, names_are_the_ones_that_scenes_use);
  tcase_add_test(cases, lame_parameters_of_a_textbook_case);
  tcase_add_loop_test(cases, rest_has_no_energy_and_no_stress, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, rotations_cost_nothing, 1, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, turning_the_deformed_body_turns_the_stress, 1, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, the_material_has_no_preferred_direction, 1, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, stress_is_the_derivative_of_energy, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, tangent_is_the_derivative_of_stress, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, tangent_is_symmetric_to_the_last_bit, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, at_rest_every_law_has_the_given_isotropic_stiffness, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, small_strain_energy_is_the_linear_one, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_test(cases, linear_law_in_uniaxial_stress_obeys_young_and_poisson);
  tcase_add_test(cases, stvk_in_uniaxial_stress_is_a_cubic);
  tcase_add_test(cases, stvk_confined_and_sheared_has_its_closed_form);
  tcase_add_test(cases, corotational_stress_is_the_linear_one_turned);
  tcase_add_test(cases, neo_hookean_energy_is_the_published_one_less_its_rest_value);
  tcase_add_test(cases, the_logarithm_resists_any_pressure_and_the_stable_law_does_not);
  tcase_add_test(cases, the_isochoric_law_is_that_of_calculix_and_abaqus);
  tcase_add_test(cases, the_logarithm_goes_on_with_two_continuous_derivatives);
  tcase_add_loop_test(cases, no_state_has_less_energy_than_rest, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_test(cases, a_mirrored_state_is_pushed_back_by_the_laws_that_say_so);
  tcase_add_loop_test(cases, degenerate_states_have_finite_values, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_test(cases, smooth_laws_are_differentiable_at_collapse);
  tcase_add_test(cases, mooney_rivlin_and_ogden_pull_as_rubber_does);
  tcase_add_test(cases, fibres_resist_along_their_direction_only);
  tcase_add_test(cases, fibres_have_consistent_derivatives);
  tcase_add_test(cases, pushed_stiffness_is_the_material_part_of_the_tangent);
  return suite_run("material", cases, 20);
}
