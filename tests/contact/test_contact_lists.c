// SPDX-License-Identifier: GPL-3.0-or-later
// contact/system over a run: which candidates are kept, how far bodies may move, when a contact begins, what
// the stiffness may couple; evaluation changes nothing.
#include "blocks.h"
#include "evaluated.h"

#include <omp.h>

#include "base/vec3.h"
#include "contact/search/near.h"
#include "overlap/models.h"

typedef struct Fixture {
  Blocks blocks;
  double *rest, *velocities;
  OverlapModel model;
  ContactSystemDef def;
  ContactSystem *system;
} Fixture;

static void update(Fixture *f, double time, const double *x) {
  ck_assert_ok(contact_system_update(f->system, time, x, f->velocities, 0.01));
}

// Takes the blocks as they are.
static void start(Fixture *f) {
  f->rest = blocks_copy(&f->blocks);
  f->velocities = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(f->velocities);
  ck_assert_ok(overlap_models_create(&f->model, "clip"));
  f->def = blocks_def(&f->blocks, f->rest, &f->model);
  ck_assert_ok(contact_system_create(&f->system, &f->def));
  update(f, 0, f->blocks.x);
}

// Lower block with its surface at z = 2, the upper one `gap` above it.
static Fixture *two_blocks(double gap, double jitter) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {4, 4, 2}, .jitter = jitter});
  blocks_add(&f->blocks, &(BlockDef){.corner = {0.63, 0.41, 2 + gap},
                                     .cell = {0.9, 0.9, 0.9},
                                     .cells = {3, 3, 2},
                                     .jitter = jitter});
  start(f);
  return f;
}

static void destroy(Fixture *f) {
  contact_system_destroy(f->system);
  overlap_model_destroy(&f->model);
  blocks_destroy(&f->blocks);
  free(f->rest), free(f->velocities), free(f);
}

// Half the mean edge of the finer block: the margin while bodies are near.
static double default_margin(const Fixture *f) {
  double sum = 0;
  int count = 0;
  for (int i = f->blocks.bodies[1].tet_begin; i < f->blocks.bodies[1].tet_end; i++)
    for (int v = 0; v < 4; v++)
      for (int w = 0; w < v; w++, count++)
        sum += vec3_length(vec3_sub(vec3_at(f->rest + 3 * f->blocks.tets[i][v]),
                                    vec3_at(f->rest + 3 * f->blocks.tets[i][w])));
  return sum / count / 2;
}

// Everything that an evaluation gives, to compare bit by bit.
typedef struct Result {
  Status status;
  double energy;
  int active_count;
  ContactInterface interface;
  double *force; // owned
} Result;

static Result result_at(const Fixture *f, ContactSystem *system, double time, const double *x) {
  Result result = {.force = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double))};
  ck_assert_ptr_nonnull(result.force);
  const ContactEvaluation *evaluation;
  result.status = contact_evaluate(system, 0, time, x, &evaluation);
  if (result.status) return result;
  contact_system_add_force(system, evaluation, result.force);
  result.energy = evaluation->energy;
  result.interface = evaluation->interfaces[0];
  result.active_count = contact_evaluation_active_count(evaluation);
  return result;
}

// Consumes both.
static void check_same(const Fixture *f, Result a, Result b) {
  ck_assert_ok(a.status);
  ck_assert_ok(b.status);
  ck_assert_int_eq(a.active_count, b.active_count);
  ck_assert_mem_eq(&a.energy, &b.energy, sizeof a.energy);
  ck_assert_mem_eq(&a.interface.force, &b.interface.force, sizeof a.interface.force);
  ck_assert_mem_eq(a.force, b.force, 3 * sizeof(double) * (size_t)f->blocks.vertex_count);
  free(a.force), free(b.force);
}

static double *moved(const Fixture *f, double x, double y, double z) {
  double *positions = blocks_copy(&f->blocks);
  blocks_shift(&f->blocks, positions, 1, (double[]){x, y, z});
  return positions;
}

