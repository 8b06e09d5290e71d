// SPDX-License-Identifier: GPL-3.0-or-later
// The potential `field` in whole scenes: uniform stress through an interface of meshes that do not match, and
// forces under what stands still.
#include <string.h>
#include <unistd.h>

#include "curved.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/effect.h"
#include "fem/model/build.h"
#include "medit.h"
#include "scene.h"
#include "scene_text.h"

static const double TRACTION = 1000;

static void open_text(SceneRun *run, const char *text) {
  *run = (SceneRun){.status = STATUS_OK};
  ck_assert_ok(scene_text_read("field.yaml", text, strlen(text), &run->scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
}

// ---- Patch test.

// Two blocks of 0.1 × 0.1 × 0.05 m, three planes of symmetry, pressed from above.
static const char SCENE[] = "time: {end: 1, static: true}\n"
                            "bodies:\n"
                            "  - name: lower\n"
                            "    element: %s\n"
                            "    mesh: {%s}\n"
                            "    %s\n"
                            "    material: {law: linear, young: 1e6, poisson: 0.3, density: 1000}\n"
                            "    fixed:\n"
                            "      - {box: {min: [-1e-9, -1, -1], max: [1e-9, 1, 1]}, components: [x]}\n"
                            "      - {box: {min: [-1, -1e-9, -1], max: [1, 1e-9, 1]}, components: [y]}\n"
                            "      - {box: {min: [-1, -1, -1e-9], max: [1, 1, 1e-9]}, components: [z]}\n"
                            "  - name: upper\n"
                            "    element: %s\n"
                            "    mesh: {box: {size: [0.1, 0.1, 0.05], cells: %s}}\n"
                            "    place: {translate: [0, 0, 0.05]}\n"
                            "    material: {law: linear, young: 1e6, poisson: 0.3, density: 1000}\n"
                            "    fixed:\n"
                            "      - {group: x_min, components: [x]}\n"
                            "      - {group: y_min, components: [y]}\n"
                            "    loads: [{group: z_max, traction: [0, 0, -1000]}]\n"
                            "contact: {potential: field, overlap: clip, stiffness: %g}\n"
                            "output: {frames: 1}\n";

typedef struct Patch {
  const char *element, *mesh, *place, *upper_cells;
} Patch;

static const Patch CUBES = {"linear", "box: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}", "", "[5, 5, 3]"};
static const Patch UNSTRUCTURED = {"linear", "file: " TETLAP_SOURCE_DIR "/meshes/block.msh",
                                   "place: {scale: [0.5, 0.5, 0.25], translate: [0.05, 0.05, 0]}",
                                   "[5, 5, 3]"};
// Largest difference of any stress of any element from the uniform one, over it.
static double unevenness(const Patch *patch, double stiffness) {
  char text[4096];
  snprintf(text, sizeof text, SCENE, patch->element, patch->mesh, patch->place, patch->element,
           patch->upper_cells, stiffness);
  SceneRun run;
  open_text(&run, text);
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  ck_assert_near(fabs(scene_force(&run, 1, 0)[2]), TRACTION * 0.01, 1e-6 * TRACTION * 0.01);
  double worst = 0;
  const double *positions = scene_position(&run, 1, 0);
  for (int e = 0; e < run.model.tet_count; e++) {
    double stress[6];
    fem_model_stress(&run.model, e, positions, stress);
    for (int k = 0; k < 6; k++)
      worst = suite_larger(worst, fabs(stress[k] + (k == 2 ? TRACTION : 0)) / TRACTION);
  }
  scene_close(&run);
  return worst;
}

// c = κ/(2h) is as compliant as `nodal` with κ: for κ = E 2e7 Pa/m.
static void expect_evenness(const char *name, const Patch *patch, double soft_bound, double hard_bound) {
  double soft = unevenness(patch, 2e7), hard = unevenness(patch, 2e8);
  printf("patch test, %s: %.1e at the compliance of E, %.1e at that of 10 E\n", name, soft, hard);
  ck_assert(soft <= soft_bound);
  ck_assert(hard <= hard_bound);
}

START_TEST(uniform_stress_passes_an_interface) {
  expect_evenness(_i ? "unstructured" : "cubes", _i ? &UNSTRUCTURED : &CUBES, 5e-3, 5e-4);
}
END_TEST

// Every vertex moved by up to a fifth of a cell, those of a side within it.
START_TEST(uniform_stress_passes_between_jittered_meshes) {
  static const double SIZE[3] = {0.1, 0.1, 0.05};
  static const int CELLS[3] = {4, 4, 2};
  char path[] = "/tmp/tetlap_jittered_XXXXXX.mesh", mesh_key[64];
  int file = mkstemps(path, 5);
  ck_assert_int_ge(file, 0);
  close(file);
  FemMesh mesh;
  Random random = random_seeded(9, 0);
  ck_assert_ok(fem_mesh_box(&mesh, SIZE, CELLS));
  for (int v = 0; v < mesh.vertex_count; v++) curved_move(SIZE, CELLS, 0.2, &random, mesh.rest + 3 * v);
  medit_write(&mesh, path);
  fem_mesh_destroy(&mesh);
  snprintf(mesh_key, sizeof mesh_key, "file: %s", path);
  Patch patch = {"linear", mesh_key, "", "[5, 5, 3]"};
  expect_evenness("jittered", &patch, 5e-3, 5e-4);
  unlink(path);
}
END_TEST

START_TEST(uniform_stress_passes_between_quadratic_elements) {
  static const Patch PATCHES[] = {
      {"quadratic", "box: {size: [0.1, 0.1, 0.05], cells: [2, 2, 1]}", "", "[3, 3, 2]"},
      {"quadratic", "box: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}", "", "[5, 5, 3]"}};
  expect_evenness(_i ? "quadratic, finer" : "quadratic", &PATCHES[_i], 1e-2, 1e-3);
}
END_TEST

// Nodes on edges moved by up to 5 % of a cell, those in the interface within it. Alone, without contact, such
// elements are off by 1e-3: they integrate at four points.
START_TEST(uniform_stress_passes_between_curved_elements) {
  char path[] = "/tmp/tetlap_curved_XXXXXX.vtk", mesh_key[64];
  int file = mkstemps(path, 4), is_finer = _i;
  ck_assert_int_ge(file, 0);
  close(file);
  FemMesh mesh;
  curved_box(&mesh, (double[]){0.1, 0.1, 0.05}, is_finer ? (int[]){4, 4, 2} : (int[]){2, 2, 1}, 0.05, 1);
  curved_write(&mesh, path);
  fem_mesh_destroy(&mesh);
  snprintf(mesh_key, sizeof mesh_key, "file: %s", path);
  Patch patch = {"quadratic", mesh_key, "", is_finer ? "[5, 5, 3]" : "[3, 3, 2]"};
  expect_evenness(is_finer ? "curved, finer" : "curved", &patch, 1e-2, 3e-3);
  unlink(path);
}
END_TEST

// ---- At rest, with the default tolerance.

START_TEST(what_stands_weighs_m_g) {
  static const double MODULI[] = {1e5, 1e6, 1e7, 1e8, 1e9};
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 2}\n"
           "effects: {gravity: [0, 0, -9.81], damping: 4e-3}\n"
           "bodies:\n"
           "  - name: cube\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
           "    material: {young: %g, poisson: 0.3, density: 1000}\n"
           "obstacles: [{name: floor, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
           "contact: {potential: field, overlap: clip}\n"
           "output: {frames: 20}\n",
           MODULI[_i]);
  SceneRun run;
  open_text(&run, text);
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  for (int frame = 13; frame <= 20; frame++) ck_assert_near(scene_force(&run, frame, 0)[2] / 9.81, 1, 1e-3);
  scene_close(&run);
}
END_TEST

