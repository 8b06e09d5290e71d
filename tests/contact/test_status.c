// SPDX-License-Identifier: GPL-3.0-or-later
// contact/status: who overlaps as a model says it, held against a reference.
#include <math.h>

#include "blocks.h"
#include "contact/status.h"
#include "overlap/models.h"

// Says V = 1 m³ of every pair: `claims` 1, or of none.
static Status eval_claim(const void *self, const double pair[24], const OverlapAnswer *answer) {
  (void)pair;
  *answer->volume = *(const int *)self;
  if (answer->gradient) memset(answer->gradient, 0, 24 * sizeof *answer->gradient);
  *answer->flags = *answer->volume > 0 ? 0 : OVERLAP_DISJOINT;
  return STATUS_OK;
}

// Status heads that say the opposite of V.
static Status tell_opposite(const void *self, int count, const double *pairs, double *logits) {
  (void)pairs;
  for (int k = 0; k < count; k++) logits[k] = *(const int *)self ? -1 : 1;
  return STATUS_OK;
}

static bool sees_all(const void *self) {
  (void)self;
  return true;
}

static const OverlapOps CLAIM = {.name = "claim", .eval_pair = eval_claim};
static const OverlapOps GHOSTS = {.name = "ghosts", .eval_pair = eval_claim, .has_ghosts = sees_all};
static const OverlapOps LOGITS = {
    .name = "logits", .eval_pair = eval_claim, .has_ghosts = sees_all, .eval_logits = tell_opposite};
static int NONE = 0, ALL = 1;

typedef struct Stack {
  Blocks blocks;
  double *rest;
  OverlapModel exact;
  ContactSystem *system;
} Stack;

