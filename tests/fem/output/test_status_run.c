// SPDX-License-Identifier: GPL-3.0-or-later
// output.status through a whole run: frames, history and summary say the same of who overlaps.
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "fem/output/vtk/vtu_read.h"
#include "scene.h"

enum { FRAMES = 5 };

static char folder[] = "/tmp/tetlap_status_XXXXXX";

static void open_folder(void) {
  strcpy(folder, "/tmp/tetlap_status_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void path_in(char path[128], const char *name) {
  snprintf(path, 128, "%s/%s", folder, name);
}

// Runs tests/scenes/status.yaml into the folder.
static void run_into(SceneRun *run, const char *const *overrides) {
  open_folder();
  scene_open(run, "status", overrides);
  FemRunOptions options = {.directory = folder};
  ck_assert_msg(fem_run(&run->model, &options, &run->result) == STATUS_OK, "%s", status_message());
}

static void close_folder(SceneRun *run) {
  char path[128], name[32];
  for (int f = 0; f < FRAMES; f++) {
    snprintf(name, sizeof name, "frame_%05d.vtu", f);
    path_in(path, name);
    unlink(path);
  }
  path_in(path, "history.csv"), unlink(path);
  path_in(path, "frames.pvd"), unlink(path);
  rmdir(folder);
  scene_close(run);
}

// A column of history.csv by its name.
static void read_column(const char *name, double values[FRAMES]) {
  char path[128], *text;
  size_t size;
  path_in(path, "history.csv");
  ck_assert_ok(file_read(path, &text, &size));
  int column = 0, row = 0;
  char *line_end, *cell_end;
  char *line = strtok_r(text, "\n", &line_end);
  char *cell = strtok_r(line, ",", &cell_end);
  for (; cell && strcmp(cell, name) != 0; cell = strtok_r(NULL, ",", &cell_end)) column++;
  ck_assert_msg(cell != NULL, "history.csv has no column %s", name);
  while ((line = strtok_r(NULL, "\n", &line_end)) != NULL) {
    ck_assert_int_lt(row, FRAMES);
    cell = strtok_r(line, ",", &cell_end);
    for (int c = 0; c < column; c++) cell = strtok_r(NULL, ",", &cell_end);
    ck_assert_ptr_nonnull(cell);
    values[row++] = strtod(cell, NULL);
  }
  ck_assert_int_eq(row, FRAMES);
  memory_free(text);
}

static double sum(const double values[FRAMES]) {
  double total = 0;
  for (int f = 0; f < FRAMES; f++) total += values[f];
  return total;
}

static const double *field_of(const FemVtuContent *frame, const char *name) {
  for (int f = 0; f < frame->field_count; f++)
    if (strcmp(frame->fields[f].name, name) == 0) return frame->fields[f].values;
  ck_abort_msg("the frame has no field %s", name);
  return NULL;
}

static void read_frame(int f, FemVtuContent *frame) {
  char path[128], name[32];
  snprintf(name, sizeof name, "frame_%05d.vtu", f);
  path_in(path, name);
  ck_assert_ok(fem_vtu_read(path, frame));
}

// What the run's result counts is what history.csv's rows add up to.
static void check_sums(const SceneRun *run) {
  double pairs[FRAMES], overlapping[FRAMES], positives[FRAMES], negatives[FRAMES];
  read_column("status_pairs", pairs);
  read_column("status_overlapping", overlapping);
  read_column("status_false_positive", positives);
  read_column("status_false_negative", negatives);
  ck_assert(run->result.status.is_asked);
  ck_assert(sum(pairs) == (double)run->result.status.pairs.asked);
  ck_assert(sum(overlapping) == (double)run->result.status.pairs.overlapping);
  ck_assert(sum(positives) == (double)run->result.status.pairs.false_positives);
  ck_assert(sum(negatives) == (double)run->result.status.pairs.false_negatives);
  ck_assert(overlapping[0] == 0 && overlapping[FRAMES - 1] > overlapping[1]);
}

// An element overlaps where some of its volume is covered: told apart from the status by another path.
START_TEST(clipping_is_right_everywhere_and_overlap_is_where_volume_is_covered) {
  SceneRun run;
  run_into(&run, NULL);
  check_sums(&run);
  ck_assert(run.result.status.pairs.false_positives == 0 && run.result.status.pairs.false_negatives == 0);
  int seen = 0;
  for (int f = 0; f < FRAMES; f++) {
    FemVtuContent frame;
    read_frame(f, &frame);
    const double *predicted = field_of(&frame, "status_predicted"), *exact = field_of(&frame, "status_exact"),
                 *error = field_of(&frame, "status_error"), *wrong = field_of(&frame, "status_wrong_pairs"),
                 *covered = field_of(&frame, "overlap_fraction");
    for (int e = 0; e < frame.cell_count; e++) {
      ck_assert(exact[e] == (covered[e] > 0) && predicted[e] == exact[e]);
      ck_assert(error[e] == 0 && wrong[e] == 0);
      seen += exact[e] > 0;
    }
    fem_vtu_read_destroy(&frame);
  }
  ck_assert_int_ge(seen, 20);
  close_folder(&run);
}
END_TEST

// Each pair that is told wrongly counts for both of its elements. (`tpn` tells all of these correctly.)
START_TEST(a_network_s_errors_are_the_same_in_frames_history_and_result) {
  SceneRun run;
  run_into(&run, (const char *const[]){"contact.overlap=tpn-published", NULL});
  check_sums(&run);
  double positives[FRAMES], negatives[FRAMES], elements[FRAMES];
  read_column("status_false_positive", positives);
  read_column("status_false_negative", negatives);
  read_column("status_wrong_elements", elements);
  ck_assert(sum(positives) + sum(negatives) > 0);
  for (int f = 0; f < FRAMES; f++) {
    FemVtuContent frame;
    read_frame(f, &frame);
    const double *predicted = field_of(&frame, "status_predicted"), *exact = field_of(&frame, "status_exact"),
                 *error = field_of(&frame, "status_error"), *wrong = field_of(&frame, "status_wrong_pairs");
    double wrong_pairs = 0, wrong_elements = 0;
    for (int e = 0; e < frame.cell_count; e++) {
      ck_assert(error[e] == (predicted[e] == exact[e] ? 0 : predicted[e] > exact[e] ? 1 : 2));
      wrong_pairs += wrong[e];
      wrong_elements += error[e] != 0;
    }
    ck_assert(wrong_pairs == 2 * (positives[f] + negatives[f]));
    ck_assert(wrong_elements == elements[f]);
    fem_vtu_read_destroy(&frame);
  }
  close_folder(&run);
}
END_TEST

START_TEST(a_run_that_was_not_asked_has_no_status) {
  SceneRun run;
  run_into(&run, (const char *const[]){"output.status=null", NULL});
  ck_assert(!run.result.status.is_asked);
  FemVtuContent frame;
  read_frame(FRAMES - 1, &frame);
  for (int f = 0; f < frame.field_count; f++) ck_assert(strncmp(frame.fields[f].name, "status_", 7) != 0);
  fem_vtu_read_destroy(&frame);
  close_folder(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("status_run");
  tcase_add_test(test_case, clipping_is_right_everywhere_and_overlap_is_where_volume_is_covered);
  tcase_add_test(test_case, a_network_s_errors_are_the_same_in_frames_history_and_result);
  tcase_add_test(test_case, a_run_that_was_not_asked_has_no_status);
  return suite_run("status_run", test_case, 60);
}
