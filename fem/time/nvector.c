// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/nvector.h"

#include <math.h>

#include "base/ranks.h"
#include "fem/sparse/vector.h"

// More vectors than a combination of IDA's or KINSOL's ever has: one of each order, and one more.
enum { COMBINED_COUNT = 16 };

static int length_of(N_Vector x) {
  return (int)NV_LENGTH_S(x);
}

static double *values_of(N_Vector x) {
  return NV_DATA_S(x);
}

static void fill(sunrealtype a, N_Vector z) {
  fem_vector_fill(length_of(z), a, values_of(z));
}

static void scale(sunrealtype a, N_Vector x, N_Vector z) {
  if (a == 1)
    fem_vector_copy(length_of(z), values_of(x), values_of(z));
  else
    fem_vector_scale(length_of(z), a, values_of(x), values_of(z));
}

static void multiply(N_Vector x, N_Vector y, N_Vector z) {
  fem_vector_multiply(length_of(z), values_of(x), values_of(y), values_of(z));
}

static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z) {
  fem_vector_sum(length_of(z), a, values_of(x), b, values_of(y), values_of(z));
}

static sunrealtype largest(N_Vector x) {
  return fem_vector_largest(length_of(x), values_of(x));
}

static sunrealtype dot(N_Vector x, N_Vector y) {
  return fem_vector_dot(length_of(x), values_of(x), values_of(y));
}

static int combine(int count, sunrealtype *a, N_Vector *x, N_Vector z) {
  const double *values[COMBINED_COUNT];
  if (count < 1 || count > COMBINED_COUNT) return -1;
  for (int k = 0; k < count; k++) values[k] = values_of(x[k]);
  fem_vector_combine(length_of(z), count, a, values, values_of(z));
  return 0;
}

sunrealtype fem_nvector_norm(N_Vector x, N_Vector weights) {
  double all[2] = {fem_vector_square(length_of(x), values_of(x), values_of(weights)), length_of(x)};
  ranks()->sum(all, 2);
  return sqrt(all[0] / all[1]);
}

// What SUNDIALS asks often. The rest are the serial vector's own.
N_Vector fem_nvector_create(int length, SUNContext context) {
  N_Vector vector = N_VNew_Serial(length, context);
  if (!vector) return NULL;
  vector->ops->nvconst = fill;
  vector->ops->nvscale = scale;
  vector->ops->nvprod = multiply;
  vector->ops->nvlinearsum = linear_sum;
  vector->ops->nvmaxnorm = largest;
  vector->ops->nvdotprod = dot;
  vector->ops->nvlinearcombination = combine;
  vector->ops->nvwrmsnorm = fem_nvector_norm;
  N_VConst(0, vector);
  return vector;
}
