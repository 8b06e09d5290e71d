// SPDX-License-Identifier: GPL-3.0-or-later
// fem/effect/elements/assembly.h and the effects on elements (elasticity, damping, gravity): sums over a
// model of several bodies against single elements, derivatives, and any number of threads.
#include "suite.h"

#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/effect/elements/assembly.h"
#include "fem/effect/elements/elasticity.h"
#include "fem/effect/numbering.h"
#include "fem/model/build.h"
#include "reference/element.h"

// Two boxes of different law and damping, the first with a fixed face, and an obstacle that must stay silent.
typedef struct Scene {
  FemSceneDef def;
  FemBodyDef bodies[2];
  FemObstacleDef obstacle;
  FemConstraintDef fixed;
  FemModel model;
  FemNumbering numbering;
  FemPattern *pattern;
  FemMatrix matrix;
  double *x, *v, *force;
} Scene;

static size_t dof_count(const Scene *scene) {
  return 3 * (size_t)scene->model.vertex_count;
}

static FemState state_of(const Scene *scene) {
  return (FemState){.positions = scene->x, .velocities = scene->v};
}

static void describe(Scene *scene, int cells) {
  static char names[2][8] = {"left", "right"};
  *scene = (Scene){0};
  for (int b = 0; b < 2; b++)
    scene->bodies[b] = (FemBodyDef){
        .name = names[b],
        .box_size = {1, 1, 1},
        .box_cells = {cells, cells, cells},
        .placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}},
        .material =
            {.law = FEM_MATERIAL_NEO_HOOKEAN, .young = 1, .poisson = 0.3, .density = 2, .damping = -1},
    };
  scene->bodies[0].material.law = FEM_MATERIAL_COROTATIONAL;
  scene->bodies[0].material.damping = 0.2;
  scene->bodies[1].placement.translate[0] = 2;
  scene->fixed = (FemConstraintDef){
      .select = {.kind = FEM_SELECT_BOX, .box_min = {-1, -1, -1}, .box_max = {2, 2, 1e-9}},
      .components = {true, true, true},
      .until = INFINITY,
  };
  scene->bodies[0].fixed = &scene->fixed, scene->bodies[0].fixed_count = 1;
  scene->obstacle = (FemObstacleDef){.name = "wall",
                                     .box_size = {1, 1, 1},
                                     .box_cells = {1, 1, 1},
                                     .placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}},
                                     .motion = {.components = {true, true, true}, .until = INFINITY}};
  scene->obstacle.placement.translate[0] = 4;
  scene->def = (FemSceneDef){.bodies = scene->bodies,
                             .body_count = 2,
                             .obstacles = &scene->obstacle,
                             .obstacle_count = 1,
                             .has_gravity = true,
                             .gravity = {0, 1, -9.81}};
}

// Positions a little off rest, the obstacle's too, and random velocities.
static void build(Scene *scene, int cells) {
  describe(scene, cells);
  ck_assert_ok(fem_model_create(&scene->model, &scene->def));
  ck_assert_ok(fem_numbering_create(&scene->numbering, &scene->model));
  size_t n = dof_count(scene);
  scene->x = memory_zeroed(n, sizeof(double));
  scene->v = memory_zeroed(n, sizeof(double));
  scene->force = memory_zeroed(n, sizeof(double));
  ck_assert(scene->x && scene->v && scene->force);
  Random random = random_seeded(61, 0);
  for (size_t i = 0; i < n; i++) {
    scene->x[i] = scene->model.rest[i] + 0.1 / cells * suite_normal(&random);
    scene->v[i] = suite_normal(&random);
  }
}

static void lay_out(Scene *scene, const FemEffectOps *ops, void *effect) {
  FemState state = state_of(scene);
  int has_grown = 0;
  ck_assert_ok(fem_pattern_create(&scene->pattern, scene->model.vertex_count));
  for (int a = 0; a < scene->model.vertex_count; a++)
    ck_assert_ok(fem_pattern_add_clique(scene->pattern, 1, &a, NULL));
  ck_assert_ok(ops->couple(effect, &state, scene->pattern, &has_grown));
  ck_assert_int_eq(has_grown, 1);
  ck_assert_ok(fem_matrix_create(&scene->matrix, scene->pattern, scene->numbering.unknown_of_dof));
}

