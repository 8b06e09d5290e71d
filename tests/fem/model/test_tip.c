// SPDX-License-Identifier: GPL-3.0-or-later
// The tips of bodies, and the contact stiffness that is chosen for them.
#include "fem/model/compliance/tip.h"

#include <math.h>
#include <stdlib.h>

#include "fem/mesh/mesh.h"
#include "fem/model/compliance/compliance.h"
#include "folder.h"
#include "medit.h"
#include "scene.h"

static const double RADIUS = 0.05, HEIGHT = 0.1, YOUNG = 1e6;

static double volume_of(const FemMesh *mesh, const int tet[4]) {
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = vec3_at(mesh->rest + 3 * (size_t)tet[v]);
  return vec3_det4(x[0], x[1], x[2], x[3]);
}

static void add_tet(FemMesh *mesh, int a, int b, int c, int d) {
  int *tet = mesh->tets[mesh->tet_count++], kept;
  memcpy(tet, (int[]){a, b, c, d}, 4 * sizeof(int));
  if (volume_of(mesh, tet) > 0) return;
  kept = tet[1], tet[1] = tet[2], tet[2] = kept;
}

// Layers of `round` prisms about the axis, three tetrahedra each, on the tip.
static void write_cone(const char *path, int round, int layers, double radius) {
  int vertices = 1 + layers * (round + 1), tets = round * (1 + 3 * (layers - 1));
  FemMesh mesh = {.rest = calloc(3 * (size_t)vertices, sizeof(double)),
                  .tets = calloc((size_t)tets, sizeof(int[4])),
                  .vertex_count = vertices};
  ck_assert(mesh.rest && mesh.tets);
  for (int k = 1; k <= layers; k++)
    for (int i = -1; i < round; i++) {
      double share = (double)k / layers, from = i < 0 ? 0 : share * radius, angle = 2 * M_PI * i / round;
      double place[3] = {from * cos(angle), from * sin(angle), share * HEIGHT};
      memcpy(mesh.rest + 3 * (size_t)(2 + i + (k - 1) * (round + 1)), place, sizeof place);
    }
  for (int k = 0; k < layers; k++)
    for (int i = 0; i < round; i++) {
      int next = (i + 1) % round, low = i < next ? i : next, high = i < next ? next : i;
      int at = 1 + k * (round + 1), to[3] = {at, at + 1 + low, at + 1 + high}, down = round + 1;
      if (k == 0) {
        add_tet(&mesh, 0, to[0], to[1], to[2]);
        continue;
      }
      add_tet(&mesh, to[0] - down, to[1] - down, to[2] - down, to[2]);
      add_tet(&mesh, to[0] - down, to[1] - down, to[1], to[2]);
      add_tet(&mesh, to[0] - down, to[0], to[1], to[2]);
    }
  ck_assert_int_eq(mesh.tet_count, tets);
  medit_write(&mesh, path);
  free(mesh.rest), free(mesh.tets);
}

// Opens tests/scenes/cone.yaml with such a mesh; `others` ends with NULL.
static void open_cone(SceneRun *run, int round, int layers, double radius, const char *const *others) {
  char path[128], mesh[160];
  const char *sets[8] = {mesh};
  snprintf(path, sizeof path, "%s/cone.mesh", folder);
  snprintf(mesh, sizeof mesh, "bodies.cone.mesh={file: %s}", path);
  write_cone(path, round, layers, radius);
  for (int k = 0; others && others[k]; k++) sets[1 + k] = others[k];
  scene_open(run, "cone", sets);
}

static FemTip find(const SceneRun *run, int body) {
  FemTip tip;
  ck_assert_ok(fem_tip_find(&run->model, body, &tip));
  return tip;
}

// A pyramid whose base has the side 2 b fills 4 asin(b²/(b² + h²)).
START_TEST(a_tip_is_as_narrow_as_what_fills_it) {
  SceneRun run;
  open_cone(&run, 4, 8, RADIUS, NULL);
  FemTip tip = find(&run, 1);
  double half = RADIUS / sqrt(2), angle = 4 * asin(half * half / (half * half + HEIGHT * HEIGHT));
  double cosine = 1 - angle / (2 * M_PI);
  ck_assert_near(tip.slope, cosine / sqrt(1 - cosine * cosine), 1e-9);
  ck_assert_near(tip.reach, hypot(RADIUS, HEIGHT) / 8, 1e-9);
  scene_close(&run);
}
END_TEST

START_TEST(the_more_sides_the_nearer_to_a_round_cone) {
  SceneRun run;
  open_cone(&run, 40, 8, RADIUS, NULL);
  ck_assert_near(find(&run, 1).slope, HEIGHT / RADIUS, 0.01 * HEIGHT / RADIUS);
  scene_close(&run);
}
END_TEST

