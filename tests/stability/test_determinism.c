// SPDX-License-Identifier: GPL-3.0-or-later
// The same numbers to the last bit, for any number of threads and in every run: of every overlap model on a
// large batch of pairs, and of a scene with every effect, with every overlap model.
#include <omp.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "overlap/models.h"
#include "scene.h"

static const OverlapOps *model_of(int index) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  ck_assert_int_lt(index, count);
  return models[index];
}

static int model_count(void) {
  int count;
  overlap_models_list(&count);
  return count;
}

// Tetrahedra of size 1 around points half a size apart: most pairs overlap.
static double *make_pairs(int count) {
  double *pairs = memory_zeroed(24 * (size_t)count, sizeof *pairs);
  ck_assert_ptr_nonnull(pairs);
  Random random = random_seeded(11, 0);
  static const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (size_t i = 0; i < 24 * (size_t)count; i++)
    pairs[i] = corners[i % 12] + random_between(&random, -0.25, 0.25);
  return pairs;
}

typedef struct Answer {
  double *volumes, *gradients; // (count), (count, 24)
  unsigned *flags;             // (count)
} Answer;

static Answer ask(const OverlapModel *model, const double *pairs, int count, int threads) {
  Answer answer = {memory_zeroed((size_t)count, sizeof(double)),
                   memory_zeroed(24 * (size_t)count, sizeof(double)),
                   memory_zeroed((size_t)count, sizeof(unsigned))};
  ck_assert(answer.volumes && answer.gradients && answer.flags);
  omp_set_num_threads(threads);
  OverlapBatch batch = {.pair_count = count,
                        .pairs = pairs,
                        .volume = answer.volumes,
                        .gradient = answer.gradients,
                        .flags = answer.flags};
  ck_assert_ok(overlap_model_eval(model, &batch));
  return answer;
}

static void forget(Answer *answer) {
  memory_free(answer->volumes), memory_free(answer->gradients), memory_free(answer->flags);
}

static void check_same(const char *name, const char *what, const void *a, const void *b, size_t bytes) {
  ck_assert_msg(memcmp(a, b, bytes) == 0, "%s: %s differ", name, what);
}

// _i: model.
START_TEST(the_number_of_threads_changes_no_bit_of_a_volume) {
  const OverlapOps *ops = model_of(_i);
  const double work = 0.02; // [s]
  double affordable = work / ops->seconds_per_pair;
  int count = affordable > 10000 ? 10000 : affordable < 20 ? 20 : (int)affordable;
  double *pairs = make_pairs(count);
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, ops->name));
  Answer one = ask(&model, pairs, count, 1);
  int overlapping = 0;
  for (int i = 0; i < count; i++) overlapping += one.volumes[i] > 0;
  ck_assert_int_gt(overlapping, count / 3);
  for (int threads = 1; threads <= 3; threads++) {
    Answer other = ask(&model, pairs, count, threads);
    check_same(ops->name, "volumes", one.volumes, other.volumes, (size_t)count * sizeof(double));
    check_same(ops->name, "gradients", one.gradients, other.gradients, 24 * (size_t)count * sizeof(double));
    check_same(ops->name, "flags", one.flags, other.flags, (size_t)count * sizeof(unsigned));
    forget(&other);
  }
  forget(&one);
  overlap_model_destroy(&model);
  memory_free(pairs);
}
END_TEST

// Models get as much of the scene as they can afford: `cgal` some hundred pairs, a few times.
static void run_with(SceneRun *run, const OverlapOps *ops, int threads, const char *more) {
  char overlap[64], solver[64];
  snprintf(overlap, sizeof overlap, "contact.overlap=%s", ops->name);
  snprintf(solver, sizeof solver, "solver.threads=%d", threads);
  bool is_costly = ops->seconds_per_pair > 1e-5, is_dear = ops->seconds_per_pair > 1e-4;
  bool leaps = strcmp(ops->name, "tpn") == 0 || strcmp(ops->name, "tpn-bf16") == 0 ||
               strcmp(ops->name, "tpn-published") == 0; // its steps fall to nothing
  const char *overrides[] = {overlap,
                             solver,
                             is_dear || leaps ? "time={end: 1e-8, initial_step: 1e-8}"
                             : is_costly      ? "time.end=2e-5"
                                              : "time.end=4e-5",
                             is_dear ? "bodies.strip.mesh.box.cells=1" : "output.frames=2",
                             is_costly ? "output.status=null" : "output.status=exact",
                             is_dear     ? "bodies.slab.mesh.box.cells=1"
                             : is_costly ? "bodies.slab.mesh.box.cells=[2,2,1]"
                                         : "bodies.slab.mesh.box.cells=[6,6,1]",
                             is_costly ? "bodies.block.mesh.box.cells=1"
                                       : "bodies.block.mesh.box.cells=[4,4,1]",
                             is_dear ? "contact.potential=nodal" : "contact.margin=null", // whole elements
                             is_dear ? "contact.friction=0" : "contact.margin=null",
                             more,
                             NULL};
  omp_set_num_threads(threads);
  scene_run(run, "everything", overrides);
}