// ---- A press of 1 %, ends glued, in plane strain: the pressure is uneven, and converges.

static const char PRESS[] =
    "time: {end: 1, static: true}\n"
    "bodies:\n"
    "  - name: lower\n"
    "    mesh: {box: {size: [0.1, %g, 0.1], cells: [%d, 1, %d]}}\n"
    "    material: {law: linear, young: 1e6, poisson: 0.3, density: 1000}\n"
    "    fixed: [{group: z_min}, {box: {min: [-1, -1, 1e-9], max: [1, 1, 1]}, components: [y]}]\n"
    "    inner_faces: [{group: y_min}, {group: y_max}]\n"
    "  - name: upper\n"
    "    mesh: {box: {size: [0.1, %g, 0.1], cells: [%d, 1, %d]}}\n"
    "    place: {translate: [0, 0, 0.1]}\n"
    "    material: {law: linear, young: 1e6, poisson: 0.3, density: 1000}\n"
    "    fixed: [{box: {min: [-1, -1, -1], max: [1, 1, 0.1999999]}, components: [y]}]\n"
    "    inner_faces: [{group: y_min}, {group: y_max}]\n"
    "    driven: [{group: z_max, velocity: [0, 0, -0.002]}]\n"
    "contact: {potential: field, overlap: clip}\n"
    "output: {frames: 1}\n";

