// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/evaluation.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "base/sorted.h"
#include "base/vec3.h"
#include "datagen/generate.h"
#include "overlap/ops.h"

enum { SIZE = OVERLAP_PAIR_SIZE };

// Upper ends of the paper's bins of V: small, medium, large.
static const double bin_ends[APP_EVALUATION_BINS] = {0.0067, 0.0133, 0.02};

static const uint64_t SYMMETRY_SEED = 0x5e3d;
static const double DEGREES = 57.29577951308232;

// What is known and what the model says of one block.
typedef struct Block {
  size_t count;
  const DatagenPairs *pairs;
  double *true_gradient; // (count, 24); owned unless it is the pairs'
  double *true_centroid; // (count, 3); owned unless it is the pairs'
  double *volume;        // (count), owned
  double *gradient;      // (count, 24), owned
  double *centroid;      // (count, 3), owned
  unsigned *flags;       // (count), owned
  double *logits;        // (count), owned; NULL: the model gives none
  double *swapped;       // (count), owned: what the status depends on, V or logit, the two exchanged
} Block;

void app_evaluation_begin(AppEvaluationRun *run, const OverlapModel *model, AppEvaluationLogits logits) {
  *run = (AppEvaluationRun){.model = model, .logits = logits, .sums.has_status = logits != NULL};
}

void app_evaluation_end(AppEvaluationRun *run) {
  memory_free(run->gradient_errors);
  memory_free(run->angles);
  app_evaluation_bounds_end(&run->bounds);
  *run = (AppEvaluationRun){0};
}

static double length_of(const double x[SIZE]) {
  double sum = 0;
  for (int i = 0; i < SIZE; i++) sum += x[i] * x[i];
  return sqrt(sum);
}

static double distance_of(const double a[SIZE], const double b[SIZE]) {
  double difference[SIZE];
  for (int i = 0; i < SIZE; i++) difference[i] = a[i] - b[i];
  return length_of(difference);
}

static Vec3 force_of(const double gradient[SIZE]) {
  Vec3 force = {0, 0, 0};
  for (int v = 0; v < 4; v++) force = vec3_add(force, vec3_at(gradient + 3 * v));
  return force;
}

// The true gradients and centroids where the data have none; NULL: not wanted.
static Status complete(const DatagenPairs *pairs, size_t count, double *gradient, double *centroid) {
  bool has_failed = false;
#pragma omp parallel for schedule(dynamic, 64) reduction(|| : has_failed)
  for (ptrdiff_t i = 0; i < (ptrdiff_t)count; i++) {
    double volume;
    if (pairs->volume[i] > 0 && datagen_generate_label(DATAGEN_LABEL_CLIP, pairs->coordinates + i * SIZE, 3,
                                                       &volume, gradient ? gradient + i * SIZE : NULL,
                                                       centroid ? centroid + i * 3 : NULL) != STATUS_OK)
      has_failed = true;
  }
  return has_failed ? status_fail(STATUS_SOLVER, "clipping gave no answer for a pair") : STATUS_OK;
}

static void block_destroy(Block *block) {
  if (block->true_gradient != block->pairs->gradient) memory_free(block->true_gradient);
  if (block->true_centroid != block->pairs->centroid) memory_free(block->true_centroid);
  memory_free(block->volume), memory_free(block->gradient);
  memory_free(block->centroid), memory_free(block->flags);
  memory_free(block->logits), memory_free(block->swapped);
}

static Status block_tell_status(Block *block, const AppEvaluationRun *run) {
  if (!run->logits) return STATUS_OK;
  block->logits = memory_zeroed(block->count, sizeof *block->logits);
  if (!block->logits) return status_no_memory("an evaluation");
  return run->logits(run->model->self, (int)block->count, block->pairs->coordinates, block->logits);
}

static Status block_tell_swapped(Block *block, const AppEvaluationRun *run) {
  block->swapped = memory_zeroed(block->count, sizeof *block->swapped);
  double *pairs = memory_zeroed(block->count * SIZE, sizeof *pairs);
  Status status = block->swapped && pairs ? STATUS_OK : status_no_memory("an evaluation");
  for (size_t i = 0; i < block->count && !status; i++)
    overlap_ops_swap(block->pairs->coordinates + i * SIZE, pairs + i * SIZE);
  OverlapBatch batch = {.pair_count = (int)block->count, .pairs = pairs, .volume = block->swapped};
  if (!status)
    status = run->logits ? run->logits(run->model->self, (int)block->count, pairs, block->swapped)
                         : overlap_model_eval(run->model, &batch);
  memory_free(pairs);
  return status;
}

