// SPDX-License-Identifier: GPL-3.0-or-later
// SUNDIALS's operations on our vectors are those of its serial vectors, clones included.
#include "fem/time/nvector.h"

#include "fem/sparse/vector.h"
#include "fem/time/sundials.h"
#include "suite.h"

enum { N = FEM_VECTOR_LONG + 3, VECTORS = 4 };

// N additions to a sum that is at most N/2 round by 2⁻⁵³ of it each, up and down at random.
#define SUM_ERROR (sqrt(N) * N * 0x1p-54)

static SUNContext context;
static N_Vector ours[VECTORS], serial[VECTORS];

static void set_values(void) {
  for (int k = 0; k < VECTORS; k++)
    for (int i = 0; i < N; i++) NV_Ith_S(ours[k], i) = NV_Ith_S(serial[k], i) = sin(i + 0.1 * k);
}

static void make(void) {
  ck_assert(fem_sundials_create(&context));
  ours[0] = fem_nvector_create(N, context);
  serial[0] = N_VNew_Serial(N, context);
  ck_assert(ours[0] && serial[0]);
  for (int k = 1; k < VECTORS; k++) ours[k] = N_VClone(ours[0]), serial[k] = N_VClone(serial[0]);
  for (int i = 0; i < N; i++) ck_assert(NV_Ith_S(ours[0], i) == 0);
  set_values();
}

static void end(void) {
  for (int k = 0; k < VECTORS; k++) N_VDestroy(ours[k]), N_VDestroy(serial[k]);
  SUNContext_Free(&context);
}

// Values are at most 10: rounding of some operations.
static void check_same(int k) {
  int wrong = 0;
  for (int i = 0; i < N; i++) wrong += !(fabs(NV_Ith_S(ours[k], i) - NV_Ith_S(serial[k], i)) <= 1e-14);
  ck_assert_int_eq(wrong, 0);
}

static void operate(N_Vector *v) {
  sunrealtype factors[3] = {0.5, -2, 3};
  N_Vector operands[3] = {v[0], v[1], v[2]};
  N_VConst(7, v[3]);
  N_VLinearSum(2, v[0], -1, v[1], v[2]);
  N_VScale(-1, v[2], v[2]);
  N_VScale(1, v[2], v[3]);
  N_VProd(v[0], v[1], v[1]);
  ck_assert(N_VLinearCombination(3, factors, operands, v[0]) == 0);
}

START_TEST(operations_give_what_serial_vectors_give) {
  operate(ours), operate(serial);
  for (int k = 0; k < VECTORS; k++) check_same(k);
}
END_TEST

START_TEST(norms_are_those_of_serial_vectors) {
  for (int k = 0; k < VECTORS; k++) {
    ck_assert_near(N_VWrmsNorm(ours[k], ours[1]), N_VWrmsNorm(serial[k], serial[1]), 1e-13);
    ck_assert(N_VMaxNorm(ours[k]) == N_VMaxNorm(serial[k]));
    ck_assert_near(N_VDotProd(ours[k], ours[1]), N_VDotProd(serial[k], serial[1]), SUM_ERROR);
  }
}
END_TEST

// IDA works with clones of clones.
START_TEST(clones_have_our_operations) {
  N_Vector clone = N_VClone(ours[VECTORS - 1]);
  ck_assert(clone && clone->ops->nvlinearsum == ours[0]->ops->nvlinearsum);
  ck_assert(clone->ops->nvlinearsum != serial[0]->ops->nvlinearsum);
  ck_assert(clone->ops->nvlinearcombination && clone->ops->nvwrmsnorm == fem_nvector_norm);
  N_VDestroy(clone);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("nvector");
  tcase_add_checked_fixture(cases, make, end);
  tcase_add_test(cases, operations_give_what_serial_vectors_give);
  tcase_add_test(cases, norms_are_those_of_serial_vectors);
  tcase_add_test(cases, clones_have_our_operations);
  return suite_run("nvector", cases, 5);
}
