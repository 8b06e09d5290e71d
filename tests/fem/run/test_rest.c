// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that have come to rest: contact keeps what they press with, the run leaves them out, and something
// that comes near, or a load, awakes them.
#include "blocks.h"
#include "evaluated.h"
#include "scene.h"

#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/run/rest/rest.h"
#include "fem/scene/drive.h"
#include "overlap/models.h"

// ---- contact_system_hold

typedef struct Pile {
  Blocks blocks;
  double *rest, *still;
  ContactShape ground;
  OverlapModel model;
  ContactSystem *system;
} Pile;

// Three blocks one on another, the lowest 0.05 deep in a half-space.
static Pile *pile(void) {
  Pile *p = calloc(1, sizeof *p);
  ck_assert_ptr_nonnull(p);
  for (int k = 0; k < 3; k++)
    blocks_add(&p->blocks, &(BlockDef){.corner = {0.1 * k, 0.05 * k, 1.95 * k - 0.05},
                                       .cell = {1, 1, 1},
                                       .cells = {2, 2, 2},
                                       .jitter = 0.05});
  p->ground = (ContactShape){.name = "ground", .normal = {0, 0, 1}};
  p->rest = blocks_copy(&p->blocks);
  p->still = calloc(3 * (size_t)p->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(p->still);
  ck_assert_ok(overlap_models_create(&p->model, "clip"));
  ContactSystemDef def = blocks_def(&p->blocks, p->rest, &p->model);
  def.shapes = &p->ground, def.shape_count = 1, def.margin = 0.2;
  ck_assert_ok(contact_system_create(&p->system, &def));
  ck_assert_ok(contact_system_update(p->system, 0, p->blocks.x, p->still, 0.01));
  return p;
}

static void destroy(Pile *p) {
  contact_system_destroy(p->system);
  overlap_model_destroy(&p->model);
  blocks_destroy(&p->blocks);
  free(p->rest), free(p->still), free(p);
}

static double energy_of(Pile *p, const double *x) {
  return evaluated_at(p->system, 0, x)->energy;
}

static void hold(Pile *p, const bool *is_held) {
  ck_assert_ok(contact_system_hold(p->system, 0, p->blocks.x, p->still, 0.01, is_held));
}

START_TEST(what_is_held_stays_in_the_results) {
  Pile *p = pile();
  const ContactEvaluation *evaluation = evaluated_at(p->system, 0, p->blocks.x);
  int count = contact_system_layout(p->system)->interface_count;
  double energy = evaluation->energy;
  ck_assert_double_gt(energy, 0);
  ContactInterface before[8];
  memcpy(before, evaluation->interfaces, (size_t)count * sizeof *before);
  size_t values = 3 * (size_t)p->blocks.vertex_count;
  double *forces = malloc(values * sizeof(double));
  ck_assert_ptr_nonnull(forces);
  memcpy(forces, evaluation->given_forces, values * sizeof(double));
  int pairs = contact_evaluation_active_count(evaluation);

  hold(p, (const bool[]){true, true, false, true}); // the two lower blocks and the ground
  long long tried = contact_system_counters(p->system)->pairs.tried;
  evaluation = evaluated_at(p->system, 0, p->blocks.x);
  ck_assert_near(evaluation->energy, energy, 1e-14 * energy);
  ck_assert_int_lt((int)(contact_system_counters(p->system)->pairs.tried - tried), pairs);
  ck_assert_int_eq(contact_evaluation_active_count(evaluation), pairs);
  const ContactInterface *interfaces = evaluation->interfaces;
  for (int i = 0; i < count; i++) {
    ck_assert_int_eq(interfaces[i].active_count, before[i].active_count);
    for (int c = 0; c < 3; c++) ck_assert_double_eq(interfaces[i].force[c], before[i].force[c]);
  }
  for (size_t k = 0; k < values; k++)
    ck_assert_near(evaluation->given_forces[k], forces[k], 1e-13 * fabs(before[0].force[2]));

  // The upper block moves off: what it pressed with is gone, the rest stands.
  double *x = blocks_copy(&p->blocks);
  for (int v = 2 * p->blocks.vertex_count / 3; v < p->blocks.vertex_count; v++) x[3 * v + 2] += 0.15;
  double left = energy_of(p, x);
  hold(p, NULL);
  ck_assert_near(left, energy_of(p, x), 1e-14 * energy);
  ck_assert_double_lt(left, 0.9 * energy);
  free(x), free(forces), destroy(p);
}
END_TEST

START_TEST(near_is_what_was_near_when_it_was_held) {
  Pile *p = pile();
  int count = contact_system_layout(p->system)->interface_count;
  const ContactInterfaceDef *interfaces = contact_system_layout(p->system)->interfaces;
  bool near[8], held[] = {true, true, true, true};
  for (int i = 0; i < count; i++) {
    near[i] = contact_system_is_near(p->system, i);
    // neighbours in the pile, and the lowest on the ground
    int a = interfaces[i].a, b = interfaces[i].b;
    if (a == b) continue; // neighbours within a body
    bool is_expected = b < 3 ? b == a + 1 : a == 0;
    ck_assert_msg(near[i] == is_expected, "%d and %d: %d", a, b, near[i]);
  }
  hold(p, held);
  for (int i = 0; i < count; i++) ck_assert(contact_system_is_near(p->system, i) == near[i]);
  long long tried = contact_system_counters(p->system)->pairs.tried;
  energy_of(p, p->blocks.x);
  ck_assert_int_eq((int)(contact_system_counters(p->system)->pairs.tried - tried), 0);
  ck_assert_int_gt((int)contact_system_counters(p->system)->left_at_rest, 0);
  destroy(p);
}
END_TEST

// ---- When something changes

START_TEST(a_motion_changes_when_it_begins_to) {
  double rows[] = {1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 1, 4, 0, 0, 1};
  FemConstraintDef def = {.until = INFINITY};
  ck_assert(isinf(fem_drive_next_change(&def, 0)));
  def.table = rows, def.table_count = 4;
  ck_assert_double_eq(fem_drive_next_change(&def, 0), 2);
  ck_assert_double_eq(fem_drive_next_change(&def, 1.5), 2);
  ck_assert_double_eq(fem_drive_next_change(&def, 2), 2);
  ck_assert_double_eq(fem_drive_next_change(&def, 2.5), 2.5);
  ck_assert(isinf(fem_drive_next_change(&def, 3)));
  ck_assert(isinf(fem_drive_next_change(&def, 9)));
  def.until = 1.9; // it never gets to move
  ck_assert(isinf(fem_drive_next_change(&def, 0)));
  def.until = 7, def.table_count = 0, def.velocity[1] = 1;
  ck_assert_double_eq(fem_drive_next_change(&def, 6), 6);
  ck_assert(isinf(fem_drive_next_change(&def, 7)));
  Expression formula;
  ck_assert_ok(expression_parse(&formula, "t", "2*pi"));
  ck_assert(expression_is_constant(&formula));
  FemLoadDef load = {.factor = &formula};
  ck_assert(isinf(fem_load_next_change(&load, 3)));
  ck_assert_ok(expression_parse(&formula, "t", "2*t"));
  ck_assert_double_eq(fem_load_next_change(&load, 3), 3);
  double profile[] = {0, 1, 1, 1, 2, 5};
  load = (FemLoadDef){.table = profile, .table_count = 3};
  ck_assert_double_eq(fem_load_next_change(&load, 0.5), 1);
  ck_assert_double_eq(fem_load_next_change(&load, 1.5), 1.5);
  ck_assert(isinf(fem_load_next_change(&load, 2)));
}
END_TEST

// ---- Whole runs

static long long counted(const SceneRun *run, const char *name) {
  double number = record_find_number(run->result.counters, name);
  ck_assert(isfinite(number));
  return (long long)number;
}

static Vec3 middle(const SceneRun *run, int frame, int body) {
  const FemModelBody *b = &run->model.bodies[body];
  Vec3 sum = {0, 0, 0};
  for (int v = b->vertex_begin; v < b->vertex_end; v++)
    sum = vec3_add(sum, vec3_at(scene_position(run, frame, v)));
  return vec3_scale(1.0 / (b->vertex_end - b->vertex_begin), sum);
}

// The frame before `time`.
static int frame_at(const SceneRun *run, double time) {
  int frame = 0;
  while (frame + 1 < run->result.trajectory.frame_count && run->result.trajectory.times[frame + 1] < time)
    frame++;
  return frame;
}

START_TEST(a_stack_sleeps_until_it_is_hit_and_is_hit_as_it_is_without) {
  SceneRun with, without;
  // The highest force of a blow is as good as the speed is at which it strikes.
  const char *const fine[] = {"time.velocity_tolerance=1e-3", "output.checkpoint.frames=0", NULL};
  scene_run(&with, "asleep", fine);
  scene_open(&without, "asleep", fine);
  without.scene.contact.rest_is_on = false;
  scene_run_from(&without, NULL);
  ck_assert_ok(without.status);
  // The two slabs fell asleep and were awakened by the blow; what jumped never slept.
  ck_assert_int_eq((int)counted(&with, "bodies_put_to_rest"), 2);
  ck_assert_int_eq((int)counted(&with, "bodies_awakened"), 2);
  ck_assert_int_gt((int)counted(&with, "pairs_left_at_rest"), 0);
  // While they slept they did not move, and pressed each other with what they had.
  int asleep = frame_at(&with, 0.42), before = asleep - 1, hit = frame_at(&with, 0.46);
  double weight = 9.81 * (with.model.bodies[0].mass + with.model.bodies[1].mass);
  for (int body = 0; body < 2; body++)
    ck_assert_double_eq(vec3_length(vec3_sub(middle(&with, asleep, body), middle(&with, before, body))), 0);
  int ground = 0;
  while (!strstr(with.result.trajectory.interface_names[ground], "low, ground")) ground++;
  double force = scene_force(&with, asleep, ground)[2];
  // the bound on the acceleration, 0.16 m/s², is 1.6 % of the weight
  ck_assert_near(force, weight, 0.016 * weight);
  ck_assert_double_eq(scene_force(&with, before, ground)[2], force);
  // The blow is the same.
  double peak = with.result.contact.force_max;
  ck_assert_double_gt(peak, 50 * weight);
  ck_assert_near(peak, without.result.contact.force_max, 0.01 * peak);
  for (int body = 0; body < 3; body++) {
    double apart = vec3_length(vec3_sub(middle(&with, hit, body), middle(&without, hit, body)));
    ck_assert_double_le(apart, 5e-5); // of slabs 60 mm thick
  }
  ck_assert_double_le(scene_gain(&with), 1e-3);
  // What it saves.
  ck_assert_double_lt((double)with.result.contact.pairs.tried,
                      0.9 * (double)without.result.contact.pairs.tried);
  scene_close(&with), scene_close(&without);
}
END_TEST

// All sleep; a load that has been constant begins to rise at 0.6 s.
START_TEST(a_load_that_begins_awakes_what_it_acts_on) {
  SceneRun run;
  scene_open(&run, "rest_load", NULL);
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  ck_assert_int_ge((int)counted(&run, "bodies_put_to_rest"), 2);
  ck_assert_int_eq((int)counted(&run, "bodies_awakened"), 1); // the other sleeps on
  int before = frame_at(&run, 0.6), after = run.result.trajectory.frame_count - 1;
  ck_assert_double_eq(vec3_length(vec3_sub(middle(&run, before, 0), middle(&run, before - 1, 0))), 0);
  ck_assert_double_gt(middle(&run, after, 0).x - middle(&run, before, 0).x, 1e-3);
  ck_assert_double_eq(vec3_length(vec3_sub(middle(&run, after, 1), middle(&run, before, 1))), 0);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// All sleep, so that nothing but time goes on; a ball comes down along a table and must not pass through.
START_TEST(an_obstacle_that_comes_awakes_what_it_nears) {
  SceneRun run;
  scene_run(&run, "rest_obstacle", NULL);
  ck_assert_int_ge((int)counted(&run, "bodies_awakened"), 1);
  int last = run.result.trajectory.frame_count - 1, asleep = frame_at(&run, 0.5);
  ck_assert_double_eq(vec3_length(vec3_sub(middle(&run, asleep, 0), middle(&run, asleep - 1, 0))), 0);
  ck_assert_double_lt(middle(&run, last, 0).z, middle(&run, asleep, 0).z - 1e-4); // it is pressed down
  ck_assert_double_gt(run.result.contact.force_max, 20);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// The last value of a column of history.csv in that folder.
static double last_in_history(const char *folder, const char *column) {
  char path[128], *text, *save;
  size_t size;
  snprintf(path, sizeof path, "%s/history.csv", folder);
  ck_assert_ok(file_read(path, &text, &size));
  text[strlen(text) - 1] = 0;
  char *last = strrchr(text, '\n') + 1, *cell = text;
  *strchr(text, '\n') = 0;
  int place = 0;
  for (cell = strtok_r(text, ",", &save); cell && strcmp(cell, column) != 0;
       cell = strtok_r(NULL, ",", &save))
    place++;
  ck_assert_msg(cell != NULL, "history.csv has no column %s", column);
  cell = strtok_r(last, ",", &save);
  for (int k = 0; k < place; k++) cell = strtok_r(NULL, ",", &save);
  double value = atof(cell);
  memory_free(text);
  return value;
}

START_TEST(what_holds_a_sleeper_bears_what_lies_on_it) {
  char folder[] = "/tmp/tetlap_rest_XXXXXX", path[128];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  SceneRun run;
  scene_open(&run, "rest_held", NULL);
  FemRunOptions options = {.directory = folder};
  ck_assert_msg(fem_run(&run.model, &options, &run.result) == STATUS_OK, "%s", status_message());
  ck_assert_int_eq((int)counted(&run, "bodies_put_to_rest"), 2);
  ck_assert_int_eq((int)counted(&run, "bodies_awakened"), 0);
  // All forces of a block of 1 kg on a pillar of 4 kg; the bound on the acceleration is 0.16 m/s².
  ck_assert_near(last_in_history(folder, "reaction_pillar_fixed_0_x_N"), -5 * 1, 5 * 0.16);
  ck_assert_near(last_in_history(folder, "reaction_pillar_fixed_0_z_N"), 5 * 9.81, 5 * 0.16);
  ck_assert_near(last_in_history(folder, "probe_sole_force_z_N"), 9.81, 0.16);
  snprintf(path, sizeof path, "%s/history.csv", folder), unlink(path);
  snprintf(path, sizeof path, "%s/frames.pvd", folder), unlink(path);
  snprintf(path, sizeof path, "%s/end.h5", folder), unlink(path);
  ck_assert_int_eq(rmdir(folder), 0);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("rest");
  tcase_add_test(test_case, what_is_held_stays_in_the_results);
  tcase_add_test(test_case, near_is_what_was_near_when_it_was_held);
  tcase_add_test(test_case, a_motion_changes_when_it_begins_to);
  tcase_add_test(test_case, a_stack_sleeps_until_it_is_hit_and_is_hit_as_it_is_without);
  tcase_add_test(test_case, a_load_that_begins_awakes_what_it_acts_on);
  tcase_add_test(test_case, an_obstacle_that_comes_awakes_what_it_nears);
  tcase_add_test(test_case, what_holds_a_sleeper_bears_what_lies_on_it);
  return suite_run("rest", test_case, 120);
}