enum { SAMPLES = 61 };

// Pressures of the upper block's lower side, means over y, by x.
typedef struct Line {
  const FemModel *model;
  int cells;
  double *pressures, *depths;
  double by_x[65];
} Line;

static Status look_at_line(void *self, const FemRunProgress *progress) {
  Line *line = self;
  ContactSystem *contact =
      fem_effect_contact_system(fem_system_effect(progress->system, &fem_effect_contact));
  const FemModelBody *upper = &line->model->bodies[1];
  const ContactEvaluation *evaluation;
  ck_assert_ok(fem_effect_contact_evaluate(progress->system, &progress->system->accepted, &evaluation));
  ck_assert_ok(
      contact_system_trace(contact, evaluation, NULL,
                           &(ContactTraceResult){.pressures = line->pressures, .depths = line->depths}));
  memset(line->by_x, 0, sizeof line->by_x);
  for (int v = upper->vertex_begin; v < upper->vertex_end; v++)
    if (fabs(line->model->rest[3 * v + 2] - 0.1) < 1e-9)
      line->by_x[lround(line->model->rest[3 * v] * line->cells / 0.1)] += 0.5 * line->pressures[v];
  return STATUS_OK;
}

// At points from 0.02 to 0.08 m: a band of 0.02 m at the rim is left out.
static void press_line(int cells, double samples[SAMPLES]) {
  int upper_cells = 5 * cells / 4;
  char text[2048];
  snprintf(text, sizeof text, PRESS, 0.1 / cells, cells, cells, 0.1 / cells, upper_cells, upper_cells);
  SceneRun run;
  open_text(&run, text);
  Line line = {.model = &run.model, .cells = upper_cells};
  line.pressures = calloc((size_t)run.model.vertex_count, sizeof(double));
  line.depths = calloc((size_t)run.model.vertex_count, sizeof(double));
  ck_assert(line.pressures && line.depths);
  FemRunOptions options = {.observe = look_at_line, .observer = &line};
  ck_assert_ok(fem_run(&run.model, &options, &run.result));
  for (int k = 0; k < SAMPLES; k++) {
    double at = (0.02 + 0.06 * k / (SAMPLES - 1)) * upper_cells / 0.1;
    int left = (int)at;
    samples[k] = line.by_x[left] + (at - left) * (line.by_x[left + 1] - line.by_x[left]);
  }
  free(line.pressures), free(line.depths);
  scene_close(&run);
}

static double difference(const double a[SAMPLES], const double b[SAMPLES]) {
  double sum = 0;
  for (int k = 0; k < SAMPLES; k++) sum += (a[k] - b[k]) * (a[k] - b[k]) / SAMPLES;
  return sqrt(sum);
}

START_TEST(pressure_converges_in_the_mean_square) {
  double lines[4][SAMPLES], apart[3], mean = 0;
  for (int k = 0; k < 4; k++) press_line(4 << k, lines[k]);
  for (int k = 0; k < SAMPLES; k++) mean += lines[3][k] / SAMPLES;
  for (int k = 0; k < 3; k++) apart[k] = difference(lines[k], lines[k + 1]) / mean;
  printf("press of 1 %%: pressure at h, h/2, h/4 against half of each %.2e, %.2e, %.2e: orders %.2f, %.2f\n",
         apart[0], apart[1], apart[2], log2(apart[0] / apart[1]), log2(apart[1] / apart[2]));
  ck_assert(apart[0] > 1e-4); // uneven indeed
  ck_assert(log2(apart[0] / apart[1]) >= 0.9);
  ck_assert(log2(apart[1] / apart[2]) >= 0.9);
}
END_TEST