// Nor has a tip that is as large as its body, or as wide as a cube's corner in any direction.
START_TEST(boxes_and_balls_and_what_is_held_have_no_tip) {
  SceneRun run;
  open_cone(&run, 16, 8, RADIUS, (const char *const[]){"bodies.plate.place={scale: 0.9}", NULL});
  ck_assert(find(&run, 0).slope == 0);
  ck_assert(find(&run, 1).slope > 0);
  scene_close(&run);
  open_cone(
      &run, 16, 8, RADIUS,
      (const char *const[]){"bodies.cone.fixed=[{radius: {centre: [0.003, 0.002, 0.01], max: 1e-3}}]", NULL});
  ck_assert(find(&run, 1).slope == 0);
  scene_close(&run);
  open_cone(&run, 16, 3, RADIUS, NULL);
  ck_assert(find(&run, 1).slope == 0);
  scene_close(&run);
  open_cone(&run, 16, 8, 2 * HEIGHT, NULL);
  ck_assert(find(&run, 1).slope == 0);
  scene_close(&run);
  open_cone(&run, 16, 8, 1.3 * HEIGHT, (const char *const[]){"bodies.cone.place.scale=[1, 0.3, 1]", NULL});
  ck_assert(find(&run, 1).slope == 0);
  scene_close(&run);
  scene_open(&run, "bowl", NULL);
  for (int b = 0; b < run.model.body_count; b++) ck_assert(find(&run, b).slope == 0);
  scene_close(&run);
}
END_TEST

static double chosen(const SceneRun *run, int a, int b, FemComplianceBound bound) {
  FemCompliance choice;
  ck_assert_ok(fem_compliance_choose(&run->model, &choice));
  int k = a * choice.party_count + b;
  double value = choice.stiffness[k];
  ck_assert_int_eq(choice.bounds[k], bound);
  ck_assert_double_eq(choice.stiffness[b * choice.party_count + a], value);
  for (int c = 0; c < run->model.body_count; c++) ck_assert_int_eq(choice.levels[c], 0);
  fem_compliance_destroy(&choice);
  return value;
}

// c = 1.5 E* cot β/(.2 h), E* of the elements that a plate has under the tip.
START_TEST(a_tip_gives_way_before_a_fifth_of_its_elements_is_covered) {
  static const char *const CELLS[] = {"bodies.plate.mesh.box.cells=[30, 30, 6]",
                                      "bodies.plate.mesh.box.cells=[3, 3, 1]"};
  double stiff = YOUNG / (1 - 3.5 * pow(0.3, 4)), edge = 0.15 / 3;
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    open_cone(&run, 16, 8, RADIUS, (const char *const[]){CELLS[k], NULL});
    FemTip tip = find(&run, 1);
    double share = k == 0 ? 1 : pow(tip.reach / edge, 2);
    double expected = 1.5 * tip.slope * stiff / (1 + share) / (0.2 * tip.reach);
    ck_assert_near(chosen(&run, 0, 1, FEM_COMPLIANCE_TIP), expected, (k == 0 ? 1e-9 : 0.2) * expected);
    scene_close(&run);
  }
}
END_TEST

// Coarse cones, whose tips are as large as they are, keep the stiffness of their height.
START_TEST(a_tip_as_large_as_its_body_says_nothing) {
  SceneRun run;
  open_cone(&run, 6, 3, RADIUS, (const char *const[]){"bodies.cone.velocity=[0, 0, 0]", NULL});
  chosen(&run, 0, 1, FEM_COMPLIANCE_BODIES);
  scene_close(&run);
}
END_TEST

static void expect_sound(SceneRun *run) {
  scene_run_from(run, NULL);
  ck_assert_str_eq(fem_run_outcome(&run->result, run->status), "finished");
  ck_assert_double_gt(run->result.contact.force_max, 50);
  ck_assert_double_lt(run->result.contact.deepest_overlap_max, 0.4);
  const FemTroubleKind kinds[] = {FEM_TROUBLE_INVERTED, FEM_TROUBLE_ENCLOSED, FEM_TROUBLE_WRONG_WAY,
                                  FEM_TROUBLE_ENERGY, FEM_TROUBLE_PASSED};
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    ck_assert_int_eq((int)run->result.trouble.of[kinds[k]].steps, 0);
}

START_TEST(a_cone_on_a_plate_is_not_enclosed) {
  SceneRun run;
  open_cone(&run, 16, 8, RADIUS, NULL);
  expect_sound(&run);
  scene_close(&run);
}
END_TEST

// The upper one topples, so its tip slides off.
START_TEST(cones_that_meet_tip_on_tip_are_not_enclosed) {
  SceneRun run;
  char lower[200];
  snprintf(lower, sizeof lower, "bodies.plate.mesh={file: %s/cone.mesh}", folder);
  open_cone(
      &run, 16, 10, RADIUS,
      (const char *const[]){lower, "bodies.plate.place={rotate: {axis: [1, 0, 0], degrees: 180}}",
                            "bodies.plate.fixed=[{halfspace: {point: [0, 0, -0.0999], normal: [0, 0, 1]}}]",
                            "bodies.cone.place.translate=[0.0003, 0.0002, 0.01]", NULL});
  expect_sound(&run);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("tip");
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_test(cases, a_tip_is_as_narrow_as_what_fills_it);
  tcase_add_test(cases, the_more_sides_the_nearer_to_a_round_cone);
  tcase_add_test(cases, boxes_and_balls_and_what_is_held_have_no_tip);
  tcase_add_test(cases, a_tip_gives_way_before_a_fifth_of_its_elements_is_covered);
  tcase_add_test(cases, a_tip_as_large_as_its_body_says_nothing);
  tcase_add_test(cases, a_cone_on_a_plate_is_not_enclosed);
  tcase_add_test(cases, cones_that_meet_tip_on_tip_are_not_enclosed);
  return suite_run("tip", cases, 30);
}
