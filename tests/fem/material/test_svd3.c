// SPDX-License-Identifier: GPL-3.0-or-later
// fem/material/svd3.h: two proper rotations and ordered, signed singular values, for whatever matrix.
#include "suite.h"

#include "base/random.h"
#include "fem/material/svd3.h"

static double determinant(const double A[9]) {
  return A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
         A[2] * (A[3] * A[7] - A[4] * A[6]);
}

static void check_rotation(const double R[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double dot = R[i] * R[j] + R[3 + i] * R[3 + j] + R[6 + i] * R[6 + j];
      ck_assert_near(dot, i == j, 2e-14);
    }
  ck_assert_near(determinant(R), 1, 2e-14);
}

// Every property that the header promises; errors relative to the largest entry.
static void check_factors(const double F[9], FemSvd3 *svd) {
  fem_svd3_factor(svd, F);
  double scale = 0;
  for (int r = 0; r < 9; r++) scale = fmax(scale, fabs(F[r]));
  check_rotation(svd->U);
  check_rotation(svd->V);
  ck_assert(svd->sigma[0] >= svd->sigma[1] && svd->sigma[1] >= fabs(svd->sigma[2]) * (1 - 1e-14));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double entry = 0;
      for (int k = 0; k < 3; k++) entry += svd->U[3 * i + k] * svd->sigma[k] * svd->V[3 * j + k];
      ck_assert_near(entry, F[3 * i + j], 4e-15 * scale);
    }
}

// Q diag(σ) Wᵀ with random rotations.
static void compose(Random *random, const double sigma[3], double F[9]) {
  double Q[9], W[9];
  random_rotation(random, Q);
  random_rotation(random, W);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      F[3 * i + j] = 0;
      for (int k = 0; k < 3; k++) F[3 * i + j] += Q[3 * i + k] * sigma[k] * W[3 * j + k];
    }
}

START_TEST(a_diagonal_matrix_gives_its_entries_in_order) {
  FemSvd3 svd;
  check_factors((const double[9]){2, 0, 0, 0, 5, 0, 0, 0, 3}, &svd);
  ck_assert_double_eq(svd.sigma[0], 5);
  ck_assert_double_eq(svd.sigma[1], 3);
  ck_assert_double_eq(svd.sigma[2], 2);
}
END_TEST

START_TEST(a_mirror_has_its_sign_in_the_last_value) {
  FemSvd3 svd;
  check_factors((const double[9]){-1, 0, 0, 0, 1, 0, 0, 0, 1}, &svd);
  ck_assert_double_eq(svd.sigma[0], 1);
  ck_assert_double_eq(svd.sigma[2], -1);
  check_factors((const double[9]){-4, 0, 0, 0, -3, 0, 0, 0, -2}, &svd);
  ck_assert_double_eq(svd.sigma[0], 4);
  ck_assert_double_eq(svd.sigma[1], 3);
  ck_assert_double_eq(svd.sigma[2], -2);
}
END_TEST

START_TEST(random_matrices_are_restored_and_the_sign_follows_the_determinant) {
  Random random = random_seeded(11, 0);
  int negative_count = 0;
  for (int k = 0; k < 20000; k++) {
    double F[9];
    for (int r = 0; r < 9; r++) F[r] = suite_normal(&random);
    FemSvd3 svd;
    check_factors(F, &svd);
    double det = determinant(F);
    ck_assert_near(svd.sigma[0] * svd.sigma[1] * svd.sigma[2], det, 1e-13 * pow(svd.sigma[0], 3));
    negative_count += det < 0;
  }
  ck_assert_int_gt(negative_count, 9000);
}
END_TEST

START_TEST(known_singular_values_come_back) {
  static const double known[][3] = {
      {1, 1, 1},    {1, 1, -1},        {2, 2, 0.5},       {3, 1, 1}, {3, 1, -1}, {1, 1 - 1e-15, 1 - 2e-15},
      {1, 1e-8, 0}, {1, 1e-8, -1e-12}, {1, 1e-16, 1e-17}, {1, 0, 0}, {1, 1, 0},  {1, 1e-200, 0},
  };
  Random random = random_seeded(12, 0);
  for (size_t c = 0; c < sizeof known / sizeof *known; c++)
    for (int k = 0; k < 500; k++) {
      double F[9];
      compose(&random, known[c], F);
      FemSvd3 svd;
      check_factors(F, &svd);
      for (int i = 0; i < 3; i++) ck_assert_near(fabs(svd.sigma[i]), fabs(known[c][i]), 4e-15);
      if (fabs(known[c][2]) > 1e-14) ck_assert(svd.sigma[2] * known[c][2] > 0);
    }
}
END_TEST

START_TEST(the_zero_matrix_has_rotations_too) {
  FemSvd3 svd;
  check_factors((const double[9]){0}, &svd);
  for (int i = 0; i < 3; i++) ck_assert_double_eq(svd.sigma[i], 0);
}
END_TEST

