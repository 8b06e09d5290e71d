// SPDX-License-Identifier: GPL-3.0-or-later
// Trouble that does not end a run is found, marked, counted and told.
#include "scene.h"

#include <string.h>

#include "fem/output/trouble.h"

typedef struct Looked {
  SceneRun run;
  FemTroubleWatch watch;
  double *force, det_F[2], overlap[2];
} Looked;

// Two tetrahedra (0: lower, 1: upper) without any trouble.
static void open_two(Looked *looked) {
  *looked = (Looked){.det_F = {1, 1}};
  scene_open(&looked->run, "single_tets", NULL);
  ck_assert_int_eq(looked->run.model.tet_count, 2);
  looked->force = calloc(24, sizeof *looked->force);
  ck_assert_ok(fem_trouble_watch_create(&looked->watch, &looked->run.model));
}

static FemTroubleState look(Looked *looked) {
  FemTroubleState state;
  fem_trouble_find(&looked->watch, looked->run.model.rest, looked->force, looked->det_F, looked->overlap,
                   &state);
  return state;
}

static void close_two(Looked *looked) {
  fem_trouble_watch_destroy(&looked->watch);
  free(looked->force);
  scene_close(&looked->run);
}

START_TEST(a_sound_state_has_no_trouble) {
  Looked looked;
  open_two(&looked);
  FemTroubleState state = look(&looked);
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) {
    ck_assert_int_eq(state.count[k], 0);
    ck_assert_int_eq(state.first[k], -1);
  }
  FemTrouble trouble = fem_trouble_begin(&looked.run.model);
  ck_assert_int_eq(trouble.sliver_count, 0);
  ck_assert_near(trouble.worst_shape, sqrt(0.5), 1e-12); // regular tetrahedra
  ck_assert(!fem_trouble_add(&trouble, 0, &state));
  close_two(&looked);
}
END_TEST

START_TEST(inverted_and_enclosed_elements_are_marked) {
  Looked looked;
  open_two(&looked);
  looked.det_F[1] = -0.5, looked.overlap[1] = 0.4; // of 0.5
  FemTroubleState state = look(&looked);
  ck_assert_int_eq(state.count[FEM_TROUBLE_INVERTED], 1);
  ck_assert_int_eq(state.first[FEM_TROUBLE_INVERTED], 1);
  ck_assert_int_eq(state.count[FEM_TROUBLE_ENCLOSED], 0);
  looked.overlap[1] = 0.5;
  state = look(&looked);
  ck_assert_int_eq(state.count[FEM_TROUBLE_ENCLOSED], 1);
  ck_assert_int_eq(looked.watch.marks[0], 0);
  ck_assert_int_eq(looked.watch.marks[1], FEM_TROUBLE_MARK_INVERTED | FEM_TROUBLE_MARK_ENCLOSED);
  looked.det_F[1] = NAN;
  ck_assert_int_eq(look(&looked).count[FEM_TROUBLE_INVERTED], 1);
  close_two(&looked);
}
END_TEST

// The lower tetrahedron's apex, vertex 3, has the outward normal +z.
START_TEST(a_contact_force_that_pulls_is_a_wrong_way_push) {
  Looked looked;
  open_two(&looked);
  double *apex = looked.force + 9, *corner = looked.force;
  apex[2] = -1;
  ck_assert_int_eq(look(&looked).count[FEM_TROUBLE_WRONG_WAY], 0);
  apex[2] = 1;
  looked.overlap[0] = 0.49 * looked.det_F[0]; // nothing is pierced
  ck_assert_int_eq(look(&looked).count[FEM_TROUBLE_WRONG_WAY], 0);
  looked.overlap[0] = 0.51 * looked.det_F[0];
  ck_assert_int_eq(look(&looked).count[FEM_TROUBLE_WRONG_WAY], 1);
  ck_assert_int_eq(look(&looked).first[FEM_TROUBLE_WRONG_WAY], 3);
  ck_assert_int_eq(looked.watch.is_wrongway[3], 1);
  apex[0] = 2; // more sideways than outwards
  ck_assert_int_eq(look(&looked).count[FEM_TROUBLE_WRONG_WAY], 0);
  ck_assert_int_eq(looked.watch.is_wrongway[3], 0);
  apex[0] = 0, corner[0] = -1e4; // beside it the pull at the apex is nothing
  ck_assert_int_eq(look(&looked).count[FEM_TROUBLE_WRONG_WAY], 0);
  close_two(&looked);
}
END_TEST