START_TEST(an_old_list_gives_what_a_new_one_gives) {
  Fixture *f = two_blocks(-0.2, 0.1);
  double m = default_margin(f), *x = moved(f, 0.3 * m, -0.2 * m, -0.9 * m);
  Result old = result_at(f, f->system, 0, x);
  ck_assert_int_gt(old.active_count, 50);
  ck_assert_int_eq(contact_system_counters(f->system)->searches, 1);
  update(f, 0, x);
  ck_assert_int_eq(contact_system_counters(f->system)->searches, 2);
  ContactSystem *fresh;
  ck_assert_ok(contact_system_create(&fresh, &f->def));
  ck_assert_ok(contact_system_update(fresh, 0, x, f->velocities, 0.01));
  check_same(f, old, result_at(f, fresh, 0, x));
  contact_system_destroy(fresh);
  free(x), destroy(f);
}
END_TEST

START_TEST(small_motion_keeps_the_list) {
  Fixture *f = two_blocks(-0.2, 0.1);
  double m = default_margin(f), *x = moved(f, 0, 0, 0.45 * m);
  ck_assert_ok(contact_system_update(f->system, 0, x, f->velocities, 0.01));
  ck_assert_int_eq(contact_system_counters(f->system)->searches, 1);
  contact_system_forget(f->system);
  ck_assert_ok(contact_system_update(f->system, 0, x, f->velocities, 0.01));
  ck_assert_int_eq(contact_system_counters(f->system)->searches, 2);
  free(x), destroy(f);
}
END_TEST

START_TEST(motion_beyond_the_margin_is_refused_and_changes_nothing) {
  Fixture *f = two_blocks(-0.2, 0.1);
  double m = default_margin(f), *x = moved(f, 0, 0, -1.01 * m);
  Result before = result_at(f, f->system, 0, f->blocks.x);
  const ContactEvaluation *kept = evaluated_at(f->system, 0, f->blocks.x);
  Result refused = result_at(f, f->system, 0, x);
  ck_assert_int_eq(refused.status, STATUS_RETRY);
  ck_assert_int_eq(contact_system_counters(f->system)->beyond_margin, 1);
  ck_assert_mem_eq(kept->interfaces[0].force, before.interface.force, sizeof before.interface.force);
  ck_assert_double_eq(kept->interfaces[0].volume, before.interface.volume);
  ck_assert_mem_eq(kept->given_forces, before.force, 3 * sizeof(double) * (size_t)f->blocks.vertex_count);
  x[3 * f->blocks.bodies[1].vertex_begin] = NAN;
  Result nan = result_at(f, f->system, 0, x);
  ck_assert_int_eq(nan.status, STATUS_RETRY);
  check_same(f, before, result_at(f, f->system, 0, f->blocks.x));
  free(refused.force), free(nan.force), free(x), destroy(f);
}
END_TEST

START_TEST(a_rejected_trial_leaves_no_trace) {
  Fixture *f = two_blocks(-0.2, 0.1);
  double *x = moved(f, 0.1, 0.05, -0.1), *y = moved(f, -0.1, 0, 0.3);
  Result first = result_at(f, f->system, 0, x), other = result_at(f, f->system, 0, y);
  ck_assert_int_ne(first.active_count, other.active_count);
  check_same(f, first, result_at(f, f->system, 0, x));
  free(other.force), free(x), free(y), destroy(f);
}
END_TEST

START_TEST(one_thread_and_two_give_the_same_bits) {
  Fixture *f = two_blocks(-0.2, 0.1);
  omp_set_num_threads(1);
  Result one = result_at(f, f->system, 0, f->blocks.x);
  omp_set_num_threads(2);
  check_same(f, one, result_at(f, f->system, 0, f->blocks.x));
  destroy(f);
}
END_TEST

// How often the system has evaluated after one more call.
static int evaluations_after(const Fixture *f, long long version, const double *x, Status expected) {
  const ContactEvaluation *evaluation;
  ck_assert_int_eq(contact_evaluate(f->system, version, 0, x, &evaluation), expected);
  return (int)contact_system_counters(f->system)->evaluations;
}

