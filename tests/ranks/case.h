// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of ranks share. Each of them is one program that mpiexec starts n times; a check compares what
// all ranks have found, so that all of them fail or none.
#ifndef TETLAP_TESTS_RANKS_CASE_H
#define TETLAP_TESTS_RANKS_CASE_H

#include <check.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/ranks.h"
#include "base/status.h"
#include "dist/mpi.h"
#include "dist/solver.h"
#include "fem/sparse/solver.h"

#define ck_assert_ok(call)                                                                                   \
  do {                                                                                                       \
    Status ck_status_ = ranks()->worst(call);                                                                \
    ck_assert_msg(ck_status_ == STATUS_OK, "%s: %d: %s", #call, (int)ck_status_, status_message());          \
  } while (0)

// The largest of all ranks; NaN of any of them is INFINITY.
static inline double case_most(double value) {
  value = isnan(value) ? INFINITY : value;
  ranks()->most(&value, 1);
  return value;
}

// The division: METIS', pieces of the numbering, or every vertex anywhere.
typedef enum CaseDivision { CASE_METIS, CASE_PIECES, CASE_SCATTERED, CASE_DIVISIONS } CaseDivision;

static inline Status case_pieces(const RanksGraph *graph, int rank_count, int *rank_of_node) {
  for (int i = 0; i < graph->node_count; i++)
    rank_of_node[i] = (int)((long long)i * rank_count / graph->node_count);
  return STATUS_OK;
}

static inline Status case_scattered(const RanksGraph *graph, int rank_count, int *rank_of_node) {
  for (int i = 0; i < graph->node_count; i++)
    rank_of_node[i] = (int)((unsigned)i * 2654435761u >> 8) % rank_count;
  return STATUS_OK;
}

static const Ranks *case_mpi; // as MPI has it
static Ranks case_divided;

// Several ranks from here on, divided so.
static inline void case_share(CaseDivision division) {
  case_divided = *case_mpi;
  if (division == CASE_PIECES) case_divided.divide = case_pieces;
  if (division == CASE_SCATTERED) case_divided.divide = case_scattered;
  ranks_set(&case_divided);
  if (case_mpi->count > 1) dist_solver_provide();
}

// Every rank by itself from here on, with the whole.
static inline void case_alone(void) {
  ranks_set(NULL);
  fem_solver_provide(NULL);
}

static inline int case_main(int argument_count, char **arguments, const char *name, TCase *test_case) {
  if (dist_mpi_is_wanted()) dist_mpi_begin(&argument_count, &arguments, dist_solver_close);
  case_mpi = ranks();
  Suite *suite = suite_create(name);
  tcase_set_timeout(test_case, 0);
  suite_add_tcase(suite, test_case);
  SRunner *runner = srunner_create(suite);
  srunner_set_fork_status(runner, CK_NOFORK);
  srunner_run_all(runner, CK_ENV);
  int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  ranks_set(case_mpi);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#endif