// ---- What holds between some two in place of what holds for all.

static const char TWO_CUBES[] =
    "time: {%s}\n"
    "effects: {gravity: [%g, 0, -9.81], damping: 2e-3}\n"
    "bodies:\n"
    "  - name: one\n"
    "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
    "    material: {law: linear, young: 1e6, poisson: 0, density: 1000}\n"
    "    %s\n"
    "  - name: two\n"
    "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
    "    place: {translate: [0, 1, 0]}\n"
    "    material: {law: linear, young: 1e6, poisson: 0, density: 1000}\n"
    "    %s\n"
    "obstacles: [{name: floor, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
    "contact: {potential: field, stiffness: 1e7, friction: %g, pairs: [{bodies: [%s], %s}]}\n"
    "output: {frames: 4}\n";

// p = c d under m g, with what was given to that pair in either order of names.
START_TEST(a_pair_has_its_own_stiffness) {
  static const char HELD[] = "fixed: [{box: {min: [-9, -9, -9], max: [9, 9, 9]}, components: [x, y]}]";
  char text[2048];
  snprintf(text, sizeof text, TWO_CUBES, "end: 1, static: true", 0.0, HELD, HELD, 0.0,
           _i ? "floor, two" : "two, floor", "stiffness: 1e8");
  SceneRun run;
  open_text(&run, text);
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  for (int b = 0; b < 2; b++) {
    double sum = 0, pressure = 1000 * 9.81 * 0.1;
    int count = 0;
    for (int v = run.model.bodies[b].vertex_begin; v < run.model.bodies[b].vertex_end; v++) {
      if (run.model.rest[3 * v + 2] != 0) continue;
      sum += scene_position(&run, 4, v)[2], count++;
    }
    ck_assert_int_eq(count, 9);
    ck_assert_near(-sum / count, pressure / (b ? 1e8 : 1e7), 0.02 * pressure / (b ? 1e8 : 1e7));
  }
  scene_close(&run);
}
END_TEST

// One sticks by the scene's μ, the other slides as its own says.
START_TEST(a_pair_has_its_own_friction) {
  double end = 0.2, pull = 2;
  char text[2048];
  snprintf(text, sizeof text, TWO_CUBES, "end: 0.2", pull, "", "", 0.5, "two, floor", "friction: 0");
  SceneRun run;
  open_text(&run, text);
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  for (int b = 0; b < 2; b++) {
    double way = 0;
    const FemModelBody *body = &run.model.bodies[b];
    for (int v = body->vertex_begin; v < body->vertex_end; v++)
      way += run.model.mass[v] / body->mass * (scene_position(&run, 4, v)[0] - run.model.rest[3 * v]);
    if (b == 0) ck_assert(fabs(way) < 1e-3);
    if (b == 1) ck_assert_near(way, 0.5 * pull * end * end, 0.01 * way);
  }
  // The one without friction slides on the floor, not above it: it presses with its weight and drags with
  // nothing.
  int floor = 0;
  while (!strstr(run.result.trajectory.interface_names[floor], "two, floor")) floor++;
  double weight = 9.81 * run.model.bodies[1].mass;
  const double *force = scene_force(&run, 4, floor);
  ck_assert_near(fabs(force[2]), weight, 0.1 * weight); // it still bounces a little
  ck_assert_near(force[0], 0, 1e-9 * weight);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("field_theory");
  tcase_add_loop_test(tests, uniform_stress_passes_an_interface, 0, 2);
  tcase_add_test(tests, uniform_stress_passes_between_jittered_meshes);
  tcase_add_loop_test(tests, uniform_stress_passes_between_quadratic_elements, 0, 2);
  tcase_add_loop_test(tests, uniform_stress_passes_between_curved_elements, 0, 2);
  tcase_add_loop_test(tests, what_stands_weighs_m_g, 0, 5);
  tcase_add_test(tests, pressure_converges_in_the_mean_square);
  tcase_add_loop_test(tests, a_pair_has_its_own_stiffness, 0, 2);
  tcase_add_test(tests, a_pair_has_its_own_friction);
  return suite_run("field_theory", tests, 120);
}
