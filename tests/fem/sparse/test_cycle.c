// SPDX-License-Identifier: GPL-3.0-or-later
// fem/sparse/multigrid: a V-cycle over two levels of a chain of vertices whose coordinates are coupled.
#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/sparse/multigrid/cycle.h"
#include "suite.h"

enum { VERTICES = 6000, ROWS = 3 * VERTICES, GROUP = 4, COARSE = ROWS / GROUP, WIDTH = 15 };

// A chain: each vertex with two on either side, by 3 × 3 blocks; and groups of vertices as one, each
// direction apart.
typedef struct Chain {
  int begin[ROWS + 1], column[ROWS * WIDTH];
  double value[ROWS * WIDTH];
  int coarse_begin[COARSE + 1], coarse_column[COARSE * WIDTH];
  double coarse_value[COARSE * WIDTH];
  int map_begin[ROWS + 1], map_column[ROWS];
  double map_value[ROWS];
} Chain;

static int coarse_of(int row) {
  return 3 * (row / 3 / GROUP) + row % 3;
}

// Of rows i and j of the chain: symmetric, and positive definite since the diagonal dominates.
static double entry(int i, int j) {
  return i == j ? 6.5 : i % 3 == j % 3 ? -1 : 0.1 * (i % 3 + j % 3);
}

static void add_coarse(Chain *chain, int i, int j, double value) {
  int k = chain->coarse_begin[i];
  while (k < chain->coarse_begin[i + 1] && chain->coarse_column[k] != j) k++;
  if (k == chain->coarse_begin[i + 1]) chain->coarse_column[chain->coarse_begin[i + 1]++] = j;
  chain->coarse_value[k] += value;
}

static Chain *chain_create(void) {
  Chain *chain = memory_zeroed(1, sizeof *chain);
  for (int i = 0; i < ROWS; i++) {
    int end = chain->begin[i];
    for (int v = i / 3 - 2; v <= i / 3 + 2; v++)
      for (int c = 0; c < 3 && v >= 0 && v < VERTICES; c++) {
        chain->column[end] = 3 * v + c;
        chain->value[end++] = entry(i, 3 * v + c);
      }
    chain->begin[i + 1] = end;
    chain->map_begin[i + 1] = i + 1;
    chain->map_column[i] = coarse_of(i);
    chain->map_value[i] = 1;
  }
  for (int a = 0; a < COARSE; a++) { // rows of a group one after the other: PᵀAP
    chain->coarse_begin[a + 1] = chain->coarse_begin[a];
    for (int k = 0; k < GROUP; k++) {
      int i = 3 * (a / 3 * GROUP + k) + a % 3;
      for (int e = chain->begin[i]; e < chain->begin[i + 1]; e++)
        add_coarse(chain, a, coarse_of(chain->column[e]), chain->value[e]);
    }
  }
  return chain;
}

static Status cycle_of(const Chain *chain, FemCycle *cycle) {
  FemRows matrices[2] = {{ROWS, ROWS, chain->begin, chain->column, chain->value},
                         {COARSE, COARSE, chain->coarse_begin, chain->coarse_column, chain->coarse_value}};
  FemRows map = {ROWS, COARSE, chain->map_begin, chain->map_column, chain->map_value};
  return fem_cycle_create(cycle, 2, matrices, &map);
}

static double *draw(uint64_t stream) {
  Random random = random_seeded(7, stream);
  double *vector = memory_zeroed(ROWS, sizeof *vector);
  for (int i = 0; i < ROWS; i++) vector[i] = suite_normal(&random);
  return vector;
}

static double dot(const double *x, const double *y) {
  double sum = 0;
  for (int i = 0; i < ROWS; i++) sum += x[i] * y[i];
  return sum;
}

static void multiply(const Chain *chain, const double *x, double *y) {
  for (int i = 0; i < ROWS; i++) {
    y[i] = 0;
    for (int k = chain->begin[i]; k < chain->begin[i + 1]; k++) y[i] += chain->value[k] * x[chain->column[k]];
  }
}

// Entries in single precision have 7 digits; on the coarse level others are rounded than their mirror images.
START_TEST(a_cycle_is_symmetric_and_positive) {
  Chain *chain = chain_create();
  FemCycle cycle;
  ck_assert_ok(cycle_of(chain, &cycle));
  double *a = draw(1), *b = draw(2), *Ma = draw(3), *Mb = draw(4);
  fem_cycle_apply(&cycle, a, Ma);
  fem_cycle_apply(&cycle, b, Mb);
  double size = sqrt(dot(Ma, Ma) * dot(b, b));
  ck_assert(fabs(dot(Ma, b) - dot(a, Mb)) <= 1e-6 * size);
  ck_assert(dot(a, Ma) > 0 && dot(b, Mb) > 0);
  fem_cycle_destroy(&cycle);
  memory_free(a), memory_free(b), memory_free(Ma), memory_free(Mb), memory_free(chain);
}
END_TEST