START_TEST(steps_and_events_are_counted_apart) {
  Looked looked;
  open_two(&looked);
  FemTrouble trouble = fem_trouble_begin(&looked.run.model);
  const int strikes[] = {0, 2, 3, 0, 1};
  for (int s = 0; s < 5; s++) {
    FemTroubleState state = {.count = {strikes[s]}, .first = {strikes[s] ? s % 2 : -1}};
    ck_assert_int_eq(fem_trouble_add(&trouble, 0.1 * s, &state), s == 1 || s == 4);
  }
  ck_assert_int_eq(trouble.of[FEM_TROUBLE_INVERTED].steps, 3);
  ck_assert_int_eq(trouble.of[FEM_TROUBLE_INVERTED].events, 2);
  ck_assert_int_eq(trouble.of[FEM_TROUBLE_INVERTED].most, 3);
  ck_assert_int_eq(trouble.of[FEM_TROUBLE_INVERTED].first, 1);
  char text[512];
  fem_trouble_describe(&trouble, &looked.run.model, FEM_TROUBLE_INVERTED, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, "t = 0.1 s"));
  ck_assert_ptr_nonnull(strstr(text, "body 'upper'"));
  ck_assert_ptr_nonnull(strstr(text, " in 3 steps"));
  trouble.of[FEM_TROUBLE_INVERTED].steps = 1;
  fem_trouble_describe(&trouble, &looked.run.model, FEM_TROUBLE_INVERTED, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, " in 1 step "));
  close_two(&looked);
}
END_TEST

START_TEST(against_inversion_the_law_decides_what_helps) {
  const char *const laws[] = {"neo_hookean", "neo_hookean_log", "linear"}, *const advice[] = {
                                                                               "take law: neo_hookean_log",
                                                                               "refine it there",
                                                                               "no more than a spring"};
  for (int k = 0; k < 3; k++) {
    SceneRun run;
    char set[64], text[512];
    snprintf(set, sizeof set, "bodies.upper.material.law=%s", laws[k]);
    scene_open(&run, "single_tets", (const char *const[]){set, NULL});
    FemTrouble trouble = fem_trouble_begin(&run.model);
    fem_trouble_add(&trouble, 0.1, &(FemTroubleState){.count = {1}, .first = {1}});
    fem_trouble_describe(&trouble, &run.model, FEM_TROUBLE_INVERTED, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, advice[k]));
    scene_close(&run);
  }
}
END_TEST

START_TEST(a_sliver_is_counted_at_rest) {
  SceneRun run;
  scene_open(&run, "single_tets", (const char *const[]){"bodies.upper.place={scale: [1, 1, 1e-4]}", NULL});
  FemTrouble trouble = fem_trouble_begin(&run.model);
  ck_assert_int_eq(trouble.sliver_count, 1);
  ck_assert_int_eq(trouble.worst_sliver, 1);
  scene_close(&run);
}
END_TEST

START_TEST(the_last_line_says_what_struck_or_that_nothing_did) {
  SceneRun run;
  char text[1024];
  scene_run(&run, "free_fall", NULL);
  fem_run_describe_trouble(&run.result, &run.model, text, sizeof text);
  ck_assert_str_eq(text, "none");
  fem_run_describe_statistics(&run.result, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, "\nshortest step "));
  ck_assert(run.result.trouble.smallest_step > 0 && run.result.trouble.smallest_step <= run.scene.end);
  scene_close(&run);
  // The small tetrahedron starts inside the large one.
  scene_run(&run, "single_tets",
            (const char *const[]){"bodies.upper.place={scale: 0.3, translate: [0, 0, 0.01]}", "time.end=0.01",
                                  "contact.overlap=clip", NULL});
  fem_run_describe_trouble(&run.result, &run.model, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, "wholly inside another body"));
  ck_assert_ptr_nonnull(strstr(text, "\n  first at t = "));
  ck_assert_ptr_nonnull(strstr(text, "\n  what to do: try a larger contact.stiffness"));
  fem_run_describe_statistics(&run.result, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, "enclosed pairs"));
  ck_assert_int_gt((int)run.result.trouble.of[FEM_TROUBLE_ENCLOSED].steps, 0);
  ck_assert_int_eq(run.result.trouble.of[FEM_TROUBLE_ENCLOSED].first, 1);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("trouble");
  tcase_add_test(cases, a_sound_state_has_no_trouble);
  tcase_add_test(cases, inverted_and_enclosed_elements_are_marked);
  tcase_add_test(cases, a_contact_force_that_pulls_is_a_wrong_way_push);
  tcase_add_test(cases, steps_and_events_are_counted_apart);
  tcase_add_test(cases, against_inversion_the_law_decides_what_helps);
  tcase_add_test(cases, a_sliver_is_counted_at_rest);
  tcase_add_test(cases, the_last_line_says_what_struck_or_that_nothing_did);
  return suite_run("trouble", cases, 60);
}
