// SPDX-License-Identifier: GPL-3.0-or-later
// What every overlap model must obey, on every class of pairs (datagen/hard.h). The volume's oracle is
// `exact`, whose own oracles are cases with a known volume and `cgal`.
#include "suite.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "datagen/hard.h"
#include "overlap/exact/exact.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"
#include "overlap/separation.h"

// What a model may lack. Networks that follow the paper see vertices in an order, know volumes roughly and
// compute in float32.
enum {
  LACKS_ACCURACY = 1 << 0, // V near the true one: of pairs, of parts
  LACKS_ORDER = 1 << 1,    // indifference to the order of vertices and tetrahedra
  LACKS_DIGITS = 1 << 2,   // differences of V, V after a motion to many digits
  LACKS_STATUS = 1 << 3,   // knowing which pairs are flat, disjoint, enclosed
  LACKS_BOUND = 1 << 4,    // V below the smaller tetrahedron
  LACKS_ALL_BUT_BALANCE = LACKS_ACCURACY | LACKS_ORDER | LACKS_DIGITS,
};

// What is asked of a model. Volumes in units of overlap_invariant_allowed, the rest relative to powers of the
// pair's extent.
typedef struct Demand {
  const char *name;
  int members;              // of each class; fewer where a pair takes milliseconds
  double misfit;            // of V against exact, and of V against itself in another order or place
  double learned;           // share of V that a learned model may be off besides, as measured; 0: none
  double invariant;         // Σ∇V, Σ x×∇V, Σ x·∇V − 3V
  double gradient, hessian; // against central differences
  unsigned lacks;
  double rounding[2]; // share of V and of the smaller volume that rounding may take besides
  double step;        // of central differences, relative to the extent; 0: 1e-6
} Demand;

static const Demand demands[] = {
    {"clip", 100, 1, 0, 1e-14, 1e-7, 1e-5, 0, {0, 0}, 0},
    {"clip32", 100, 1, 0, 2e-6, 2e-2, 0, 0, {1e-3, 1e-4}, 1e-2}, // its ∇V against exact: test_clip_lanes.c
    {"clip-scalar", 100, 1, 0, 1e-14, 1e-7, 1e-5, 0, {0, 0}, 0},
    {"geo-small", 100, 1, 0.25, 1e-12, 1e-6, 1e-4, 0, {0, 0}, 0},
    {"geo", 100, 1, 0.2, 1e-12, 1e-6, 1e-4, 0, {0, 0}, 0},
    {"tpn", 100, 1, 0, 1e-7, 0, 0, LACKS_ALL_BUT_BALANCE | LACKS_STATUS | LACKS_BOUND, {0, 0}, 0},
    {"tpn-bf16", 100, 1, 0, 1e-7, 0, 0, LACKS_ALL_BUT_BALANCE | LACKS_STATUS | LACKS_BOUND, {0, 0}, 0},
    {"tpn-published", 100, 1, 0, 1e-7, 0, 0, LACKS_ALL_BUT_BALANCE | LACKS_STATUS | LACKS_BOUND, {0, 0}, 0},
    {"tpn-scene", 100, 1, 0, 1e-7, 0, 0, LACKS_ALL_BUT_BALANCE, {0, 0}, 0},
    {"hybrid", 100, 1, 0.25, 5e-12, 1e-6, 1e-4, 0, {0, 0}, 0},
    {"exact", 100, 1e-6, 0, 1e-14, 1e-7, 0, 0, {0, 0}, 0},
    {"cgal", 3, 1e-5, 0, 1e-14, 1e-7, 0, 0, {0, 0}, 0},
};

static double step_of(const Demand *demand) {
  return demand->step > 0 ? demand->step : 1e-6;
}

static const OverlapOps *model_at(int index) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  ck_assert_int_lt(index, count);
  return models[index];
}

