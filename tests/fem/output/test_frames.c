// SPDX-License-Identifier: GPL-3.0-or-later
// Frames that are written while their arrays change: the same files as on one thread, and the same errors.
#include <omp.h>
#include <unistd.h>

#include "base/memory.h"
#include "fem/output/frames.h"
#include "folder.h"

enum { VERTICES = 2000, CELLS = 3000, FRAMES = 4 };

static double positions[3 * VERTICES], heat[CELLS];
static int cells[4 * CELLS], marks[VERTICES];
static double moment;

static void fill(void *self, size_t first, size_t count, double *values) {
  const double *of = self;
  for (size_t i = 0; i < count; i++) values[i] = *of + (double)(first + i);
}

static void change(int frame) {
  moment = frame;
  for (int i = 0; i < 3 * VERTICES; i++) positions[i] = sin(i + frame);
  for (int i = 0; i < CELLS; i++) heat[i] = cos(i * frame);
  for (int i = 0; i < VERTICES; i++) marks[i] = i * frame;
  for (int i = 0; i < 4 * CELLS; i++) cells[i] = i % VERTICES;
}

static Status write_next(FemFrames *frames, int frame) {
  change(frame);
  const FemVtuArray arrays[] = {
      {.name = "marks", .components = 1, .integers = marks},
      {.name = "heat", .is_cell = true, .components = 1, .reals = heat},
      {.name = "filled", .is_cell = true, .components = 1, .fill = fill, .self = &moment}};
  const double history_time = frame - 0.5;
  const FemVtuFrame next = {.time = frame,
                            .history_time = &history_time,
                            .vertex_count = VERTICES,
                            .positions = positions,
                            .cell_count = CELLS,
                            .cells = cells,
                            .arrays = arrays,
                            .array_count = 3};
  if (frame > 0) frames->writing_s = 1e-9; // however short it takes to come here: apart, if at all
  Status status = fem_frames_write(frames, &next);
  if (frame > 0) change(frame + 7);
  return status;
}

static const FemSceneDef scene = {.end = FRAMES - 1, .frames = FRAMES - 1};
static const FemModel model = {.scene = &scene};

// All files one after another, the caller's.
static char *write_all(int threads, const char *directory) {
  FemFrames frames;
  omp_set_num_threads(threads);
  ck_assert_ok(file_make_directories(directory));
  ck_assert_ok(fem_frames_create(&frames, &model, directory));
  for (int frame = 0; frame < FRAMES; frame++) {
    ck_assert_ok(write_next(&frames, frame));
    ck_assert_int_eq(frames.background.is_running, threads > 1 && frame > 0);
  }
  ck_assert_ok(fem_frames_finish(&frames));
  ck_assert_int_eq(frames.count, FRAMES);
  fem_frames_destroy(&frames);
  char command[256];
  snprintf(command, sizeof command, "cd %s && ls > ../names && cat ../names * > ../all", directory);
  ck_assert_int_eq(system(command), 0);
  return folder_read("all");
}

START_TEST(the_number_of_threads_changes_no_byte) {
  char one[128], two[128];
  snprintf(one, sizeof one, "%s/one", folder), snprintf(two, sizeof two, "%s/two", folder);
  char *first = write_all(1, one), *second = write_all(2, two);
  ck_assert_ptr_nonnull(strstr(first, "frame_00003.vtu"));
  ck_assert_ptr_nonnull(strstr(first, "timestep=\"3\""));
  ck_assert(strcmp(first, second) == 0);
  memory_free(first), memory_free(second);
}
END_TEST

START_TEST(a_frame_that_cannot_be_written_ends_the_frames) {
  FemFrames frames;
  char place[128];
  omp_set_num_threads(2);
  snprintf(place, sizeof place, "%s/place", folder);
  ck_assert_ok(file_make_directories(place));
  ck_assert_ok(fem_frames_create(&frames, &model, place));
  ck_assert_ok(write_next(&frames, 0));
  ck_assert_ok(write_next(&frames, 1));
  ck_assert_ok(fem_frames_wait(&frames));
  char command[256];
  snprintf(command, sizeof command, "mv %s %s/away", place, folder);
  ck_assert_int_eq(system(command), 0);
  ck_assert_ok(write_next(&frames, 2)); // its failure is not known yet
  ck_assert_int_eq(write_next(&frames, 3), STATUS_IO);
  ck_assert_msg(strstr(status_message(), "place/frame_00002.vtu: cannot be written"), "%s", status_message());
  ck_assert_int_eq(frames.count, 2);
  ck_assert_ok(fem_frames_finish(&frames)); // the list has what is there
  fem_frames_destroy(&frames);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("frames");
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_test(test_case, the_number_of_threads_changes_no_byte);
  tcase_add_test(test_case, a_frame_that_cannot_be_written_ends_the_frames);
  return suite_run("frames", test_case, 5);
}
