// SPDX-License-Identifier: GPL-3.0-or-later
// Training of a TetrahedronPairNet, as published or after it: ½ cross-entropy of the status + ½ RMSLE of 1000
// V, from normalised pairs. The network gives V of the normalised pair in a unit of its own (output_scale);
// before the loss it is brought to 1000 V, so that the loss is about V whatever the normalisation.
//
// With loss.sobolev > 0 the loss has a term that the paper has not, of ∇V (rates.h).
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/training/tpn.h"

#include "app/training/rates.h"
#include "app/training/start.h"
#include "app/training/task.h"
#include "base/memory.h"
#include "overlap/pair/range.h"
#include "overlap/tpn/network.h"

enum { SIZE = 24, HALF = SIZE / 2, BLOCK = 16384, MAX_SETS = 6, MEASURED = 1 << 18 };

// Samples as the network sees them.
typedef struct Samples {
  char name[APP_TRAINING_SCORE_NAME];
  int count, left_out;
  int width;              // numbers that the network is shown: 24, or the second tetrahedron's 12
  float *x;               // of normalised pairs     (count, width)
  float *factor;          // scale · V = factor · y  (count)
  float *label;           // 1: the pair intersects  (count)
  float *target;          // scale · V               (count)
  uint8_t *kind;          // DatagenKind             (count)
  AppTrainingRates rates; // zeroed unless ∇V is learned
} Samples;

typedef struct Tpn {
  Samples training;
  Samples sets[MAX_SETS];
  int set_count;
  AppTrainingOrder order;
  OverlapRange range;             // of the training's pairs
  NetWork_f32 work;               // of validation
  int *samples;                   // (batch)
  float *x, *y, *gy;              // (batch, width), (batch, 2), (batch, 2)
  float *factor, *label, *target; // (batch)
  float *xt, *yt, *gyt, *rate;    // (batch, tangents, 24), twice (…, 2), (batch, tangents); NULL: none
} Tpn;

static OverlapTpnNormalisation normalisation_of(const AppTrainingConfig *config) {
  static const OverlapTpnNormalisation kinds[] = {[APP_NORMALISATION_UNIT] = OVERLAP_TPN_NORMALISE_UNIT,
                                                  [APP_NORMALISATION_PCA] = OVERLAP_TPN_NORMALISE_PCA,
                                                  [APP_NORMALISATION_SORTED] = OVERLAP_TPN_NORMALISE_SORTED,
                                                  [APP_NORMALISATION_UNSCALED] =
                                                      OVERLAP_TPN_NORMALISE_UNSCALED,
                                                  [APP_NORMALISATION_AXIS] = OVERLAP_TPN_NORMALISE_AXIS};
  return kinds[config->model.normalisation];
}

static bool learns_gradients(const AppTrainingConfig *config) {
  return config->loss.sobolev > 0;
}

static int tangents_of(const AppTrainingConfig *config) {
  return learns_gradients(config) ? config->loss.tangents : 0;
}

static void scale_widths(NetWidths *widths, double scale) {
  for (int k = 0; k < widths->count; k++)
    widths->width[k] = (int)fmax(4, 4 * round(widths->width[k] * scale / 4));
}

static void set_layers(NetWidths *widths, int layers) {
  for (int k = 1; k < layers; k++) widths->width[k] = widths->width[0];
  widths->count = layers;
}

// The published shape, wider or deeper; scale 1 and two layers change nothing.
static void resize(NetShape *shape, double scale, int layers) {
  NetWidths *blocks[3] = {&shape->vertex, &shape->tetrahedron, &shape->combiner};
  NetWidths *all[6] = {blocks[0],        blocks[1],           blocks[2],
                       &shape->backbone, &shape->status_head, &shape->volume_head};
  for (int b = 0; b < 6; b++) scale_widths(all[b], scale);
  for (int b = 0; b < 3; b++) set_layers(blocks[b], layers);
}