static void clear(Scene *scene) {
  fem_numbering_destroy(&scene->numbering);
  fem_matrix_destroy(&scene->matrix);
  fem_pattern_destroy(scene->pattern);
  memory_free(scene->x);
  memory_free(scene->v);
  memory_free(scene->force);
  fem_model_destroy(&scene->model);
}

static void find_force(Scene *scene, const FemEffectOps *ops, void *effect) {
  FemState state = state_of(scene);
  memset(scene->force, 0, dof_count(scene) * sizeof *scene->force);
  ck_assert_ok(ops->add_force(effect, &state, scene->force));
}

static void gather(const Scene *scene, const double *field, int tet, double values[12]) {
  for (int r = 0; r < 12; r++) values[r] = field[3 * scene->model.tets[tet][r / 3] + r % 3];
}

static const FemEffectOps *const element_effects[2] = {&fem_effect_elasticity, &fem_effect_damping};

START_TEST(only_what_a_scene_calls_for_is_wanted) {
  Scene scene;
  describe(&scene, 1);
  ck_assert(fem_effect_elasticity.is_wanted(&scene.def));
  ck_assert(fem_effect_damping.is_wanted(&scene.def));
  ck_assert(fem_effect_gravity.is_wanted(&scene.def));
  scene.bodies[0].material.damping = 0;
  scene.def.has_gravity = false;
  ck_assert(!fem_effect_damping.is_wanted(&scene.def));
  ck_assert(!fem_effect_gravity.is_wanted(&scene.def));
  scene.def.stiffness_damping = 0.1;
  ck_assert(fem_effect_damping.is_wanted(&scene.def));
  scene.bodies[1].material.damping = 0;
  ck_assert(!fem_effect_damping.is_wanted(&scene.def));
}
END_TEST

START_TEST(elastic_forces_and_energy_are_the_sums_over_elements_of_bodies) {
  Scene scene;
  build(&scene, 3);
  const FemModel *model = &scene.model;
  void *effect;
  ck_assert_ok(fem_effect_elasticity.create(&effect, model));
  find_force(&scene, &fem_effect_elasticity, effect);
  double *expected = memory_zeroed(dof_count(&scene), sizeof *expected), sum = 0;
  double sums[2] = {0, 0}, energies[3] = {NAN, NAN, NAN}; // of bodies; the third is the obstacle
  ck_assert_int_eq(model->body_count, 3);
  ck_assert_int_gt(model->tet_count, model->bodies[1].tet_end);
  for (int tet = 0; tet < model->bodies[1].tet_end; tet++) {
    double x[12], force[12];
    const FemMaterial *material = &model->parts[model->tet_part[tet]].material;
    gather(&scene, scene.x, tet, x);
    const FemElement element = fem_model_element(model, tet);
    reference_element_force(&element, material, x, force);
    for (int r = 0; r < 12; r++) expected[3 * model->tets[tet][r / 3] + r % 3] += force[r];
    sums[model->tet_body[tet]] += reference_element_energy(&element, material, x);
  }
  sum = sums[0] + sums[1];
  for (size_t i = 0; i < dof_count(&scene); i++) ck_assert_near(scene.force[i], expected[i], 1e-14);
  for (int i = 3 * model->bodies[2].vertex_begin; i < 3 * model->bodies[2].vertex_end; i++)
    ck_assert_double_eq(scene.force[i], 0);
  FemEnergy energy = {0};
  FemState state = state_of(&scene);
  ck_assert_ok(fem_effect_elasticity.add_energy(effect, &state, &energy));
  ck_assert(sum > 1e-3);
  ck_assert_near(energy.elastic, sum, 1e-13 * sum);
  fem_effect_elasticity_energies(effect, &state, energies);
  for (int b = 0; b < 2; b++) ck_assert_near(energies[b], sums[b], 1e-13 * sum);
  ck_assert(sums[0] > 1e-3 && sums[1] > 1e-3 && energies[2] == 0);
  memory_free(expected);
  fem_effect_elasticity.destroy(effect);
  clear(&scene);
}
END_TEST

