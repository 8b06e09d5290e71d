// SPDX-License-Identifier: GPL-3.0-or-later
// Repeated measurements of time. All contestants are measured in turn in every round, in the opposite order
// every other round, so that changes in the machine's speed and cold caches affect all alike; the median over
// the rounds counts.
#ifndef TETLAP_APP_BENCH_TIMER_H
#define TETLAP_APP_BENCH_TIMER_H

#include <stddef.h>

#include "app/bench/options.h"
#include "base/status.h"

// One quantity of one contestant. Starts zeroed.
typedef struct AppBenchTimer {
  double wall_began, cpu_began;
  double wall[APP_BENCH_MAX_REPEATS], cpu[APP_BENCH_MAX_REPEATS]; // [s], by round
} AppBenchTimer;

void app_bench_timer_start(AppBenchTimer *timer);
// `parts` equal parts were timed: the round's value is the time of one.
void app_bench_timer_stop(AppBenchTimer *timer, int round, double parts);

// Medians, and the least and the largest wall time [s].
typedef struct AppBenchTime {
  double wall, wall_min, wall_max, cpu;
} AppBenchTime;

AppBenchTime app_bench_timer_time(const AppBenchTimer *timer, int rounds);
// How often the reference's time holds this one's [1]: the median over rounds of the ratio of the two times
// that were taken in the same round, and the least and the largest ratio.
typedef struct AppBenchRatio {
  double median, min, max;
} AppBenchRatio;
AppBenchRatio app_bench_timer_ratio(const AppBenchTimer *timer, const AppBenchTimer *reference, int rounds);
// The same of processor times.
AppBenchRatio app_bench_timer_cpu_ratio(const AppBenchTimer *timer, const AppBenchTimer *reference,
                                        int rounds);

// Does a contestant's part of a round. A warm-up is round 0, done once more afterwards.
typedef Status AppBenchAct(void *contestant, int round);

// Lets `count` contestants, elements of `size` bytes, take turns, after a warm-up of each.
Status app_bench_timer_take_turns(void *contestants, size_t size, int count, int rounds, AppBenchAct *act);

#endif