static NetShape shape(const AppTrainingConfig *config) {
  NetShape (*const readings[])(void) = {[APP_READING_A] = net_shape_tpn_a,
                                        [APP_READING_B] = net_shape_tpn_b,
                                        [APP_READING_C] = net_shape_tpn_c,
                                        [APP_READING_BACKBONE] = net_shape_tpn_backbone};
  NetShape made = readings[config->model.reading]();
  made.activation = config->model.activation == APP_ACTIVATION_RELU ? NET_RELU : NET_SILU;
  made.pool = config->model.pool == APP_POOL_MAX ? NET_MAX : NET_SUM;
  resize(&made, config->model.scale, config->model.layers);
  return made;
}

static void samples_destroy(Samples *samples) {
  memory_free(samples->x), memory_free(samples->factor), memory_free(samples->label);
  memory_free(samples->target), memory_free(samples->kind);
  app_training_rates_destroy(&samples->rates);
  *samples = (Samples){0};
}

static void destroy(AppTrainingTask *task) {
  Tpn *tpn = task->self;
  if (!tpn) return;
  samples_destroy(&tpn->training);
  for (int s = 0; s < tpn->set_count; s++) samples_destroy(&tpn->sets[s]);
  app_training_order_destroy(&tpn->order);
  net_work_destroy_f32(&tpn->work);
  memory_free(tpn->samples), memory_free(tpn->x), memory_free(tpn->y), memory_free(tpn->gy);
  memory_free(tpn->factor), memory_free(tpn->label), memory_free(tpn->target);
  memory_free(tpn->xt), memory_free(tpn->yt), memory_free(tpn->gyt), memory_free(tpn->rate);
  memory_free(tpn);
  task->self = NULL;
}

static Status samples_create(Samples *samples, const AppTrainingConfig *config, size_t count) {
  samples->width = shape(config).input_count;
  samples->x = memory_zeroed(count * (size_t)samples->width, sizeof(float));
  samples->factor = memory_zeroed(count, sizeof(float));
  samples->label = memory_zeroed(count, sizeof(float));
  samples->target = memory_zeroed(count, sizeof(float));
  samples->kind = memory_zeroed(count, 1);
  bool fits = samples->x && samples->factor && samples->label && samples->target && samples->kind;
  return fits ? STATUS_OK : status_no_memory("the training's samples");
}

static void samples_add(Samples *samples, const AppTrainingConfig *config, const DatagenPairs *pairs,
                        size_t i) {
  OverlapTpnNormalised normalised;
  if (!overlap_tpn_normalise(normalisation_of(config), pairs->coordinates + i * SIZE, &normalised)) {
    samples->left_out++;
    return;
  }
  int at = samples->count++, first = SIZE - samples->width;
  float *x = samples->x + at * (ptrdiff_t)samples->width;
  for (int c = 0; c < samples->width; c++) x[c] = (float)normalised.pair[first + c];
  samples->factor[at] = (float)(normalised.factor * config->loss.volume_scale / config->model.output_scale);
  samples->label[at] = pairs->status[i];
  samples->target[at] = (float)(config->loss.volume_scale * pairs->volume[i]);
  samples->kind[at] = pairs->kind[i];
  if (samples->rates.rate)
    app_training_rates_set(&samples->rates, at, &normalised, pairs->gradient + i * SIZE,
                           config->model.output_scale);
}

static Status fill(Samples *samples, const AppTrainingConfig *config, AppSource *source,
                   const DatagenPairs *block) {
  for (long long first = 0; first < source->count; first += BLOCK) {
    long long left = source->count - first;
    size_t count = (size_t)(left < BLOCK ? left : BLOCK);
    TRY(app_dataset_source_read(source, first, count, block));
    for (size_t i = 0; i < count; i++) samples_add(samples, config, block, i);
  }
  return STATUS_OK;
}

