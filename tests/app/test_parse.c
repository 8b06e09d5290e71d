// SPDX-License-Identifier: GPL-3.0-or-later
// app/cli/parse.h: what a line of a command's table does to the command's struct.
#include "suite.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "app/cli/parse.h"

typedef struct Shared {
  int mode;
  bool is_quiet;
} Shared;

typedef struct Options {
  const char *text, *words, *listed[4], *repeated[2], *files[2];
  int listed_count, repeated_count, file_count, small, owned;
  long long large;
  double number, positive;
  uint64_t seed;
  bool chosen[3], has_number, is_checked;
  Shared shared;
} Options;

static const char *const colours[] = {"red", "green", "blue"};

static void read_own(struct argp_state *state, void *member, char *text) {
  (void)state;
  *(int *)member = (int)strlen(text);
}

static const AppOption shared_table[] = {
    {"fast", 'f', NULL, "", 0, CLI_VALUE, CLI_TO(Shared, mode), 3},
    {"quiet", 'q', NULL, "", 0, CLI_FLAG, CLI_TO(Shared, is_quiet)},
    {0},
};

static const AppOption table[] = {
    {"text", 't', "T", "", 0, CLI_TEXT, CLI_TO(Options, text)},
    {"small", 0, "N", "", 0, CLI_INTEGER, CLI_TO(Options, small), -5, 5},
    {"large", 0, "N", "", 0, CLI_INTEGER, CLI_TO(Options, large), 1, INFINITY},
    {"number", 0, "X", "", 0, CLI_NUMBER, CLI_TO(Options, number), 0, 1,
     .mark_offset = offsetof(Options, has_number)},
    {"positive", 0, "X", "", 0, CLI_POSITIVE, CLI_TO(Options, positive)},
    {"seed", 0, "N", "", 0, CLI_SEED, CLI_TO(Options, seed)},
    {"words", 0, "L", "", 0, CLI_WORDS, CLI_TO(Options, words), .example = "a,b"},
    {"list", 0, "L", "", 0, CLI_LIST, CLI_TO(Options, listed), .most = 4, .example = "a,b",
     .count_offset = offsetof(Options, listed_count)},
    {"set", 's', "T", "", 0, CLI_REPEATED, CLI_TO(Options, repeated), .most = 2, .example = "--set",
     .count_offset = offsetof(Options, repeated_count)},
    {"colour", 0, "L", "", 0, CLI_CHOICES, CLI_TO(Options, chosen), .most = 3, .choices = colours},
    {"own", 0, "T", "", 0, CLI_OWN, CLI_TO(Options, owned), .read = read_own},
    {.table = shared_table, .offset = offsetof(Options, shared)},
    {0},
};

static void check(struct argp_state *state, void *options) {
  (void)state;
  ((Options *)options)->is_checked = true;
}

static const AppCommand command = {.name = "command",
                                   .options = table,
                                   .arguments =
                                       &(const AppArguments){"FILE [FILE]", offsetof(Options, files), 2,
                                                             offsetof(Options, file_count), "name a file",
                                                             "'%s' is one too many: at most %d"},
                                   .doc = "",
                                   .check = check};

// Reads a line of words with a blank between them; they live on in `line`.
static Options read_line(char *line) {
  char *words[32] = {(char *)"command"};
  int count = 1;
  for (char *word = strtok(line, " "); word; word = strtok(NULL, " ")) words[count++] = word;
  Options options = {.shared.mode = 1, .chosen = {true, true, true}};
  app_cli_parse(&command, count, words, &options);
  return options;
}

START_TEST(every_type_of_option_goes_to_its_member) {
  char line[] =
      "--text=a --small=-5 --large=9000000000 --number=.5 --positive=2e3 --seed=18446744073709551615 "
      "--own=seven --colour=blue,red -s one -fq first -s two second";
  Options options = read_line(line);
  ck_assert_str_eq(options.text, "a");
  ck_assert_int_eq(options.small, -5);
  ck_assert_int_eq(options.large, 9000000000);
  ck_assert(options.number == .5 && options.has_number && options.positive == 2000);
  ck_assert(options.seed == UINT64_MAX);
  ck_assert_int_eq(options.owned, 5);
  ck_assert(options.chosen[0] && !options.chosen[1] && options.chosen[2]);
  ck_assert_int_eq(options.repeated_count, 2);
  ck_assert_str_eq(options.repeated[1], "two");
  ck_assert_int_eq(options.file_count, 2);
  ck_assert_str_eq(options.files[1], "second");
  ck_assert(options.shared.mode == 3 && options.shared.is_quiet && options.is_checked);
}
END_TEST

START_TEST(what_is_not_given_stays_as_it_was) {
  char line[] = "file";
  Options options = read_line(line);
  ck_assert(!options.text && !options.has_number && options.shared.mode == 1 && options.chosen[1]);
  ck_assert(options.listed_count == 0 && options.file_count == 1);
}
END_TEST

START_TEST(lists_are_cut_at_their_commas) {
  char line[] = "--list=a,b,c --words=d,e file";
  Options options = read_line(line);
  ck_assert_int_eq(options.listed_count, 3);
  ck_assert_str_eq(options.listed[2], "c");
  ck_assert_str_eq(options.words, "d,e");
}
END_TEST

// Each of these ends the program with 64.
START_TEST(a_wrong_line_ends_the_program) {
  static const char *const lines[] = {"",
                                      "a b c",
                                      "--small=6 a",
                                      "--large=0 a",
                                      "--nil a",
                                      "--number=nan a",
                                      "--positive=0 a",
                                      "--seed=-1 a",
                                      "--list a,,b a",
                                      "--colour=pink a",
                                      "-s 1 -s 2 -s 3 a"};
  char line[64];
  snprintf(line, sizeof line, "%s", lines[_i]);
  read_line(line);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("parse");
  tcase_add_test(cases, every_type_of_option_goes_to_its_member);
  tcase_add_test(cases, what_is_not_given_stays_as_it_was);
  tcase_add_test(cases, lists_are_cut_at_their_commas);
  tcase_add_loop_exit_test(cases, a_wrong_line_ends_the_program, 64, 0, 11);
  return suite_run("parse", cases, 60);
}