START_TEST(a_version_is_evaluated_once_as_long_as_no_other_is) {
  Fixture *f = two_blocks(-0.2, 0.1);
  double *x = moved(f, 0, 0, 1), *here = f->blocks.x;
  ck_assert_int_eq(evaluations_after(f, 7, here, STATUS_OK), 1);
  ck_assert_int_eq(evaluations_after(f, 7, here, STATUS_OK), 1);
  ck_assert_int_eq(evaluations_after(f, 8, here, STATUS_OK), 2);
  ck_assert_int_eq(evaluations_after(f, 0, here, STATUS_OK), 3); // none
  ck_assert_int_eq(evaluations_after(f, 0, here, STATUS_OK), 4);
  ck_assert_int_eq(evaluations_after(f, 7, here, STATUS_OK), 5);
  ck_assert_int_eq(evaluations_after(f, 9, x, STATUS_RETRY), 5); // too far, and nothing is lost
  ck_assert_int_eq(evaluations_after(f, 7, here, STATUS_OK), 5);
  // What is held changes the results.
  ck_assert_ok(contact_system_hold(f->system, 0, here, f->velocities, 0.01, NULL));
  ck_assert_int_eq(evaluations_after(f, 7, here, STATUS_OK), 6);
  free(x), destroy(f);
}
END_TEST

START_TEST(bodies_far_apart_may_move_as_far_as_they_are_apart) {
  Fixture *f = two_blocks(50, 0);
  double *x = moved(f, 0, 0, -49), *y = moved(f, 0, 0, -50.1);
  Result near = result_at(f, f->system, 0, x), through = result_at(f, f->system, 0, y);
  ck_assert_ok(near.status);
  ck_assert_int_eq(near.active_count, 0);
  ck_assert_int_eq(through.status, STATUS_RETRY);
  free(near.force), free(through.force), free(x), free(y), destroy(f);
}
END_TEST

// Falls with steps that are far longer than an element wherever the system lets it.
START_TEST(a_fast_body_is_stopped_at_the_surface_and_not_behind_it) {
  Fixture *f = two_blocks(30, 0.1);
  for (int v = f->blocks.bodies[1].vertex_begin; v < f->blocks.bodies[1].vertex_end; v++)
    f->velocities[3 * v + 2] = -1000;
  double height = 30, step = 0.01, m = default_margin(f); // 10 m a step
  int steps = 0, active = 0;
  for (; steps < 200 && !active; steps++) {
    double *x = moved(f, 0, 0, height - 1000 * step - 30);
    Result tried = result_at(f, f->system, 0, x);
    active = tried.status ? 0 : tried.active_count;
    if (tried.status) {
      ck_assert_int_eq(tried.status, STATUS_RETRY);
      step /= 2;
    } else {
      height -= 1000 * step;
      ck_assert_ok(contact_system_update(f->system, 0, x, f->velocities, step));
      step *= 1.5;
    }
    free(tried.force), free(x);
  }
  ck_assert_int_gt(active, 0);
  ck_assert(height > -m - 0.4); // jitter of the surfaces: 0.19
  ck_assert_int_lt(steps, 60);
  destroy(f);
}
END_TEST

START_TEST(a_halfspace_that_rises_beyond_the_margin_is_refused) {
  static ContactShape ground = {
      .name = "ground", .normal = {0, 0, 1}, .point = {0, 0, -1}, .velocity = {0, 0, 2}};
  Fixture *f = calloc(1, sizeof *f);
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {2, 2, 2}});
  start(f);
  contact_system_destroy(f->system);
  f->def.shapes = &ground, f->def.shape_count = 1;
  ck_assert_ok(contact_system_create(&f->system, &f->def));
  update(f, 0, f->blocks.x);
  Result below = result_at(f, f->system, 0.49, f->blocks.x),
         above = result_at(f, f->system, 0.51, f->blocks.x);
  ck_assert_ok(below.status);
  ck_assert_int_eq(above.status, STATUS_RETRY);
  update(f, 0.51, f->blocks.x);
  Result after = result_at(f, f->system, 0.51, f->blocks.x);
  ck_assert_int_gt(after.active_count, 0);
  ck_assert_near(after.interface.volume, 4 * 0.02, 1e-12);
  free(below.force), free(above.force), free(after.force), destroy(f);
}
END_TEST

