// SPDX-License-Identifier: GPL-3.0-or-later
// The rate of libtetlap-overlap at 4096 pairs a call (V and ∇V, set near, one thread) over that of the same
// model called directly, in turns; and of two threads with a handle each over one. Prints, judges nothing.
//
//   build/release/tests/library/library_rate [MODEL]
#include <omp.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <tetlap/overlap.h>

#include "app/bench/overlap/pairs.h"
#include "app/bench/timer.h"
#include "overlap/models.h"

enum { PAIRS = 4096, CALLS = 100, ROUNDS = 15 };

static double pairs[PAIRS * OVERLAP_PAIR_SIZE];

// Each contestant writes to its own place.
typedef struct Contestant {
  AppBenchTimer timer; // of a pair
  int threads;         // 0: the model itself, without the library
  OverlapModel model;
  TetlapOverlap *overlap[2];
  double volume[2][PAIRS], gradient[2][PAIRS * OVERLAP_PAIR_SIZE];
} Contestant;

typedef struct Worker {
  Contestant *contestant;
  int number;
  Status status;
} Worker;

static Status fail_library(void) {
  return status_fail(STATUS_SOLVER, "%s", tetlap_overlap_message());
}

static void *call_library(void *self) {
  Worker *worker = self;
  Contestant *contestant = worker->contestant;
  TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
  batch.count = PAIRS, batch.pairs = pairs, batch.volume = contestant->volume[worker->number];
  batch.gradient = contestant->gradient[worker->number];
  for (int k = 0; k < CALLS && !worker->status; k++)
    if (tetlap_overlap_eval(contestant->overlap[worker->number], &batch)) worker->status = fail_library();
  return NULL;
}

static Status call_model(Contestant *contestant) {
  OverlapBatch batch = {.pair_count = PAIRS,
                        .pairs = pairs,
                        .volume = contestant->volume[0],
                        .gradient = contestant->gradient[0]};
  for (int k = 0; k < CALLS; k++) TRY(overlap_model_eval(&contestant->model, &batch));
  return STATUS_OK;
}

static Status call_library_in_threads(Contestant *contestant) {
  Worker workers[2] = {{contestant, 0, STATUS_OK}, {contestant, 1, STATUS_OK}};
  pthread_t thread;
  bool has_second = contestant->threads == 2;
  if (has_second && pthread_create(&thread, NULL, call_library, &workers[1]) != 0)
    return status_fail(STATUS_SOLVER, "no second thread");
  call_library(&workers[0]);
  if (has_second) pthread_join(thread, NULL);
  return workers[0].status ? workers[0].status : workers[1].status;
}

static Status take_turn(void *self, int round) {
  Contestant *contestant = self;
  int threads = contestant->threads;
  app_bench_timer_start(&contestant->timer);
  TRY(threads ? call_library_in_threads(contestant) : call_model(contestant));
  app_bench_timer_stop(&contestant->timer, round, (double)PAIRS * CALLS * (threads == 2 ? 2 : 1));
  return STATUS_OK;
}

static Status open_all(Contestant contestants[3], const char *name) {
  TetlapOverlapOptions options = TETLAP_OVERLAP_OPTIONS_INIT;
  options.model = name, options.threads = 1;
  for (int c = 0; c < 3; c++) {
    contestants[c].threads = c;
    if (c == 0) TRY(overlap_models_create(&contestants[c].model, name));
    for (int h = 0; h < c; h++)
      if (tetlap_overlap_open_with(&contestants[c].overlap[h], &options)) return fail_library();
  }
  return app_bench_pairs_make("near", PAIRS, 1, pairs);
}

static Status measure(Contestant contestants[3], const char *name) {
  TRY(open_all(contestants, name));
  TRY(app_bench_timer_take_turns(contestants, sizeof *contestants, 3, ROUNDS, take_turn));
  const AppBenchTimer *model = &contestants[0].timer, *one = &contestants[1].timer,
                      *two = &contestants[2].timer;
  printf("%s, V+grad, set near, %d pairs a call, one thread\n", name, PAIRS);
  printf("  model    %10.4g pairs a processor second\n", 1 / app_bench_timer_time(model, ROUNDS).cpu);
  printf("  library  %10.4g\n", 1 / app_bench_timer_time(one, ROUNDS).cpu);
  printf("  library over model    %.3f (processor time, median of %d rounds)\n",
         app_bench_timer_cpu_ratio(one, model, ROUNDS).median, ROUNDS);
  printf("  two threads over one  %.2f (processor time: had each a core of its own)\n",
         2 * app_bench_timer_cpu_ratio(two, one, ROUNDS).median);
  AppBenchRatio gain = app_bench_timer_ratio(two, one, ROUNDS);
  printf("  two threads over one  %.2f (wall time, median; %.2f to %.2f)\n", gain.median, gain.min, gain.max);
  return STATUS_OK;
}

int main(int count, char **arguments) {
  static Contestant contestants[3];
  omp_set_num_threads(1);
  Status status = measure(contestants, count > 1 ? arguments[1] : "clip");
  if (status) fprintf(stderr, "%s\n", status_message());
  overlap_model_destroy(&contestants[0].model);
  for (int c = 1; c < 3; c++)
    for (int h = 0; h < c; h++) tetlap_overlap_close(contestants[c].overlap[h]);
  return status_exit_code(status);
}