static const Demand *demand_of(const char *name) {
  for (size_t d = 0; d < sizeof demands / sizeof *demands; d++)
    if (strcmp(demands[d].name, name) == 0) return &demands[d];
  ck_abort_msg("the overlap model '%s' has no row in the table of demands", name);
}

typedef struct Answer {
  double volume, gradient[24];
  unsigned flags;
} Answer;

static Answer ask(const OverlapModel *model, const double x[24]) {
  Answer answer;
  OverlapBatch batch = {.pair_count = 1,
                        .pairs = x,
                        .volume = &answer.volume,
                        .gradient = answer.gradient,
                        .flags = &answer.flags};
  ck_assert_ok(overlap_model_eval(model, &batch));
  return answer;
}

static double ask_volume(const OverlapModel *model, const double x[24]) {
  double volume;
  OverlapBatch batch = {.pair_count = 1, .pairs = x, .volume = &volume};
  ck_assert_ok(overlap_model_eval(model, &batch));
  return volume;
}

static double exact_volume(const double x[24]) {
  double volume;
  unsigned flags;
  ck_assert_ok(overlap_exact_ops.eval_pair(NULL, x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  return volume;
}

static OverlapModel open_model(int index) {
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, model_at(index)->name));
  return model;
}

static const char *name_of(unsigned asked) {
  return asked & LACKS_ACCURACY ? "volumes near the true ones"
         : asked & LACKS_ORDER  ? "indifference to the order of vertices"
         : asked & LACKS_DIGITS ? "differences of V to many digits"
         : asked & LACKS_STATUS ? "which pairs are flat, disjoint or enclosed"
                                : "V below the smaller tetrahedron";
}

// Calls `check` for every member of every class, unless the model lacks what it asks for.
static void for_each_pair(int model_index, unsigned asked,
                          void (*check)(const OverlapModel *model, const Demand *demand,
                                        const DatagenHardPair *pair, const char *where)) {
  const Demand *demand = demand_of(model_at(model_index)->name);
  if (demand->lacks & asked) {
    suite_skip("%s does not promise %s", demand->name, name_of(asked));
    return;
  }
  OverlapModel model = open_model(model_index);
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < demand->members; member++) {
      char where[96];
      snprintf(where, sizeof where, "%s: %s, member %d", demand->name, datagen_hard_classes[c].name, member);
      DatagenHardPair pair = datagen_hard_make(c, member);
      check(&model, demand, &pair, where);
    }
  overlap_model_destroy(&model);
}

