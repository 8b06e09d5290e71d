// SPDX-License-Identifier: GPL-3.0-or-later
// Probes: what they read is what a hand computes.
#include "scene.h"

#include <string.h>

#include "fem/measure/reading.h"

// Of the summary, the probe of that place.
static double read_last(const SceneRun *run, int probe, const char *key) {
  const Record *one = record_at(record_find(run->result.account.record, "probes"), probe);
  ck_assert_ptr_nonnull(one);
  return record_find_number(record_find(one, "last"), key);
}

// Two blocks, 0.1 × 0.1 m², pressed by 1000 Pa: 10 N through every face, also where they touch.
START_TEST(fixed_touching_and_loaded_faces_read_the_same_press) {
  SceneRun run;
  scene_run(&run, "patch",
            (const char *const[]){
                "bodies.lower.probes=[{name: floor, group: z_min}, {name: seam, group: z_max}]",
                "bodies.upper.probes=[{name: sole, group: z_min}, {name: top, group: z_max}]", NULL});
  const double signs[] = {1, -1, 1, -1};
  for (int p = 0; p < 4; p++) {
    // Where two touch, the share depth over element acts on the vertices behind the face.
    ck_assert_near(read_last(&run, p, "force_z_N"), 10 * signs[p], p == 1 || p == 2 ? 0.02 : 1e-4);
    ck_assert_near(read_last(&run, p, "pressure_Pa"), 1000, 5);
    ck_assert_near(read_last(&run, p, "area_m2"), 0.01, 0.01 * 0.01);
    ck_assert_near(read_last(&run, p, "moment_x_Nm"), 0, 1e-2);
  }
  // By 0.1 % each and what the interface gives: 0.1 mm and p / (2 c) = 0.025 mm.
  ck_assert_near(read_last(&run, 3, "displacement_z_m"), -1.25e-4, 2e-6);
  ck_assert_near(read_last(&run, 0, "displacement_z_m"), 0, 1e-12);
  scene_close(&run);
}
END_TEST

// A beam held at one end by its weight's moment M g L/2, about the mean place of the fixed vertices.
START_TEST(a_clamp_reads_the_moment_of_what_hangs_on_it) {
  SceneRun run;
  scene_run(&run, "free_fall",
            (const char *const[]){"bodies.block.fixed=[{group: x_min}]", "bodies.block.velocity=[0, 0, 0]",
                                  "bodies.block.probes=[{name: clamp, group: x_min}]", "time.static=true",
                                  "bodies.block.material={young: 1e9, poisson: 0.3, density: 1000}", NULL});
  ck_assert_near(read_last(&run, 0, "force_z_N"), 9.81 * 8, 1e-3);
  ck_assert_near(read_last(&run, 0, "moment_y_Nm"), -9.81 * 8 * 0.1, 1e-3);
  scene_close(&run);
}
END_TEST

START_TEST(the_summary_has_the_peak_and_when) {
  SceneRun run;
  scene_run(&run, "drop",
            (const char *const[]){"bodies.block.probes=[{name: sole, group: z_min}]", "time.end=0.15", NULL});
  const Record *one = record_at(record_find(run.result.account.record, "probes"), 0);
  // All the contact there is presses on this face, but for the share of depth over element.
  ck_assert_near(record_find_number(one, "force_max_N"), run.result.contact.force_max,
                 1e-2 * run.result.contact.force_max);
  double time = record_find_number(one, "force_max_time");
  ck_assert(time > 0.1 && time < 0.15); // it falls 5 cm in 0.101 s
  scene_close(&run);
}
END_TEST

START_TEST(a_probe_without_vertices_is_refused_with_its_place) {
  FemSceneDef scene;
  FemModel model;
  const char *const overrides[] = {
      "bodies.block.probes=[{name: nowhere, box: {min: [5, 5, 5], max: [6, 6, 6]}}]"};
  ck_assert_ok(app_scene_read(TETLAP_SOURCE_DIR "/tests/scenes/drop.yaml", overrides, 1, &scene));
  ck_assert_int_eq(fem_model_create(&model, &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "probe 'nowhere'"));
  fem_scene_destroy(&scene);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("probe");
  tcase_add_test(cases, fixed_touching_and_loaded_faces_read_the_same_press);
  tcase_add_test(cases, a_clamp_reads_the_moment_of_what_hangs_on_it);
  tcase_add_test(cases, the_summary_has_the_peak_and_when);
  tcase_add_test(cases, a_probe_without_vertices_is_refused_with_its_place);
  return suite_run("probe", cases, 60);
}
