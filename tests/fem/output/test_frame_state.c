// SPDX-License-Identifier: GPL-3.0-or-later
// A frame is a state of the motion: forces made anew from its positions, its velocities and the accepted
// state before it are those that it holds. Frames are few against steps, so all of them lie within steps.
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/output/vtk/vtu_read.h"
#include "scene.h"

static char folder[64];

static void open_folder(void) {
  strcpy(folder, "/tmp/tetlap_frame_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void) {
  char command[96];
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
}

static void path_of_frame(int number, char path[96]) {
  snprintf(path, 96, "%s/frame_%05d.vtu", folder, number);
}

// NULL: the frame has no such array.
static const double *find_field(const FemVtuContent *frame, const char *name) {
  for (int f = 0; f < frame->field_count; f++)
    if (strcmp(frame->fields[f].name, name) == 0) return frame->fields[f].values;
  return NULL;
}

static double largest(size_t count, const double *values) {
  double most = 0;
  for (size_t k = 0; k < count; k++) most = suite_larger(fabs(values[k]), most);
  return most;
}

// ---- The same effects once more, led along the accepted states.

enum { MOST_FRAMES = 512 };

typedef struct Replay {
  FemSystem system;
  FemState state; // under trial
  double time;    // of the last accepted state; < 0: there is none [s]
  int next_frame;
  double *u, *v;                               // of the unknowns, scratch
  double *force, *friction, *pressure, *depth; // scratch
  int within;                                  // frames in which bodies touch
  double worst;                                // difference of an array, over its largest number
  char worst_name[32];
  double forces[MOST_FRAMES][3]; // of contact and friction on the first body [N]
} Replay;

static void replay_create(Replay *replay, const FemModel *model) {
  size_t vertices = (size_t)model->vertex_count;
  *replay = (Replay){.time = -1};
  ck_assert_ok(fem_system_create(&replay->system, model));
  ck_assert_ok(fem_system_create_state(&replay->system, &replay->state));
  double **arrays[] = {&replay->u, &replay->v, &replay->force, &replay->friction};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    *arrays[k] = memory_zeroed(3 * vertices, sizeof(double));
  replay->pressure = memory_zeroed(vertices, sizeof(double));
  replay->depth = memory_zeroed(vertices, sizeof(double));
}

static void replay_destroy(Replay *replay) {
  fem_state_destroy(&replay->state);
  fem_system_destroy(&replay->system);
  memory_free(replay->u), memory_free(replay->v);
  memory_free(replay->force), memory_free(replay->friction);
  memory_free(replay->pressure), memory_free(replay->depth);
}

static ContactSystem *contact_of(const Replay *replay) {
  return fem_effect_contact_system(fem_system_effect(&replay->system, &fem_effect_contact));
}

static void take(Replay *replay, double time, const double *positions, const double *velocities) {
  const FemNumbering *numbering = &replay->system.numbering;
  for (int i = 0; i < numbering->count; i++) {
    int dof = numbering->dof_of_unknown[i];
    replay->u[i] = positions[dof] - replay->system.model->rest[dof];
    replay->v[i] = velocities[dof];
  }
  fem_system_scatter(&replay->system, time, replay->u, replay->v, &replay->state);
}

static void accept(Replay *replay, double time, const double *positions, const double *velocities) {
  take(replay, time, positions, velocities);
  if (replay->time < 0)
    ck_assert_ok(fem_system_begin(&replay->system, &replay->state, 0));
  else
    ck_assert_ok(fem_system_accept(&replay->system, &replay->state, 0));
  replay->time = time;
}

static void add(const Replay *replay, const FemEffectOps *ops, double *force) {
  void *effect = fem_system_effect(&replay->system, ops);
  if (effect) ck_assert_ok(ops->add_force(effect, &replay->state, force));
}

static void compare(Replay *replay, const FemVtuContent *frame, const char *name, size_t count,
                    const double *made) {
  const double *written = find_field(frame, name);
  if (!written) return;
  double scale = largest(count, made), difference = 0;
  for (size_t k = 0; k < count; k++) difference = suite_larger(fabs(written[k] - made[k]), difference);
  if (scale > 0) difference /= scale;
  if (difference <= replay->worst) return;
  replay->worst = difference;
  snprintf(replay->worst_name, sizeof replay->worst_name, "%s", name);
}

// Minus all forces on what is fixed or driven; 0 elsewhere.
static void compare_reactions(Replay *replay, const FemVtuContent *frame) {
  size_t values = 3 * (size_t)replay->system.model->vertex_count;
  const double *written = find_field(frame, "reaction");
  if (!written) return;
  ck_assert_ok(fem_system_forces_of_all(&replay->system, &replay->state));
  for (size_t k = 0; k < values; k++) replay->force[k] = written[k] != 0 ? -replay->system.forces[k] : 0;
  compare(replay, frame, "reaction", values, replay->force);
}

static void compare_forces(Replay *replay, const FemVtuContent *frame) {
  const FemModel *model = replay->system.model;
  size_t vertices = (size_t)model->vertex_count;
  memset(replay->force, 0, 3 * vertices * sizeof *replay->force);
  memset(replay->friction, 0, 3 * vertices * sizeof *replay->friction);
  add(replay, &fem_effect_contact, replay->force);
  add(replay, &fem_effect_viscosity, replay->force);
  add(replay, &fem_effect_stick, replay->friction);
  const ContactEvaluation *contact;
  ck_assert_ok(fem_effect_contact_evaluate(&replay->system, &replay->state, &contact));
  ck_assert_ok(
      contact_system_trace(contact_of(replay), contact, NULL,
                           &(ContactTraceResult){.pressures = replay->pressure, .depths = replay->depth}));
  compare(replay, frame, "contact_force", 3 * vertices, replay->force);
  compare(replay, frame, "friction_force", 3 * vertices, replay->friction);
  compare(replay, frame, "contact_pressure", vertices, replay->pressure);
  compare(replay, frame, "contact_depth", vertices, replay->depth);
  replay->within += largest(3 * vertices, replay->force) > 0;
  const double *covered = contact->given_covered, *share = find_field(frame, "overlap_fraction");
  for (int e = 0; e < model->tet_count; e++) ck_assert_near(share[e] * model->volumes[e], covered[e], 1e-18);
}

static void sum_first_body(Replay *replay) {
  const FemModel *model = replay->system.model;
  ck_assert_int_lt(replay->next_frame, MOST_FRAMES);
  for (int i = 0; i < 3 * model->bodies[0].vertex_end; i++)
    replay->forces[replay->next_frame][i % 3] += replay->force[i] + replay->friction[i];
}

static void check_frame(Replay *replay, const FemVtuContent *frame) {
  take(replay, frame->time, frame->positions, find_field(frame, "velocity"));
  ck_assert_ok(fem_system_renew(&replay->system, &replay->state));
  compare_forces(replay, frame);
  sum_first_body(replay);
  compare_reactions(replay, frame);
}

// The frames up to a state that is accepted; those that lie on it have been tried with the state before it.
static Status follow(void *self, const FemRunProgress *progress) {
  Replay *replay = self;
  char path[96];
  for (path_of_frame(replay->next_frame, path); file_exists(path);
       path_of_frame(++replay->next_frame, path)) {
    FemVtuContent frame;
    ck_assert_ok(fem_vtu_read(path, &frame));
    if (replay->time < 0) accept(replay, frame.time, frame.positions, find_field(&frame, "velocity"));
    ck_assert_double_ge(frame.time, replay->time);
    ck_assert_double_le(frame.time, progress->time * (1 + 1e-12));
    check_frame(replay, &frame);
    fem_vtu_read_destroy(&frame);
  }
  const FemState *now = &progress->system->accepted;
  accept(replay, now->time, now->positions, now->velocities);
  return STATUS_OK;
}

static void replay_run(SceneRun *run, Replay *replay, const char *scene, const char *const *overrides) {
  open_folder();
  scene_open(run, scene, overrides);
  replay_create(replay, &run->model);
  FemRunOptions options = {.directory = folder, .observe = follow, .observer = replay};
  omp_set_num_threads(1); // frames are then there at once
  ck_assert_ok(fem_run(&run->model, &options, &run->result));
  ck_assert_int_eq(replay->next_frame, run->scene.frames + 1);
}

static void replay_close(SceneRun *run, Replay *replay) {
  replay_destroy(replay);
  scene_close(run);
  remove_folder();
}

// Of a row of history.csv.
static double value_at(const char *row, int column) {
  for (int c = 0; c < column; c++) row = strchr(row, ',') + 1;
  return strtod(row, NULL);
}

static int column_of(const char *titles, const char *name) {
  const char *at = strstr(titles, name);
  ck_assert_msg(at != NULL, "history.csv has no column %s", name);
  int column = 0;
  for (const char *c = titles; c < at; c++) column += *c == ',';
  return column;
}

static char *read_history(void) {
  char path[96], *text;
  size_t size;
  snprintf(path, sizeof path, "%s/history.csv", folder);
  ck_assert_ok(file_read(path, &text, &size));
  return text;
}

// force_…_N of each row is the sum over the first body's vertices at that frame.
static void check_rows(const Replay *replay, const char *first_column) {
  char *text = read_history(), *next, *row = strtok_r(text, "\n", &next);
  int column = column_of(row, first_column), count = 0;
  double scale = largest(3 * MOST_FRAMES, replay->forces[0]);
  while ((row = strtok_r(NULL, "\n", &next)) != NULL) {
    for (int c = 0; c < 3; c++)
      ck_assert_near(value_at(row, column + c), replay->forces[count][c], 1e-9 * scale);
    count++;
  }
  ck_assert_int_eq(count, replay->next_frame);
  memory_free(text);
}

typedef struct Case {
  const char *scene;
  const char *overrides[6];
  int within;         // frames with contact, at least
  const char *column; // of the force on the first body; NULL: there are several
} Case;

static const Case cases[] = {
    {"edges", {"output={frames: 25}", "contact.friction=0.4"}, 10, "force_lower_upper_x_N"},
    {"collision", {"output={frames: 40}"}, 10, "force_left_right_x_N"},
    {"incline",
     {"output={frames: 20}", "time.end=0.4", "contact={stiffness: 1e7, friction: 0.3}"},
     10,
     "force_block_slope_x_N"},
    {"incline", {"output={frames: 20}", "time.end=0.4", "contact.friction=0.3"}, 10, "force_block_slope_x_N"},
    {"bounce",
     {"output={frames: 60}", "contact={stiffness: 1e6, viscosity: 2e4}"},
     4,
     "force_block_ground_x_N"},
    {"rest_obstacle", {"output={frames: 36}"}, 20, NULL},
};
enum { CASES = sizeof cases / sizeof *cases };

START_TEST(forces_made_anew_from_a_frame_are_those_that_it_holds) {
  const Case *which = &cases[_i];
  SceneRun run;
  Replay replay;
  replay_run(&run, &replay, which->scene, which->overrides);
  ck_assert_int_ge(replay.within, which->within);
  ck_assert_msg(replay.worst <= 1e-9, "%s: %s differs by %.3g of its largest", which->scene,
                replay.worst_name, replay.worst);
  if (which->column) check_rows(&replay, which->column);
  replay_close(&run, &replay);
}
END_TEST

// A block falls and bounces; frames are closer than steps. What the ground has given it until a frame, by the
// trapezoidal rule over frames, less its weight, is what it has by its velocities: but for the error of the
// steps themselves (`momentum_gap`).
START_TEST(forces_of_frames_are_mass_times_acceleration) {
  SceneRun run;
  open_folder();
  scene_open(&run, "bounce",
             (const char *const[]){"output={frames: 400, vtu: false}", "contact={stiffness: 1e6}", NULL});
  FemRunOptions options = {.directory = folder};
  ck_assert_ok(fem_run(&run.model, &options, &run.result));
  ck_assert_int_lt(run.result.integrator.steps, 200);
  char *text = read_history(), *next, *row = strtok_r(text, "\n", &next);
  const int force_column = column_of(row, "force_block_ground_z_N"),
            momentum_column = column_of(row, "momentum_z");
  const double weight = 1 * 9.81, interval = run.scene.end / run.scene.frames;
  double before = -weight, impulse = 0, largest_momentum = 0, worst = 0;
  while ((row = strtok_r(NULL, "\n", &next)) != NULL) {
    double force = value_at(row, force_column) - weight, momentum = value_at(row, momentum_column);
    if (value_at(row, 0) > 0) impulse += 0.5 * interval * (before + force);
    before = force;
    largest_momentum = suite_larger(fabs(momentum), largest_momentum);
    worst = suite_larger(fabs(momentum - impulse), worst);
  }
  ck_assert_double_gt(largest_momentum, 1); // 1 kg that falls 10 cm
  ck_assert_double_le(worst, 5e-3 * largest_momentum);
  memory_free(text);
  scene_close(&run);
  remove_folder();
}
END_TEST

// Positions at the end, with many frames written and with none but the first and the last.
START_TEST(writing_frames_changes_no_bit_of_a_run) {
  static const char *const scenes[] = {"edges", "rest_obstacle"};
  static const char *const contact[] = {"contact.friction=0.4", "contact.friction=0.2"};
  double *end[2] = {NULL, NULL};
  size_t values = 0;
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    open_folder();
    scene_open(&run, scenes[_i],
               (const char *const[]){k ? "output={frames: 57}" : "output={frames: 1, vtu: false}",
                                     contact[_i], NULL});
    FemRunOptions options = {.directory = k ? folder : NULL, .keep_trajectory = true};
    ck_assert_ok(fem_run(&run.model, &options, &run.result));
    values = 3 * (size_t)run.model.vertex_count;
    end[k] =
        memory_copy(scene_position(&run, run.result.trajectory.frame_count - 1, 0), values, sizeof(double));
    ck_assert_ptr_nonnull(end[k]);
    scene_close(&run);
    remove_folder();
  }
  ck_assert_mem_eq(end[1], end[0], values * sizeof(double));
  memory_free(end[0]), memory_free(end[1]);
}
END_TEST