#define ck_assert_at_most(what, value, bound)                                                                \
  do {                                                                                                       \
    double ck_value_ = (value), ck_bound_ = (bound);                                                         \
    ck_assert_msg(ck_value_ <= ck_bound_, "%s: %s = %.3g > %.3g", what, #value, ck_value_, ck_bound_);       \
  } while (0)

// How far V may differ from that of the same pair in another order or place [m³].
static double difference_allowed(const Demand *demand, const double x[24], double volume) {
  return demand->misfit * overlap_invariant_allowed(x, volume) + demand->rounding[0] * volume +
         demand->rounding[1] * overlap_invariant_smaller_volume(x);
}

// How far V may be off where it should be `volume` [m³].
static double error_allowed(const Demand *demand, const double x[24], double volume) {
  return difference_allowed(demand, x, volume) + demand->learned * volume;
}

static void check_volume(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                         const char *where) {
  Answer answer = ask(model, pair->x);
  double reference = exact_volume(pair->x);
  ck_assert_at_most(where, fabs(answer.volume - reference), error_allowed(demand, pair->x, reference));
  if (!isnan(pair->volume))
    ck_assert_at_most(where, fabs(answer.volume - pair->volume),
                      pair->slack + error_allowed(demand, pair->x, pair->volume));
}

START_TEST(volumes_are_right_in_every_class) {
  for_each_pair(_i, LACKS_ACCURACY, check_volume);
}
END_TEST

static void check_flags(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                        const char *where) {
  (void)demand;
  Answer answer = ask(model, pair->x);
  bool is_flat = (answer.flags & OVERLAP_FLAT) != 0;
  bool is_nothing = is_flat || (answer.flags & OVERLAP_DISJOINT);
  ck_assert_msg(is_flat == pair->is_flat, "%s: FLAT is %d", where, is_flat);
  ck_assert_msg(is_nothing == (answer.volume == 0), "%s: flags %u with V = %g", where, answer.flags,
                answer.volume);
  bool has_gradient = false;
  for (int i = 0; i < 24; i++) has_gradient = has_gradient || answer.gradient[i] != 0;
  ck_assert_msg(!is_nothing || !has_gradient, "%s: no common interior and a gradient", where);
}

START_TEST(flags_say_what_the_numbers_are) {
  for_each_pair(_i, LACKS_STATUS, check_flags);
}
END_TEST

static void check_invariants(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                             const char *where) {
  Answer answer = ask(model, pair->x);
  if (!(demand->lacks & LACKS_BOUND))
    ck_assert_at_most(where, overlap_invariant_bounds(pair->x, answer.volume),
                      4e-16 + demand->learned + demand->rounding[1]);
  else
    ck_assert_msg(answer.volume >= 0, "%s: V = %g", where, answer.volume);
  if (model->ops->lacks_scale) { // no length measures ∇V but its own; only a shift leaves V as it is
    double size = 0, extent = overlap_invariant_extent(pair->x);
    for (int i = 0; i < 24; i++) size += fabs(answer.gradient[i]);
    ck_assert_at_most(where, overlap_invariant_translation(pair->x, answer.gradient) * extent * extent,
                      (demand->invariant + FLT_EPSILON) * size);
    return;
  }
  ck_assert_at_most(where, overlap_invariant_translation(pair->x, answer.gradient), demand->invariant);
  ck_assert_at_most(where, overlap_invariant_rotation(pair->x, answer.gradient), demand->invariant);
  ck_assert_at_most(where, overlap_invariant_scaling(pair->x, answer.volume, answer.gradient),
                    demand->invariant);
}

START_TEST(volumes_are_bounded_and_gradients_balance) {
  if (model_at(_i)->lacks_scale) suite_skip("%s: balance of moments, for V has no scale", model_at(_i)->name);
  for_each_pair(_i, 0, check_invariants);
}
END_TEST

static void check_exchange(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                           const char *where) {
  double volume = ask_volume(model, pair->x), swapped[24], permuted[24];
  overlap_ops_swap(pair->x, swapped);
  double allowed = 2 * difference_allowed(demand, pair->x, volume);
  ck_assert_at_most(where, fabs(ask_volume(model, swapped) - volume), allowed);
  for (int k = 1; k < 24; k += demand->members < 10 ? 11 : 1) {
    datagen_hard_permute(pair->x, k, permuted);
    datagen_hard_permute(pair->x + 12, (5 * k + 3) % 24, permuted + 12);
    ck_assert_at_most(where, fabs(ask_volume(model, permuted) - volume), allowed);
  }
}

START_TEST(nothing_depends_on_the_order_of_tetrahedra_and_vertices) {
  for_each_pair(_i, LACKS_ORDER, check_exchange);
}
END_TEST

// The largest coordinate times the extent squared: what rounding of coordinates may change, over ε.
static double rounding_scale(const double x[24]) {
  double largest = 0, extent = overlap_invariant_extent(x);
  for (int i = 0; i < 24; i++) largest = fmax(largest, fabs(x[i]));
  return largest * extent * extent;
}

static void check_motion(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                         const char *where) {
  double moved[24], volume = ask_volume(model, pair->x), extent = overlap_invariant_extent(pair->x);
  double rotation[9];
  Random random = random_seeded(77, 0);
  random_rotation(&random, rotation);
  memcpy(moved, pair->x, sizeof moved);
  datagen_hard_transform(moved, 8, rotation, 1, (Vec3){extent, -2 * extent, extent});
  double slack = 8 * DBL_EPSILON * (rounding_scale(pair->x) + rounding_scale(moved));
  ck_assert_at_most(where, fabs(ask_volume(model, moved) - volume),
                    slack + difference_allowed(demand, pair->x, volume));
  for (int i = 0; i < 24; i++) moved[i] = 0x1p20 * pair->x[i];
  double scaled = 1e-6 * overlap_invariant_allowed(pair->x, volume);
  if (demand->rounding[0] > 0) scaled = difference_allowed(demand, pair->x, volume);
  ck_assert_at_most(where, fabs(0x1p-60 * ask_volume(model, moved) - volume), scaled);
}

START_TEST(a_rigid_motion_changes_nothing_and_scaling_gives_the_cube) {
  for_each_pair(_i, LACKS_DIGITS, check_motion);
}
END_TEST

static void check_subdivision(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                              const char *where) {
  const double weights[4] = {0.125, 0.25, 0.25, 0.375};
  double parts[4][12], whole = overlap_invariant_tet_volume(pair->x + 12), sum_of_parts = 0;
  datagen_hard_subdivide(pair->x + 12, weights, parts);
  for (int k = 0; k < 4; k++) sum_of_parts += overlap_invariant_tet_volume(parts[k]);
  if (!(fabs(sum_of_parts - whole) <= 1e-13 * whole) || pair->is_flat) return; // rounded out of a sliver
  double volume = ask_volume(model, pair->x), sum = 0, allowed = 1e-14 * volume;
  for (int k = 0; k < 4; k++) {
    double x[24];
    memcpy(x, pair->x, 12 * sizeof *x), memcpy(x + 12, parts[k], 12 * sizeof *x);
    double part = ask_volume(model, x);
    sum += part;
    allowed += error_allowed(demand, x, part);
  }
  ck_assert_at_most(where, fabs(sum - volume), allowed + error_allowed(demand, pair->x, volume));
}

START_TEST(the_parts_of_a_tetrahedron_sum_to_the_whole) {
  for_each_pair(_i, LACKS_ACCURACY, check_subdivision);
}
END_TEST

static void check_gradient(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                           const char *where) {
  if (!pair->is_smooth) return;
  Answer answer = ask(model, pair->x);
  double extent = overlap_invariant_extent(pair->x), h = step_of(demand) * extent;
  for (int i = 0; i < 24; i += demand->members < 10 ? 7 : 1) {
    double up[24], down[24];
    memcpy(up, pair->x, sizeof up), memcpy(down, pair->x, sizeof down);
    up[i] += h, down[i] -= h;
    double difference = (ask_volume(model, up) - ask_volume(model, down)) / (up[i] - down[i]);
    ck_assert_at_most(where, fabs(difference - answer.gradient[i]) / (extent * extent), demand->gradient);
  }
}

START_TEST(the_gradient_is_the_derivative_of_the_volume) {
  for_each_pair(_i, LACKS_DIGITS, check_gradient);
}
END_TEST

static void ask_hessian(const OverlapModel *model, const double x[24], double hessian[576]) {
  double volume;
  OverlapBatch batch = {.pair_count = 1, .pairs = x, .volume = &volume, .hessian = hessian};
  ck_assert_ok(overlap_model_eval(model, &batch));
}

static void check_hessian(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                          const char *where) {
  double extent = overlap_invariant_extent(pair->x), h = step_of(demand) * extent, hessian[576];
  ask_hessian(model, pair->x, hessian);
  double shift = 0; // what translation of both changes
  for (int i = 0; i < 24; i++)
    for (int c = 0; c < 3; c++) {
      double sum = 0, size = 0;
      for (int j = c; j < 24; j += 3) sum += hessian[24 * i + j], size += fabs(hessian[24 * i + j]);
      shift = suite_larger(shift, fabs(sum) / (size + extent));
    }
  ck_assert_at_most(where, shift, 1e-11 + 1e3 * demand->invariant);
  bool is_symmetric = true;
  for (int i = 0; i < 24; i++)
    for (int j = 0; j < i; j++) is_symmetric = is_symmetric && hessian[24 * i + j] == hessian[24 * j + i];
  ck_assert_msg(is_symmetric, "%s: the Hessian's rows differ from its columns", where);
  // what floats let differences show: test_net_overlap.c
  if (!pair->is_smooth || demand->lacks & LACKS_DIGITS) return;
  for (int i = 0; i < 24; i++) {
    double up[24], down[24];
    memcpy(up, pair->x, sizeof up), memcpy(down, pair->x, sizeof down);
    up[i] += h, down[i] -= h;
    Answer plus = ask(model, up), minus = ask(model, down);
    double error = 0; // one assertion a row: each costs a system call
    for (int j = 0; j < 24; j++) {
      double difference = (plus.gradient[j] - minus.gradient[j]) / (up[i] - down[i]);
      error = suite_larger(error, fabs(difference - hessian[24 * i + j]) / extent);
    }
    ck_assert_at_most(where, error, demand->hessian);
  }
}

START_TEST(the_hessian_is_symmetric_and_the_derivative_of_the_gradient) {
  OverlapModel model = open_model(_i);
  double volume, hessian[576];
  DatagenHardPair pair = datagen_hard_make(2, 0);
  if (overlap_model_has_hessian(&model)) {
    overlap_model_destroy(&model);
    for_each_pair(_i, 0, check_hessian);
    return;
  }
  OverlapBatch batch = {.pair_count = 1, .pairs = pair.x, .volume = &volume, .hessian = hessian};
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "Hessian"));
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(a_tetrahedron_inside_another_is_flagged) {
  if (demand_of(model_at(_i)->name)->lacks & LACKS_STATUS) {
    suite_skip("%s does not promise %s", model_at(_i)->name, name_of(LACKS_STATUS));
    return;
  }
  OverlapModel model = open_model(_i);
  int seen = 0;
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++) {
    bool is_inside = strcmp(datagen_hard_classes[c].name, "inside") == 0;
    if (!is_inside && strcmp(datagen_hard_classes[c].name, "shallow") != 0) continue;
    for (int member = 0; member < 5; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      double swapped[24];
      overlap_ops_swap(pair.x, swapped);
      ck_assert_int_eq(is_inside, (ask(&model, pair.x).flags & OVERLAP_ENCLOSED) != 0);
      ck_assert_int_eq(is_inside, (ask(&model, swapped).flags & OVERLAP_ENCLOSED) != 0);
      seen++;
    }
  }
  ck_assert_int_eq(seen, 10);
  overlap_model_destroy(&model);
}
END_TEST

