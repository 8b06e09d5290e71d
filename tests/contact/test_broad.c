// SPDX-License-Identifier: GPL-3.0-or-later
// contact/search/broad: the candidate pairs are those whose grown boxes meet, no more and no fewer.
#include "blocks.h"

#include "base/memory.h"
#include "base/random.h"
#include "contact/search/boxes.h"
#include "contact/search/broad.h"

static ContactBroadSide side_of(const Blocks *blocks, int body) {
  const ContactBody *b = &blocks->bodies[body];
  return (ContactBroadSide){(const int(*)[4])blocks->tets + b->tet_begin, b->tet_end - b->tet_begin,
                            b->tet_begin};
}

static int boxes_meet(const Blocks *blocks, int i, int j, double margin) {
  for (int c = 0; c < 3; c++) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int s = 0; s < 2; s++)
      for (int v = 0; v < 4; v++) {
        double x = blocks->x[3 * blocks->tets[s ? j : i][v] + c];
        low[s] = fmin(low[s], x - margin / 2), high[s] = fmax(high[s], x + margin / 2);
      }
    if (low[0] > high[1] || low[1] > high[0]) return 0;
  }
  return 1;
}

// Walks all pairs in order beside the list.
static int check_against_brute_force(const Blocks *blocks, double margin) {
  ContactBroadSide a = side_of(blocks, 0), b = side_of(blocks, 1);
  ContactPairList list = {0};
  ck_assert_ok(contact_broad_append(&list, &a, &b, blocks->x, margin));
  int count = 0;
  for (int i = blocks->bodies[0].tet_begin; i < blocks->bodies[0].tet_end; i++)
    for (int j = blocks->bodies[1].tet_begin; j < blocks->bodies[1].tet_end; j++) {
      if (!boxes_meet(blocks, i, j, margin)) continue;
      ck_assert_int_lt(count, list.count);
      ck_assert_int_eq(list.pairs[count][0], i);
      ck_assert_int_eq(list.pairs[count][1], j);
      count++;
    }
  ck_assert_int_eq(count, list.count);
  contact_broad_destroy(&list);
  return count;
}

static Blocks two_blocks(double gap) {
  Blocks blocks = {0};
  blocks_add(&blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {4, 3, 3}, .jitter = 0.2});
  blocks_add(
      &blocks,
      &(BlockDef){.corner = {0.4, 0.3, 3 + gap}, .cell = {0.7, 0.8, 0.9}, .cells = {5, 4, 2}, .jitter = 0.2});
  return blocks;
}

START_TEST(the_list_is_that_of_brute_force) {
  static const double GAPS[] = {-1.5, -0.3, 0.1, 1};
  Blocks blocks = two_blocks(GAPS[_i]);
  int without = check_against_brute_force(&blocks, 0), with = check_against_brute_force(&blocks, 0.5);
  ck_assert_int_gt(_i < 2 ? without : 1, 0);
  ck_assert_int_ge(with, without);
  blocks_destroy(&blocks);
}
END_TEST

START_TEST(exactly_touching_boxes_are_candidates) {
  Blocks blocks = {0};
  blocks_add(&blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {1, 1, 1}});
  blocks_add(&blocks, &(BlockDef){.corner = {0, 0, 1}, .cell = {1, 1, 1}, .cells = {1, 1, 1}});
  ck_assert_int_eq(check_against_brute_force(&blocks, 0), 36); // all Kuhn tetrahedra span their cube
  blocks_destroy(&blocks);
}
END_TEST

START_TEST(appending_keeps_what_is_there) {
  Blocks blocks = two_blocks(-0.3);
  ContactBroadSide a = side_of(&blocks, 0), b = side_of(&blocks, 1);
  ContactPairList list = {0};
  ck_assert_ok(contact_broad_append(&list, &a, &b, blocks.x, 0));
  int count = list.count;
  ck_assert_int_gt(count, 0);
  ck_assert_ok(contact_broad_append(&list, &a, &b, blocks.x, 0));
  ck_assert_int_eq(list.count, 2 * count);
  ck_assert_mem_eq(list.pairs, list.pairs + count, (size_t)count * sizeof *list.pairs);
  contact_broad_destroy(&list);
  blocks_destroy(&blocks);
}
END_TEST