static Status block_evaluate(Block *block, const OverlapModel *model) {
  size_t count = block->count;
  block->volume = memory_zeroed(count, sizeof *block->volume);
  block->gradient = memory_zeroed(count * SIZE, sizeof *block->gradient);
  block->flags = memory_zeroed(count, sizeof *block->flags);
  block->centroid = memory_zeroed(count * 3, sizeof *block->centroid);
  block->true_gradient = block->pairs->gradient, block->true_centroid = block->pairs->centroid;
  if (!block->true_gradient) block->true_gradient = memory_zeroed(count * SIZE, sizeof(double));
  if (!block->true_centroid) block->true_centroid = memory_zeroed(count * 3, sizeof(double));
  if (!block->volume || !block->gradient || !block->centroid || !block->flags || !block->true_gradient ||
      !block->true_centroid)
    return status_no_memory("an evaluation");
  if (!block->pairs->gradient || !block->pairs->centroid)
    TRY(complete(block->pairs, count, block->pairs->gradient ? NULL : block->true_gradient,
                 block->pairs->centroid ? NULL : block->true_centroid));
  const bool has_gradient = overlap_model_has_gradient(model),
             has_centroid = has_gradient || overlap_model_has_own_centroid(model);
  for (size_t k = 0; k < count * SIZE && !has_gradient; k++) block->gradient[k] = NAN;
  for (size_t k = 0; k < count * 3 && !has_centroid; k++) block->centroid[k] = NAN;
  OverlapBatch batch = {.pair_count = (int)count,
                        .pairs = block->pairs->coordinates,
                        .volume = block->volume,
                        .gradient = has_gradient ? block->gradient : NULL,
                        .centroid = has_centroid ? block->centroid : NULL,
                        .flags = block->flags};
  return overlap_model_eval(model, &batch);
}

static int bin_of(double volume) {
  int bin = 0;
  while (bin < APP_EVALUATION_BINS - 1 && volume >= bin_ends[bin]) bin++;
  return bin;
}

// λ of x in the tetrahedron, by the three edges from its first vertex; false: it is flat.
static bool find_coordinates(const double tet[12], const double x[3], double lambda[4]) {
  Vec3 edge[3], to = vec3_sub(vec3_at(x), vec3_at(tet));
  for (int k = 0; k < 3; k++) edge[k] = vec3_sub(vec3_at(tet + 3 * (k + 1)), vec3_at(tet));
  double det = vec3_dot(edge[0], vec3_cross(edge[1], edge[2]));
  lambda[0] = 1;
  for (int k = 0; k < 3; k++) {
    lambda[k + 1] = vec3_dot(to, vec3_cross(edge[(k + 1) % 3], edge[(k + 2) % 3])) / det;
    lambda[0] -= lambda[k + 1];
  }
  return det != 0;
}

bool app_evaluation_coordinates(const double pair[24], const double x[3], double lambda[8]) {
  return find_coordinates(pair, x, lambda) && find_coordinates(pair + 12, x, lambda + 4);
}

static void add_angle(AppEvaluationRun *run, const double truth[SIZE], const double told[SIZE]) {
  Vec3 a = force_of(truth), b = force_of(told);
  // of a tetrahedron inside the other nothing but rounding is left
  if (!(vec3_length(a) > 1e-9 * length_of(truth)) || isnan(told[0])) return;
  double angle = atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
  run->angles[run->angle_count++] = vec3_length(b) > 0 ? DEGREES * angle : 180;
}

// Σ_z |m_z − m*_z| over the eight vertices, m_z = V λ_z(x̄), with the true V and with the model's own.
static void add_moments(AppEvaluationRun *run, const Block *block, size_t i) {
  double truth[8], told[8], volume = block->pairs->volume[i];
  if (!app_evaluation_coordinates(block->pairs->coordinates + i * SIZE, block->true_centroid + 3 * i,
                                  truth) ||
      !app_evaluation_coordinates(block->pairs->coordinates + i * SIZE, block->centroid + 3 * i, told))
    return;
  for (int z = 0; z < 8; z++) {
    if (!(block->volume[i] > 0)) told[z] = 0; // with no volume there is no centroid
    run->sums.moment_error += fabs(volume * (told[z] - truth[z]));
    run->sums.moment_error_own += fabs(block->volume[i] * told[z] - volume * truth[z]);
    run->true_moments += fabs(volume * truth[z]);
  }
}

