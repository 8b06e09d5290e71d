// SPDX-License-Identifier: Apache-2.0
// The learning rate over the steps of a training: a linear warm-up from 0, then half a cosine down to the
// final rate.
#ifndef NET_SCHEDULE_H
#define NET_SCHEDULE_H

#include <stdint.h>

typedef struct NetSchedule {
  double peak, final;   // rates
  int64_t warmup_steps; // steps before the peak
  int64_t total_steps;  // from then on the final rate
} NetSchedule;

// The rate of step 0, 1, …: peak · (step + 1)/warmup during the warm-up.
double net_schedule_rate(const NetSchedule *schedule, int64_t step);

#endif
