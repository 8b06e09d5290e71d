// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/newton/mixing.h"

#include <math.h>

#include "base/memory.h"
#include "fem/model/limits.h"
#include "fem/sparse/vector.h"
#include "fem/time/part.h"

Status fem_mixing_create(FemMixing *mixing, int n) {
  *mixing = (FemMixing){.n = n};
  double **arrays[] = {&mixing->steps[0],   &mixing->steps[1], &mixing->changes[0],
                       &mixing->changes[1], &mixing->last,     &mixing->taken};
  for (int i = 0; i < 6; i++)
    if (!(*arrays[i] = memory_zeroed((size_t)n, sizeof(double)))) return status_no_memory("Newton's method");
  return STATUS_OK;
}

void fem_mixing_destroy(FemMixing *mixing) {
  for (int j = 0; j < FEM_MIXING_DEPTH; j++) {
    memory_free(mixing->steps[j]);
    memory_free(mixing->changes[j]);
  }
  memory_free(mixing->last);
  memory_free(mixing->taken);
  *mixing = (FemMixing){0};
}

void fem_mixing_forget(FemMixing *mixing) {
  mixing->count = 0;
  mixing->has_last = false;
}

static double dot(const FemMixing *mixing, const double *weights, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < mixing->n; i++) sum += weights[i] * weights[i] * a[i] * b[i];
  return fem_part_sum(sum);
}

// The last step and what it changed becomes the newest pair.
static void push(FemMixing *mixing, const double *d) {
  double *step = mixing->steps[1], *change = mixing->changes[1];
  mixing->steps[1] = mixing->steps[0];
  mixing->changes[1] = mixing->changes[0];
  fem_vector_copy(mixing->n, mixing->taken, step);
  fem_vector_sum(mixing->n, 1, d, -1, mixing->last, change);
  mixing->steps[0] = step;
  mixing->changes[0] = change;
  if (mixing->count < FEM_MIXING_DEPTH) mixing->count++;
}

// γ of the pairs there are.
static void find_shares(const FemMixing *mixing, const double *weights, const double *d, double gamma[2]) {
  const double *one = mixing->changes[0], *two = mixing->changes[1];
  double a = dot(mixing, weights, one, one), right = dot(mixing, weights, one, d);
  gamma[0] = a > 0 ? right / a : 0;
  gamma[1] = 0;
  if (mixing->count < 2) return;
  double b = dot(mixing, weights, one, two), c = dot(mixing, weights, two, two),
         right_two = dot(mixing, weights, two, d), det = a * c - b * b;
  if (!(det > FEM_ROUNDING * a * c)) return; // sine² of their angle: they count as one
  gamma[0] = (right * c - right_two * b) / det;
  gamma[1] = (right_two * a - right * b) / det;
}

void fem_mixing_note(FemMixing *mixing, const double *d) {
  if (mixing->has_last) push(mixing, d);
  fem_vector_copy(mixing->n, d, mixing->last);
}

void fem_mixing_mix(FemMixing *mixing, const double *weights, double *d) {
  double gamma[2];
  fem_mixing_note(mixing, d);
  if (mixing->count == 0) return;
  find_shares(mixing, weights, d, gamma);
  if (!isfinite(gamma[0] + gamma[1])) return;
  for (int j = 0; j < mixing->count; j++)
    for (int i = 0; i < mixing->n; i++) d[i] -= gamma[j] * (mixing->steps[j][i] + mixing->changes[j][i]);
}

void fem_mixing_take(FemMixing *mixing, double share, const double *step) {
  fem_vector_scale(mixing->n, share, step, mixing->taken);
  mixing->has_last = true;
}