static void add_inside(AppEvaluationRun *run, const Block *block, size_t i) {
  AppEvaluation *sums = &run->sums;
  const double *truth = block->true_gradient + i * SIZE, *told = block->gradient + i * SIZE;
  double volume = block->pairs->volume[i], error = fabs(block->volume[i] - volume);
  int bin = bin_of(volume);
  sums->handed_on += (block->flags[i] & OVERLAP_FALLBACK) != 0;
  sums->handed_on_in_part += (block->flags[i] & OVERLAP_BLENDED) != 0;
  sums->mae += error;
  sums->bin_mae[bin] += error;
  sums->bin_accuracy[bin] += block->volume[i] > 0 && bin_of(block->volume[i]) == bin;
  run->bins[bin]++;
  run->true_volume += volume;
  double size = length_of(truth), difference = distance_of(told, truth);
  run->true_gradient += size;
  sums->gradient_error += difference;
  run->gradient_errors[sums->inside++] = difference / size;
  add_angle(run, truth, told);
  add_moments(run, block, i);
}

static void add_outside(AppEvaluationRun *run, const Block *block, size_t i) {
  run->outside++;
  run->sums.ghost_volume += fabs(block->volume[i]);
  run->sums.ghost_gradient += length_of(block->gradient + i * SIZE);
}

static void add_confidence(AppEvaluationRun *run, double logit, bool intersects) {
  double probability = 1 / (1 + exp(-logit));
  int bin = (int)fmin(APP_EVALUATION_CONFIDENCES * probability, APP_EVALUATION_CONFIDENCES - 1);
  run->probability[bin] += probability;
  run->confident[bin]++;
  run->intersecting[bin] += intersects;
}

// `told`: the logit if the model gives one, else V.
static bool is_right(const Block *block, size_t i, double told) {
  if (block->logits) return (told > 0) == (block->pairs->status[i] != 0);
  return (told > 0) == (block->pairs->volume[i] > 0);
}

static void add_pair(AppEvaluationRun *run, const Block *block, size_t i) {
  AppEvaluationKind *kind = &run->sums.kinds[block->pairs->kind[i]];
  double volume = block->pairs->volume[i];
  kind->count++;
  kind->accuracy += is_right(block, i, block->logits ? block->logits[i] : block->volume[i]);
  kind->accuracy_swapped += is_right(block, i, block->swapped[i]);
  if (block->logits) add_confidence(run, block->logits[i], block->pairs->status[i] != 0);
  kind->volume_mae += fabs(block->volume[i] - volume);
  run->sums.count++;
  run->sums.fallbacks += (block->flags[i] & OVERLAP_FALLBACK) != 0;
  run->sums.blended += (block->flags[i] & OVERLAP_BLENDED) != 0;
  run->sums.unsound += (block->flags[i] & OVERLAP_UNSOUND) != 0;
  if (volume > 0)
    add_inside(run, block, i);
  else
    add_outside(run, block, i);
}

static void reorder(const double pair[SIZE], Random *random, double changed[SIZE]) {
  for (int t = 0; t < 2; t++) {
    int order[4] = {0, 1, 2, 3};
    for (int v = 3; v > 0; v--) {
      int other = random_below(random, v + 1), kept = order[v];
      order[v] = order[other], order[other] = kept;
    }
    for (int v = 0; v < 4; v++)
      memcpy(changed + 12 * t + 3 * v, pair + 12 * t + 3 * order[v], 3 * sizeof(double));
  }
}

static void rotate(const double pair[SIZE], Random *random, double changed[SIZE]) {
  double r[9];
  random_rotation(random, r);
  for (int v = 0; v < 8; v++)
    for (int i = 0; i < 3; i++) {
      changed[3 * v + i] = 0.5;
      for (int j = 0; j < 3; j++) changed[3 * v + i] += r[3 * i + j] * (pair[3 * v + j] - 0.5);
    }
}

static Status add_defects(AppEvaluationRun *run, const double pair[SIZE], double volume) {
  Random random = random_seeded(SYMMETRY_SEED, (uint64_t)run->symmetry_count);
  double changed[3][SIZE], told[3];
  reorder(pair, &random, changed[0]);
  memcpy(changed[1], pair + 12, 12 * sizeof(double));
  memcpy(changed[1] + 12, pair, 12 * sizeof(double));
  rotate(pair, &random, changed[2]);
  OverlapBatch batch = {.pair_count = 3, .pairs = changed[0], .volume = told};
  TRY(overlap_model_eval(run->model, &batch));
  run->sums.defect_vertex_order += fabs(told[0] - volume);
  run->sums.defect_swap += fabs(told[1] - volume);
  run->sums.defect_rotation += fabs(told[2] - volume);
  run->symmetry_volume += volume;
  run->symmetry_count++;
  return STATUS_OK;
}