// A smooth error, which sweeps alone leave nearly whole, and a rough one: what remains of x after a cycle
// with b = A x, in the norm of A.
START_TEST(a_cycle_takes_most_of_an_error) {
  Chain *chain = chain_create();
  FemCycle cycle;
  ck_assert_ok(cycle_of(chain, &cycle));
  double *x = draw(5), *b = draw(6), *y = draw(7);
  for (int i = 0; i < ROWS && _i == 0; i++) x[i] = sin(20.0 * i / ROWS);
  multiply(chain, x, b);
  double before = dot(x, b);
  fem_cycle_apply(&cycle, b, y);
  for (int i = 0; i < ROWS; i++) x[i] -= y[i];
  multiply(chain, x, b);
  ck_assert_msg(dot(x, b) <= 0.09 * before, "%g of the energy is left", dot(x, b) / before);
  fem_cycle_destroy(&cycle);
  memory_free(x), memory_free(b), memory_free(y), memory_free(chain);
}
END_TEST

START_TEST(a_cycle_has_the_same_bits_on_any_number_of_threads) {
  Chain *chain = chain_create();
  FemCycle cycle;
  ck_assert_ok(cycle_of(chain, &cycle));
  double *b = draw(8), *one = draw(9), *many = draw(10);
  ck_assert_int_gt(cycle.levels[0].stage_count, 1);
  omp_set_num_threads(1);
  fem_cycle_apply(&cycle, b, one);
  for (int threads = 2; threads <= 7; threads++) {
    omp_set_num_threads(threads);
    fem_cycle_apply(&cycle, b, many);
    ck_assert_mem_eq(one, many, ROWS * sizeof *one);
  }
  fem_cycle_destroy(&cycle);
  memory_free(b), memory_free(one), memory_free(many), memory_free(chain);
}
END_TEST

// Chunks of one stage have no entry in common, so threads do not read what others write.
START_TEST(chunks_of_a_stage_are_apart) {
  Chain *chain = chain_create();
  FemCycle cycle;
  ck_assert_ok(cycle_of(chain, &cycle));
  for (int l = 0; l < 2; l++) {
    const FemLevel *level = &cycle.levels[l];
    for (int s = 0; s < level->stage_count; s++)
      for (int c = level->stage[s]; c < level->stage[s + 1]; c++)
        for (int k = level->begin[level->chunk[c]]; k < level->begin[level->chunk[c + 1]]; k++) {
          int other = level->column[k];
          bool is_own = other >= level->chunk[c] && other < level->chunk[c + 1];
          bool is_of_stage =
              other >= level->chunk[level->stage[s]] && other < level->chunk[level->stage[s + 1]];
          ck_assert(is_own || !is_of_stage);
        }
  }
  fem_cycle_destroy(&cycle);
  memory_free(chain);
}
END_TEST

START_TEST(a_diagonal_that_is_not_positive_is_refused) {
  Chain *chain = chain_create();
  FemCycle cycle;
  for (int k = chain->begin[5]; k < chain->begin[6]; k++)
    if (chain->column[k] == 5) chain->value[k] = _i == 0 ? 0 : _i == 1 ? -1 : NAN;
  ck_assert_int_eq(cycle_of(chain, &cycle), STATUS_RETRY);
  memory_free(chain);
}
END_TEST

START_TEST(every_failed_allocation_is_reported) {
  Chain *chain = chain_create();
  Status status = STATUS_MEMORY;
  for (int k = 1; status == STATUS_MEMORY; k++) {
    ck_assert_int_lt(k, 200);
    FemCycle cycle;
    memory_fail_at(k);
    status = cycle_of(chain, &cycle);
    memory_fail_at(0);
    if (!status) fem_cycle_destroy(&cycle);
  }
  ck_assert_ok(status);
  memory_free(chain);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("cycle");
  tcase_add_test(cases, a_cycle_is_symmetric_and_positive);
  tcase_add_loop_test(cases, a_cycle_takes_most_of_an_error, 0, 2);
  tcase_add_test(cases, a_cycle_has_the_same_bits_on_any_number_of_threads);
  tcase_add_test(cases, chunks_of_a_stage_are_apart);
  tcase_add_loop_test(cases, a_diagonal_that_is_not_positive_is_refused, 0, 3);
  tcase_add_test(cases, every_failed_allocation_is_reported);
  return suite_run("cycle", cases, 60);
}
