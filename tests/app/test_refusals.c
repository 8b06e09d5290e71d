// SPDX-License-Identifier: GPL-3.0-or-later
// What the program refuses, with its exit code and what it says, and that it leaves files as they were.
#include "suite.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/tetlap_refusals_XXXXXX", message[8192];

static void enter_folder(void) {
  ck_assert_ptr_nonnull(mkdtemp(folder));
  ck_assert_int_eq(chdir(folder), 0);
  setenv("tetlap", TETLAP_PROGRAM, 1);
  setenv("examples", TETLAP_SOURCE_DIR "/examples", 1);
}

static void leave_folder(void) {
  char command[64];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  ck_assert_int_eq(system(command), 0);
  memset(folder + strlen(folder) - 6, 'X', 6);
}

// The exit code of a line of the shell in the folder; what it printed is in `message`. $tetlap is the
// program, $examples the examples' folder.
static int code_of(const char *line) {
  char command[1024];
  snprintf(command, sizeof command, "(%s) > message 2>&1", line);
  int state = system(command);
  FILE *stream = fopen("message", "r");
  message[fread(message, 1, sizeof message - 1, stream)] = 0;
  fclose(stream);
  return WEXITSTATUS(state);
}

static bool says(const char *words) {
  return strstr(message, words) != NULL;
}

#define ck_assert_refused(code, line, words)                                                                 \
  do {                                                                                                       \
    int ck_code_ = code_of(line);                                                                            \
    ck_assert_msg(ck_code_ == (code) && says(words), "%s: %d: %s", line, ck_code_, message);                 \
  } while (0)

START_TEST(a_data_set_that_finds_no_room_is_one_message_with_the_system_s_reason) {
  static const char *const counts[] = {"100", "2000", "20000"};
  for (int i = 0; i < 3; i++) {
    char line[200];
    snprintf(line, sizeof line, "ulimit -f 8; $tetlap datagen --law scene -q -n %s -o a.h5", counts[i]);
    ck_assert_refused(74, line, ": File too large");
    ck_assert_msg(strchr(message, '\n') == message + strlen(message) - 1, "%s", message);
    ck_assert_int_ne(access("a.h5", F_OK), 0);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("refusals");
  tcase_add_checked_fixture(cases, enter_folder, leave_folder);
  tcase_add_test(cases, a_data_set_that_finds_no_room_is_one_message_with_the_system_s_reason);
  return suite_run("refusals", cases, 120);
}