// Moves the second tetrahedron away from the first until the two are apart by at least `gap`, and by little
// more where they overlapped before.
static void part(double x[24], double gap) {
  double way[3], length = 0;
  for (int c = 0; c < 3; c++) {
    way[c] = 0;
    for (int v = 0; v < 4; v++) way[c] += (x[12 + 3 * v + c] - x[3 * v + c]) / 4;
    length += way[c] * way[c];
  }
  for (int c = 0; c < 3; c++) way[c] = length > 0 ? way[c] / sqrt(length) : c == 0;
  for (double left = gap - overlap_separation_pair(x, INFINITY); left > 0;
       left = gap - overlap_separation_pair(x, INFINITY))
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++) x[12 + 3 * v + c] += fmax(left, gap / 8) * way[c];
}

START_TEST(a_model_without_ghosts_gives_no_volume_where_nothing_is_shared) {
  OverlapModel model = open_model(_i);
  if (overlap_model_has_ghosts(&model)) {
    suite_skip("%s has ghosts", model.ops->name);
    overlap_model_destroy(&model);
    return;
  }
  int members = demand_of(model_at(_i)->name)->members, wrong = 0, asked = 0;
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < members; member++, asked++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      part(pair.x, 1e-9 * overlap_invariant_extent(pair.x));
      wrong += ask(&model, pair.x).volume != 0;
    }
  ck_assert_int_gt(asked, 0);
  ck_assert_int_eq(wrong, 0);
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(a_coordinate_that_is_no_number_is_an_error_that_names_the_pair) {
  const double bad[3] = {NAN, INFINITY, -INFINITY};
  OverlapModel model = open_model(_i);
  double x[5 * 24], volume[5];
  for (int k = 0; k < 5; k++) memcpy(x + 24 * k, datagen_hard_make(0, k).x, 24 * sizeof *x);
  OverlapBatch batch = {.pair_count = 5, .pairs = x, .volume = volume};
  for (int kind = 0; kind < 3; kind++)
    for (int i = 0; i < 24; i++) {
      double good = x[3 * 24 + i];
      x[3 * 24 + i] = bad[kind];
      ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INPUT);
      ck_assert_ptr_nonnull(strstr(status_message(), "pair 3,"));
      x[3 * 24 + i] = good;
    }
  ck_assert_ok(overlap_model_eval(&model, &batch));
  overlap_model_destroy(&model);
}
END_TEST