// How often has been searched once the lists are made anew.
static long long searches_anew(Fixture *f, double time, const double *x) {
  contact_system_start_over(f->system);
  update(f, time, x);
  return contact_system_counters(f->system)->searches;
}

START_TEST(a_list_that_is_kept_is_copied_where_a_search_would_find_the_same) {
  static ContactShape ground = {.name = "ground", .normal = {0, 0, 1}, .velocity = {0, 0, 0.1}};
  Fixture *f = two_blocks(-0.2, 0.1);
  contact_system_destroy(f->system);
  f->def.shapes = &ground, f->def.shape_count = 1;
  ck_assert_ok(contact_system_create(&f->system, &f->def));
  update(f, 0, f->blocks.x);
  ck_assert_ok(contact_system_keep(f->system));
  double *x = moved(f, 0.5, 0, 0);
  ck_assert_int_eq(searches_anew(f, 0, x), 1);
  Result away = result_at(f, f->system, 0, x);
  ck_assert_int_eq(searches_anew(f, 0, f->blocks.x), 0);
  Result copied = result_at(f, f->system, 0, f->blocks.x);
  ck_assert_int_gt(copied.active_count, 50);
  ck_assert_int_eq(searches_anew(f, 1, f->blocks.x), 1); // another time
  ground.point[2] = -0.01;                               // an obstacle that was set elsewhere
  ck_assert_int_eq(searches_anew(f, 0, f->blocks.x), 1);
  ground.point[2] = 0;
  f->velocities[0] = 1; // other steps are expected
  ck_assert_int_eq(searches_anew(f, 0, f->blocks.x), 1);
  f->velocities[0] = 0;
  ck_assert_int_eq(searches_anew(f, 0, f->blocks.x), 0);
  update(f, 0, f->blocks.x); // makes no list, so there is none to keep
  ck_assert_ok(contact_system_keep(f->system));
  ck_assert_int_eq(searches_anew(f, 0, f->blocks.x), 1);
  check_same(f, copied, result_at(f, f->system, 0, f->blocks.x));
  free(away.force), free(x), destroy(f);
}
END_TEST

// ---- Couplings

typedef struct Couplings {
  int vertex_count;
  unsigned char *may; // (vertex_count, vertex_count)
  int clique_count, missing;
} Couplings;

static Status allow_clique(void *visitor, int count, const int *vertices) {
  Couplings *couplings = visitor;
  couplings->clique_count++;
  for (int i = 0; i < count; i++)
    for (int j = 0; j < count; j++) {
      if (i != j) ck_assert_int_ne(vertices[i], vertices[j]);
      couplings->may[vertices[i] * couplings->vertex_count + vertices[j]] = 1;
    }
  return STATUS_OK;
}

static void look_up(Couplings *couplings, int count, const int *vertices) {
  for (int i = 0; i < count; i++)
    for (int j = 0; j < count; j++)
      couplings->missing += !couplings->may[vertices[i] * couplings->vertex_count + vertices[j]];
}

static void look_up_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  (void)w, (void)scale;
  look_up(self, count, vertices);
}

static void look_up_dense(void *self, int count, const int *vertices, const double *matrix) {
  (void)matrix;
  look_up(self, count, vertices);
}

static int missing_at(Couplings *couplings, ContactSystem *system, const double *x) {
  couplings->missing = 0;
  ck_assert_ok(contact_system_stiffness(system, evaluated_at(system, 0, x),
                                        &(ContactStiffnessSink){couplings, look_up_outer, look_up_dense}));
  return couplings->missing;
}

