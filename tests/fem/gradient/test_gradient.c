// SPDX-License-Identifier: GPL-3.0-or-later
// Gradients of static scenes against central differences of whole runs, and what has none.
#include "fem/gradient/gradient.h"
#include "static_solve.h"

typedef struct Asked {
  FemQuantity quantity;
  const FemParameter *parameters;
  int count;
  FemGradient gradient;
  bool is_done;
} Asked;

static Status at_end(void *observer, const FemRunProgress *progress) {
  Asked *asked = observer;
  if (progress->time < progress->end) return STATUS_OK;
  fem_gradient_destroy(&asked->gradient);
  asked->is_done = true;
  return fem_gradient_find(&asked->gradient, progress->system, &asked->quantity, asked->parameters,
                           asked->count);
}

static Status run_text(const char *text, Asked *asked) {
  SceneRun run;
  scene_open_text(&run, text);
  FemRunOptions options = {.observe = at_end, .observer = asked};
  run.status = fem_run(&run.model, &options, &run.result);
  Status status = run.status;
  scene_close(&run);
  return status;
}

typedef struct Values {
  double young, density, gravity, stiffness;
} Values;

// Two blocks of unlike meshes, the lower one held, one upon the other.
static void write_blocks(const Values *values, char text[2048]) {
  snprintf(text, 2048,
           "time: {end: 1, static: true}\n"
           "output: {frames: 2}\n"
           "effects: {gravity: [0, 0, %.17g]}\n"
           "bodies:\n"
           "  - name: lower\n"
           "    mesh: {box: {size: [1, 1, 0.5], cells: [3, 3, 2]}}\n"
           "    material: {law: neo_hookean, young: %.17g, poisson: 0.3, density: 1000}\n"
           "    fixed: [{group: z_min}]\n"
           "  - name: upper\n"
           "    mesh: {box: {size: [0.61, 0.57, 0.4], cells: [2, 2, 2]}}\n"
           "    place: {translate: [0.17, 0.23, 0.499]}\n"
           "    material: {law: stvk, young: 3e5, poisson: 0.2, density: %.17g}\n"
           "    fixed: [{group: x_min, components: [x, y]}]\n"
           "contact: {stiffness: %.17g}\n",
           values->gravity, values->young, values->density, values->stiffness);
}

// A block on a round obstacle, nodal elements, an upright face held.
static void write_curved(const Values *values, char text[2048]) {
  snprintf(text, 2048,
           "time: {end: 1, static: true}\n"
           "output: {frames: 2}\n"
           "effects: {gravity: [0, 0, %.17g]}\n"
           "bodies:\n"
           "  - name: slab\n"
           "    element: nodal\n"
           "    mesh: {box: {size: [1, 0.6, 0.2], cells: [6, 4, 2]}}\n"
           "    place: {translate: [-0.37, -0.31, 0]}\n"
           "    material: {law: neo_hookean, young: %.17g, poisson: 0.4, density: %.17g}\n"
           "    fixed: [{group: x_min}]\n"
           "obstacles: [{name: ball, sphere: {centre: [0.1, 0, -0.49], radius: 0.5}}]\n"
           "contact: {stiffness: %.17g}\n",
           values->gravity, values->young, values->density, values->stiffness);
}

typedef void Scene(const Values *values, char text[2048]);

static double value_at(Scene *scene, const Values *values, FemQuantity quantity) {
  char text[2048];
  Asked asked = {.quantity = quantity};
  scene(values, text);
  ck_assert_ok(run_text(text, &asked));
  ck_assert(asked.is_done);
  double value = asked.gradient.value;
  fem_gradient_destroy(&asked.gradient);
  return value;
}

static void check_against_runs(Scene *scene, int loaded, FemQuantity quantity) {
  enum { COUNT = 4 };
  static const double SHARE = 1e-4;
  const FemParameter parameters[COUNT] = {{FEM_PARAMETER_YOUNG, 0, 0},
                                          {FEM_PARAMETER_DENSITY, loaded, 0},
                                          {FEM_PARAMETER_GRAVITY, 0, 2},
                                          {FEM_PARAMETER_CONTACT_STIFFNESS, 0, 0}};
  Values values = {1e5, 1500, -9.81, 4e6};
  double *const places[COUNT] = {&values.young, &values.density, &values.gravity, &values.stiffness};
  char text[2048];
  Asked asked = {.quantity = quantity, .parameters = parameters, .count = COUNT};
  scene(&values, text);
  ck_assert_ok(run_text(text, &asked));
  ck_assert(asked.is_done);
  ck_assert_double_le(asked.gradient.residual, 1e-10);
  ck_assert_double_le(asked.gradient.unbalanced, 1e-10);
  for (int p = 0; p < COUNT; p++) {
    double middle = *places[p];
    *places[p] = middle * (1 + SHARE);
    double above = value_at(scene, &values, quantity);
    *places[p] = middle * (1 - SHARE);
    double below = value_at(scene, &values, quantity);
    *places[p] = middle;
    double share = (above - below) / (2 * SHARE), found = asked.gradient.derivatives[p] * middle;
    printf("parameter %d: p dg/dp = %.12g, runs %.12g, g = %.6g, off by %.2g\n", p, found, share,
           asked.gradient.value, fabs(found / share - 1));
    ck_assert_double_gt(fabs(share), 1e-6 * fabs(asked.gradient.value));
    ck_assert_near(found, share, 1e-6 * fabs(asked.gradient.value));
  }
  fem_gradient_destroy(&asked.gradient);
}