// All sources, one after another, block by block.
static Status load(Samples *samples, const AppTrainingConfig *config, const AppTrainingSourceDef *defs,
                   int count) {
  AppSource source;
  long long total = 0;
  for (int s = 0; s < count; s++) {
    AppSourceDef def = app_training_config_source(&defs[s]);
    TRY(app_dataset_source_open(&source, &def, learns_gradients(config)));
    total += source.count;
    app_dataset_source_close(&source);
  }
  TRY(samples_create(samples, config, (size_t)total));
  if (learns_gradients(config)) TRY(app_training_rates_create(&samples->rates, (size_t)total));
  DatagenPairs block;
  TRY(datagen_pairs_create(&block, BLOCK, learns_gradients(config)));
  Status status = STATUS_OK;
  for (int s = 0; s < count && !status; s++) {
    AppSourceDef def = app_training_config_source(&defs[s]);
    status = app_dataset_source_open(&source, &def, learns_gradients(config));
    if (!status) status = fill(samples, config, &source, &block);
    app_dataset_source_close(&source);
  }
  datagen_pairs_destroy(&block);
  if (learns_gradients(config)) app_training_rates_finish(&samples->rates, samples->count);
  return status;
}

static Status load_sets(Tpn *tpn, const AppTrainingConfig *config) {
  if (config->validation_count > MAX_SETS)
    return status_fail(STATUS_INPUT, "%s: %d validation sets; at most %d", config->path,
                       config->validation_count, MAX_SETS);
  for (int s = 0; s < config->validation_count; s++) {
    Samples *set = &tpn->sets[tpn->set_count++];
    TRY(load(set, config, &config->validation[s], 1));
    snprintf(set->name, sizeof set->name, "set%d", s + 1);
    if (config->validation[s].name) snprintf(set->name, sizeof set->name, "%s", config->validation[s].name);
  }
  return STATUS_OK;
}

static Status create_batch(Tpn *tpn, const AppTrainingConfig *config) {
  size_t batch = (size_t)config->optimiser.batch;
  tpn->samples = memory_zeroed(batch, sizeof(int));
  tpn->x = memory_zeroed(batch * (size_t)tpn->training.width, sizeof(float));
  tpn->y = memory_zeroed(batch * 2, sizeof(float)), tpn->gy = memory_zeroed(batch * 2, sizeof(float));
  tpn->factor = memory_zeroed(batch, sizeof(float)), tpn->label = memory_zeroed(batch, sizeof(float));
  tpn->target = memory_zeroed(batch, sizeof(float));
  bool fits = tpn->samples && tpn->x && tpn->y && tpn->gy && tpn->factor && tpn->label && tpn->target;
  return fits ? STATUS_OK : status_no_memory("a batch");
}

static Status create_tangents(Tpn *tpn, const AppTrainingConfig *config) {
  size_t rows = (size_t)config->optimiser.batch * (size_t)tangents_of(config);
  if (rows == 0) return STATUS_OK;
  tpn->xt = memory_zeroed(rows * SIZE, sizeof(float));
  tpn->yt = memory_zeroed(rows * 2, sizeof(float)), tpn->gyt = memory_zeroed(rows * 2, sizeof(float));
  tpn->rate = memory_zeroed(rows, sizeof(float));
  return tpn->xt && tpn->yt && tpn->gyt && tpn->rate ? STATUS_OK : status_no_memory("a batch's tangents");
}

static void measure_range(const Samples *samples, const AppTrainingConfig *config, int count,
                          OverlapRangeMeasures *measures, double *overlaps, double *values,
                          OverlapRange *range) {
  double pair[SIZE], output_scale = config->model.output_scale;
  if (samples->width == HALF)
    memcpy(pair, overlap_tpn_normalise_first(normalisation_of(config)), HALF * sizeof *pair);
  for (int i = 0; i < count; i++) {
    ptrdiff_t at = (ptrdiff_t)i * samples->count / count; // evenly from all of them
    for (int c = 0; c < samples->width; c++)
      pair[SIZE - samples->width + c] = (double)samples->x[at * samples->width + c];
    measures[i] = overlap_range_measure(pair);
    overlaps[i] = (double)samples->target[at] / (output_scale * (double)samples->factor[at]);
  }
  *range = overlap_range_of(count, measures, overlaps, values);
}