START_TEST(couplings_hold_the_stiffness_here_and_within_reach) {
  Fixture *f = two_blocks(0.1, 0.1);
  contact_system_destroy(f->system);
  f->def.potential = (ContactPotential)_i;
  ck_assert_ok(contact_system_create(&f->system, &f->def));
  update(f, 0, f->blocks.x);
  size_t n = (size_t)f->blocks.vertex_count;
  Couplings here = {.vertex_count = (int)n, .may = calloc(n * n, 1)};
  Couplings near = {.vertex_count = (int)n, .may = calloc(n * n, 1)};
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  ContactCoupled coupled[2] = {{0}};
  ck_assert_ok(contact_system_couple(f->system, evaluation, 0, &coupled[0], &here, allow_clique));
  ck_assert_ok(contact_system_couple(f->system, evaluation, 0.3, &coupled[1], &near, allow_clique));
  ck_assert_int_gt(here.clique_count, 0);
  ck_assert_int_eq(missing_at(&here, f->system, f->blocks.x), 0);
  ck_assert_int_eq(missing_at(&near, f->system, f->blocks.x), 0);
  double *x = moved(f, 0.05, 0, -0.28);
  ck_assert_int_eq(missing_at(&near, f->system, x), 0);
  ck_assert_int_gt(missing_at(&here, f->system, x), 0);
  for (int k = 0; k < 2; k++) contact_coupled_destroy(&coupled[k]);
  free(x), free(here.may), free(near.may), destroy(f);
}
END_TEST

// In steps of the reach each two elements are visited once, and couple what all at once do.
START_TEST(what_is_coupled_is_not_visited_again) {
  Fixture *f = two_blocks(0.1, 0.1);
  size_t n = (size_t)f->blocks.vertex_count;
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  Couplings steps = {.vertex_count = (int)n, .may = calloc(n * n, 1)};
  Couplings once = {.vertex_count = (int)n, .may = calloc(n * n, 1)};
  ContactCoupled coupled[2] = {{0}};
  const double reaches[] = {0, 0.15, 0.3, 0.3, 0};
  int counts[5];
  for (int k = 0; k < 5; k++) {
    ck_assert_ok(contact_system_couple(f->system, evaluation, reaches[k], &coupled[0], &steps, allow_clique));
    counts[k] = steps.clique_count;
  }
  ck_assert_ok(contact_system_couple(f->system, evaluation, 0.3, &coupled[1], &once, allow_clique));
  ck_assert_int_gt(counts[0], 0);
  ck_assert_int_gt(counts[2], counts[0]);
  ck_assert_int_eq(counts[4], counts[2]);
  ck_assert_int_eq(steps.clique_count, once.clique_count);
  ck_assert_mem_eq(steps.may, once.may, n * n);
  for (int k = 0; k < 2; k++) contact_coupled_destroy(&coupled[k]);
  free(steps.may), free(once.may), destroy(f);
}
END_TEST

static Status refuse_clique(void *visitor, int count, const int *vertices) {
  (void)visitor, (void)count, (void)vertices;
  return status_fail(STATUS_MEMORY, "no room");
}

START_TEST(a_visitor_that_fails_ends_the_visit) {
  Fixture *f = two_blocks(-0.2, 0.1);
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  ContactCoupled coupled = {0};
  ck_assert_int_eq(contact_system_couple(f->system, evaluation, 0, &coupled, NULL, refuse_clique),
                   STATUS_MEMORY);
  Couplings all = {.vertex_count = f->blocks.vertex_count};
  all.may = calloc((size_t)all.vertex_count * (size_t)all.vertex_count, 1);
  ck_assert_ok(
      contact_system_couple(f->system, evaluation, 0, &coupled, &all, allow_clique)); // and leaves nothing
  ck_assert_int_eq(missing_at(&all, f->system, f->blocks.x), 0);
  contact_coupled_destroy(&coupled);
  free(all.may), destroy(f);
}
END_TEST