enum { BATCH = 200 };

START_TEST(results_do_not_depend_on_the_number_of_threads) {
  OverlapModel model = open_model(_i);
  static double x[BATCH * 24], volume[2][BATCH], gradient[2][BATCH * 24];
  static unsigned flags[2][BATCH];
  for (int k = 0; k < BATCH; k++)
    memcpy(x + 24 * k, datagen_hard_make(k % DATAGEN_HARD_CLASS_COUNT, k).x, 24 * sizeof *x);
  int threads = omp_get_max_threads();
  for (int run = 0; run < 2; run++) {
    omp_set_num_threads(run ? 4 : 1);
    OverlapBatch batch = {.pair_count = BATCH,
                          .pairs = x,
                          .volume = volume[run],
                          .gradient = gradient[run],
                          .flags = flags[run]};
    ck_assert_ok(overlap_model_eval(&model, &batch));
  }
  omp_set_num_threads(threads);
  ck_assert_mem_eq(volume[0], volume[1], sizeof volume[0]);
  ck_assert_mem_eq(gradient[0], gradient[1], sizeof gradient[0]);
  ck_assert_mem_eq(flags[0], flags[1], sizeof flags[0]);
  overlap_model_destroy(&model);
}
END_TEST

// What a batch leaves out beforehand must be what the model says of the pair.
START_TEST(a_batch_says_what_each_pair_says) {
  const OverlapOps *ops = model_at(_i);
  if (ops->eval_batch) return; // batches of their own: tested with them
  OverlapModel model = open_model(_i);
  static double x[BATCH * 24], volume[BATCH], gradient[BATCH * 24];
  static unsigned flags[BATCH];
  int disjoint = 0, flat = 0;
  for (int k = 0; k < BATCH; k++) {
    memcpy(x + 24 * k, datagen_hard_make(k % DATAGEN_HARD_CLASS_COUNT, k).x, 24 * sizeof *x);
    for (int c = 12; k % 5 == 0 && c < 24; c++) x[24 * k + c] += 2 * overlap_invariant_extent(x + 24 * k);
  }
  OverlapBatch batch = {
      .pair_count = BATCH, .pairs = x, .volume = volume, .gradient = gradient, .flags = flags};
  memset(volume, -1, sizeof volume), memset(gradient, -1, sizeof gradient);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  for (int k = 0; k < BATCH; k += demand_of(ops->name)->members < 10 && k % 5 ? 7 : 1) {
    Answer answer;
    ck_assert_ok(ops->eval_pair(
        model.self, x + 24 * k,
        &(OverlapAnswer){.volume = &answer.volume, .gradient = answer.gradient, .flags = &answer.flags}));
    ck_assert(answer.volume == volume[k]);
    ck_assert_uint_eq(answer.flags, flags[k]);
    ck_assert_mem_eq(answer.gradient, gradient + 24 * k, sizeof answer.gradient);
    disjoint += (flags[k] & OVERLAP_DISJOINT) != 0, flat += (flags[k] & OVERLAP_FLAT) != 0;
  }
  ck_assert_int_ge(disjoint, 20);
  ck_assert_int_ge(flat, 1);
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(an_empty_batch_is_fine) {
  OverlapModel model = open_model(_i);
  ck_assert_ok(overlap_model_eval(&model, &(OverlapBatch){0}));
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(an_unknown_name_is_an_error_that_lists_the_known_ones) {
  OverlapModel model;
  ck_assert_int_eq(overlap_models_create(&model, "clipp"), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "did you mean 'clip'"));
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++) ck_assert_ptr_nonnull(strstr(status_message(), models[m]->name));
  overlap_model_destroy(&model); // also of one that was never made
}
END_TEST