// A bar is drawn out of the yield surface in few long steps, perfectly plastic: in no frame is its stress
// beyond yield, though the plastic strain moves on between two accepted states. Strains are some thousandths,
// which is what Cauchy's stress and the law's own differ by.
START_TEST(stress_in_a_frame_has_the_plastic_strain_of_that_time) {
  const double yield = 1e5;
  SceneRun run;
  open_folder();
  scene_open(
      &run, "cantilever",
      (const char *const[]){
          "output={frames: 40}", "time={end: 1, max_step: 0.1}", "effects={damping: 1e-3}",
          "bodies=[{name: bar, mesh: {box: {size: [0.2, 0.1, 0.1], cells: [4, 2, 2]}}, material: {law: "
          "stvk, young: 1e8, poisson: 0.3, density: 1000, plasticity: {yield: 1e5, hardening: 0}}, "
          "fixed: [{group: x_min, components: [x]}], driven: [{group: x_max, components: [x], formula: "
          "{x: 1e-3*smooth(t)}}]}]",
          NULL});
  FemRunOptions options = {.directory = folder};
  ck_assert_ok(fem_run(&run.model, &options, &run.result));
  double most = 0;
  for (int f = 0; f <= run.scene.frames; f++) {
    FemVtuContent frame;
    char path[96];
    path_of_frame(f, path);
    ck_assert_ok(fem_vtu_read(path, &frame));
    most = suite_larger(largest((size_t)frame.cell_count, find_field(&frame, "von_mises")), most);
    fem_vtu_read_destroy(&frame);
  }
  ck_assert_double_ge(most, 0.99 * yield);
  ck_assert_double_le(most, 1.02 * yield);
  scene_close(&run);
  remove_folder();
}
END_TEST

