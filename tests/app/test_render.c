// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap render`: the picture that was asked for, and what is said where a program is missing.
#include "folder.h"

#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/render/browser.h"
#include "app/render/movie.h"
#include "base/files/file.h"
#include "base/memory.h"

static int run(const char *format, const char *options) {
  char words[512], command[1024];
  snprintf(words, sizeof words, format, folder);
  snprintf(command, sizeof command, "%s %s %s > %s/said 2>&1", TETLAP_PROGRAM, words, options, folder);
  return WEXITSTATUS(system(command));
}

static void make_run(void) {
  folder_make();
  ck_assert_int_eq(run("run " TETLAP_SOURCE_DIR "/examples/01_drop.yaml -q -o %s/run",
                       "-s time.end=0.02 -s output.frames=2"),
                   0);
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
  ck_assert_int_eq(render("-o x.jpg"), 64);
  ck_assert_int_eq(render("-o x"), 64);
  ck_assert_int_eq(render("--movie x.mp4 --frame 1"), 64);
  ck_assert_int_eq(render("-o x.png --rate 10"), 64);
  ck_assert_int_eq(render("-o x.png --size 12"), 64);
  ck_assert_int_eq(render("-o x.png --cut w"), 64);
  ck_assert_int_eq(render("-o x.png --cut x:2"), 64);
  ck_assert_int_eq(render("-o x.png --theme blue"), 64);
  ck_assert_int_eq(render("-o x.png --range 3"), 64);
  ck_assert_int_eq(render("-o x.png --range 8,0"), 64);
  ck_assert_int_eq(render("-o x.png --view 10,95"), 64);
  ck_assert(says("between -90 and 90"));
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

// A test that needs a program which is not there says so.
static bool has_program(const char *name, const char *loss) {
  char command[64];
  snprintf(command, sizeof command, "command -v %s > /dev/null", name);
  if (system(command) == 0) return true;
  suite_skip("%s is not installed, so %s", name, loss);
  return false;
}

// A program of this name in the folder, which stands first in the path; returns the path as it was, owned.
static char *put_program(const char *name, const char *script) {
  char text[1024], *kept = memory_copy(getenv("PATH"), strlen(getenv("PATH")) + 1, 1);
  snprintf(text, sizeof text, "%s/%s", folder, name);
  FILE *file = fopen(text, "w");
  ck_assert_ptr_nonnull(file);
  fprintf(file, "#!/bin/sh\n%s\n", script);
  ck_assert_int_eq(fclose(file), 0);
  ck_assert_int_eq(chmod(text, 0755), 0);
  snprintf(text, sizeof text, "%s:%s", folder, kept);
  setenv("PATH", text, 1);
  return kept;
}

static void restore_path(char *kept) {
  setenv("PATH", kept, 1);
  memory_free(kept);
}

START_TEST(a_browser_that_does_not_answer_is_given_up) {
  AppRenderBrowser browser;
  char *kept = put_program("chromium", "exec sleep 100");
  Status status = app_render_browser_start(&browser, "about:blank", 64, 64, 0.2);
  ck_assert_int_eq(status, STATUS_IO);
  ck_assert_msg(strstr(status_message(), "has not answered") != NULL, "%s", status_message());
  app_render_browser_stop(&browser);
  restore_path(kept);
}
END_TEST

static int count_descriptors(void) {
  int count = 0;
  for (int file = 0; file < 256; file++) count += fcntl(file, F_GETFD) >= 0;
  return count;
}

START_TEST(a_browser_that_fails_leaves_no_descriptor_open) {
  AppRenderBrowser browser;
  int before = count_descriptors();
  char *kept = put_program("chromium", "exit 1");
  for (int k = 0; k < 3; k++) {
    ck_assert_int_eq(app_render_browser_start(&browser, "about:blank", 64, 64, 10), STATUS_IO);
    app_render_browser_stop(&browser);
  }
  // As many files as may be open: the second pipe fails.
  struct rlimit limit, tight;
  ck_assert_int_eq(getrlimit(RLIMIT_NOFILE, &limit), 0);
  tight = (struct rlimit){(rlim_t)before + 3, limit.rlim_max};
  ck_assert_int_eq(setrlimit(RLIMIT_NOFILE, &tight), 0);
  Status status = app_render_browser_start(&browser, "about:blank", 64, 64, 10);
  app_render_browser_stop(&browser);
  ck_assert_int_eq(setrlimit(RLIMIT_NOFILE, &limit), 0);
  ck_assert_int_eq(status, STATUS_IO);
  restore_path(kept);
  ck_assert_int_eq(count_descriptors(), before);
}
END_TEST

// Ctrl-C reaches the whole group of the terminal, and does not wait for a browser that answers nothing.
START_TEST(ctrl_c_ends_it_as_interrupted) {
  char *kept = put_program("chromium", "touch \"$0.began\"; exec sleep 1000"), began[128], directory[128],
       picture[128];
  int state;
  snprintf(began, sizeof began, "%s/chromium.began", folder);
  snprintf(directory, sizeof directory, "%s/run", folder);
  snprintf(picture, sizeof picture, "%s/x.png", folder);
  pid_t child = fork();
  if (child == 0) {
    setpgid(0, 0);
    freopen("/dev/null", "w", stderr);
    execl(TETLAP_PROGRAM, "tetlap", "render", directory, "-o", picture, (char *)NULL);
    _exit(127);
  }
  setpgid(child, child);
  for (int k = 0; k < 3000 && !file_exists(began); k++)
    nanosleep(&(struct timespec){.tv_nsec = 10 * 1000 * 1000}, NULL);
  ck_assert(file_exists(began));
  ck_assert_int_eq(kill(-child, SIGINT), 0);
  ck_assert_int_eq(waitpid(child, &state, 0), child);
  restore_path(kept);
  ck_assert(WIFEXITED(state));
  ck_assert_int_eq(WEXITSTATUS(state), 130);
  ck_assert(!file_exists(picture));
}
END_TEST

// What stood there before still does when ffmpeg fails, and nothing is left beside it.
START_TEST(a_movie_appears_whole_or_not_at_all) {
  AppRenderMovie movie;
  char path[128], *text, command[256];
  size_t size;
  snprintf(path, sizeof path, "%s/x.mp4", folder);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  ck_assert(fputs("before", file) >= 0 && fclose(file) == 0);
  char *kept = put_program(
      "ffmpeg", "for target; do :; done; echo half > \"${target#file:}\"; cat > /dev/null; exit 1");
  ck_assert_ok(app_render_movie_begin(&movie, path, 20));
  ck_assert_int_eq(app_render_movie_end(&movie), STATUS_IO);
  app_render_movie_abandon(&movie);
  restore_path(kept);
  ck_assert_ok(file_read(path, &text, &size));
  ck_assert_str_eq(text, "before");
  memory_free(text);
  snprintf(command, sizeof command, "! ls %s | grep part", folder);
  ck_assert_int_eq(system(command), 0);
}
END_TEST

// One picture of 1 × 1: enough for a movie; a name that begins with '-' is a name.
START_TEST(a_movie_may_have_any_name) {
  if (!has_program("ffmpeg", "no movie can be written")) return;
  static const unsigned char png[] = {0x89, 'P',  'N',  'G',  '\r', '\n', 0x1a, '\n', 0,    0,    0,    13,
                                      'I',  'H',  'D',  'R',  0,    0,    0,    1,    0,    0,    0,    1,
                                      8,    2,    0,    0,    0,    0x90, 0x77, 0x53, 0xde, 0,    0,    0,
                                      12,   'I',  'D',  'A',  'T',  0x08, 0xd7, 0x63, 0xf8, 0xcf, 0xc0, 0x00,
                                      0x00, 0x03, 0x01, 0x01, 0x00, 0x18, 0xdd, 0x8d, 0xb0, 0,    0,    0,
                                      0,    'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
  char here[512];
  ck_assert_ptr_nonnull(getcwd(here, sizeof here));
  ck_assert_int_eq(chdir(folder), 0);
  AppRenderMovie movie;
  Status status = app_render_movie_begin(&movie, "-y.gif", 20);
  if (!status) status = app_render_movie_add(&movie, png, sizeof png);
  if (!status) status = app_render_movie_end(&movie);
  char said[512];
  snprintf(said, sizeof said, "%s", status_message());
  app_render_movie_abandon(&movie);
  bool is_there = file_exists("-y.gif");
  ck_assert_int_eq(chdir(here), 0);
  ck_assert_msg(status == STATUS_OK, "%s", said);
  ck_assert(is_there);
}
END_TEST

static unsigned int number_at(const unsigned char *bytes) {
  return (unsigned int)bytes[0] << 24 | (unsigned int)bytes[1] << 16 | (unsigned int)bytes[2] << 8 | bytes[3];
}

// The head of a PNG (W3C): its mark, then the width and height at the bytes 16 and 20.
START_TEST(a_picture_has_the_size_that_was_asked_for) {
  if (!has_program("chromium", "no picture can be drawn")) return;
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
  ck_assert_int_eq(render(options), 64);
  ck_assert(says("there is no frame 7; there are 3"));
  snprintf(options, sizeof options, "-o %s --field nothing", path);
  ck_assert_int_eq(render(options), 64);
  ck_assert(says("there is no field 'nothing'; there are "));
}
END_TEST

// The bytes of a picture drawn with these options, owned.
static char *picture(const char *more, size_t *size) {
  char options[256], path[128], *bytes;
  snprintf(path, sizeof path, "%s/y.png", folder);
  snprintf(options, sizeof options, "-q -o %s --frame 1 --size 320x200 --field displacement %s", path, more);
  ck_assert_int_eq(render(options), 0);
  ck_assert_ok(file_read(path, &bytes, size));
  return bytes;
}

START_TEST(a_picture_shows_the_range_and_the_view_that_were_asked_for) {
  if (!has_program("chromium", "no picture can be drawn")) return;
  size_t size, other_size;
  char *plain = picture("", &size);
  const char *const wishes[] = {"--range 0,1", "--view 20,60"};
  for (int k = 0; k < 2; k++) {
    char *other = picture(wishes[k], &other_size);
    ck_assert_msg(size != other_size || memcmp(plain, other, size) != 0, "%s changed nothing", wishes[k]);
    memory_free(other);
  }
  memory_free(plain);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("render");
  tcase_add_checked_fixture(cases, make_run, folder_remove);
  tcase_add_test(cases, what_cannot_be_drawn_is_a_usage_error);
  tcase_add_test(cases, a_missing_browser_is_named_with_its_package);
  tcase_add_test(cases, a_browser_that_does_not_answer_is_given_up);
  tcase_add_test(cases, a_browser_that_fails_leaves_no_descriptor_open);
  tcase_add_test(cases, ctrl_c_ends_it_as_interrupted);
  tcase_add_test(cases, a_movie_appears_whole_or_not_at_all);
  tcase_add_test(cases, a_movie_may_have_any_name);
  tcase_add_test(cases, a_picture_has_the_size_that_was_asked_for);
  tcase_add_test(cases, a_picture_shows_the_range_and_the_view_that_were_asked_for);
  return suite_run("render", cases, 60);
}
