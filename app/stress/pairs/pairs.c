// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/pairs/pairs.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "app/evaluation/model.h"
#include "app/stress/pairs/tolerances.h"
#include "app/stress/pairs/traits.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/text.h"
#include "datagen/hard.h"
#include "overlap/exact/exact.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"
#include "overlap/source.h"

enum { MEMBERS = 100, MEMBERS_QUICK = 10, MEMBERS_SLOW = 3 };
static const double SLOW_PAIR = 1e-3; // seconds
static const char NOT_A_NUMBER[] = "not a number";

// What double precision must hold. Volumes count in overlap_invariant_allowed, besides what rounding of the
// coordinates changes.
static const double WORTH_NOTING = 1e-9; // of the smaller tetrahedron: an overlap that is not to be missed
static const double BOUNDS = 4e-16, BALANCE = 1e-14, GRADIENT = 1e-7;

typedef struct Asked {
  const OverlapModel *model;
  bool has_gradient; // else V alone is graded
  AppStressPairErrors worst;
  double misfit; // worst volume-like error over what the standard allows
  long long member_count, true_count, wrong_flags;
  long long overlap_count, missed; // pairs that share a volume, and of those the ones said to share none
  long long fallbacks;             // answers that the model left to another
} Asked;

typedef struct Answer {
  double volume, gradient[24]; // 0 where the model gives none
  unsigned flags;
} Answer;

static Status eval_measured(const Asked *asked, const double x[24], Answer *answer) {
  OverlapBatch batch = {.pair_count = 1,
                        .pairs = x,
                        .volume = &answer->volume,
                        .gradient = asked->has_gradient ? answer->gradient : NULL,
                        .flags = &answer->flags};
  return overlap_model_eval(asked->model, &batch);
}

static Status ask_volume(const Asked *asked, const double x[24], double *volume) {
  OverlapBatch batch = {.pair_count = 1, .pairs = x, .volume = volume};
  return overlap_model_eval(asked->model, &batch);
}

// NaN is worse than anything.
static void keep_worst(double *worst, double value) {
  if (!(value <= *worst)) *worst = value;
}

// A volume that should be `wanted` but for `slack`.
static void compare(Asked *asked, double *worst, const double x[24], double volume, double wanted,
                    double allowances, double slack) {
  double error = fmax(0, fabs(volume - wanted) - slack), smaller = overlap_invariant_smaller_volume(x);
  if (isnan(volume)) error = NAN;
  if (error == 0) return;
  keep_worst(worst, error / smaller);
  keep_worst(&asked->misfit, error / (allowances * overlap_invariant_allowed(x, wanted)));
}

static Status compare_orders(Asked *asked, const double x[24], double volume, int step) {
  double swapped[24], permuted[24], other;
  overlap_ops_swap(x, swapped);
  TRY(ask_volume(asked, swapped, &other));
  compare(asked, &asked->worst.order, x, other, volume, 2, 0);
  for (int k = 1; k < 24; k += step) {
    datagen_hard_permute(x, k, permuted);
    datagen_hard_permute(x + 12, (5 * k + 3) % 24, permuted + 12);
    TRY(ask_volume(asked, permuted, &other));
    compare(asked, &asked->worst.order, x, other, volume, 2, 0);
  }
  return STATUS_OK;
}

// The largest coordinate times the extent squared: what rounding of coordinates may change, over ε.
static double rounding_scale(const double x[24]) {
  double largest = 0, extent = overlap_invariant_extent(x);
  for (int i = 0; i < 24; i++) largest = fmax(largest, fabs(x[i]));
  return largest * extent * extent;
}

static Status compare_motions(Asked *asked, const double x[24], double volume) {
  double moved[24], rotation[9], extent = overlap_invariant_extent(x), other;
  Random random = random_seeded(77, 0);
  random_rotation(&random, rotation);
  memcpy(moved, x, sizeof moved);
  datagen_hard_transform(moved, 8, rotation, 1, (Vec3){extent, -2 * extent, extent});
  TRY(ask_volume(asked, moved, &other));
  compare(asked, &asked->worst.motion, x, other, volume, 1,
          8 * DBL_EPSILON * (rounding_scale(x) + rounding_scale(moved)));
  for (int i = 0; i < 24; i++) moved[i] = 0x1p20 * x[i];
  TRY(ask_volume(asked, moved, &other));
  compare(asked, &asked->worst.motion, x, 0x1p-60 * other, volume, 1, 0);
  return STATUS_OK;
}

