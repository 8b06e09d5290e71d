// SPDX-License-Identifier: GPL-3.0-or-later
// base/: messages, memory that fails on request, files that appear whole, reproducible random numbers.
#include "suite.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"

START_TEST(a_failure_may_quote_the_one_before) {
  ck_assert_int_eq(status_fail(STATUS_RETRY, "inner %d", 3), STATUS_RETRY);
  ck_assert_int_eq(status_fail(STATUS_SOLVER, "outer: %s", status_message()), STATUS_SOLVER);
  ck_assert_str_eq(status_message(), "outer: inner 3");
}
END_TEST

START_TEST(a_failure_carries_its_message_and_code) {
  ck_assert_int_eq(status_fail(STATUS_INPUT, "line %d: bad", 7), STATUS_INPUT);
  ck_assert_str_eq(status_message(), "line 7: bad");
  status_prefix(STATUS_INPUT, "scene.yaml");
  ck_assert_str_eq(status_message(), "scene.yaml: line 7: bad");
  ck_assert_int_eq(status_exit_code(STATUS_INPUT), 65);
  ck_assert_int_eq(status_exit_code(STATUS_RETRY), 70);
}
END_TEST

START_TEST(the_kth_allocation_fails_once) {
  memory_fail_at(2);
  void *first = memory_zeroed(1, 8), *second = memory_zeroed(1, 8), *third = memory_zeroed(1, 8);
  ck_assert_ptr_nonnull(first);
  ck_assert_ptr_null(second);
  ck_assert_ptr_nonnull(third);
  memory_free(first), memory_free(third);
}
END_TEST

START_TEST(an_abandoned_file_leaves_the_old_one) {
  char path[64];
  snprintf(path, sizeof path, "/tmp/tetlap_file_%ld", (long)getpid());
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, path));
  fputs("whole", writer.stream);
  ck_assert_ok(file_commit(&writer));
  ck_assert_ok(file_begin(&writer, path));
  fputs("half", writer.stream);
  file_abandon(&writer);
  char *text;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  ck_assert_str_eq(text, "whole");
  memory_free(text);
  unlink(path);
}
END_TEST

static void write_text(const char *path, const char *text) {
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, path));
  fputs(text, writer.stream);
  ck_assert_ok(file_commit(&writer));
}

static void expect_text(const char *path, const char *expected) {
  char *text;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  ck_assert_str_eq(text, expected);
  memory_free(text);
}

static bool is_kind(const char *path, mode_t kind) {
  struct stat info;
  return lstat(path, &info) == 0 && (info.st_mode & S_IFMT) == kind;
}

START_TEST(a_link_is_written_through_to_the_file_that_it_names) {
  char folder[] = "/tmp/tetlap_link_XXXXXX";
  ck_assert_ptr_nonnull(mkdtemp(folder));
  ck_assert_int_eq(chdir(folder), 0);
  ck_assert_int_eq(symlink("target", "link"), 0);
  ck_assert_int_eq(symlink("link", "far"), 0);
  write_text("far", "made"); // of a link to a file that is not there yet
  expect_text("target", "made");
  write_text("link", "changed");
  expect_text("target", "changed");
  ck_assert(is_kind("link", S_IFLNK) && is_kind("far", S_IFLNK) && is_kind("target", S_IFREG));
  ck_assert_int_eq(symlink("loop", "loop"), 0);
  FileWriter writer;
  ck_assert_int_eq(file_begin(&writer, "loop"), STATUS_IO);
  ck_assert_int_eq(unlink("loop") | unlink("far") | unlink("link") | unlink("target"), 0);
  ck_assert_int_eq(rmdir(folder), 0);
}
END_TEST

START_TEST(a_pipe_and_a_descriptor_get_what_is_written_and_stay) {
  char folder[] = "/tmp/tetlap_pipe_XXXXXX", text[16] = "", name[32];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  ck_assert_int_eq(chdir(folder), 0);
  ck_assert_int_eq(mkfifo("pipe", 0600), 0);
  int reader = open("pipe", O_RDONLY | O_NONBLOCK);
  write_text("pipe", "in");
  ck_assert_int_eq(read(reader, text, sizeof text), 2);
  ck_assert_str_eq(text, "in");
  ck_assert(is_kind("pipe", S_IFIFO));
  FILE *file = fopen("file", "w");
  fputs("before ", file);
  fflush(file);
  snprintf(name, sizeof name, "/dev/fd/%d", fileno(file));
  write_text(name, "behind");
  fclose(file);
  expect_text("file", "before behind");
  write_text("/dev/null", "gone");
  ck_assert(is_kind("/dev/null", S_IFCHR));
  close(reader);
  ck_assert_int_eq(unlink("pipe") | unlink("file"), 0);
  ck_assert_int_eq(rmdir(folder), 0);
}
END_TEST

START_TEST(a_full_disk_is_an_error_with_the_path) {
  FileWriter writer;
  ck_assert_int_eq(file_begin(&writer, "/proc/no/such/place"), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "/proc/no/such/place"));
}
END_TEST

START_TEST(random_rotations_are_rotations) {
  Random random = random_seeded(1, 2);
  for (int k = 0; k < 100; k++) {
    double R[9];
    random_rotation(&random, R);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) {
        double dot = 0;
        for (int c = 0; c < 3; c++) dot += R[3 * i + c] * R[3 * j + c];
        ck_assert_near(dot, i == j, 1e-14);
      }
  }
}
END_TEST

START_TEST(random_streams_repeat_and_differ) {
  Random a = random_seeded(5, 0), b = random_seeded(5, 0), c = random_seeded(5, 1);
  uint64_t x = random_bits(&a);
  ck_assert_uint_eq(x, random_bits(&b));
  ck_assert_uint_ne(x, random_bits(&c));
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("base");
  tcase_add_test(cases, a_failure_carries_its_message_and_code);
  tcase_add_test(cases, the_kth_allocation_fails_once);
  tcase_add_test(cases, an_abandoned_file_leaves_the_old_one);
  tcase_add_test(cases, a_link_is_written_through_to_the_file_that_it_names);
  tcase_add_test(cases, a_pipe_and_a_descriptor_get_what_is_written_and_stay);
  tcase_add_test(cases, a_full_disk_is_an_error_with_the_path);
  tcase_add_test(cases, random_rotations_are_rotations);
  tcase_add_test(cases, random_streams_repeat_and_differ);
  tcase_add_test(cases, a_failure_may_quote_the_one_before);
  return suite_run("base", cases, 10);
}