// Two cubes of 2 × 2 × 2 cells of 1 m; the upper one begins `height` above the lower one's top.
static void build(Stack *stack, double height, const OverlapModel *model) {
  *stack = (Stack){0};
  ck_assert_ok(overlap_models_create(&stack->exact, "exact"));
  blocks_add(&stack->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {2, 2, 2}});
  blocks_add(&stack->blocks,
             &(BlockDef){.corner = {0.3, 0.4, 2 + height}, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  stack->rest = blocks_copy(&stack->blocks);
  ContactSystemDef def = blocks_def(&stack->blocks, stack->rest, model ? model : &stack->exact);
  ck_assert_ok(contact_system_create(&stack->system, &def));
  double *still = calloc(3 * (size_t)stack->blocks.vertex_count, sizeof *still);
  ck_assert_ok(contact_system_update(stack->system, 0, stack->blocks.x, still, 0.01));
  free(still);
}

static const ContactStatus *status_of(Stack *stack) {
  const ContactStatus *status;
  ck_assert_ok(contact_system_status(stack->system, 0, stack->blocks.x, &stack->exact, &status));
  return status;
}

static void clear(Stack *stack) {
  contact_system_destroy(stack->system);
  overlap_model_destroy(&stack->exact);
  free(stack->rest);
  blocks_destroy(&stack->blocks);
}

// Every tetrahedron of a Kuhn cell has a vertex at its top: those of the lower cube's upper layer reach up.
START_TEST(elements_that_reach_into_the_other_body_overlap_and_others_do_not) {
  Stack stack;
  build(&stack, -0.1, NULL);
  const ContactStatus *status = status_of(&stack);
  double height;
  int overlapping = 0;
  for (int e = 0; e < stack.blocks.tet_count; e++) {
    double low = INFINITY, high = -INFINITY;
    for (int v = 0; v < 4; v++) {
      height = stack.blocks.x[3 * stack.blocks.tets[e][v] + 2];
      low = fmin(low, height), high = fmax(high, height);
    }
    bool is_lower = e < stack.blocks.bodies[0].tet_end;
    if (is_lower ? high < 1.9 : low > 2) ck_assert_int_eq(status->exact[e], 0);
    overlapping += status->exact[e];
    ck_assert_int_eq(status->predicted[e], status->exact[e]);
    ck_assert_int_eq(status->error[e], CONTACT_VERDICT_RIGHT);
    ck_assert_int_eq(status->wrong_pairs[e], 0);
  }
  ck_assert_int_gt(overlapping, 24);
  ck_assert_int_eq(status->elements.overlapping, overlapping);
  ck_assert_int_gt(status->pairs.overlapping, overlapping / 2);
  ck_assert_int_eq(status->pairs.false_positives + status->pairs.false_negatives, 0);
  clear(&stack);
}
END_TEST

START_TEST(a_model_that_denies_every_overlap_gives_false_negatives_only) {
  Stack stack;
  OverlapModel none = {&CLAIM, &NONE};
  build(&stack, -0.1, &none);
  const ContactStatus *status = status_of(&stack);
  ck_assert_int_gt(status->pairs.overlapping, 0);
  ck_assert_int_eq(status->pairs.false_negatives, status->pairs.overlapping);
  ck_assert_int_eq(status->pairs.false_positives, 0);
  for (int e = 0; e < stack.blocks.tet_count; e++) {
    ck_assert_int_eq(status->predicted[e], 0);
    ck_assert_int_eq(status->error[e],
                     status->exact[e] ? CONTACT_VERDICT_FALSE_NEGATIVE : CONTACT_VERDICT_RIGHT);
    ck_assert_int_eq(status->wrong_pairs[e] > 0, status->exact[e]);
  }
  clear(&stack);
}
END_TEST

// Boxes of many elements meet that share no volume.
START_TEST(ghosts_are_false_positives_and_a_face_that_separates_hides_them) {
  Stack stack;
  OverlapModel ghosts = {&GHOSTS, &ALL}, all = {&CLAIM, &ALL};
  build(&stack, -0.1, &ghosts);
  const ContactStatusCounts pairs = status_of(&stack)->pairs;
  ck_assert_int_gt(pairs.asked, pairs.overlapping);
  ck_assert_int_eq(pairs.false_positives, pairs.asked - pairs.overlapping);
  ck_assert_int_eq(pairs.false_negatives, 0);
  clear(&stack);
  build(&stack, -0.1, &all);
  ck_assert_int_eq(status_of(&stack)->pairs.asked, pairs.asked);
  ck_assert_int_lt(status_of(&stack)->pairs.false_positives, pairs.false_positives);
  clear(&stack);
}
END_TEST

START_TEST(a_status_head_has_the_word_not_the_volume) {
  Stack stack;
  OverlapModel denies = {&LOGITS, &ALL}, claims = {&LOGITS, &NONE};
  build(&stack, -0.1, &denies);
  const ContactStatusCounts denied = status_of(&stack)->pairs;
  ck_assert_int_eq(denied.false_negatives, denied.overlapping);
  ck_assert_int_eq(denied.false_positives, 0);
  clear(&stack);
  build(&stack, -0.1, &claims);
  const ContactStatusCounts claimed = status_of(&stack)->pairs;
  ck_assert_int_eq(claimed.false_negatives, 0);
  ck_assert_int_eq(claimed.false_positives, claimed.asked - claimed.overlapping);
  clear(&stack);
}
END_TEST

START_TEST(bodies_apart_ask_no_pair_and_the_last_answer_is_forgotten) {
  Stack stack;
  build(&stack, -0.1, NULL);
  ck_assert_int_gt(status_of(&stack)->pairs.asked, 0);
  blocks_shift(&stack.blocks, stack.blocks.x, 1, (double[]){0, 0, 0.15});
  const ContactStatus *status = status_of(&stack);
  ck_assert_int_eq(status->pairs.asked, 0);
  for (int e = 0; e < stack.blocks.tet_count; e++) ck_assert_int_eq(status->exact[e], 0);
  clear(&stack);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("status");
  tcase_add_test(test_case, elements_that_reach_into_the_other_body_overlap_and_others_do_not);
  tcase_add_test(test_case, a_model_that_denies_every_overlap_gives_false_negatives_only);
  tcase_add_test(test_case, ghosts_are_false_positives_and_a_face_that_separates_hides_them);
  tcase_add_test(test_case, a_status_head_has_the_word_not_the_volume);
  tcase_add_test(test_case, bodies_apart_ask_no_pair_and_the_last_answer_is_forgotten);
  return suite_run("status", test_case, 60);
}