static Status compare_parts(Asked *asked, const DatagenHardPair *pair, double volume) {
  const double weights[4] = {0.125, 0.25, 0.25, 0.375};
  double parts[4][12], whole = overlap_invariant_tet_volume(pair->x + 12), sum = 0, slack = 1e-14 * volume;
  datagen_hard_subdivide(pair->x + 12, weights, parts);
  for (int k = 0; k < 4; k++) sum += overlap_invariant_tet_volume(parts[k]);
  if (!(fabs(sum - whole) <= 1e-13 * whole) || pair->is_flat) return STATUS_OK; // rounded out of a sliver
  sum = 0;
  for (int k = 0; k < 4; k++) {
    double x[24], part;
    memcpy(x, pair->x, 12 * sizeof *x), memcpy(x + 12, parts[k], 12 * sizeof *x);
    TRY(ask_volume(asked, x, &part));
    sum += part;
    slack += overlap_invariant_allowed(x, part);
  }
  compare(asked, &asked->worst.parts, pair->x, sum, volume, 1, slack);
  return STATUS_OK;
}

static Status compare_differences(Asked *asked, const DatagenHardPair *pair, const double gradient[24],
                                  int step) {
  double extent = overlap_invariant_extent(pair->x), h = 1e-6 * extent;
  for (int i = 0; i < 24 && pair->is_smooth; i += step) {
    double up[24], down[24], high, low;
    memcpy(up, pair->x, sizeof up), memcpy(down, pair->x, sizeof down);
    up[i] += h, down[i] -= h;
    TRY(ask_volume(asked, up, &high));
    TRY(ask_volume(asked, down, &low));
    double error = fabs((high - low) / (up[i] - down[i]) - gradient[i]) / (extent * extent);
    keep_worst(&asked->worst.gradient, error);
  }
  return STATUS_OK;
}

// The pull-back of a coordinate of x̄ against central differences; a pair that shares less than a thousandth
// has an x̄ that rounding moves.
static Status compare_pull(Asked *asked, const DatagenHardPair *pair, double volume, int step) {
  const OverlapOps *ops = asked->model->ops;
  if (!ops->eval_pull || !overlap_model_has_own_centroid(asked->model) || !pair->is_smooth ||
      !(volume > 1e-3 * overlap_invariant_smaller_volume(pair->x)))
    return STATUS_OK;
  const double none = 0, along[3] = {2.0 / 3, -1.0 / 3, 2.0 / 3},
               h = 1e-6 * overlap_invariant_extent(pair->x);
  double slope[24];
  TRY(ops->eval_pull(
      asked->model->self,
      &(OverlapPull){
          .pair_count = 1, .pairs = pair->x, .by_volume = &none, .by_centroid = along, .slope = slope}));
  for (int i = 0; i < 24; i += step) {
    double sides[2][24], volumes[2], centroids[2][3], change = 0;
    memcpy(sides[0], pair->x, sizeof sides[0]), memcpy(sides[1], pair->x, sizeof sides[1]);
    sides[0][i] -= h, sides[1][i] += h;
    TRY(overlap_model_eval(
        asked->model,
        &(OverlapBatch){.pair_count = 2, .pairs = sides[0], .volume = volumes, .centroid = centroids[0]}));
    for (int c = 0; c < 3; c++) change += along[c] * (centroids[1][c] - centroids[0][c]);
    keep_worst(&asked->worst.gradient, fabs(change / (sides[1][i] - sides[0][i]) - slope[i]));
  }
  return STATUS_OK;
}

static bool flags_are_right(const DatagenHardPair *pair, const Answer *answer) {
  bool is_flat = (answer->flags & OVERLAP_FLAT) != 0;
  bool is_nothing = is_flat || (answer->flags & OVERLAP_DISJOINT);
  if (is_flat != pair->is_flat || is_nothing != (answer->volume == 0)) return false;
  for (int i = 0; i < 24 && is_nothing; i++)
    if (answer->gradient[i] != 0) return false;
  return true;
}

static void measure_balance(Asked *asked, const double x[24], const Answer *answer) {
  keep_worst(&asked->worst.balance, overlap_invariant_translation(x, answer->gradient));
  keep_worst(&asked->worst.balance, overlap_invariant_rotation(x, answer->gradient));
  keep_worst(&asked->worst.balance, overlap_invariant_scaling(x, answer->volume, answer->gradient));
}

