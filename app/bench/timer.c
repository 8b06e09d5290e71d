// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/timer.h"

#include <string.h>

#include "base/log.h"
#include "base/machine/clock.h"
#include "base/sorted.h"

void app_bench_timer_start(AppBenchTimer *timer) {
  timer->wall_began = clock_wall_s();
  timer->cpu_began = clock_cpu_s();
}

void app_bench_timer_stop(AppBenchTimer *timer, int round, double parts) {
  timer->wall[round] = (clock_wall_s() - timer->wall_began) / parts;
  timer->cpu[round] = (clock_cpu_s() - timer->cpu_began) / parts;
}

static void sort(const double *times, int count, double sorted[APP_BENCH_MAX_REPEATS]) {
  memcpy(sorted, times, (size_t)count * sizeof *sorted);
  sorted_values(sorted, (size_t)count);
}

AppBenchTime app_bench_timer_time(const AppBenchTimer *timer, int rounds) {
  double sorted[APP_BENCH_MAX_REPEATS];
  sort(timer->cpu, rounds, sorted);
  double cpu = sorted_median(sorted, (size_t)rounds);
  sort(timer->wall, rounds, sorted);
  return (AppBenchTime){.wall = sorted_median(sorted, (size_t)rounds),
                        .wall_min = sorted[0],
                        .wall_max = sorted[rounds - 1],
                        .cpu = cpu};
}

static AppBenchRatio ratio_of(const double *times, const double *reference, int rounds) {
  double ratios[APP_BENCH_MAX_REPEATS], sorted[APP_BENCH_MAX_REPEATS];
  for (int r = 0; r < rounds; r++) ratios[r] = reference[r] / times[r];
  sort(ratios, rounds, sorted);
  return (AppBenchRatio){sorted_median(sorted, (size_t)rounds), sorted[0], sorted[rounds - 1]};
}

AppBenchRatio app_bench_timer_ratio(const AppBenchTimer *timer, const AppBenchTimer *reference, int rounds) {
  return ratio_of(timer->wall, reference->wall, rounds);
}

AppBenchRatio app_bench_timer_cpu_ratio(const AppBenchTimer *timer, const AppBenchTimer *reference,
                                        int rounds) {
  return ratio_of(timer->cpu, reference->cpu, rounds);
}

Status app_bench_timer_take_turns(void *contestants, size_t size, int count, int rounds, AppBenchAct *act) {
  char *first = contestants;
  Status status = STATUS_OK;
  for (int c = 0; c < count && status == STATUS_OK; c++) {
    log_progress("warm-up %d of %d", c + 1, count);
    status = act(first + (size_t)c * size, 0);
  }
  for (int round = 0; round < rounds && status == STATUS_OK; round++)
    for (int turn = 0; turn < count && status == STATUS_OK; turn++) {
      log_progress("round %d of %d, %d of %d", round + 1, rounds, turn + 1, count);
      int c = round % 2 == 0 ? turn : count - 1 - turn;
      status = act(first + (size_t)c * size, round);
    }
  log_progress_end();
  return status;
}
