// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of several materials: which element is of which, and what they do together.
#include "fem/model/parts.h"

#include <string.h>

#include "base/memory.h"
#include "fem/model/compliance/compliance.h"
#include "scene.h"
#include "static_solve.h"

// Of the corners at x_max in the mean [m].
static double pulled_by(const SceneRun *run) {
  double sum = 0;
  int count = 0;
  for (int v = 0; v < run->model.vertex_count; v++)
    if (run->model.rest[3 * v] > 0.3 - 1e-9) sum += scene_position(run, 1, v)[0] - 0.3, count++;
  return sum / count;
}

static const char *const elements[] = {"bodies.bar.element=linear", "bodies.bar.element=nodal",
                                       "bodies.bar.element=quadratic"};
enum { ELEMENTS = sizeof elements / sizeof *elements };

// p (l₁/E₁ + l₂/E₂); ν = 0, so that the parts do not hold each other at the sides.
START_TEST(two_materials_one_behind_the_other_are_springs_in_series) {
  SceneRun run;
  scene_run(&run, "layers", (const char *const[]){elements[_i], NULL});
  ck_assert_near(pulled_by(&run), 1000 * (0.2 / 1e6 + 0.1 / 4e6), 1e-9 * 2.25e-4);
  scene_close(&run);
}
END_TEST

// With one ν of both they strain alike side by side: p = (A₁ E₁ + A₂ E₂) ε / A.
START_TEST(two_materials_side_by_side_are_springs_in_parallel) {
  SceneRun run;
  scene_run(&run, "layers",
            (const char *const[]){
                elements[_i], "bodies.bar.material.poisson=0.3", "bodies.bar.materials[0].poisson=0.3",
                "bodies.bar.materials[0].box={min: [0, 0, 0.05], max: [1, 1, 1]}", "bodies.bar.loads=null",
                "bodies.bar.driven=[{group: x_max, components: [x], velocity: [3e-4, 0, 0]}]", NULL});
  // Work on the same strain in both: ½ ε² (V₁ E₁ + V₂ E₂), ε = 1e-3.
  ck_assert_near(run.result.energy.audit.work, 0.5e-6 * 1.5e-3 * 5e6, 1e-9 * 3.75e-3);
  scene_close(&run);
}
END_TEST

START_TEST(masses_are_those_of_the_materials) {
  SceneRun run;
  scene_open(&run, "layers", (const char *const[]){elements[_i], NULL});
  const FemModel *model = &run.model;
  ck_assert_int_eq(model->part_count, 2);
  ck_assert_near(model->parts[0].mass, 2e-3 * 1000, 1e-12 * 2);
  ck_assert_near(model->parts[1].mass, 1e-3 * 2500, 1e-12 * 2.5);
  ck_assert_near(model->bodies[0].mass, 4.5, 1e-12 * 4.5);
  ck_assert_near(fem_model_parts_volume(model, 0), 3e-3, 1e-12 * 3e-3);
  ck_assert_near(model->parts[0].skin, 0.2 * 0.4 + 0.01, 1e-12);
  ck_assert_near(model->parts[1].skin, 0.1 * 0.4 + 0.01, 1e-12);
  double sum = 0, *volumes = memory_zeroed((size_t)model->vertex_count, sizeof *volumes);
  fem_model_parts_spread(model, 1, volumes);
  for (int v = 0; v < model->vertex_count; v++) {
    sum += volumes[v];
    if (model->rest[3 * v] < 0.2 - 1e-9) ck_assert(volumes[v] == 0);
  }
  ck_assert_near(sum, 1e-3, 1e-12 * 1e-3);
  memory_free(volumes);
  scene_close(&run);
}
END_TEST

// The same material in all entries is that material: to rounding, for θ of nodal elements is even here.
START_TEST(one_material_given_twice_is_one_material) {
  double ways[2];
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    scene_run(&run, "layers",
              (const char *const[]){elements[_i],
                                    "bodies.bar.material={young: 1e6, poisson: 0.4, density: 1}",
                                    k ? "bodies.bar.materials[0]={box: {min: [0.2, 0, 0], max: [1, 1, 1]}, "
                                        "young: 1e6, poisson: 0.4, density: 1}"
                                      : "bodies.bar.materials=null",
                                    NULL});
    ways[k] = pulled_by(&run);
    scene_close(&run);
  }
  ck_assert_near(ways[1], ways[0], 1e-9 * ways[0]);
}
END_TEST

// A bar of rubber with a stiff damped head that yields falls on the ground: gains nothing, and the head alone
// has points that may yield.
START_TEST(a_bar_of_two_laws_keeps_its_energy_in_motion) {
  SceneRun run;
  scene_run(&run, "layers",
            (const char *const[]){
                "time={end: 0.06}", "bodies.bar.loads=null", "bodies.bar.fixed=null",
                "bodies.bar.velocity=[0, 0, -2]", "effects.gravity=[0, 0, -9.81]",
                "bodies.bar.material={law: neo_hookean, young: 3e5, poisson: 0.4, density: 1000}",
                "bodies.bar.materials[0]={box: {min: [0.2, 0, 0], max: [1, 1, 1]}, law: stvk, young: 2e6, "
                "poisson: 0.3, density: 2500, damping: 1e-4, plasticity: {yield: 2e4}}",
                "obstacles=[{name: ground, halfspace: {point: [0, 0, -0.002], normal: [0, 0, 1]}}]",
                "contact={}", NULL});
  ck_assert_double_gt(run.result.contact.overlap_volume_max, 0);
  ck_assert_double_lt(scene_gain(&run), 1e-3);
  ck_assert_double_gt(record_find_number(run.result.counters, "plastic_strain_max"), 0);
  ck_assert_double_gt(run.result.energy.audit.damped, 0);
  scene_close(&run);
}
END_TEST