// A block slides over another: at every vertex that presses, on either of the two, the traction is the
// pressure and μ times it across.
START_TEST(where_all_slides_the_traction_has_mu_times_the_pressure) {
  const double friction = 0.4;
  SceneRun run;
  FemVtuContent frame;
  char path[96];
  int pressed[2] = {0, 0};
  open_folder();
  scene_open(&run, "drag", (const char *const[]){"output.vtu=true", "output.frames=20", NULL});
  FemRunOptions options = {.directory = folder};
  ck_assert_ok(fem_run(&run.model, &options, &run.result));
  path_of_frame(run.scene.frames, path);
  ck_assert_ok(fem_vtu_read(path, &frame));
  const double *pressure = find_field(&frame, "contact_pressure"),
               *traction = find_field(&frame, "contact_traction");
  for (int v = 0; v < run.model.vertex_count; v++) {
    Vec3 t = vec3_at(traction + 3 * (size_t)v);
    if (pressure[v] == 0) {
      ck_assert_double_eq(vec3_length(t), 0);
      continue;
    }
    double across = sqrt(fmax(0, vec3_dot(t, t) / (pressure[v] * pressure[v]) - 1));
    ck_assert_near(across, friction, 0.01 * friction); // normals of pairs differ by the tilt of their faces
    pressed[v >= run.model.bodies[1].vertex_begin]++;
  }
  ck_assert_int_ge(pressed[0], 16);
  ck_assert_int_ge(pressed[1], 4);
  fem_vtu_read_destroy(&frame);
  scene_close(&run);
  remove_folder();
}
END_TEST