static Status find_range(const Samples *samples, const AppTrainingConfig *config, OverlapRange *range) {
  int count = samples->count < MEASURED ? samples->count : MEASURED;
  OverlapRangeMeasures *measures = memory_zeroed((size_t)count, sizeof *measures);
  double *overlaps = memory_zeroed((size_t)count, sizeof *overlaps);
  double *values = memory_zeroed((size_t)count, sizeof *values);
  bool fits = measures && overlaps && values;
  if (fits) measure_range(samples, config, count, measures, overlaps, values, range);
  memory_free(measures), memory_free(overlaps), memory_free(values);
  return fits ? STATUS_OK : status_no_memory("the range of the training's pairs");
}

Status app_training_tpn_range(const AppTrainingConfig *config, OverlapRange *range) {
  Samples samples = {0};
  Status status = load(&samples, config, config->training, config->training_count);
  if (!status && samples.count == 0) status = status_fail(STATUS_INPUT, "there is no pair to train on");
  if (!status) status = find_range(&samples, config, range);
  samples_destroy(&samples);
  return status;
}

static Status create(AppTrainingTask *task, const NetWhitening *whitening) {
  (void)whitening;
  Tpn *tpn = task->self = memory_zeroed(1, sizeof *tpn);
  if (!tpn) return status_no_memory("a training");
  TRY(load(&tpn->training, task->config, task->config->training, task->config->training_count));
  if (tpn->training.count == 0) return status_fail(STATUS_INPUT, "there is no pair to train on");
  TRY(find_range(&tpn->training, task->config, &tpn->range));
  TRY(load_sets(tpn, task->config));
  TRY(app_training_order_create(&tpn->order, tpn->training.count));
  snprintf(task->summary, sizeof task->summary,
           tpn->training.left_out ? "%d pairs to train on; %d left out: too flat to be normalised"
                                  : "%d pairs to train on",
           tpn->training.count, tpn->training.left_out);
  TRY(create_tangents(tpn, task->config));
  return create_batch(tpn, task->config);
}

static void gather(Tpn *tpn, const int *samples, int count) {
  const Samples *from = &tpn->training;
  for (int k = 0; k < count; k++) {
    int at = samples[k];
    memcpy(tpn->x + (ptrdiff_t)k * from->width, from->x + (ptrdiff_t)at * from->width,
           (size_t)from->width * sizeof(float));
    tpn->factor[k] = from->factor[at];
    tpn->label[k] = from->label[at];
    tpn->target[k] = from->target[at];
  }
}

// ReLU gives a volume below 0 no derivative. Of a pair that shares volume it gets the one from the right:
// else a network whose volumes have all fallen below 0 stays there.
static void lift_clamped(const Tpn *tpn, int batch, double rmsle) {
  for (int k = 0; k < batch; k++) {
    if (tpn->y[2 * k + 1] > 0 || !(tpn->target[k] > 0) || !(rmsle > 0)) continue;
    tpn->gy[2 * k + 1] = (float)(-0.5 * log1p((double)tpn->target[k]) / (batch * rmsle));
  }
}

// Movements of the batch's pairs, each from a stream of its own.
static void draw_tangents(Tpn *tpn, const AppTrainingConfig *config, const Samples *from, const int *samples,
                          int first, int count, uint64_t stream) {
  int tangents = tangents_of(config);
  for (int k = 0; k < count; k++) {
    NetRandom random = net_random_seeded((uint64_t)config->seed, 2 * (stream + (uint64_t)k) + 1);
    for (ptrdiff_t t = (ptrdiff_t)k * tangents; t < (ptrdiff_t)(k + 1) * tangents; t++)
      tpn->rate[t] = app_training_rates_draw(&from->rates, samples ? samples[k] : first + k, &random,
                                             tpn->xt + t * SIZE);
  }
}