// Only the first body is damped; what is lost is what the damping forces take.
START_TEST(damping_acts_on_damped_bodies_and_dissipates_its_forces_power) {
  Scene scene;
  build(&scene, 3);
  void *effect;
  ck_assert_ok(fem_effect_damping.create(&effect, &scene.model));
  find_force(&scene, &fem_effect_damping, effect);
  double power = 0, undamped = 0;
  for (size_t i = 0; i < dof_count(&scene); i++) {
    power -= scene.force[i] * scene.v[i];
    if (i >= 3 * (size_t)scene.model.bodies[1].vertex_begin) undamped += fabs(scene.force[i]);
  }
  ck_assert_double_eq(undamped, 0);
  FemEnergy energy = {0};
  FemState state = state_of(&scene);
  ck_assert_ok(fem_effect_damping.add_energy(effect, &state, &energy));
  ck_assert(power > 1e-3);
  ck_assert_near(energy.dissipated_power, power, 1e-12 * power);
  fem_effect_damping.destroy(effect);
  clear(&scene);
}
END_TEST

// y = A·direction against the force difference along it, over the unknowns. The damping matrix lacks the
// unsymmetric part of ∂f/∂x, so damping is compared in v.
static void check_jacobian(Scene *scene, const FemEffectOps *ops, void *effect, bool in_velocity) {
  const FemNumbering *numbering = &scene->numbering;
  size_t n = (size_t)numbering->count;
  double *direction = memory_zeroed(n, sizeof *direction), *product = memory_zeroed(n, sizeof *product);
  double *change = memory_zeroed(n, sizeof *change), *field = in_velocity ? scene->v : scene->x;
  FemState state = state_of(scene);
  double scale = 2.5, h = 1e-5, largest = 0;
  fem_matrix_zero(&scene->matrix);
  ck_assert_ok(
      ops->add_jacobian(effect, &state, in_velocity ? 0 : scale, in_velocity ? scale : 0, &scene->matrix));
  Random random = random_seeded(62, 0);
  for (size_t i = 0; i < n; i++) direction[i] = suite_normal(&random);
  fem_matrix_multiply(&scene->matrix, direction, product);
  for (int side = -1; side <= 1; side += 2) {
    for (size_t i = 0; i < n; i++) field[numbering->dof_of_unknown[i]] += side * h * direction[i];
    find_force(scene, ops, effect);
    for (size_t i = 0; i < n; i++) {
      change[i] -= scale * side * scene->force[numbering->dof_of_unknown[i]] / (2 * h);
      field[numbering->dof_of_unknown[i]] -= side * h * direction[i];
    }
  }
  for (size_t i = 0; i < n; i++) {
    ck_assert_near(product[i], change[i], 1e-6);
    largest = fmax(largest, fabs(product[i]));
  }
  ck_assert(largest > 0.1);
  memory_free(direction);
  memory_free(product);
  memory_free(change);
}

START_TEST(assembled_matrices_are_the_derivatives_of_the_forces) {
  Scene scene;
  build(&scene, 2);
  const FemEffectOps *ops = element_effects[_i];
  void *effect;
  ck_assert_ok(ops->create(&effect, &scene.model));
  lay_out(&scene, ops, effect);
  ck_assert_int_lt(scene.numbering.count, 3 * scene.model.bodies[1].vertex_end); // some are fixed
  check_jacobian(&scene, ops, effect, _i == 1);
  ops->destroy(effect);
  clear(&scene);
}
END_TEST