static Status ask_member(Asked *asked, const DatagenHardPair *pair, bool is_slow) {
  Answer answer = {0};
  double exact;
  unsigned flags;
  const double *x = pair->x;
  TRY(eval_measured(asked, x, &answer));
  TRY(overlap_exact_ops.eval_pair(NULL, x, &(OverlapAnswer){.volume = &exact, .flags = &flags}));
  asked->member_count++;
  asked->fallbacks += (answer.flags & OVERLAP_FALLBACK) != 0;
  asked->wrong_flags += !flags_are_right(pair, &answer);
  bool overlaps = !pair->is_flat && exact > WORTH_NOTING * overlap_invariant_smaller_volume(x);
  asked->overlap_count += overlaps;
  asked->missed += overlaps && answer.volume == 0;
  if (!pair->is_flat) {
    compare(asked, &asked->worst.volume, x, answer.volume, exact, 1, 0);
    if (!isnan(pair->volume))
      compare(asked, &asked->worst.volume, x, answer.volume, pair->volume, 1, pair->slack);
  }
  if (!pair->is_flat) keep_worst(&asked->worst.bounds, overlap_invariant_bounds(x, answer.volume));
  if (asked->has_gradient) measure_balance(asked, x, &answer);
  if (pair->is_flat) return STATUS_OK;
  TRY(compare_orders(asked, x, answer.volume, is_slow ? 11 : 1));
  TRY(compare_motions(asked, x, answer.volume));
  TRY(compare_parts(asked, pair, answer.volume));
  TRY(compare_pull(asked, pair, answer.volume, is_slow ? 7 : 1));
  return asked->has_gradient ? compare_differences(asked, pair, answer.gradient, is_slow ? 7 : 1) : STATUS_OK;
}

// What double precision must hold; the volumes themselves are reported beside that.
static void ask_standard(const Asked *asked, AppStressRow *row) {
  const AppStressPairErrors *worst = &asked->worst;
  app_stress_ask_most(row, "misfit", asked->misfit, 1);
  app_stress_ask_most(row, "volume", worst->volume, worst->volume);
  app_stress_ask_most(row, "bounds", worst->bounds, BOUNDS);
  if (asked->has_gradient) app_stress_ask_most(row, "balance", worst->balance, BALANCE);
  if (asked->has_gradient) app_stress_ask_most(row, "gradient", worst->gradient, GRADIENT);
  app_stress_ask_most(row, "flags", worst->flags, 0);
  app_stress_ask_most(row, "missed", worst->missed, 0);
}

// Of a model of which nothing is promised: how much it changes where it should not.
static void tell_changes(const Asked *asked, AppStressRow *row) {
  const AppStressPairErrors *worst = &asked->worst;
  app_stress_ask_most(row, "order", worst->order, worst->order);
  app_stress_ask_most(row, "motion", worst->motion, worst->motion);
}

static void ask_tolerance(const Asked *asked, const AppStressPairErrors *most, AppStressRow *row) {
  const AppStressPairErrors *worst = &asked->worst;
  app_stress_ask_most(row, "volume", worst->volume, most->volume);
  app_stress_ask_most(row, "bounds", worst->bounds, most->bounds);
  app_stress_ask_most(row, "balance", worst->balance, most->balance);
  app_stress_ask_most(row, "order", worst->order, most->order);
  app_stress_ask_most(row, "motion", worst->motion, most->motion);
  app_stress_ask_most(row, "parts", worst->parts, most->parts);
  app_stress_ask_most(row, "gradient", worst->gradient, most->gradient);
  app_stress_ask_most(row, "flags", worst->flags, most->flags);
  app_stress_ask_most(row, "missed", worst->missed, most->missed);
}

// The verdict: held by the standard, else by the tolerance of the model, a weights file's of its kind.
static void judge_class(const Asked *asked, AppStressRow *row) {
  const AppStressPairErrors *worst = &asked->worst;
  const AppStressTolerance *own = app_stress_tolerances_find(asked->model->ops->name);
  bool is_held = asked->misfit <= 1 && worst->bounds <= BOUNDS && worst->balance <= BALANCE &&
                 worst->gradient <= GRADIENT && worst->flags == 0 && worst->missed == 0;
  app_stress_ask_occurred(row, "members that are what the class says", (double)asked->true_count,
                          (double)asked->member_count);
  row->pairs = asked->member_count, row->fallbacks = asked->fallbacks;
  if (is_held || !own)
    ask_standard(asked, row);
  else
    ask_tolerance(asked, &own->most, row);
  if (!is_held && !own) tell_changes(asked, row);
  app_stress_judge(row);
  if (is_held || row->outcome != APP_STRESS_HELD) return;
  row->outcome = APP_STRESS_TOLERANCE;
  char missed[32] = "";
  if (worst->missed > 0) snprintf(missed, sizeof missed, ", missed %.0f %%", 100 * worst->missed);
  snprintf(row->remark, sizeof row->remark, "V to %.1e, order %.1e, motion %.1e, dV/dx %.1e%s; %s",
           worst->volume, worst->order, worst->motion, worst->gradient, missed, own->reason);
  row->counter = own->counter;
}

static int members_of(const AppStressOptions *options, const OverlapModel *model) {
  if (model->ops->seconds_per_pair > SLOW_PAIR) return MEMBERS_SLOW;
  return options->is_quick ? MEMBERS_QUICK : MEMBERS;
}

