// SPDX-License-Identifier: GPL-3.0-or-later
// fem/output/vtk/pieces.h: a frame in pieces, one of each rank, is the frame that one process writes.
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/output/vtk/pieces.h"
#include "fem/output/vtk/pieces_read.h"

// Two tetrahedra that share a face; one beside them; a vertex that no element has.
enum { VERTICES = 10, CELLS = 3 };
static const int cells[CELLS][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}, {5, 6, 7, 8}};
static const double positions[VERTICES][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1},
                                              {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}, {9, 9, 9}};
static const double speeds[VERTICES] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
static const int bodies[CELLS] = {0, 0, 1};
// The first element is of rank 0, though it has vertices of rank 1; the others are of rank 1.
static int owners[VERTICES] = {0, 1, 1, 1, 1, 1, 1, 1, 1, 0};

static void fill_stress(void *self, size_t first, size_t count, double *values) {
  (void)self;
  for (size_t i = 0; i < 6 * count; i++) values[i] = (double)(6 * first + i) / 7;
}

static const FemVtuArray arrays[] = {
    {.name = "speed", .components = 1, .reals = speeds},
    {.name = "body", .is_cell = true, .components = 1, .integers = bodies},
    {.name = "stress", .is_cell = true, .components = 6, .fill = fill_stress},
};
static const FemVtuFrame whole = {.time = 0.25,
                                  .vertex_count = VERTICES,
                                  .positions = positions[0],
                                  .cell_count = CELLS,
                                  .cells = cells[0],
                                  .arrays = arrays,
                                  .array_count = 3};

static char folder[64];

