// SPDX-License-Identifier: GPL-3.0-or-later
// fem/effect/state: forces, energies and matrices are functions of a state and of the last accepted one,
// whatever was evaluated before; and what effects remember can be copied.
#include <string.h>

#include "base/random.h"
#include "fem/effect/system.h"
#include "fem/effect/system_energy.h"
#include "scene.h"
#include "suite.h"

// Steps that are accepted before anything is compared, so that what effects remember is not nothing.
enum { STEPS = 3, STATES = 4 };
static const double STEP = 1e-4;

typedef struct Walk {
  SceneRun run;
  FemSystem system;
  int n;
  FemState states[STATES]; // under trial, each near the last accepted one
} Walk;

// A body that is sheared, pressed and shaken a little.
static void displace(const Walk *walk, double time, int k, FemState *state) {
  const FemModel *model = walk->system.model;
  double *u = malloc((size_t)walk->n * sizeof *u), *v = malloc((size_t)walk->n * sizeof *v);
  Random random = random_seeded(5, (uint64_t)k);
  for (int i = 0; i < model->free_count; i++) {
    int dof = walk->system.numbering.dof_of_unknown[i];
    double shear = dof % 3 == 0 ? 3e-3 * model->rest[dof + 2] : 0;
    u[i] = (1 + 0.2 * k) * shear + 2e-6 * suite_normal(&random);
    v[i] = model->initial_velocity[dof] + 1e-3 * suite_normal(&random);
  }
  fem_system_scatter(&walk->system, time, u, v, state);
  free(u), free(v);
}

static void displace_under_trial(Walk *walk, int k) {
  displace(walk, (STEPS + 0.25 * k) * STEP, STEPS + k, &walk->states[k]);
}

static void open_walk(Walk *walk, const char *setting) {
  scene_open(&walk->run, "everything", (const char *const[]){setting, NULL});
  const FemModel *model = &walk->run.model;
  walk->n = model->free_count;
  ck_assert_ok(fem_system_create(&walk->system, model));
  for (int k = 0; k < STATES; k++) ck_assert_ok(fem_system_create_state(&walk->system, &walk->states[k]));
  ck_assert_ok(fem_system_begin(&walk->system, &walk->states[0], STEP));
  for (int k = 1; k <= STEPS; k++) {
    displace(walk, k * STEP, k, &walk->states[0]);
    ck_assert_ok(fem_system_renew(&walk->system, &walk->states[0]));
    ck_assert_ok(fem_system_accept(&walk->system, &walk->states[0], STEP));
  }
  for (int k = 1; k < STATES; k++) displace_under_trial(walk, k);
}

static void close_walk(Walk *walk) {
  for (int k = 0; k < STATES; k++) fem_state_destroy(&walk->states[k]);
  fem_system_destroy(&walk->system);
  scene_close(&walk->run);
}

typedef struct Values {
  double *forces;              //                                                       (vertex_count, 3)
  double *stiffness, *damping; // K and D times a vector of ones                         (n)
  FemEnergy energy;
} Values;

static void multiply(Walk *walk, const FemState *state, double k, double d, double *product) {
  FemMatrix *matrix = &walk->system.matrix;
  double *ones = malloc((size_t)walk->n * sizeof *ones);
  for (int i = 0; i < walk->n; i++) ones[i] = 1;
  ck_assert_ok(fem_system_couple(&walk->system, state));
  ck_assert_ok(fem_system_assemble(&walk->system, state, k, d, 0, matrix));
  fem_matrix_multiply(matrix, ones, product);
  free(ones);
}

// All that there is, beginning with one of it.
static Values evaluate(Walk *walk, const FemState *state, int first) {
  FemSystem *system = &walk->system;
  size_t n = (size_t)walk->n, forces = 3 * (size_t)system->model->vertex_count;
  Values values = {.forces = malloc(forces * sizeof(double)),
                   .stiffness = malloc(n * sizeof(double)),
                   .damping = malloc(n * sizeof(double))};
  for (int k = 0; k < 3; k++) switch ((first + k) % 3) {
    case 0:
      ck_assert_ok(fem_system_forces(system, state));
      memcpy(values.forces, system->forces, forces * sizeof(double));
      break;
    case 1:
      ck_assert_ok(fem_system_energy(system, state, &values.energy));
      break;
    default:
      multiply(walk, state, 1, 0, values.stiffness);
      multiply(walk, state, 0, 1, values.damping);
    }
  return values;
}

static void forget(Values *values) {
  free(values->forces), free(values->stiffness), free(values->damping);
}

static void compare(const Walk *walk, const Values *one, const Values *other) {
  size_t forces = 3 * (size_t)walk->system.model->vertex_count * sizeof(double);
  size_t product = (size_t)walk->n * sizeof(double);
  ck_assert_mem_eq(one->forces, other->forces, forces);
  ck_assert_mem_eq(&one->energy, &other->energy, sizeof one->energy);
  ck_assert_mem_eq(one->stiffness, other->stiffness, product);
  ck_assert_mem_eq(one->damping, other->damping, product);
}

#define SMALL_CONTACT "contact={overlap: clip, friction: 0.3}"
#define VISCOUS "contact={overlap: clip, viscosity: 5e4}"
static const char *const settings[] = {SMALL_CONTACT, VISCOUS};