static double chosen_stiffness(const char *material, const char *materials) {
  SceneRun run;
  FemCompliance choice;
  scene_open(&run, "layers",
             (const char *const[]){
                 "contact={}", material, materials,
                 "obstacles=[{name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]", NULL});
  ck_assert_ok(fem_compliance_choose(&run.model, &choice));
  double stiffness = choice.stiffness[1];
  fem_compliance_destroy(&choice);
  scene_close(&run);
  return stiffness;
}

// A soft coat does not make a stiff body's contact soft, and a stiff skin makes a soft body's stiff.
START_TEST(contact_is_as_stiff_as_the_skin_and_as_the_whole) {
  const char *soft = "bodies.bar.material={young: 1e6, poisson: 0, density: 1000}",
             *stiff = "bodies.bar.material={young: 1e8, poisson: 0, density: 1000}",
             *none = "bodies.bar.materials=null",
             *coat =
                 "bodies.bar.materials=[{halfspace: {point: [0, 0, 0.05], normal: [0, 0, 1]}, young: 1e6, "
                 "poisson: 0, density: 1000}]",
             *skin =
                 "bodies.bar.materials=[{halfspace: {point: [0, 0, 0.05], normal: [0, 0, 1]}, young: 1e8, "
                 "poisson: 0, density: 1000}]";
  double low = chosen_stiffness(soft, none), high = chosen_stiffness(stiff, none);
  ck_assert_near(high, 100 * low, 1e-9 * high);
  double coated = chosen_stiffness(stiff, coat), skinned = chosen_stiffness(soft, skin);
  ck_assert_double_gt(coated, 1.5 * low);
  ck_assert_double_lt(coated, high);
  ck_assert_double_gt(skinned, 1.5 * low);
  ck_assert_double_lt(skinned, high);
}
END_TEST

static const struct Wrong {
  const char *override, *message;
} wrong[] = {
    {"bodies.bar.materials[0].box={min: [1, 1, 1], max: [2, 2, 2]}",
     "body 'bar', materials[0]: the selection holds no tetrahedron's middle; in the scene the mesh lies in "
     "[0"},
    {"bodies.bar.materials=[{group: core, young: 1, poisson: 0, density: 1}]",
     "body 'bar', materials[0]: the mesh has no group 'core'; no group of it has tetrahedra: select by box"},
    {"bodies.bar.materials=[{group: x_max, young: 1, poisson: 0, density: 1}]",
     "the mesh has no group 'x_max' of tetrahedra, only one of vertices; no group of it has tetrahedra"},
    {"bodies.bar.materials=[{box: {min: [0, 0, 0], max: [0.15, 1, 1]}, young: 1, poisson: 0, density: 1}, "
     "{box: "
     "{min: [0.1, 0, 0], max: [1, 1, 1]}, young: 2, poisson: 0, density: 1}]",
     "body 'bar', materials[1]: tetrahedron 12 is in materials[0], too: let selections not overlap"},
    {"bodies.bar.material=null", "body 'bar': 96 of 144 tetrahedra are in none of its materials"},
};

START_TEST(what_is_no_part_is_refused) {
  char path[512];
  snprintf(path, sizeof path, "%s/tests/scenes/layers.yaml", TETLAP_SOURCE_DIR);
  const char *overrides[] = {wrong[_i].override};
  FemSceneDef scene = {0};
  FemModel model;
  ck_assert_ok(app_scene_read(path, overrides, 1, &scene));
  ck_assert_int_eq(fem_model_create(&model, &scene), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), wrong[_i].message) != NULL, "%s", status_message());
  fem_scene_destroy(&scene);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("parts");
  tcase_add_loop_test(cases, two_materials_one_behind_the_other_are_springs_in_series, 0, ELEMENTS);
  tcase_add_loop_test(cases, two_materials_side_by_side_are_springs_in_parallel, 0, ELEMENTS);
  tcase_add_loop_test(cases, masses_are_those_of_the_materials, 0, ELEMENTS);
  tcase_add_loop_test(cases, one_material_given_twice_is_one_material, 0, ELEMENTS);
  tcase_add_test(cases, a_bar_of_two_laws_keeps_its_energy_in_motion);
  tcase_add_test(cases, contact_is_as_stiff_as_the_skin_and_as_the_whole);
  tcase_add_loop_test(cases, what_is_no_part_is_refused, 0, sizeof wrong / sizeof *wrong);
  return suite_run("parts", cases, 60);
}
