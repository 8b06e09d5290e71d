// SPDX-License-Identifier: GPL-3.0-or-later
// Friction by elastic stick in whole scenes: bodies that stick are turned together, and a body is dragged
// with either of two as slave.
#include "static_solve.h"

#include "base/files/record.h"
#include "base/vec3.h"
#include "contact/friction/stick.h"
#include "fem/effect/contact/stick.h"

// Three blocks on each other, meshed differently.
static const char *const STACK =
    "time: {end: 1}\n"
    "bodies:\n"
    "  - name: low\n"
    "    mesh: {box: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}}\n"
    "    material: {law: neo_hookean, young: 1e6, poisson: 0.3, density: 1000}\n"
    "  - name: middle\n"
    "    mesh: {box: {size: [0.09, 0.08, 0.05], cells: [3, 3, 2]}}\n"
    "    place: {rotate: {axis: [0, 0, 1], degrees: 20}, translate: [0.03, 0.0, 0.04998]}\n"
    "    material: {law: neo_hookean, young: 1e6, poisson: 0.3, density: 1000}\n"
    "  - name: top\n"
    "    mesh: {box: {size: [0.05, 0.05, 0.05], cells: [2, 2, 2]}}\n"
    "    place: {translate: [0.025, 0.025, 0.09996]}\n"
    "    material: {law: corotational, young: 1e6, poisson: 0.3, density: 1000}\n"
    "contact: {potential: field, overlap: clip, stiffness: 3.5e7, friction: 0.5}\n"
    "output: {frames: 1}\n";

// Nothing is prescribed: unknowns are coordinates.
static void set(const FemModel *model, const double *positions, double *u) {
  for (int i = 0; i < model->free_count; i++) u[i] = positions[i] - model->rest[i];
}

// By Rodrigues' formula about an axis through the origin.
static Vec3 turned(Vec3 axis, double angle, Vec3 x) {
  Vec3 along = vec3_scale(vec3_dot(axis, x), axis);
  return vec3_add(along, vec3_add(vec3_scale(cos(angle), vec3_sub(x, along)),
                                  vec3_scale(sin(angle), vec3_cross(axis, x))));
}

// Positions with every body moved a bit against the one below, and bent a bit: friction holds that.
static void shear(const FemModel *model, double *positions) {
  for (int v = 0; v < model->vertex_count; v++) {
    double *x = positions + 3 * (size_t)v, height = x[2];
    x[0] += 4e-5 * height + 2e-3 * height * x[1] * x[1];
    x[1] += 1e-5 * (v >= model->bodies[2].vertex_begin);
  }
}