// Lists of candidates are renewed in between near one of the states, or are not.
START_TEST(states_give_the_same_in_any_order_and_any_number_of_times) {
  static const int ORDER[] = {3, 1, 2, 2, 1, 3, 2, 3, 1}, RENEWED[] = {0, 2, 3, 0, 1, 1, 0, 3, 0};
  Walk walk;
  Values first[STATES];
  open_walk(&walk, settings[_i]);
  for (int k = 1; k < STATES; k++) first[k] = evaluate(&walk, &walk.states[k], 0);
  ck_assert(first[1].energy.contact > 0 && first[1].energy.plastic_work > 0);
  ck_assert(_i > 0 || first[1].energy.friction_work > 0);
  ck_assert(memcmp(&first[1].energy, &first[2].energy, sizeof first[1].energy) != 0);
  for (int i = 0; i < (int)(sizeof ORDER / sizeof *ORDER); i++) {
    if (RENEWED[i] > 0) ck_assert_ok(fem_system_renew(&walk.system, &walk.states[RENEWED[i]]));
    Values again = evaluate(&walk, &walk.states[ORDER[i]], i);
    compare(&walk, &first[ORDER[i]], &again);
    forget(&again);
  }
  for (int k = 1; k < STATES; k++) forget(&first[k]);
  close_walk(&walk);
}
END_TEST

START_TEST(every_effect_is_among_them) {
  int count;
  const FemEffectOps *const *list = fem_effect_list(&count);
  Walk walks[2];
  for (int w = 0; w < 2; w++) open_walk(&walks[w], settings[w]);
  for (int i = 0; i < count; i++)
    ck_assert_msg(fem_system_effect(&walks[0].system, list[i]) ||
                      fem_system_effect(&walks[1].system, list[i]),
                  "no walk has the effect '%s'", list[i]->name);
  for (int w = 0; w < 2; w++) close_walk(&walks[w]);
}
END_TEST

// A state is what its numbers are, not where they lie: another one, filled alike, gives the same.
START_TEST(a_state_that_is_filled_alike_gives_the_same) {
  Walk walk;
  FemState alike;
  open_walk(&walk, settings[_i]);
  ck_assert_ok(fem_system_create_state(&walk.system, &alike));
  Values one = evaluate(&walk, &walk.states[2], 0), between = evaluate(&walk, &walk.states[1], 1);
  displace(&walk, walk.states[2].time, STEPS + 2, &alike);
  Values other = evaluate(&walk, &alike, 2);
  compare(&walk, &one, &other);
  displace(&walk, walk.states[1].time, STEPS + 1, &alike); // the same arrays, other numbers
  Values another = evaluate(&walk, &alike, 3);
  compare(&walk, &between, &another);
  forget(&one), forget(&between), forget(&other), forget(&another);
  fem_state_destroy(&alike);
  close_walk(&walk);
}
END_TEST

// What was remembered is taken to a system that began at the last accepted state, and has been nowhere else.
START_TEST(histories_that_are_copied_give_the_same) {
  Walk walk, other;
  open_walk(&walk, settings[_i]);
  open_walk(&other, settings[_i]);
  for (int k = 0; k < STATES; k++) fem_state_destroy(&other.states[k]); // a state is of one system
  fem_system_destroy(&other.system);
  ck_assert_ok(fem_system_create(&other.system, &other.run.model));
  ck_assert_ok(fem_system_begin(&other.system, &walk.states[0], STEP));
  for (int k = 0; k < STATES; k++) ck_assert_ok(fem_system_create_state(&other.system, &other.states[k]));
  for (int k = 1; k < STATES; k++) displace_under_trial(&other, k);
  Values without = evaluate(&other, &other.states[1], 0);
  for (int i = 0; i < walk.system.effect_count; i++) {
    const FemEffectHistory *history = &walk.system.accepted.histories[i];
    ck_assert_ok(fem_system_remember(&other.system, i, history->values, history->count));
  }
  for (int k = 1; k < STATES; k++) {
    Values one = evaluate(&walk, &walk.states[k], 0), copied = evaluate(&other, &other.states[k], k);
    compare(&walk, &one, &copied);
    if (k == 1) ck_assert(memcmp(&one.energy, &without.energy, sizeof one.energy) != 0);
    forget(&one), forget(&copied);
  }
  forget(&without);
  close_walk(&walk), close_walk(&other);
}
END_TEST

START_TEST(a_history_of_another_scene_is_refused) {
  Walk walk;
  open_walk(&walk, settings[0]);
  int checked = 0;
  for (int i = 0; i < walk.system.effect_count; i++) {
    const FemEffectHistory *history = &walk.system.accepted.histories[i];
    if (history->count == 0) continue;
    checked++;
    ck_assert_int_eq(fem_system_remember(&walk.system, i, history->values, history->count - 1), STATUS_INPUT);
  }
  ck_assert_int_eq(checked, 3); // plasticity, loads, stick
  close_walk(&walk);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("state");
  tcase_add_loop_test(test_case, states_give_the_same_in_any_order_and_any_number_of_times, 0, 2);
  tcase_add_test(test_case, every_effect_is_among_them);
  tcase_add_loop_test(test_case, a_state_that_is_filled_alike_gives_the_same, 0, 2);
  tcase_add_loop_test(test_case, histories_that_are_copied_give_the_same, 0, 2);
  tcase_add_test(test_case, a_history_of_another_scene_is_refused);
  return suite_run("state", test_case, 60);
}
