// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap render`: the picture that was asked for, and what is said where a program is missing.
#include "suite.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

static char folder[] = "/tmp/tetlap_render_XXXXXX";

static int run(const char *format, const char *options) {
  char words[512], command[1024];
  snprintf(words, sizeof words, format, folder);
  snprintf(command, sizeof command, "%s %s %s > %s/said 2>&1", TETLAP_PROGRAM, words, options, folder);
  return WEXITSTATUS(system(command));
}

static void make_run(void) {
  strcpy(folder, "/tmp/tetlap_render_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
  ck_assert_int_eq(run("run " TETLAP_SOURCE_DIR "/examples/01_drop.yaml -q -o %s/run",
                       "-s time.end=0.02 -s output.frames=2"),
                   0);
}

static void remove_folder(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  ck_assert_int_eq(system(command), 0);
}

static bool says(const char *text) {
  char path[128], *said;
  size_t size;
  snprintf(path, sizeof path, "%s/said", folder);
  ck_assert_ok(file_read(path, &said, &size));
  bool is_there = strstr(said, text) != NULL;
  memory_free(said);
  return is_there;
}

static int render(const char *options) {
  return run("render %s/run", options);
}

START_TEST(what_cannot_be_drawn_is_a_usage_error) {
  ck_assert_int_eq(render(""), 64);
  ck_assert_int_eq(render("--movie run.avi"), 64);
  ck_assert_int_eq(render("-o x.png --size 12"), 64);
  ck_assert_int_eq(render("-o x.png --cut w"), 64);
  ck_assert_int_eq(render("-o x.png --cut x:2"), 64);
  ck_assert_int_eq(render("-o x.png --theme blue"), 64);
}
END_TEST

START_TEST(a_missing_browser_is_named_with_its_package) {
  char *path = getenv("PATH"), *kept = memory_copy(path, strlen(path) + 1, 1);
  setenv("PATH", folder, 1); // in which there is no browser
  char command[512];
  snprintf(command, sizeof command, "%s render %s/run -o %s/x.png > %s/said 2>&1", TETLAP_PROGRAM, folder,
           folder, folder);
  int code = WEXITSTATUS(system(command));
  setenv("PATH", kept, 1);
  memory_free(kept);
  ck_assert_int_eq(code, 74);
  ck_assert(says("Debian: chromium"));
}
END_TEST

static unsigned int number_at(const unsigned char *bytes) {
  return (unsigned int)bytes[0] << 24 | (unsigned int)bytes[1] << 16 | (unsigned int)bytes[2] << 8 | bytes[3];
}

// The head of a PNG (W3C): its mark, then the width and height at the bytes 16 and 20.
START_TEST(a_picture_has_the_size_that_was_asked_for) {
  if (system("command -v chromium > /dev/null") != 0) return; // nothing to draw with
  char path[128], options[256], *text;
  size_t size;
  snprintf(path, sizeof path, "%s/x.png", folder);
  snprintf(options, sizeof options, "-q -o %s --frame 1 --size 320x200", path);
  ck_assert_int_eq(render(options), 0);
  ck_assert_ok(file_read(path, &text, &size));
  const unsigned char *png = (const unsigned char *)text;
  ck_assert_uint_gt(size, 2000);
  ck_assert_int_eq(memcmp(png, "\x89PNG\r\n\x1a\n", 8), 0);
  ck_assert_uint_eq(number_at(png + 16), 320);
  ck_assert_uint_eq(number_at(png + 20), 200);
  memory_free(text);
  snprintf(options, sizeof options, "-o %s --frame 7", path);
  ck_assert_int_eq(render(options), 74);
  ck_assert(says("there is no frame 7; there are 3"));
  snprintf(options, sizeof options, "-o %s --field nothing", path);
  ck_assert_int_eq(render(options), 74);
  ck_assert(says("there is no field 'nothing'; there are "));
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("render");
  tcase_add_checked_fixture(cases, make_run, remove_folder);
  tcase_add_test(cases, what_cannot_be_drawn_is_a_usage_error);
  tcase_add_test(cases, a_missing_browser_is_named_with_its_package);
  tcase_add_test(cases, a_picture_has_the_size_that_was_asked_for);
  return suite_run("render", cases, 60);
}