START_TEST(two_blocks_agree_with_differences_of_runs) {
  check_against_runs(write_blocks, 1, (FemQuantity){.body = 1, .component = 2});
}
END_TEST

START_TEST(a_curved_contact_agrees_with_differences_of_runs) {
  check_against_runs(write_curved, 0, (FemQuantity){.body = 0, .component = 2});
}
END_TEST

static void expect_refusal(const char *text, FemParameter parameter, const char *why) {
  Asked asked = {.parameters = &parameter, .count = 1};
  Status status = run_text(text, &asked);
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), why) != NULL, "%s", status_message());
  fem_gradient_destroy(&asked.gradient);
}

static void expect_refused_block(const char *time, const char *material, const char *contact,
                                 FemParameter parameter, const char *why) {
  char text[1024];
  snprintf(text, sizeof text,
           "time: {%s}\n"
           "output: {frames: 1}\n"
           "bodies:\n"
           "  - name: block\n"
           "    mesh: {box: {size: [1, 1, 1], cells: 1}}\n"
           "    material: {young: 1e5, poisson: 0.3, density: 1000%s}\n"
           "    fixed: [{group: z_min}]\n"
           "%s",
           time, material, contact);
  expect_refusal(text, parameter, why);
}

START_TEST(what_has_no_gradient_is_refused_by_name) {
  const FemParameter young = {FEM_PARAMETER_YOUNG, 0, 0}, weight = {FEM_PARAMETER_GRAVITY, 0, 2};
  const FemParameter stiffness = {FEM_PARAMETER_CONTACT_STIFFNESS, 0, 0};
  const char *far = "obstacles: [{name: far, halfspace: {point: [0, 0, -9], normal: [0, 0, 1]}}]\n";
  char contact[512];
  expect_refused_block("end: 1e-3", "", "", young, "the scene moves");
  expect_refused_block("end: 1, static: true", "", "", weight, "no effects.gravity");
  expect_refused_block("end: 1, static: true", "", "", stiffness, "no contact");
  expect_refused_block("end: 1, static: true", ", law: stvk, plasticity: {yield: 1e3}", "", young, "yields");
  snprintf(contact, sizeof contact, "%scontact: {stiffness: 1e6, friction: 0.3}\n", far);
  expect_refused_block("end: 1, static: true", "", contact, young, "friction");
  snprintf(contact, sizeof contact, "%scontact: {}\n", far);
  expect_refused_block("end: 1, static: true", "", contact, stiffness, "chosen");
  expect_refused_block("end: 1, static: true", "", contact, young, "chosen");
  snprintf(contact, sizeof contact, "%scontact: {stiffness: 1e6, overlap: geo}\n", far);
  expect_refused_block("end: 1, static: true", "", contact, young, "clip");
}
END_TEST

START_TEST(the_command_prints_scaling_laws) {
  // Displacements stay the same where E and the interface's stiffness grow together.
  char command[2048], line[256];
  double young = NAN, stiffness = NAN;
  snprintf(command, sizeof command,
           "%s gradient %s/examples/26_hertz.yaml -q --of displacement:ground:z "
           "--by bodies.ground.material.young,contact.stiffness",
           TETLAP_PROGRAM, TETLAP_SOURCE_DIR);
  FILE *output = popen(command, "r");
  ck_assert_ptr_nonnull(output);
  while (fgets(line, sizeof line, output)) {
    if (strstr(line, "material.young ")) young = atof(line + strcspn(line, "P") + strlen("Pa"));
    if (strstr(line, "contact.stiffness ")) stiffness = atof(line + strcspn(line, "P") + strlen("Pa/m"));
  }
  ck_assert_int_eq(pclose(output), 0);
  ck_assert_double_gt(fabs(young), 0);
  ck_assert_near(young * 1e6 / (stiffness * 1.25e9), -1, 1e-2);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient");
  tcase_add_test(test_case, two_blocks_agree_with_differences_of_runs);
  tcase_add_test(test_case, a_curved_contact_agrees_with_differences_of_runs);
  tcase_add_test(test_case, what_has_no_gradient_is_refused_by_name);
  tcase_add_test(test_case, the_command_prints_scaling_laws);
  return suite_run("gradient", test_case, 120);
}
