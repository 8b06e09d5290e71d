// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/law/volume_law.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static const double SMALLEST = 1e-12, LARGEST = 0.03; // volumes for which f is known
static const double LEAST_SHARE = 1e-5;               // of uniform pairs that a law must keep
static const double NATURAL_SHARE = 0.6108623;        // of uniform pairs that intersect
static const double FIT_LOW = 1e-8, FIT_HIGH = 0.042; // range of the fit
static const double KNOT_MARGIN = 1.02;               // a between knots over a at the knots, at most

static const char *const shapes[] = {"natural", "log-uniform", "uniform"};
enum { SHAPE_COUNT = sizeof shapes / sizeof *shapes };

// Chebyshev series of ln f, f the density of ln V per pair drawn: least squares on a histogram of 3e8 uniform
// pairs (183,258,689 with V > 0; bins of 0.112 in ln V from 1e-9 to 0.06, weights by counts; χ² per degree of
// freedom 1.13; largest residual below 0.021: 0.7 %). tests/datagen/test_datagen_pairs.c draws anew and compares.
static const double fit[] = {-4.74658,  -0.127115, -2.27939,   -1.47737,   -0.810055,   -0.428934,
                             -0.225369, -0.116976, -0.0545749, -0.0256999, -0.00844364, -0.00382517};
enum { FIT_TERMS = sizeof fit / sizeof *fit };

// Clenshaw's recurrence. Below the fit a corner, or two edges, have just come through: V ~ depth³, and ln f
// rises by a third of ln V.
double datagen_volume_law_natural(double log_volume) {
  double low = log(FIT_LOW), high = log(FIT_HIGH), beyond = 0;
  if (log_volume < low) beyond = (log_volume - low) / 3, log_volume = low;
  double t = 2 * (log_volume - low) / (high - low) - 1, next = 0, after = 0;
  for (int k = FIT_TERMS - 1; k > 0; k--) {
    double term = 2 * t * next - after + fit[k];
    after = next, next = term;
  }
  return t * next - after + fit[0] + beyond;
}

static Status fail_law(const char *text) {
  return status_fail(STATUS_USAGE,
                     "the volume law is '%s'; give natural, uniform:LOW:HIGH or log-uniform:LOW:HIGH, as in "
                     "log-uniform:1e-7:0.02",
                     text);
}

static bool parse_number(const char **text, double *number) {
  char *end;
  if (**text != ':') return false;
  *number = strtod(*text + 1, &end);
  if (end == *text + 1) return false;
  *text = end;
  return isfinite(*number);
}

Status datagen_volume_law_parse(DatagenVolumeLaw *law, const char *text) {
  size_t length = strcspn(text, ":");
  const char *rest = text + length;
  for (int s = 0; s < SHAPE_COUNT; s++) {
    if (strlen(shapes[s]) != length || strncmp(text, shapes[s], length) != 0) continue;
    *law = (DatagenVolumeLaw){.shape = (DatagenVolumeShape)s};
    if (s != DATAGEN_VOLUME_NATURAL && !(parse_number(&rest, &law->low) && parse_number(&rest, &law->high)))
      return fail_law(text);
    return *rest ? fail_law(text) : STATUS_OK;
  }
  return fail_law(text);
}

// The shorter of two spellings, if it means the same number.
static void print_number(char text[32], double number) {
  snprintf(text, 32, "%.15g", number);
  if (strtod(text, NULL) != number) snprintf(text, 32, "%.17g", number);
}

void datagen_volume_law_print(const DatagenVolumeLaw *law, char *text, size_t size) {
  char low[32], high[32];
  print_number(low, law->low);
  print_number(high, law->high);
  if (law->shape == DATAGEN_VOLUME_NATURAL)
    snprintf(text, size, "%s", shapes[law->shape]);
  else
    snprintf(text, size, "%s:%s:%s", shapes[law->shape], low, high);
}

// ln p(ln V), p normalised over the range.
static double log_wanted(const DatagenVolumeLaw *law, double log_volume) {
  if (law->shape == DATAGEN_VOLUME_UNIFORM) return log_volume - log(law->high - law->low);
  return -log(log(law->high / law->low));
}

static Status check_range(const DatagenVolumeLaw *law) {
  bool is_logarithmic = law->shape == DATAGEN_VOLUME_LOG_UNIFORM;
  double least = is_logarithmic ? SMALLEST : 0;
  if (!(law->low >= least && law->low < law->high && law->high <= LARGEST))
    return status_fail(STATUS_USAGE,
                       "volumes from %g to %g are not possible: give two numbers, the lower one first, "
                       "from %g to %g",
                       law->low, law->high, least, LARGEST);
  return STATUS_OK;
}

static void find_knots(DatagenVolumeSieve *sieve) {
  double low = log(fmax(sieve->law.low, SMALLEST)), high = log(sieve->law.high);
  double ratio[DATAGEN_SIEVE_KNOTS];
  sieve->log_peak = -INFINITY;
  for (int k = 0; k < DATAGEN_SIEVE_KNOTS; k++) {
    double x = low + (high - low) * k / (DATAGEN_SIEVE_KNOTS - 1);
    sieve->knots[k] = exp(x);
    ratio[k] = log_wanted(&sieve->law, x) - datagen_volume_law_natural(x);
    sieve->log_peak = fmax(sieve->log_peak, ratio[k]);
  }
  for (int k = 0; k < DATAGEN_SIEVE_KNOTS; k++) {
    double larger = k + 1 < DATAGEN_SIEVE_KNOTS ? fmax(ratio[k], ratio[k + 1]) : ratio[k];
    sieve->ceilings[k] = KNOT_MARGIN * exp(larger - sieve->log_peak);
  }
  sieve->knots[0] = sieve->law.low;
  sieve->knots[DATAGEN_SIEVE_KNOTS - 1] = sieve->law.high;
}

Status datagen_volume_law_sieve_make(DatagenVolumeSieve *sieve, const DatagenVolumeLaw *law) {
  *sieve = (DatagenVolumeSieve){.law = *law, .share = NATURAL_SHARE};
  if (law->shape == DATAGEN_VOLUME_NATURAL) return STATUS_OK;
  TRY(check_range(law));
  find_knots(sieve);
  sieve->share = exp(-sieve->log_peak);
  if (!(sieve->share >= LEAST_SHARE))
    return status_fail(STATUS_USAGE,
                       "volumes from %g to %g are so rare that one pair in %.0f would be kept: give a wider "
                       "range",
                       law->low, law->high, 1 / sieve->share);
  return STATUS_OK;
}

double datagen_volume_law_sieve_keeps(const DatagenVolumeSieve *sieve, double volume) {
  if (sieve->law.shape == DATAGEN_VOLUME_NATURAL) return 1;
  if (!(volume >= sieve->law.low && volume <= sieve->law.high)) return 0;
  double x = log(volume);
  return fmin(1, exp(log_wanted(&sieve->law, x) - datagen_volume_law_natural(x) - sieve->log_peak));
}

double datagen_volume_law_sieve_floor(const DatagenVolumeSieve *sieve, double u) {
  if (sieve->law.shape == DATAGEN_VOLUME_NATURAL) return 0;
  for (int k = 0; k + 1 < DATAGEN_SIEVE_KNOTS; k++)
    if (sieve->ceilings[k] > u) return sieve->knots[k];
  return INFINITY;
}
