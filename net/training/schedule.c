// SPDX-License-Identifier: Apache-2.0
#include "net/training/schedule.h"

#include <math.h>

double net_schedule_rate(const NetSchedule *schedule, int64_t step) {
  if (step < schedule->warmup_steps)
    return schedule->peak * (double)(step + 1) / (double)schedule->warmup_steps;
  if (step >= schedule->total_steps) return schedule->final;
  double done =
      (double)(step - schedule->warmup_steps) / (double)(schedule->total_steps - schedule->warmup_steps);
  return schedule->final + (schedule->peak - schedule->final) * 0.5 * (1 + cos(3.141592653589793 * done));
}