// weight · mean of Huber(v̇ − rate) over the batch's pairs that share volume, with its derivatives.
static double sobolev_of(Tpn *tpn, const AppTrainingConfig *config, int batch) {
  int tangents = tangents_of(config);
  double sum = 0, weight = config->loss.sobolev / (batch * tangents);
  memset(tpn->gyt, 0, (size_t)batch * (size_t)tangents * 2 * sizeof(float));
  for (ptrdiff_t t = 0; t < (ptrdiff_t)batch * tangents; t++) {
    if (!(tpn->target[t / tangents] > 0)) continue;
    double derivative, error = (double)tpn->yt[2 * t + 1] - (double)tpn->rate[t];
    sum += weight * net_loss_huber(error, config->loss.huber, &derivative);
    tpn->gyt[2 * t + 1] = (float)(weight * derivative);
  }
  return sum;
}

static double step(AppTrainingTask *task, const NetModel_f32 *model, NetWork_f32 *work, long long number,
                   float *gradient) {
  Tpn *tpn = task->self;
  int batch = task->config->optimiser.batch, tangents = tangents_of(task->config);
  app_training_order_take(&tpn->order, task->config->seed, number, batch, tpn->samples);
  gather(tpn, tpn->samples, batch);
  if (tangents)
    draw_tangents(tpn, task->config, &tpn->training, tpn->samples, 0, batch,
                  (uint64_t)number * (uint64_t)batch);
  net_gradient_forward_f32(work, model, batch, tangents, tpn->x, tpn->xt, tpn->y, tpn->yt);
  for (int k = 0; k < batch; k++) tpn->y[2 * k + 1] *= tpn->factor[k];
  NetLossPaper loss = net_loss_paper_f32(batch, tpn->y, tpn->label, tpn->target, tpn->gy);
  lift_clamped(tpn, batch, loss.rmsle);
  for (int k = 0; k < batch; k++) tpn->gy[2 * k + 1] *= tpn->factor[k];
  double sobolev = tangents ? sobolev_of(tpn, task->config, batch) : 0;
  net_gradient_backward_f32(work, model, batch, tangents, tpn->gy, tpn->gyt, gradient);
  return loss.total + sobolev;
}

// Sums over a validation set.
typedef struct Sums {
  double loss; // Σ over batches of loss · samples
  long long right[DATAGEN_KIND_COUNT], count[DATAGEN_KIND_COUNT];
  double error; // Σ |ΔV| of pairs that share volume
  long long inside;
  double rate_error, rate; // Σ |v̇ − rate| and Σ |rate|, both times ‖r‖ + soft, over such pairs
} Sums;

static void add_batch(Sums *sums, const Tpn *tpn, const Samples *set, int first, int count, double scale) {
  for (int k = 0; k < count; k++) {
    int kind = set->kind[first + k];
    sums->count[kind]++;
    sums->right[kind] += (tpn->y[2 * k] > 0) == (set->label[first + k] > 0.5f);
    if (!(set->target[first + k] > 0)) continue;
    sums->inside++;
    sums->error += fabs(fmax(0, (double)tpn->y[2 * k + 1]) - (double)set->target[first + k]) / scale;
  }
}

static void add_rates(Sums *sums, Tpn *tpn, const AppTrainingConfig *config, const NetModel_f32 *model,
                      const Samples *set, int first, int count) {
  int tangents = tangents_of(config);
  draw_tangents(tpn, config, set, NULL, first, count, (uint64_t)first);
  net_tangent_eval_f32(&tpn->work, model, count, tangents, set->x + (ptrdiff_t)first * SIZE, tpn->xt, tpn->y,
                       tpn->yt);
  for (ptrdiff_t t = 0; t < (ptrdiff_t)count * tangents; t++) {
    ptrdiff_t at = first + t / tangents;
    double size = (double)set->rates.size[at] + set->rates.soft;
    if (!(set->target[at] > 0)) continue;
    sums->rate_error += size * fabs((double)tpn->yt[2 * t + 1] - (double)tpn->rate[t]);
    sums->rate += size * fabs((double)tpn->rate[t]);
  }
}