START_TEST(exactly_rank_deficient_matrices_are_restored) {
  FemSvd3 svd;
  check_factors((const double[9]){1, 2, 3, 2, 4, 6, -1, -2, -3}, &svd);
  ck_assert_near(svd.sigma[0], sqrt(84), 1e-14);
  ck_assert_near(svd.sigma[1], 0, 1e-14);
  check_factors((const double[9]){0, 0, 0, 0, 0, 0, 0, 0, 7}, &svd);
  ck_assert_double_eq(svd.sigma[0], 7);
  check_factors((const double[9]){1, 2, 3, 4, 5, 6, 7, 8, 9}, &svd);
  ck_assert_near(svd.sigma[2], 0, 1e-14);
}
END_TEST

// Columns so far apart in length that the square of their product underflows.
START_TEST(columns_of_vanishing_length_still_give_rotations) {
  FemSvd3 svd;
  check_factors((const double[9]){1, 3e-163, 0, 0, 1e-161, 0, 0, 0, 0}, &svd);
  check_factors((const double[9]){1, 1e-200, 1e-300, 0, 1e-200, 1e-300, 0, 0, 1e-300}, &svd);
}
END_TEST

// Powers of two change no rounding: the factors must be the same at every scale, subnormal numbers excepted.
START_TEST(scale_does_not_matter) {
  static const int exponents[] = {-1060, -1000, -700, -300, -30, 30, 300, 700, 1020};
  Random random = random_seeded(13, 0);
  for (int k = 0; k < 200; k++) {
    double F[9], scaled[9];
    for (int r = 0; r < 9; r++) F[r] = random_between(&random, -1, 1);
    FemSvd3 reference, svd;
    check_factors(F, &reference);
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++) {
      for (int r = 0; r < 9; r++) scaled[r] = ldexp(F[r], exponents[e]);
      int is_subnormal = exponents[e] < -1000;
      fem_svd3_factor(&svd, scaled);
      check_rotation(svd.U);
      check_rotation(svd.V);
      for (int i = 0; i < 3; i++)
        ck_assert_near(ldexp(svd.sigma[i], -exponents[e]), reference.sigma[i], is_subnormal ? 1e-3 : 1e-14);
    }
  }
}
END_TEST

START_TEST(the_rotation_is_the_nearest_one) {
  Random random = random_seeded(14, 0);
  for (int k = 0; k < 300; k++) {
    double F[9], R[9];
    for (int r = 0; r < 9; r++) F[r] = suite_normal(&random);
    FemSvd3 svd;
    fem_svd3_factor(&svd, F);
    fem_svd3_rotation(&svd, R);
    check_rotation(R);
    double nearest = 0;
    for (int r = 0; r < 9; r++) nearest += (F[r] - R[r]) * (F[r] - R[r]);
    for (int other = 0; other < 100; other++) {
      double Q[9], distance = 0;
      random_rotation(&random, Q);
      for (int r = 0; r < 9; r++) distance += (F[r] - Q[r]) * (F[r] - Q[r]);
      ck_assert(distance >= nearest * (1 - 1e-14));
    }
  }
}
END_TEST

START_TEST(a_rotation_near_the_identity_is_itself) {
  Random random = random_seeded(15, 0);
  for (int k = 0; k < 1000; k++) {
    double Q[9], R[9];
    random_rotation(&random, Q);
    FemSvd3 svd;
    check_factors(Q, &svd);
    fem_svd3_rotation(&svd, R);
    for (int r = 0; r < 9; r++) ck_assert_near(R[r], Q[r], 4e-15);
  }
}
END_TEST

START_TEST(nan_and_infinity_end_and_give_no_number) {
  for (int r = 0; r < 9; r++)
    for (int background = 0; background < 2; background++)
      for (int kind = 0; kind < 2; kind++) {
        double F[9] = {background, 0, 0, 0, background, 0, 0, 0, background};
        F[r] = kind == 0 ? NAN : -INFINITY;
        FemSvd3 svd;
        fem_svd3_factor(&svd, F);
        ck_assert(!isfinite(svd.sigma[0] + svd.sigma[1] + svd.sigma[2]));
      }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("svd3");
  tcase_add_test(cases, a_diagonal_matrix_gives_its_entries_in_order);
  tcase_add_test(cases, a_mirror_has_its_sign_in_the_last_value);
  tcase_add_test(cases, random_matrices_are_restored_and_the_sign_follows_the_determinant);
  tcase_add_test(cases, known_singular_values_come_back);
  tcase_add_test(cases, the_zero_matrix_has_rotations_too);
  tcase_add_test(cases, exactly_rank_deficient_matrices_are_restored);
  tcase_add_test(cases, columns_of_vanishing_length_still_give_rotations);
  tcase_add_test(cases, scale_does_not_matter);
  tcase_add_test(cases, the_rotation_is_the_nearest_one);
  tcase_add_test(cases, a_rotation_near_the_identity_is_itself);
  tcase_add_test(cases, nan_and_infinity_end_and_give_no_number);
  return suite_run("svd3", cases, 20);
}
