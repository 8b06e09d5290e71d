// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/start.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/training/task.h"
#include "base/memory.h"
#include "net/files/weights.h"
#include "overlap/weights.h"

// Solves X A = B for X, rows of B in place; A (n, n) is destroyed. Aᵀ is eliminated with pivots by size, that
// is, columns of A are. False: singular.
static bool solve_rows(int n, double *a, int rows, double *b) {
  for (int k = 0; k < n; k++) {
    int pivot = k;
    for (int j = k + 1; j < n; j++)
      if (fabs(a[k * n + j]) > fabs(a[k * n + pivot])) pivot = j;
    if (!(fabs(a[k * n + pivot]) > 0)) return false;
    for (int i = 0; i < n && pivot != k; i++) {
      double kept = a[i * n + k];
      a[i * n + k] = a[i * n + pivot], a[i * n + pivot] = kept;
    }
    for (int r = 0; r < rows && pivot != k; r++) {
      double kept = b[r * n + k];
      b[r * n + k] = b[r * n + pivot], b[r * n + pivot] = kept;
    }
    for (int j = k + 1; j < n; j++) {
      double factor = a[k * n + j] / a[k * n + k];
      for (int i = k; i < n; i++) a[i * n + j] -= factor * a[i * n + k];
      for (int r = 0; r < rows; r++) b[r * n + j] -= factor * b[r * n + k];
    }
  }
  for (int r = 0; r < rows; r++) {
    double *row = b + r * n;
    for (int k = n - 1; k >= 0; k--) {
      double sum = row[k];
      for (int i = k + 1; i < n; i++) sum -= row[i] * a[i * n + k];
      row[k] = sum / a[k * n + k];
    }
  }
  return true;
}

static Status unfold(const NetWhitening *whitening, NetModel_f64 *model) {
  int n = whitening->count, rows = model->plan->tensors[0].rows;
  double *weight = net_model_tensor_f64(model, "layer.0.weight");
  double *bias = net_model_tensor_f64(model, "layer.0.bias");
  if (!weight || !bias) return status_fail(STATUS_INPUT, "the network has no first layer to bring over");
  double *matrix = memory_copy(whitening->matrix, (size_t)n * (size_t)n, sizeof(double));
  if (!matrix) return status_no_memory("the first weights");
  for (int r = 0; r < rows; r++)
    for (int j = 0; j < n; j++) bias[r] += weight[r * n + j] * whitening->mean[j];
  bool is_solved = solve_rows(n, matrix, rows, weight);
  memory_free(matrix);
  return is_solved ? STATUS_OK : status_fail(STATUS_INPUT, "the data's whitening cannot be inverted");
}

static Status bring_over(const char *path, const char *normalisation, const NetWhitening *whitening,
                         const NetModel_f32 *model, NetModel_f64 *from, const NetCard *card) {
  if (!net_shape_equal(&from->plan->shape, &model->plan->shape))
    return status_fail(STATUS_INPUT, "%s: a network of another shape than `model` describes", path);
  if (strcmp(card->normalisation, normalisation) != 0)
    return status_fail(STATUS_INPUT, "%s: made for the normalisation '%s', the training has '%s'", path,
                       card->normalisation, normalisation);
  return whitening ? unfold(whitening, from) : STATUS_OK;
}

Status app_training_start_read(const char *name, const char *normalisation, const NetWhitening *whitening,
                               NetModel_f32 *model) {
  char path[4096];
  if (overlap_weights_is_path(name))
    snprintf(path, sizeof path, "%s", name);
  else
    TRY(overlap_weights_find(name, path, sizeof path));
  NetModel_f64 from = {0};
  NetCard card = {0};
  TRY(app_training_task_fail(net_weights_read_f64(path, &from, &card)));
  Status status = bring_over(path, normalisation, whitening, model, &from, &card);
  if (!status) net_model_narrow(&from, model);
  net_weights_card_destroy(&card);
  net_model_destroy_f64(&from);
  return status;
}