static Status run_class(const AppStressOptions *options, const OverlapModel *model, int class_index,
                        AppStressRow *row) {
  Asked asked = {.model = model, .has_gradient = overlap_model_has_gradient(model)};
  double began = clock_cpu_s();
  int members = members_of(options, model);
  for (int member = 0; member < members; member++) {
    DatagenHardPair pair = datagen_hard_make(class_index, member);
    if (pair.failure)
      return status_fail(STATUS_MEMORY, "%s: %s", datagen_hard_classes[class_index].name, pair.failure);
    asked.true_count += app_stress_traits_hold(class_index, &pair);
    Status status = ask_member(&asked, &pair, members == MEMBERS_SLOW);
    if (status == STATUS_MEMORY) return status;
    if (status) {
      snprintf(row->remark, sizeof row->remark, "member %d: %s", member, status_message());
      row->outcome = APP_STRESS_FAILED;
      return STATUS_OK;
    }
  }
  asked.worst.flags = (double)asked.wrong_flags / (double)asked.member_count;
  asked.worst.missed = asked.overlap_count ? (double)asked.missed / (double)asked.overlap_count : 0;
  row->cpu_s = clock_cpu_s() - began;
  judge_class(&asked, row);
  return STATUS_OK;
}

// NaN and infinity in every coordinate of one of three pairs: an error that names the pair.
static void run_not_numbers(const OverlapModel *model, AppStressRow *row) {
  const double bad[3] = {NAN, INFINITY, -INFINITY};
  double x[72], volume[3], refused = 0, named = 0;
  for (int k = 0; k < 3; k++) memcpy(x + 24 * k, datagen_hard_make(2, k).x, 24 * sizeof *x);
  OverlapBatch batch = {.pair_count = 3, .pairs = x, .volume = volume};
  for (int kind = 0; kind < 3; kind++)
    for (int i = 24; i < 48; i++) {
      double good = x[i];
      x[i] = bad[kind];
      refused += overlap_model_eval(model, &batch) == STATUS_INPUT;
      named += strstr(status_message(), "pair 1") != NULL;
      x[i] = good;
    }
  app_stress_ask_occurred(row, "asked", 72, 72);
  app_stress_ask_least(row, "refused", refused, 72);
  app_stress_ask_least(row, "named", named, 72);
  app_stress_judge(row);
}

static Status run_case(const AppStressOptions *options, AppStress *stress, const char *model_name,
                       const OverlapModel *model, int class_index) {
  bool is_class = class_index < DATAGEN_HARD_CLASS_COUNT;
  const char *name = is_class ? datagen_hard_classes[class_index].name : NOT_A_NUMBER;
  if (!app_stress_wants(options, name)) return STATUS_OK;
  if (options->stop && *options->stop) return status_fail(STATUS_INTERRUPTED, "interrupted");
  AppStressRow *row = app_stress_add(stress, "pairs", name, model_name);
  if (!row) return status_no_memory("the table of hard cases");
  if (!model)
    app_stress_excuse(row, "%s", status_message());
  else if (is_class)
    TRY(run_class(options, model, class_index, row));
  else
    run_not_numbers(model, row);
  if (options->observe) options->observe(options->observer, stress);
  return STATUS_OK;
}

// A model of the program whose weights are not there is absent; a weights file is asked for, and an error.
static Status run_model(const AppStressOptions *options, AppStress *stress, const char *source,
                        const char *name) {
  OverlapModel model;
  Status created = app_evaluation_model_open(&model, source), status = STATUS_OK;
  if (created && (created != STATUS_IO || source != name)) return created;
  for (int c = 0; c <= DATAGEN_HARD_CLASS_COUNT && !status; c++)
    status = run_case(options, stress, name, created ? NULL : &model, c);
  overlap_model_destroy(&model);
  return status;
}

static Status run_sources(const AppStressOptions *options, AppStress *stress, char *models) {
  const char *sources[APP_STRESS_MAX_MODELS];
  char path[PATH_MAX];
  int words = text_split(models, sources, APP_STRESS_MAX_MODELS), count = 0;
  for (int w = 0; w < words; w++)
    if (app_model_names_locate(sources[w], path) || overlap_source_is_foreign(sources[w]))
      sources[count++] = sources[w];
  stress->names = memory_zeroed((size_t)count + 1, sizeof *stress->names);
  if (!stress->names) return status_no_memory("the models");
  TRY(app_model_names_find(count, sources, stress->names));
  for (int f = 0; f < count; f++) TRY(run_model(options, stress, sources[f], stress->names[f]));
  return STATUS_OK;
}

Status app_stress_pairs_run(const AppStressOptions *options, AppStress *stress) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++) {
    const char *name = models[m]->name;
    if (app_stress_wants_model(options, name)) TRY(run_model(options, stress, name, name));
  }
  if (!options->models) return STATUS_OK;
  char *words = memory_copy(options->models, strlen(options->models) + 1, 1);
  Status status = words ? run_sources(options, stress, words) : status_no_memory("the models");
  memory_free(words);
  return status;
}