static Status refuse_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  (void)self, (void)pair, (void)answer;
  return status_fail(STATUS_SOLVER, "it does not like it");
}

START_TEST(messages_call_pairs_as_the_batch_does) {
  static const OverlapOps ops = {.name = "refusing", .eval_pair = refuse_pair, .rejects_disjoint = true};
  const OverlapModel model = {.ops = &ops};
  const int numbers[2] = {70, 71};
  double pairs[2][24] = {{0}}, volumes[2];
  OverlapBatch batch = {.pair_count = 2, .pairs = pairs[0], .volume = volumes, .numbers = numbers};
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_SOLVER);
  ck_assert_str_eq(status_message(), "overlap model 'refusing': pair 70: it does not like it");
  pairs[1][3] = NAN;
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "pair 71, tetrahedron 0, vertex 1"), "%s", status_message());
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("overlap_models");
  int count;
  overlap_models_list(&count);
  tcase_add_loop_test(cases, volumes_are_right_in_every_class, 0, count);
  tcase_add_loop_test(cases, flags_say_what_the_numbers_are, 0, count);
  tcase_add_loop_test(cases, volumes_are_bounded_and_gradients_balance, 0, count);
  tcase_add_loop_test(cases, nothing_depends_on_the_order_of_tetrahedra_and_vertices, 0, count);
  tcase_add_loop_test(cases, a_rigid_motion_changes_nothing_and_scaling_gives_the_cube, 0, count);
  tcase_add_loop_test(cases, the_parts_of_a_tetrahedron_sum_to_the_whole, 0, count);
  tcase_add_loop_test(cases, the_gradient_is_the_derivative_of_the_volume, 0, count);
  tcase_add_loop_test(cases, the_hessian_is_symmetric_and_the_derivative_of_the_gradient, 0, count);
  tcase_add_loop_test(cases, a_tetrahedron_inside_another_is_flagged, 0, count);
  tcase_add_loop_test(cases, a_model_without_ghosts_gives_no_volume_where_nothing_is_shared, 0, count);
  tcase_add_loop_test(cases, a_coordinate_that_is_no_number_is_an_error_that_names_the_pair, 0, count);
  tcase_add_loop_test(cases, results_do_not_depend_on_the_number_of_threads, 0, count);
  tcase_add_loop_test(cases, a_batch_says_what_each_pair_says, 0, count);
  tcase_add_loop_test(cases, an_empty_batch_is_fine, 0, count);
  tcase_add_test(cases, an_unknown_name_is_an_error_that_lists_the_known_ones);
  tcase_add_test(cases, messages_call_pairs_as_the_batch_does);
  return suite_run("overlap models", cases, 60);
}