// The pattern grows by couplings of others (contact): places that were looked up before are stale.
START_TEST(a_matrix_laid_out_anew_is_filled_correctly) {
  Scene scene;
  build(&scene, 2);
  void *effect;
  ck_assert_ok(fem_effect_elasticity.create(&effect, &scene.model));
  lay_out(&scene, &fem_effect_elasticity, effect);
  check_jacobian(&scene, &fem_effect_elasticity, effect, false);
  int far_apart[2] = {scene.model.bodies[0].vertex_end - 1, scene.model.bodies[1].vertex_end - 1};
  int has_grown = 0;
  ck_assert_ok(fem_pattern_add_clique(scene.pattern, 2, far_apart, &has_grown));
  ck_assert_int_eq(has_grown, 1);
  fem_matrix_destroy(&scene.matrix);
  ck_assert_ok(fem_matrix_create(&scene.matrix, scene.pattern, scene.numbering.unknown_of_dof));
  check_jacobian(&scene, &fem_effect_elasticity, effect, false);
  fem_effect_elasticity.destroy(effect);
  clear(&scene);
}
END_TEST

// Entry by entry against fem_matrix_add of element matrices.
START_TEST(damping_adds_both_of_its_matrices) {
  Scene scene;
  build(&scene, 2);
  const FemModel *model = &scene.model;
  void *effect;
  ck_assert_ok(fem_effect_damping.create(&effect, model));
  lay_out(&scene, &fem_effect_damping, effect);
  FemMatrix expected;
  ck_assert_ok(fem_matrix_create(&expected, scene.pattern, scene.numbering.unknown_of_dof));
  for (int tet = 0; tet < model->bodies[0].tet_end; tet++) {
    const FemModelPart *part = &model->parts[0];
    double x[12], v[12], matrix[144];
    gather(&scene, scene.x, tet, x);
    gather(&scene, scene.v, tet, v);
    const FemElement element = fem_model_element(model, tet);
    reference_element_damping_matrix(&element, &part->material, part->damping, x, matrix);
    fem_matrix_add(&expected, 4, model->tets[tet], matrix, 7);
    reference_element_damping_stiffness(&element, &part->material, part->damping, x, v, matrix);
    fem_matrix_add(&expected, 4, model->tets[tet], matrix, 3);
  }
  FemState state = state_of(&scene);
  ck_assert_ok(fem_effect_damping.add_jacobian(effect, &state, 3, 7, &scene.matrix));
  for (int k = 0; k < expected.entry_count; k++)
    ck_assert_near(scene.matrix.value[k], expected.value[k], 1e-12);
  fem_matrix_destroy(&expected);
  fem_effect_damping.destroy(effect);
  clear(&scene);
}
END_TEST

// With 1, 2, 3 and 8 threads: forces, matrix entries and energies equal to the last bit.
START_TEST(the_number_of_threads_changes_no_bit) {
  static const int threads[] = {1, 2, 3, 8};
  const FemEffectOps *ops = element_effects[_i];
  Scene scene;
  build(&scene, 16); // more elements than one thread is given alone
  void *effect;
  ck_assert_ok(ops->create(&effect, &scene.model));
  lay_out(&scene, ops, effect);
  size_t force_size = dof_count(&scene) * sizeof(double);
  size_t matrix_size = (size_t)scene.matrix.entry_count * sizeof(double);
  double *force = NULL, *value = NULL;
  FemEnergy energy = {0};
  FemState state = state_of(&scene);
  for (int k = 0; k < 4; k++) {
    omp_set_num_threads(threads[k]);
    find_force(&scene, ops, effect);
    fem_matrix_zero(&scene.matrix);
    ck_assert_ok(ops->add_jacobian(effect, &state, 1, 2, &scene.matrix));
    FemEnergy again = {0};
    ck_assert_ok(ops->add_energy(effect, &state, &again));
    if (k == 0) {
      force = memory_copy(scene.force, dof_count(&scene), sizeof *force);
      value = memory_copy(scene.matrix.value, (size_t)scene.matrix.entry_count, sizeof *value);
      energy = again;
      ck_assert(force && value && energy.elastic + energy.dissipated_power > 0);
    }
    ck_assert_mem_eq(scene.force, force, force_size);
    ck_assert_mem_eq(scene.matrix.value, value, matrix_size);
    ck_assert_mem_eq(&again, &energy, sizeof energy);
  }
  memory_free(force);
  memory_free(value);
  ops->destroy(effect);
  clear(&scene);
}
END_TEST