// Of the last frame of a scene that was run into the folder; the caller closes both.
static void run_to_last_frame(SceneRun *run, const char *scene, const char *const *overrides,
                              FemVtuContent *frame) {
  char path[96];
  open_folder();
  scene_open(run, scene, overrides);
  FemRunOptions options = {.directory = folder};
  ck_assert_ok(fem_run(&run->model, &options, &run->result));
  path_of_frame(run->scene.frames, path);
  ck_assert_ok(fem_vtu_read(path, frame));
}

static void close_last_frame(SceneRun *run, FemVtuContent *frame) {
  fem_vtu_read_destroy(frame);
  scene_close(run);
  remove_folder();
}

// The last row's number in that column.
static double last_value(const char *name) {
  char *text = read_history(), *next, *row = strtok_r(text, "\n", &next), *last = row;
  int column = column_of(row, name);
  while ((row = strtok_r(NULL, "\n", &next)) != NULL) last = row;
  double value = value_at(last, column);
  memory_free(text);
  return value;
}

// A block is dragged by 16 mm along x: what its vertices say is what the run counts.
START_TEST(friction_work_of_vertices_is_the_work_of_the_run) {
  SceneRun run;
  FemVtuContent frame;
  run_to_last_frame(&run, "drag", (const char *const[]){"output.vtu=true", "output.frames=20", NULL}, &frame);
  const double *work = find_field(&frame, "friction_work"), *way = find_field(&frame, "slip_way"),
               *slip = find_field(&frame, "slip"), *status = find_field(&frame, "contact_status"),
               *pressure = find_field(&frame, "contact_pressure"),
               *depth = find_field(&frame, "contact_depth"), *gap = find_field(&frame, "contact_gap");
  double sum = 0, dissipated = last_value("dissipated_J");
  int sliding = 0, base = run.model.bodies[1].vertex_begin;
  for (int v = 0; v < run.model.vertex_count; v++) {
    sum += work[v];
    ck_assert_double_eq(status[v], pressure[v] > 0 ? 2 : 0);
    if (depth[v] > 0) ck_assert_double_eq(gap[v], -depth[v]);
    if (v >= base) ck_assert_double_eq(way[v], 0); // the slider is the slave
    if (v >= base || status[v] == 0) continue;
    ck_assert_near(slip[3 * v], 0.016, 0.02 * 0.016); // but for the shear of the slider
    ck_assert_near(way[v], 0.016, 0.02 * 0.016);
    sliding++;
  }
  ck_assert_int_eq(sliding, 16);
  ck_assert_double_gt(dissipated, 0);
  ck_assert_near(sum, dissipated, 1e-9 * dissipated);
  close_last_frame(&run, &frame);
}
END_TEST