static Status add_block(AppEvaluationRun *run, Block *block) {
  TRY(block_evaluate(block, run->model));
  TRY(block_tell_status(block, run));
  TRY(block_tell_swapped(block, run));
  TRY(app_evaluation_bounds_add(&run->bounds, run->model, block->pairs, block->count));
  size_t wanted = (size_t)run->sums.inside + block->count;
  if (!memory_reserve((void **)&run->gradient_errors, &run->gradient_capacity, wanted, sizeof(double)) ||
      !memory_reserve((void **)&run->angles, &run->angle_capacity, wanted, sizeof(double)))
    return status_no_memory("an evaluation");
  for (size_t i = 0; i < block->count; i++) {
    add_pair(run, block, i);
    if (block->pairs->volume[i] > 0 && run->symmetry_count < APP_EVALUATION_SYMMETRY_PAIRS)
      TRY(add_defects(run, block->pairs->coordinates + i * SIZE, block->volume[i]));
  }
  return STATUS_OK;
}

Status app_evaluation_add(AppEvaluationRun *run, const DatagenPairs *pairs, size_t count) {
  enum { BLOCK = 16384 };
  for (size_t first = 0; first < count; first += BLOCK) {
    DatagenPairs part = {.coordinates = pairs->coordinates + first * SIZE,
                         .status = pairs->status + first,
                         .kind = pairs->kind + first,
                         .volume = pairs->volume + first,
                         .gradient = pairs->gradient ? pairs->gradient + first * SIZE : NULL,
                         .centroid = pairs->centroid ? pairs->centroid + first * 3 : NULL};
    Block block = {.count = count - first < BLOCK ? count - first : BLOCK, .pairs = &part};
    Status status = add_block(run, &block);
    block_destroy(&block);
    TRY(status);
  }
  return STATUS_OK;
}

// The value below which that share of them lies; sorts them.
static double quantile(double *values, size_t count, double share) {
  if (count == 0) return NAN;
  sorted_values(values, count);
  return values[(size_t)(share * (double)(count - 1) + 0.5)];
}

static double divide(double sum, double by) {
  return by > 0 ? sum / by : NAN;
}

static void finish_kinds(AppEvaluation *result) {
  int present = 0;
  result->accuracy_mean = result->accuracy_swapped_mean = 0;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    AppEvaluationKind *kind = &result->kinds[k];
    double count = (double)kind->count;
    kind->accuracy = divide(kind->accuracy, count);
    kind->accuracy_swapped = divide(kind->accuracy_swapped, count);
    kind->volume_mae = divide(kind->volume_mae, count);
    if (kind->count == 0) continue;
    present++;
    result->accuracy_mean += kind->accuracy;
    result->accuracy_swapped_mean += kind->accuracy_swapped;
  }
  result->accuracy_mean = divide(result->accuracy_mean, present);
  result->accuracy_swapped_mean = divide(result->accuracy_swapped_mean, present);
}

static double calibration_of(const AppEvaluationRun *run) {
  double sum = 0;
  for (int b = 0; b < APP_EVALUATION_CONFIDENCES; b++)
    sum += fabs(run->probability[b] - (double)run->intersecting[b]);
  return run->logits ? divide(sum, (double)run->sums.count) : NAN;
}

void app_evaluation_finish(AppEvaluationRun *run, AppEvaluation *result) {
  *result = run->sums;
  finish_kinds(result);
  result->calibration_error = calibration_of(run);
  result->bounds = app_evaluation_bounds_finish(&run->bounds);
  double inside = (double)result->inside, outside = (double)run->outside;
  for (int b = 0; b < APP_EVALUATION_BINS; b++) {
    double count = (double)run->bins[b];
    result->bin_mae[b] = divide(result->bin_mae[b], count);
    result->bin_accuracy[b] = divide(result->bin_accuracy[b], count);
    result->bin_share[b] = divide(count, inside);
  }
  result->volume_error_sum = divide(result->mae, run->true_volume);
  result->mae = divide(result->mae, inside);
  result->handed_on = divide(result->handed_on, inside);
  result->handed_on_in_part = divide(result->handed_on_in_part, inside);
  result->gradient_error = divide(result->gradient_error, run->true_gradient);
  result->moment_error = divide(result->moment_error, run->true_moments);
  result->moment_error_own = divide(result->moment_error_own, run->true_moments);
  result->gradient_error_median = quantile(run->gradient_errors, (size_t)result->inside, 0.5);
  result->gradient_error_p90 = quantile(run->gradient_errors, (size_t)result->inside, 0.9);
  result->angle_median_deg = quantile(run->angles, run->angle_count, 0.5);
  result->angle_p90_deg = quantile(run->angles, run->angle_count, 0.9);
  result->ghost_volume = divide(result->ghost_volume, outside);
  result->ghost_gradient = divide(result->ghost_gradient, outside);
  result->defect_vertex_order = divide(result->defect_vertex_order, run->symmetry_volume);
  result->defect_swap = divide(result->defect_swap, run->symmetry_volume);
  result->defect_rotation = divide(result->defect_rotation, run->symmetry_volume);
}