static void compare(const char *name, const SceneRun *a, const SceneRun *b) {
  const FemRunResult *r = &a->result, *s = &b->result;
  size_t frames = (size_t)r->trajectory.frame_count, values = 3 * frames * (size_t)r->trajectory.vertex_count;
  ck_assert_int_gt(r->contact.pairs_max, 10);
  ck_assert_int_ge(r->integrator.steps, 1);
  ck_assert_int_eq(r->trajectory.frame_count, s->trajectory.frame_count);
  check_same(name, "positions", r->trajectory.positions, s->trajectory.positions, values * sizeof(double));
  check_same(name, "forces", r->trajectory.interface_forces, s->trajectory.interface_forces,
             3 * frames * (size_t)r->trajectory.interface_count * sizeof(double));
  check_same(name, "energies", &r->energy.audit, &s->energy.audit, sizeof r->energy.audit);
  check_same(name, "counts of pairs", &r->contact.pairs, &s->contact.pairs, sizeof r->contact.pairs);
  ck_assert_int_eq(r->integrator.steps, s->integrator.steps);
  ck_assert_int_eq(r->integrator.residuals, s->integrator.residuals);
  ck_assert_int_eq(r->matrix.solver.factorisations, s->matrix.solver.factorisations);
}

// _i: model. One thread, two, and one again.
START_TEST(a_run_is_the_same_to_the_last_bit) {
  const OverlapOps *ops = model_of(_i);
  SceneRun first, other;
  run_with(&first, ops, 1, NULL);
  for (int threads = 2; threads >= 1; threads--) {
    run_with(&other, ops, threads, NULL);
    compare(ops->name, &first, &other);
    scene_close(&other);
  }
  scene_close(&first);
}
END_TEST

// What the scene has not: viscous contact, bodies that sleep.
#define OTHER_CONTACT                                                                                        \
  "contact={overlap: clip, viscosity: 5e4, rest: {speed: 1, acceleration: 1e9, time: 1e-5}}"

#define NODAL "contact={stiffness: 1e6, potential: nodal, overlap: clip}"

// _i: with those; other solvers.
START_TEST(other_settings_are_the_same_to_the_last_bit) {
  static const char *const settings[] = {OTHER_CONTACT, "solver.linear=pcg", "solver.linear=klu", NODAL};
  SceneRun one, two;
  run_with(&one, model_of(0), 1, settings[_i]);
  run_with(&two, model_of(0), 2, settings[_i]);
  compare(settings[_i], &one, &two);
  scene_close(&one), scene_close(&two);
}
END_TEST

// Many bodies and long vectors: interfaces are searched side by side, vectors divided, domains factorised
// apart.
START_TEST(many_bodies_are_the_same_on_any_number_of_threads) {
  static const int counts[] = {1, 2, 3, 7};
  char cells[10][48];
  const char *overrides[13] = {"time.end=0.055", "output.frames=2"};
  for (int k = 0; k < 10; k++) {
    snprintf(cells[k], sizeof cells[k], "bodies.cube_%d.mesh.box.cells=6", k);
    overrides[2 + k] = cells[k];
  }
  SceneRun runs[4];
  for (int k = 0; k < 4; k++) {
    omp_set_num_threads(counts[k]);
    scene_run(&runs[k], "cubes", overrides);
    compare("ten cubes", &runs[0], &runs[k]);
  }
  for (int k = 0; k < 4; k++) scene_close(&runs[k]);
}
END_TEST

START_TEST(the_scene_has_every_effect) {
  int count, present = 0;
  const FemEffectOps *const *effects = fem_effect_list(&count);
  SceneRun run, other;
  scene_open(&run, "everything", NULL);
  scene_open(&other, "everything", (const char *const[]){OTHER_CONTACT, NULL});
  for (int i = 0; i < count; i++)
    present += effects[i]->is_wanted(&run.scene) || effects[i]->is_wanted(&other.scene);
  ck_assert_int_eq(present, count);
  scene_close(&run), scene_close(&other);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("determinism");
  tcase_add_loop_test(test_case, the_number_of_threads_changes_no_bit_of_a_volume, 0, model_count());
  tcase_add_loop_test(test_case, a_run_is_the_same_to_the_last_bit, 0, model_count());
  tcase_add_loop_test(test_case, other_settings_are_the_same_to_the_last_bit, 0, 4);
  tcase_add_test(test_case, many_bodies_are_the_same_on_any_number_of_threads);
  tcase_add_test(test_case, the_scene_has_every_effect);
  return suite_run("determinism", test_case, 120);
}
