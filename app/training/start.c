// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/start.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/training/task.h"
#include "base/files/record.h"
#include "base/memory.h"
#include "base/text.h"
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
  return is_solved ? STATUS_OK : status_fail(STATUS_INPUT, "the whitening of the data cannot be inverted");
}

// Coefficients of the vectors become those of the whitened ones: c = Aᵀ ĉ is solved for ĉ, whose rows begin
// with row 1 of a tensor.
static Status unfold_rows(const NetWhitening *vectors, const NetTensor *tensor, double *numbers) {
  int n = vectors->count, columns = tensor->columns ? tensor->columns : 1;
  size_t size = (size_t)n;
  double *matrix = memory_copy(vectors->matrix, size * size, sizeof(double));
  double *transposed = memory_zeroed(size * (size_t)columns, sizeof(double));
  bool fits = matrix && transposed;
  for (int j = 0; j < columns && fits; j++)
    for (int r = 0; r < n; r++) transposed[j * n + r] = numbers[(1 + r) * columns + j];
  bool is_solved = fits && solve_rows(n, matrix, columns, transposed);
  for (int j = 0; j < columns && is_solved; j++)
    for (int r = 0; r < n; r++) numbers[(1 + r) * columns + j] = transposed[j * n + r];
  memory_free(matrix), memory_free(transposed);
  if (!fits) return status_no_memory("the first weights");
  return is_solved ? STATUS_OK : status_fail(STATUS_INPUT, "the vectors' whitening cannot be inverted");
}

static Status unfold_vectors(const NetWhitening *vectors, NetModel_f64 *model) {
  const NetPlan *plan = model->plan;
  for (int t = plan->tensor_count - 2; t < plan->tensor_count; t++) // the last weights and biases
    TRY(unfold_rows(vectors, &plan->tensors[t], model->parameters + plan->tensors[t].offset));
  return STATUS_OK;
}

// "mlp: 56 inputs, hidden layers 16 16, 1 output, 1201 parameters".
static void describe(const NetPlan *plan, char *text, size_t size) {
  const NetShape *shape = &plan->shape;
  size_t used = 0;
  text_append(text, size, &used, "%s: %d inputs, ", shape->kind == NET_MLP ? "mlp" : "tpn",
              shape->input_count);
  if (shape->kind == NET_MLP) {
    text_append(text, size, &used, "hidden layers");
    for (int k = 0; k < shape->hidden.count; k++)
      text_append(text, size, &used, " %d", shape->hidden.width[k]);
    text_append(text, size, &used, ", ");
  }
  text_append(text, size, &used, "%d %s, %zu parameters", shape->output_count,
              shape->output_count == 1 ? "output" : "outputs", plan->parameter_count);
}

static Record *record_shape(const NetShape *shape) {
  char text[NET_SHAPE_TEXT];
  Record *record;
  if (net_shape_print(shape, text) != NET_OK) return NULL;
  return record_parse(&record, text, strlen(text), "shape") == STATUS_OK ? record : NULL;
}

// Both shapes, and the first of their keys that differs.
static Status fail_shape(const char *path, const NetPlan *found, const NetPlan *wanted) {
  char of_file[256], of_model[256];
  RecordDifference d = {{0}, {0}, {0}};
  Record *a = record_shape(&found->shape), *b = record_shape(&wanted->shape);
  bool is_told = a && b && record_differ(a, b, &d);
  record_destroy(a), record_destroy(b);
  if (!is_told) return status_no_memory("the difference of two shapes");
  describe(found, of_file, sizeof of_file);
  describe(wanted, of_model, sizeof of_model);
  return status_fail(
      STATUS_INPUT,
      "%s: holds another network than `model` describes: the file has %s; `model` describes %s; '%s' "
      "is %s in the file and %s by `model`. Describe in `model` what the file holds, or name "
      "another `start`",
      path, of_file, of_model, d.place, d.a, d.b);
}

static Status bring_over(const char *path, const char *normalisation, const NetWhitening *whitening,
                         const NetWhitening *vectors, const NetModel_f32 *model, NetModel_f64 *from,
                         const NetCard *card) {
  NetShape shape = model->plan->shape;
  bool lacks_centroid = vectors && from->plan->shape.output_count == 1;
  if (lacks_centroid) shape.output_count = 1;
  if (!net_shape_equal(&from->plan->shape, &shape)) return fail_shape(path, from->plan, model->plan);
  if (strcmp(card->normalisation, normalisation) != 0)
    return status_fail(STATUS_INPUT, "%s: made for the normalisation '%s', the training has '%s'", path,
                       card->normalisation, normalisation);
  if (whitening) TRY(unfold(whitening, from));
  return vectors && !lacks_centroid ? unfold_vectors(vectors, from) : STATUS_OK;
}

// Into the model, whose parameters stay where the file has none: those of the outputs beyond its first.
static void copy_parameters(const NetModel_f64 *from, NetModel_f32 *model) {
  for (int t = 0; t < from->plan->tensor_count; t++) {
    const NetTensor *tensor = &from->plan->tensors[t];
    const double *numbers = from->parameters + tensor->offset;
    float *place = model->parameters + model->plan->tensors[t].offset;
    for (size_t i = 0; i < net_plan_tensor_size(tensor); i++) place[i] = (float)numbers[i];
  }
}

Status app_training_start_read(const char *name, const char *normalisation, const NetWhitening *whitening,
                               const NetWhitening *vectors, NetModel_f32 *model) {
  char path[4096];
  if (overlap_weights_is_path(name))
    snprintf(path, sizeof path, "%s", name);
  else
    TRY(overlap_weights_find(name, path, sizeof path));
  NetModel_f64 from = {0};
  NetCard card = {0};
  TRY(app_training_task_fail(net_weights_read_f64(path, &from, &card)));
  Status status = bring_over(path, normalisation, whitening, vectors, model, &from, &card);
  if (!status) copy_parameters(&from, model);
  net_weights_card_destroy(&card);
  net_model_destroy_f64(&from);
  return status;
}