START_TEST(gravity_pulls_with_the_weight_and_its_energy_falls_accordingly) {
  Scene scene;
  build(&scene, 2);
  const FemModel *model = &scene.model;
  void *effect;
  ck_assert_ok(fem_effect_gravity.create(&effect, model));
  find_force(&scene, &fem_effect_gravity, effect);
  double total[3] = {0};
  for (size_t i = 0; i < dof_count(&scene); i++) total[i % 3] += scene.force[i];
  double mass = 2 * 2.0; // two unit cubes of density 2; the obstacle weighs nothing
  ck_assert_near(total[0], 0, 1e-13);
  ck_assert_near(total[1], mass, 1e-12);
  ck_assert_near(total[2], -9.81 * mass, 1e-12);
  FemState state = state_of(&scene);
  FemEnergy before = {0}, after = {0};
  ck_assert_ok(fem_effect_gravity.add_energy(effect, &state, &before));
  for (size_t i = 2; i < dof_count(&scene); i += 3) scene.x[i] -= 0.5;
  ck_assert_ok(fem_effect_gravity.add_energy(effect, &state, &after));
  ck_assert_near(after.gravity - before.gravity, -9.81 * mass * 0.5, 1e-12);
  fem_effect_gravity.destroy(effect);
  clear(&scene);
}
END_TEST

// Every allocation of an effect fails once: an error with a message, nothing leaks (under asan), no crash.
START_TEST(a_failed_allocation_is_an_error) {
  Scene scene;
  build(&scene, 1);
  const FemEffectOps *ops = element_effects[_i];
  void *effect = NULL;
  int failures = 0;
  enum { MOST_ALLOCATIONS = 100 };
  for (long k = 1; k < MOST_ALLOCATIONS; k++) {
    memory_fail_at(k);
    Status status = ops->create(&effect, &scene.model);
    memory_fail_at(0);
    if (status == STATUS_OK) {
      ops->destroy(effect);
      break;
    }
    ck_assert_int_eq(status, STATUS_MEMORY);
    failures++;
  }
  // Not how many lists there are, but that each of them was made to fail: the effect and one list at least
  // for each of two kinds of elements.
  ck_assert_int_ge(failures, 3);
  ck_assert_int_lt(failures, MOST_ALLOCATIONS - 1); // the last try went well
  ck_assert_ok(ops->create(&effect, &scene.model));
  lay_out(&scene, ops, effect);
  FemState state = state_of(&scene);
  memory_fail_at(1);
  ck_assert_int_eq(ops->add_jacobian(effect, &state, 1, 1, &scene.matrix), STATUS_MEMORY);
  memory_fail_at(0);
  ck_assert_ok(ops->add_jacobian(effect, &state, 1, 1, &scene.matrix));
  ops->destroy(effect);
  clear(&scene);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("assembly");
  tcase_add_test(cases, only_what_a_scene_calls_for_is_wanted);
  tcase_add_test(cases, elastic_forces_and_energy_are_the_sums_over_elements_of_bodies);
  tcase_add_test(cases, damping_acts_on_damped_bodies_and_dissipates_its_forces_power);
  tcase_add_loop_test(cases, assembled_matrices_are_the_derivatives_of_the_forces, 0, 2);
  tcase_add_test(cases, a_matrix_laid_out_anew_is_filled_correctly);
  tcase_add_test(cases, damping_adds_both_of_its_matrices);
  tcase_add_loop_test(cases, the_number_of_threads_changes_no_bit, 0, 2);
  tcase_add_test(cases, gravity_pulls_with_the_weight_and_its_energy_falls_accordingly);
  tcase_add_loop_test(cases, a_failed_allocation_is_an_error, 0, 2);
  return suite_run("assembly", cases, 20);
}