// The moment of a contact is that of the forces on the first body's vertices.
START_TEST(moments_of_contacts_are_those_of_the_forces_at_vertices) {
  SceneRun run;
  FemVtuContent frame;
  Vec3 sum = {0, 0, 0};
  run_to_last_frame(&run, "drag",
                    (const char *const[]){"output.vtu=true", "output.frames=4", "time.end=0.4", NULL},
                    &frame);
  const double *contact = find_field(&frame, "contact_force"),
               *friction = find_field(&frame, "friction_force");
  for (int v = run.model.bodies[0].vertex_begin; v < run.model.bodies[0].vertex_end; v++) {
    size_t at = 3 * (size_t)v;
    Vec3 force = vec3_add(vec3_at(contact + at), vec3_at(friction + at));
    sum = vec3_add(sum, vec3_cross(vec3_at(frame.positions + at), force));
  }
  double size = vec3_length(sum);
  ck_assert_double_gt(size, 0.1);
  ck_assert_near(last_value("moment_slider_base_x_Nm"), sum.x, 1e-9 * size);
  ck_assert_near(last_value("moment_slider_base_y_Nm"), sum.y, 1e-9 * size);
  ck_assert_near(last_value("moment_slider_base_z_Nm"), sum.z, 1e-9 * size);
  close_last_frame(&run, &frame);
}
END_TEST