static void score(const Sums *sums, const Samples *set, AppTrainingScores *scores) {
  double accuracy = 0, kinds = 0;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++)
    if (sums->count[k]) kinds++, accuracy += (double)sums->right[k] / (double)sums->count[k];
  app_training_scores_add(scores, set->name, "loss", sums->loss / set->count);
  app_training_scores_add(scores, set->name, "inaccuracy", 1 - accuracy / kinds);
  app_training_scores_add(scores, set->name, "mae", sums->inside ? sums->error / (double)sums->inside : NAN);
  scores->score += sums->loss / set->count;
  if (!(sums->rate > 0)) return;
  app_training_scores_add(scores, set->name, "rate_error", sums->rate_error / sums->rate);
  scores->score += sums->rate_error / sums->rate;
}

static void measure(Tpn *tpn, const AppTrainingConfig *config, const NetModel_f32 *model, const Samples *set,
                    AppTrainingScores *scores) {
  Sums sums = {0};
  int batch = config->optimiser.batch;
  for (int first = 0; first < set->count; first += batch) {
    int count = set->count - first < batch ? set->count - first : batch;
    net_forward_eval_f32(&tpn->work, model, count, set->x + (ptrdiff_t)first * set->width, tpn->y);
    for (int k = 0; k < count; k++) tpn->y[2 * k + 1] *= set->factor[first + k];
    sums.loss +=
        count * net_loss_paper_f32(count, tpn->y, set->label + first, set->target + first, tpn->gy).total;
    add_batch(&sums, tpn, set, first, count, config->loss.volume_scale);
    if (learns_gradients(config)) add_rates(&sums, tpn, config, model, set, first, count);
  }
  score(&sums, set, scores);
}

static Status validate(AppTrainingTask *task, const NetModel_f32 *model, const char *path,
                       AppTrainingScores *scores) {
  Tpn *tpn = task->self;
  (void)path;
  if (!tpn->work.plan) {
    NetWorkDef def = net_work_default();
    def.tangent_count = tangents_of(task->config);
    TRY(app_training_task_fail(net_work_create_f32(model->plan, &def, &tpn->work)));
  }
  for (int s = 0; s < tpn->set_count; s++)
    if (tpn->sets[s].count > 0) measure(tpn, task->config, model, &tpn->sets[s], scores);
  return STATUS_OK;
}

static void print_normalisation(const AppTrainingTask *task, char text[OVERLAP_TPN_NORMALISATION_TEXT]) {
  overlap_tpn_network_print(normalisation_of(task->config), task->config->model.output_scale, text);
}

static Status start(AppTrainingTask *task, NetModel_f32 *model) {
  char normalisation[OVERLAP_TPN_NORMALISATION_TEXT];
  print_normalisation(task, normalisation);
  return app_training_start_read(task->config->start, normalisation, NULL, NULL, model);
}

static Status write(const AppTrainingTask *task, const NetModel_f32 *model, const char *provenance,
                    const char *path) {
  const Tpn *tpn = task->self;
  char range[OVERLAP_RANGE_TEXT], normalisation[OVERLAP_TPN_NORMALISATION_TEXT], *story;
  overlap_range_print(&tpn->range, range);
  print_normalisation(task, normalisation);
  story = memory_copy(provenance, strlen(provenance) + 1, 1);
  if (!story) return status_no_memory("the weights' provenance");
  NetCard card = {.normalisation = normalisation, .range = range, .provenance = story};
  Status status = app_training_task_fail(net_weights_write_f32(path, model, &card));
  memory_free(story);
  return status;
}

const AppTrainingTaskOps app_training_tpn = {
    .shape = shape,
    .create = create,
    .start = start,
    .tangents = tangents_of,
    .step = step,
    .validate = validate,
    .write = write,
    .destroy = destroy,
};