static void make_folder(void) {
  snprintf(folder, sizeof folder, "/tmp/tetlap_pieces_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
}

static const char *place(const char *name) {
  static char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static Status as_it_is(Status status) {
  return status;
}

// What one rank of several writes, in turn.
static Status write_as(int rank, int count) {
  const FemShare share = {.rank = rank, .rank_count = count, .owner = owners};
  const Ranks table = {.number = rank, .count = count, .worst = as_it_is};
  FemVtuPart part;
  ranks_set(&table);
  Status status = fem_vtu_part_create(&part, VERTICES, CELLS, cells, count > 1 ? &share : NULL);
  if (!status) status = fem_vtu_pieces_write(folder, "frame", &whole, &part);
  fem_vtu_part_destroy(&part);
  ranks_set(NULL);
  return status;
}

// Three ranks: the last one has nothing.
START_TEST(pieces_are_read_as_the_frame_of_one_process) {
  static const int counts[] = {1, 2, 3};
  int count = counts[_i];
  for (int rank = count - 1; rank >= 0; rank--) ck_assert_ok(write_as(rank, count));
  FemVtuContent one, joined;
  ck_assert_ok(fem_vtu_write(place("whole.vtu"), &whole));
  ck_assert_ok(fem_vtu_pieces_read(place("whole.vtu"), &one));
  ck_assert_ok(fem_vtu_pieces_read(place("frame.pvtu"), &joined));
  ck_assert_int_eq(joined.vertex_count, VERTICES);
  ck_assert_int_eq(joined.cell_count, CELLS);
  ck_assert_double_eq(joined.time, 0.25);
  ck_assert_mem_eq(joined.positions, positions, sizeof positions);
  ck_assert_mem_eq(joined.cells, cells, sizeof cells);
  ck_assert_int_eq(joined.field_count, one.field_count);
  for (int k = 0; k < one.field_count; k++) {
    const FemVtuField *a = &one.fields[k], *b = &joined.fields[k];
    size_t tuples = a->is_cell ? CELLS : VERTICES;
    ck_assert_str_eq(a->name, b->name);
    ck_assert(a->is_cell == b->is_cell && a->is_integer == b->is_integer && a->components == b->components);
    ck_assert_mem_eq(a->values, b->values, tuples * (size_t)a->components * sizeof(double));
  }
  fem_vtu_read_destroy(&one), fem_vtu_read_destroy(&joined);
}
END_TEST

START_TEST(a_rank_has_its_elements_and_their_vertices) {
  const FemShare share = {.rank = 0, .rank_count = 2, .owner = owners};
  FemVtuPart part;
  ck_assert_ok(fem_vtu_part_create(&part, VERTICES, CELLS, cells, &share));
  ck_assert_int_eq(part.cell_count, 1);
  ck_assert_int_eq(part.vertex_count, 5); // four corners, and its own that no element has
  ck_assert_int_eq(part.vertices[4], 9);
  fem_vtu_part_destroy(&part);
}
END_TEST

static void write_text(const char *name, const char *text) {
  FILE *stream = fopen(place(name), "w");
  ck_assert_ptr_nonnull(stream);
  fputs(text, stream);
  fclose(stream);
}

static void expect_refusal(Status code, const char *words) {
  FemVtuContent content;
  ck_assert_int_eq(fem_vtu_pieces_read(place("frame.pvtu"), &content), code);
  ck_assert_msg(strstr(status_message(), words) && strstr(status_message(), "frame.pvtu"), "%s",
                status_message());
}

#define LIST(pieces)                                                                                         \
  "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>" pieces "</PUnstructuredGrid></VTKFile>"

START_TEST(what_is_no_whole_frame_is_refused) {
  ck_assert_ok(write_as(1, 2));
  ck_assert_ok(write_as(0, 2));
  write_text("frame.pvtu", LIST("<Piece Source=\"frame_0.vtu\"/>"));
  expect_refusal(STATUS_INPUT, "in none of the pieces");
  write_text("frame.pvtu", LIST("<Piece Source=\"frame_1.vtu\"/><Piece Source=\"frame_1.vtu\"/>"));
  expect_refusal(STATUS_INPUT, "not of one frame");
  write_text("frame.pvtu", LIST("<Piece Source=\"../frame_1.vtu\"/>"));
  expect_refusal(STATUS_INPUT, "no .vtu file beside the list");
  write_text("frame.pvtu", LIST("<Piece Source=\"frame.pvtu\"/>"));
  expect_refusal(STATUS_INPUT, "no .vtu file beside the list");
  write_text("frame.pvtu", LIST("<Piece Source=\"frame_2.vtu\"/>"));
  expect_refusal(STATUS_IO, "frame_2.vtu");
  write_text("frame.pvtu", "<VTKFile type=\"UnstructuredGrid\"/>");
  expect_refusal(STATUS_INPUT, "no");
  ck_assert_ok(fem_vtu_write(place("whole.vtu"), &whole)); // without numbers
  write_text("frame.pvtu", LIST("<Piece Source=\"whole.vtu\"/>"));
  expect_refusal(STATUS_INPUT, "not of one frame");
}
END_TEST

START_TEST(a_failed_allocation_is_an_error) {
  ck_assert_ok(write_as(1, 2));
  long k = 1;
  Status status;
  do {
    memory_fail_at(k++);
    status = write_as(0, 2);
    memory_fail_at(0);
    ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
  } while (status);
  ck_assert_int_gt(k, 10);
  FemVtuContent content;
  k = 1;
  do {
    memory_fail_at(k++);
    status = fem_vtu_pieces_read(place("frame.pvtu"), &content);
    memory_fail_at(0);
    ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
  } while (status);
  ck_assert_int_gt(k, 20);
  fem_vtu_read_destroy(&content);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("pieces");
  tcase_add_checked_fixture(cases, make_folder, remove_folder);
  tcase_add_loop_test(cases, pieces_are_read_as_the_frame_of_one_process, 0, 3);
  tcase_add_test(cases, a_rank_has_its_elements_and_their_vertices);
  tcase_add_test(cases, what_is_no_whole_frame_is_refused);
  tcase_add_test(cases, a_failed_allocation_is_an_error);
  return suite_run("pieces", cases, 60);
}