// What has not begun to slide sticks, on both sides, and has done no work by slip.
START_TEST(what_does_not_slide_is_told_to_stick) {
  SceneRun run;
  FemVtuContent frame;
  run_to_last_frame(&run, "incline",
                    (const char *const[]){"output={frames: 2}", "time.end=0.5", "contact.friction=0.9", NULL},
                    &frame);
  const double *status = find_field(&frame, "contact_status"),
               *pressure = find_field(&frame, "contact_pressure");
  int sticking = 0;
  for (int v = 0; v < run.model.vertex_count; v++)
    if (pressure[v] > 0) {
      ck_assert_double_eq(status[v], 1);
      sticking++;
    }
  ck_assert_int_ge(sticking, 8);
  close_last_frame(&run, &frame);
}
END_TEST

// Two blocks 3 mm apart, which do not move.
START_TEST(a_gap_is_the_distance_of_what_does_not_touch_yet) {
  SceneRun run;
  FemVtuContent frame;
  int near = 0;
  run_to_last_frame(
      &run, "patch",
      (const char *const[]){
          "output={frames: 1}",
          "bodies=[{name: low, mesh: {box: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}}, fixed: [{group: "
          "z_min}], material: {young: 1e6, poisson: 0.3, density: 1000}}, {name: high, mesh: {box: {size: "
          "[0.1, 0.1, 0.05], cells: [5, 5, 3]}}, place: {translate: [0, 0, 0.053]}, fixed: [{group: z_max}], "
          "material: {young: 1e6, poisson: 0.3, density: 1000}}]",
          NULL},
      &frame);
  const double *gap = find_field(&frame, "contact_gap"), *status = find_field(&frame, "contact_status");
  for (int v = 0; v < run.model.vertex_count; v++) {
    double z = run.model.rest[3 * v + 2];
    ck_assert_double_eq(status[v], 0);
    if (fabs(z - 0.05) < 1e-9 || fabs(z - 0.053) < 1e-9) {
      ck_assert_near(gap[v], 0.003, 1e-12);
      near++;
    } else if (gap[v] == gap[v])
      ck_assert_near(gap[v], z < 0.05 ? 0.053 - z : z - 0.05, 1e-12); // of a side face
  }
  ck_assert_int_eq(near, 25 + 36);
  close_last_frame(&run, &frame);
}
END_TEST

// A shaft in a hole, both made smooth for contact: every vertex of both is pressed, though what is left of
// the sagittas scatters the pressures.
START_TEST(pressure_is_told_on_surfaces_that_are_made_smooth) {
  SceneRun run;
  FemVtuContent frame;
  run_to_last_frame(&run, "shaft", NULL, &frame);
  const double *pressure = find_field(&frame, "contact_pressure");
  double sum = 0;
  int pressed = 0;
  for (int v = 0; v < run.model.vertex_count; v++)
    if (pressure[v] > 0) sum += pressure[v], pressed++;
  ck_assert_int_eq(pressed, 18 + 22);
  for (int v = 0; v < run.model.vertex_count; v++)
    if (pressure[v] > 0) ck_assert_near(pressure[v], sum / pressed, 0.85 * sum / pressed);
  close_last_frame(&run, &frame);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("frame_state");
  tcase_add_test(test_case, where_all_slides_the_traction_has_mu_times_the_pressure);
  tcase_add_test(test_case, friction_work_of_vertices_is_the_work_of_the_run);
  tcase_add_test(test_case, moments_of_contacts_are_those_of_the_forces_at_vertices);
  tcase_add_test(test_case, what_does_not_slide_is_told_to_stick);
  tcase_add_test(test_case, a_gap_is_the_distance_of_what_does_not_touch_yet);
  tcase_add_test(test_case, pressure_is_told_on_surfaces_that_are_made_smooth);
  tcase_add_loop_test(test_case, forces_made_anew_from_a_frame_are_those_that_it_holds, 0, CASES);
  tcase_add_test(test_case, forces_of_frames_are_mass_times_acceleration);
  tcase_add_loop_test(test_case, writing_frames_changes_no_bit_of_a_run, 0, 2);
  tcase_add_test(test_case, stress_in_a_frame_has_the_plastic_strain_of_that_time);
  return suite_run("frame_state", test_case, 60);
}
