// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/rates.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/memory.h"

static const double SOFT_SHARE = 0.3;

Status app_training_rates_create(AppTrainingRates *rates, size_t count) {
  rates->frame = memory_zeroed(count * APP_RATES_FRAME, sizeof(float));
  rates->rate = memory_zeroed(count * APP_RATES, sizeof(float));
  rates->size = memory_zeroed(count, sizeof(float));
  return rates->frame && rates->rate && rates->size ? STATUS_OK : status_no_memory("the rates of volumes");
}

void app_training_rates_destroy(AppTrainingRates *rates) {
  memory_free(rates->frame), memory_free(rates->rate), memory_free(rates->size);
  *rates = (AppTrainingRates){0};
}

void app_training_rates_set(AppTrainingRates *rates, int at, const OverlapTpnNormalised *normalised,
                            const double gradient[24], double scale) {
  double edge = cbrt(normalised->factor), square = 0;
  float *frame = rates->frame + (ptrdiff_t)at * APP_RATES_FRAME;
  float *rate = rates->rate + (ptrdiff_t)at * APP_RATES;
  for (int i = 0; i < APP_RATES_FRAME; i++) frame[i] = (float)(edge * normalised->matrix[i]);
  for (int i = 0; i < APP_RATES; i++) {
    double r = scale * edge / normalised->factor * gradient[12 + i];
    rate[i] = (float)r;
    square += r * r;
  }
  rates->size[at] = (float)sqrt(square);
}

void app_training_rates_finish(AppTrainingRates *rates, int count) {
  double sum = 0;
  int moving = 0;
  for (int k = 0; k < count; k++) sum += (double)rates->size[k], moving += rates->size[k] > 0;
  rates->soft = moving ? SOFT_SHARE * sum / moving : 1;
}

float app_training_rates_draw(const AppTrainingRates *rates, int at, NetRandom *random, float direction[24]) {
  const float *frame = rates->frame + (ptrdiff_t)at * APP_RATES_FRAME;
  const float *rate = rates->rate + (ptrdiff_t)at * APP_RATES;
  double by = 1 / ((double)rates->size[at] + rates->soft), change = 0;
  memset(direction, 0, 12 * sizeof *direction);
  for (int b = 0; b < 4; b++) {
    double d[3];
    for (int i = 0; i < 3; i++) {
      d[i] = by * net_random_normal(random);
      change += d[i] * (double)rate[3 * b + i];
    }
    for (int i = 0; i < 3; i++)
      direction[12 + 3 * b + i] = (float)(d[0] * (double)frame[3 * i] + d[1] * (double)frame[3 * i + 1] +
                                          d[2] * (double)frame[3 * i + 2]);
  }
  return (float)change;
}