// The short list of candidates is good for two steps of the expected length, a little less being covered in
// each, and for no third one.
START_TEST(a_list_lasts_for_the_steps_that_it_is_made_for) {
  enum { STEPS = 6 };
  Fixture *f = two_blocks(-0.2, 0.1);
  const ContactLayout *layout = contact_system_layout(f->system);
  const double step = 0.01, way = 0.03 * default_margin(f);
  const ContactBody *upper = &f->def.bodies[1];
  for (int v = upper->vertex_begin; v < upper->vertex_end; v++) f->velocities[3 * v + 2] = way / step;
  ContactCandidates candidates;
  ContactNear near;
  ck_assert_ok(contact_candidates_create(&candidates, layout));
  ck_assert_ok(contact_near_create(&near, layout));
  for (int k = 0; k < STEPS; k++) {
    double time = k * step, *x = moved(f, 0, 0, 0.95 * way * k);
    ck_assert_ok(contact_candidates_update(&candidates, layout, time, x, f->velocities, step));
    ck_assert_ok(contact_near_update(&near, layout, &candidates, time, x));
    ck_assert(near.is_made);
    ck_assert_int_eq(candidates.searches, 1);
    ck_assert_int_eq(near.reference_time == time, k % 2 == 0);
    free(x);
  }
  contact_near_destroy(&near);
  contact_candidates_destroy(&candidates);
  destroy(f);
}
END_TEST

// A list for .4 of the margin serves steps of half the length, and is replaced by a shorter one for shorter
// ones.
START_TEST(a_list_for_fast_bodies_is_not_kept_for_slow_ones) {
  Fixture *f = two_blocks(-0.2, 0.1);
  const ContactLayout *layout = contact_system_layout(f->system);
  const double step = 0.01, margin = default_margin(f), ways[] = {0.2, 0.105, 0.095, 0.03};
  const ContactBody *upper = &f->def.bodies[1];
  ContactCandidates candidates;
  ContactNear near;
  int counts[4];
  bool is_new[4];
  ck_assert_ok(contact_candidates_create(&candidates, layout));
  ck_assert_ok(contact_near_create(&near, layout));
  for (int k = 0; k < 4; k++) {
    for (int v = upper->vertex_begin; v < upper->vertex_end; v++)
      f->velocities[3 * v + 2] = ways[k] * margin / step;
    ck_assert_ok(contact_candidates_update(&candidates, layout, k * step, f->blocks.x, f->velocities, step));
    ck_assert_ok(contact_near_update(&near, layout, &candidates, k * step, f->blocks.x));
    is_new[k] = near.reference_time == k * step, counts[k] = near.list.count;
  }
  ck_assert(is_new[0] && !is_new[1] && is_new[2] && is_new[3]);
  ck_assert_int_lt(counts[3], counts[0]);
  ck_assert_int_gt(counts[3], 0);
  contact_near_destroy(&near);
  contact_candidates_destroy(&candidates);
  destroy(f);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("contact_lists");
  tcase_add_test(cases, an_old_list_gives_what_a_new_one_gives);
  tcase_add_test(cases, small_motion_keeps_the_list);
  tcase_add_test(cases, motion_beyond_the_margin_is_refused_and_changes_nothing);
  tcase_add_test(cases, a_rejected_trial_leaves_no_trace);
  tcase_add_test(cases, one_thread_and_two_give_the_same_bits);
  tcase_add_test(cases, a_version_is_evaluated_once_as_long_as_no_other_is);
  tcase_add_test(cases, bodies_far_apart_may_move_as_far_as_they_are_apart);
  tcase_add_test(cases, a_fast_body_is_stopped_at_the_surface_and_not_behind_it);
  tcase_add_test(cases, a_halfspace_that_rises_beyond_the_margin_is_refused);
  tcase_add_test(cases, a_list_that_is_kept_is_copied_where_a_search_would_find_the_same);
  tcase_add_loop_test(cases, couplings_hold_the_stiffness_here_and_within_reach, 0, CONTACT_POTENTIAL_COUNT);
  tcase_add_test(cases, what_is_coupled_is_not_visited_again);
  tcase_add_test(cases, a_visitor_that_fails_ends_the_visit);
  tcase_add_test(cases, a_list_lasts_for_the_steps_that_it_is_made_for);
  tcase_add_test(cases, a_list_for_fast_bodies_is_not_kept_for_slow_ones);
  return suite_run("contact_lists", cases, 60);
}