START_TEST(a_side_without_tetrahedra_has_no_pairs) {
  Blocks blocks = two_blocks(-0.3);
  ContactBroadSide a = side_of(&blocks, 0), none = {.tets = a.tets};
  ContactPairList list = {0};
  ck_assert_ok(contact_broad_append(&list, &a, &none, blocks.x, 1));
  ck_assert_int_eq(list.count, 0);
  contact_broad_destroy(&list);
  blocks_destroy(&blocks);
}
END_TEST

enum { MANY = 700 };

// Of all sizes; every third where another one is, and every fifth a point.
static void draw_boxes(Random *random, double boxes[MANY][6]) {
  for (int k = 0; k < MANY; k++) {
    double size = k % 5 == 0 ? 0 : 0.05 * exp(suite_normal(random));
    for (int c = 0; c < 3; c++) {
      boxes[k][c] = k % 3 == 0 && k > 0 ? boxes[k / 2][c] : random_uniform(random);
      boxes[k][c + 3] = boxes[k][c] + size;
    }
  }
}

// All at one place are in one cell of the grid, and all meet.
START_TEST(boxes_of_all_sizes_meet_as_by_brute_force) {
  static double a[MANY][6], b[MANY][6];
  static char is_found[MANY][MANY];
  Random random = random_seeded(32, (uint64_t)_i);
  draw_boxes(&random, a);
  draw_boxes(&random, b);
  for (int k = 0; k < MANY && _i == 0; k++)
    for (int c = 0; c < 6; c++) a[k][c] = b[k][c] = 1;
  ContactBoxPairs found = {0};
  ck_assert_ok(contact_boxes_intersect((const double(*)[6])a, MANY, (const double(*)[6])b, MANY, &found));
  memset(is_found, 0, sizeof is_found);
  for (size_t k = 0; k < found.count; k++) is_found[found.pairs[k][0]][found.pairs[k][1]]++;
  size_t count = 0;
  for (int i = 0; i < MANY; i++)
    for (int j = 0; j < MANY; j++) {
      bool meets = true;
      for (int c = 0; c < 3; c++) meets = meets && a[i][c] <= b[j][c + 3] && b[j][c] <= a[i][c + 3];
      ck_assert_int_eq(is_found[i][j], meets);
      count += meets;
    }
  ck_assert_uint_eq(count, found.count);
  ck_assert_uint_gt(count, MANY);
  contact_boxes_destroy(&found);
}
END_TEST

START_TEST(every_failed_allocation_is_reported) {
  Blocks blocks = two_blocks(-0.3);
  ContactBroadSide a = side_of(&blocks, 0), b = side_of(&blocks, 1);
  Status status = STATUS_MEMORY;
  for (int k = 1; status == STATUS_MEMORY; k++) {
    ck_assert_int_lt(k, 100);
    ContactPairList list = {0};
    memory_fail_at(k);
    status = contact_broad_append(&list, &a, &b, blocks.x, 0.1);
    memory_fail_at(0);
    ck_assert(status == STATUS_MEMORY ? list.count == 0 : list.count > 0);
    contact_broad_destroy(&list);
  }
  ck_assert_ok(status);
  blocks_destroy(&blocks);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("broad");
  tcase_add_loop_test(cases, the_list_is_that_of_brute_force, 0, 4);
  tcase_add_test(cases, exactly_touching_boxes_are_candidates);
  tcase_add_test(cases, appending_keeps_what_is_there);
  tcase_add_loop_test(cases, boxes_of_all_sizes_meet_as_by_brute_force, 0, 3);
  tcase_add_test(cases, a_side_without_tetrahedra_has_no_pairs);
  tcase_add_test(cases, every_failed_allocation_is_reported);
  return suite_run("broad", cases, 60);
}