START_TEST(what_sticks_and_is_turned_as_a_whole_feels_the_same_forces) {
  SceneRun run;
  scene_open_text(&run, STACK);
  const FemModel *model = &run.model;
  const size_t values = 3 * (size_t)model->vertex_count;
  ck_assert_int_eq((int)values, model->free_count);
  double *x = malloc(values * sizeof *x), *u = calloc(values, sizeof *u),
         *before = malloc(values * sizeof *x);
  FemSystem system;
  FemState state;
  memcpy(x, model->rest, values * sizeof *x);
  ck_assert_ok(fem_system_create(&system, model));
  ck_assert_ok(fem_system_create_state(&system, &state));
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_begin(&system, &state, 0));
  shear(model, x);
  set(model, x, u);
  fem_system_scatter(&system, 0.01, u, NULL, &state);
  ck_assert_ok(fem_system_renew(&system, &state));
  ck_assert_ok(fem_system_accept(&system, &state, 0));
  ck_assert_ok(fem_system_forces(&system, &state));
  memcpy(before, system.forces, values * sizeof *before);
  const ContactStick *law;
  ck_assert_ok(fem_effect_stick_evaluate(fem_system_effect(&system, &fem_effect_stick), &state, &law));
  double pull = 0;
  for (int i = 0; i < law->interface_count; i++) pull = fmax(pull, vec3_length(vec3_at(law->forces[i])));
  ck_assert_double_gt(pull, 0.05);
  ck_assert_int_lt(law->slip_count, law->node_count);
  Vec3 axis = vec3_scale(1 / sqrt(14), (Vec3){1, 2, 3});
  for (int k = 1; k <= 12; k++) {
    double time = 0.01 + 0.01 * k, worst = 0;
    for (int v = 0; v < model->vertex_count; v++) {
      vec3_store(x + 3 * (size_t)v, turned(axis, M_PI / 6, vec3_at(x + 3 * (size_t)v)));
      vec3_store(before + 3 * (size_t)v, turned(axis, M_PI / 6, vec3_at(before + 3 * (size_t)v)));
    }
    set(model, x, u);
    fem_system_scatter(&system, time, u, NULL, &state);
    ck_assert_ok(fem_system_renew(&system, &state));
    ck_assert_ok(fem_system_forces(&system, &state));
    for (size_t i = 0; i < values; i++) worst = fmax(worst, fabs(system.forces[i] - before[i]));
    ck_assert_msg(worst <= 1e-9 * pull, "after %d degrees by %.2e N of %.2e N", 30 * k, worst, pull);
    ck_assert_ok(fem_system_accept(&system, &state, 0));
  }
  free(x), free(u), free(before);
  fem_state_destroy(&state);
  fem_system_destroy(&system);
  scene_close(&run);
}
END_TEST

// ---- Dragging. The slider's foot slides over the base by 5 cm; its height decides which of the two has less
// volume and is the slave.

typedef struct Dragged {
  double total, work; // [J]
  double pull, press; // at the end [N]
  int vertices;       // of the slave in contact
} Dragged;

static Dragged drag(const char *size, const char *cells, const char *end, const char *frames) {
  SceneRun run;
  scene_run(&run, "../../examples/validation/dragging",
            (const char *const[]){size, cells, end, frames, "solver.threads=1", NULL});
  int last = run.result.trajectory.frame_count - 1;
  const double *force = scene_force(&run, last, 0);
  Dragged dragged = {.total = run.result.energy.audit.total,
                     .work = run.result.energy.audit.work,
                     .pull = hypot(force[0], force[1]),
                     .press = fabs(force[2]),
                     .vertices = (int)record_find_number(run.result.counters, "friction_vertices")};
  ck_assert_double_le(run.result.energy.audit.gain, 1e-3 * run.result.energy.audit.scale);
  scene_close(&run);
  return dragged;
}

static Dragged drag_with(const char *size, const char *cells) {
  Dragged half = drag(size, cells, "time.end=1", "output.frames=10"),
          whole = drag(size, cells, "time.end=2", "output.frames=20");
  ck_assert_near(half.total, whole.total, 1e-4 * whole.work);
  // Of the resultants: the surfaces lean by some 1e-4.
  ck_assert_near(whole.pull / whole.press, 0.4, 1e-3 * 0.4);
  return whole;
}

START_TEST(dragging_takes_mu_n_and_keeps_energy_whoever_is_slave) {
  Dragged smaller = drag_with("bodies.slider.mesh.box.size=[0.05,0.05,0.03]",
                              "bodies.slider.mesh.box.cells=[3,3,2]"),
          larger = drag_with("bodies.slider.mesh.box.size=[0.05,0.05,0.3]",
                             "bodies.slider.mesh.box.cells=[3,3,20]");
  ck_assert_int_ne(smaller.vertices, larger.vertices);
  ck_assert_near(smaller.work, larger.work, 1e-3 * larger.work);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("stick_turn");
  tcase_add_test(test_case, what_sticks_and_is_turned_as_a_whole_feels_the_same_forces);
  tcase_add_test(test_case, dragging_takes_mu_n_and_keeps_energy_whoever_is_slave);
  return suite_run("stick_turn", test_case, 60);
}
