// SPDX-License-Identifier: Apache-2.0
#include "net/model/whitening.h"

#include <math.h>
#include <string.h>

#include "net/memory.h"

NetStatus net_whitening_create(int count, NetWhitening *whitening) {
  *whitening = (NetWhitening){.count = count};
  whitening->mean = net_memory_zeroed((size_t)count, sizeof(double));
  whitening->matrix = net_memory_zeroed((size_t)count * (size_t)count, sizeof(double));
  if (whitening->mean && whitening->matrix) return NET_OK;
  net_whitening_destroy(whitening);
  return net_status_no_memory("a whitening");
}

void net_whitening_destroy(NetWhitening *whitening) {
  net_memory_free(whitening->mean);
  net_memory_free(whitening->matrix);
  *whitening = (NetWhitening){0};
}

// Standardised samples' correlations (n, n). A feature that does not vary beyond the rounding of its mean has
// deviation 1 and no correlation with anything, itself included.
static void correlate(int n, int sample_count, const double *samples, const double *mean, double *deviation,
                      double *correlation) {
  for (int s = 0; s < sample_count; s++) {
    const double *x = samples + (size_t)s * (size_t)n;
    for (int i = 0; i < n; i++) {
      double d = (x[i] - mean[i]) / sample_count;
      for (int j = 0; j <= i; j++) correlation[i * n + j] += d * (x[j] - mean[j]);
    }
  }
  for (int i = 0; i < n; i++) deviation[i] = sqrt(correlation[i * n + i]);
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) {
      bool vary = deviation[i] > 1e-12 * fabs(mean[i]) && deviation[j] > 1e-12 * fabs(mean[j]);
      double value = vary ? correlation[i * n + j] / (deviation[i] * deviation[j]) : 0;
      correlation[j * n + i] = correlation[i * n + j] = value;
    }
  for (int i = 0; i < n; i++)
    if (!(deviation[i] > 1e-12 * fabs(mean[i]))) deviation[i] = 1;
}

// One Jacobi rotation of rows and columns p, q of the symmetric a; the rows of v become the eigenvectors.
static void rotate(int n, double *a, double *v, int p, int q) {
  double apq = a[p * n + q];
  if (apq == 0) return;
  double theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
  double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
  double c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < n; k++) {
    double kp = a[k * n + p], kq = a[k * n + q];
    a[k * n + p] = c * kp - s * kq;
    a[k * n + q] = s * kp + c * kq;
  }
  for (int k = 0; k < n; k++) {
    double pk = a[p * n + k], qk = a[q * n + k], vp = v[p * n + k], vq = v[q * n + k];
    a[p * n + k] = c * pk - s * qk;
    a[q * n + k] = s * pk + c * qk;
    v[p * n + k] = c * vp - s * vq;
    v[q * n + k] = s * vp + c * vq;
  }
}

// Cyclic Jacobi (Golub and Van Loan 8.5): a becomes diagonal, its former self is vᵀ a v.
static void diagonalise(int n, double *a, double *v) {
  for (int i = 0; i < n; i++) v[i * n + i] = 1;
  for (int sweep = 0; sweep < 50; sweep++) {
    double off = 0;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) off += a[p * n + q] * a[p * n + q];
    if (!(off > 1e-30 * n * n)) return;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) rotate(n, a, v, p, q);
  }
}

NetStatus net_whitening_fit(int count, int sample_count, const double *samples, NetWhitening *whitening) {
  *whitening = (NetWhitening){0};
  if (count < 1 || sample_count < 2)
    return net_status_fail(NET_BAD_ARGUMENT, "whitening: %d features of %d samples; expected ≥ 1 and ≥ 2",
                           count, sample_count);
  NET_TRY(net_whitening_create(count, whitening));
  size_t n = (size_t)count;
  double *deviation = net_memory_zeroed(n, sizeof *deviation);
  double *correlation = net_memory_zeroed(n * n, sizeof *correlation);
  if (!deviation || !correlation) {
    net_memory_free(deviation), net_memory_free(correlation);
    net_whitening_destroy(whitening);
    return net_status_no_memory("a whitening's fit");
  }
  for (int s = 0; s < sample_count; s++)
    for (size_t i = 0; i < n; i++) whitening->mean[i] += samples[(size_t)s * n + i] / sample_count;
  correlate(count, sample_count, samples, whitening->mean, deviation, correlation);
  diagonalise(count, correlation, whitening->matrix);
  for (size_t i = 0; i < n; i++) {
    double variance = correlation[i * n + i];
    double scale = variance > 0 ? 1 / sqrt(variance + 1e-6) : 1;
    for (size_t j = 0; j < n; j++) whitening->matrix[i * n + j] *= scale / deviation[j];
  }
  net_memory_free(deviation), net_memory_free(correlation);
  return NET_OK;
}

// The mean is taken off before the product: where features nearly cancel, M is large.
void net_whitening_apply(const NetWhitening *whitening, int sample_count, const double *in, double *out) {
  size_t n = (size_t)whitening->count;
  for (int s = 0; s < sample_count; s++, in += n, out += n)
    for (size_t i = 0; i < n; i++) {
      double sum = 0;
      for (size_t j = 0; j < n; j++) sum += whitening->matrix[i * n + j] * (in[j] - whitening->mean[j]);
      out[i] = sum;
    }
}

NetStatus net_whitening_fold(const NetWhitening *whitening, NetModel_f64 *model) {
  size_t n = (size_t)whitening->count;
  if (model->plan->shape.kind != NET_MLP || model->plan->shape.input_count != whitening->count)
    return net_status_fail(NET_BAD_ARGUMENT,
                           "whitening of %d features: the network must be an mlp of as many inputs",
                           whitening->count);
  double *row = net_memory_zeroed(n, sizeof *row);
  if (!row) return net_status_no_memory("a folded layer");
  double *weight = net_model_tensor_f64(model, "layer.0.weight");
  double *bias = net_model_tensor_f64(model, "layer.0.bias");
  int rows = model->plan->tensors[net_plan_find(model->plan, "layer.0.weight")].rows;
  for (int i = 0; i < rows; i++, weight += n) {
    memset(row, 0, n * sizeof *row);
    for (size_t k = 0; k < n; k++)
      for (size_t j = 0; j < n; j++) row[j] += weight[k] * whitening->matrix[k * n + j];
    for (size_t j = 0; j < n; j++) bias[i] -= row[j] * whitening->mean[j];
    memcpy(weight, row, n * sizeof *row);
  }
  net_memory_free(row);
  return NET_OK;
}
