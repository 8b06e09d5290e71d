// SPDX-License-Identifier: GPL-3.0-or-later
// app/cli: the commands' tables, and what is made of them: help, manual pages, completion; what starting
// costs.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/cli/command.h"
#include "app/program.h"
#include "base/text.h"

enum { MOST_TEXT = 1 << 18, MOST_OPTIONS = 64, MOST_NAME = 64, MOST_LINE = 512 };

// What a shell's command prints on standard output; its exit code must be 0.
static void output_of(const char *command, char *text) {
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  size_t size = fread(text, 1, MOST_TEXT - 1, pipe);
  text[size] = 0;
  ck_assert_msg(pclose(pipe) == 0, "%s", command);
}

// The long options that argp's own help tells; those begin a line, the words that explain them are further
// in.
static int options_of(const char *help, char options[MOST_OPTIONS][MOST_NAME]) {
  int count = 0;
  for (const char *line = help; line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL) {
    char letter;
    if (sscanf(line, "  -%c, --%63[a-z0-9-]", &letter, options[count]) == 2 ||
        (strncmp(line, "      --", 8) == 0 && sscanf(line, "      --%63[a-z0-9-]", options[count]) == 1))
      ck_assert_int_lt(++count, MOST_OPTIONS);
  }
  return count;
}

static bool has_word(const char *text, const char *word) {
  size_t length = strlen(word);
  for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
    if (!strchr("abcdefghijklmnopqrstuvwxyz0123456789-", at[length]) || !at[length]) return true;
  return false;
}

static const char *long_of(const char *option) {
  static char word[MOST_NAME + 2];
  size_t used = 0;
  text_append(word, sizeof word, &used, "--%s", option);
  return word;
}

typedef void (*Visit)(const AppCommand *command, const char *called);

static void visit_all(const AppCommand *command, const char *called, Visit visit) {
  visit(command, called);
  for (const AppCommand *const *child = command->children; child && *child; child++) {
    char words[APP_CLI_MAX_CALL];
    app_cli_command_call(words, called, *child);
    visit_all(*child, words, visit);
  }
}

static char text[MOST_TEXT], script[MOST_TEXT];
static int option_total;

// Runs `command` with the words that call a command, without the program's.
static void output_for(const char *format, const char *called) {
  const char *space = strchr(called, ' ');
  char command[1024];
  snprintf(command, sizeof command, format, TETLAP_PROGRAM, space ? space + 1 : "");
  output_of(command, text);
}

static int help_options(const AppCommand *command, const char *called,
                        char options[MOST_OPTIONS][MOST_NAME]) {
  if (command->children) return 0;
  output_for("%s %s --help", called);
  int count = options_of(text, options);
  ck_assert_msg(count >= 2, "%s --help tells %d options", called, count);
  option_total += count;
  return count;
}

static void check_page(const AppCommand *command, const char *called) {
  static char options[MOST_OPTIONS][MOST_NAME];
  int count = help_options(command, called, options);
  output_for("%s help --man %s | sed 's/\\\\-/-/g'", called);
  for (int k = 0; k < count; k++) {
    const char *word = long_of(options[k]);
    ck_assert_msg(has_word(text, word), "the page of %s lacks %s", called, word);
  }
  for (const AppCommand *const *child = command->children; child && *child; child++)
    ck_assert_msg(has_word(text, (*child)->name), "the page of %s lacks %s", called, (*child)->name);
}

START_TEST(every_option_of_every_help_is_in_the_manual) {
  option_total = 0;
  visit_all(&app_program_root, "tetlap", check_page);
  ck_assert_int_gt(option_total, 100);
}
END_TEST

static int columns_of(const char *from, const char *to) {
  int count = 0;
  for (; from < to; from++) count += ((unsigned char)*from & 0xC0) != 0x80; // not within a character of UTF-8
  return count;
}

// Descriptions of options begin in column 29 or, behind a longer option, later; a list goes on behind blanks.
static void check_layout(const AppCommand *command, const char *called) {
  if (command->children) return;
  output_for("%s %s --help", called);
  bool is_in_list = false;
  for (const char *line = text; *line; line += *line == '\n') {
    const char *end = line + strcspn(line, "\n");
    ck_assert_msg(columns_of(line, end) <= 79, "%s --help is too wide: %.*s", called, (int)(end - line),
                  line);
    ck_assert_msg(!is_in_list || line == end || *line == ' ', "%s --help: %.*s", called, (int)(end - line),
                  line);
    is_in_list = *line == ' ';
    const char *gap = line + strspn(line, " ");
    bool is_option = *gap == '-' && gap - line <= 6;
    if (is_option && (gap = strstr(gap + 3, "  ")) && gap < end)
      ck_assert_msg(columns_of(line, gap + strspn(gap, " ")) >= 29, "%s --help: %.*s", called,
                    (int)(end - line), line);
    line = end;
  }
}

START_TEST(every_help_is_laid_out_in_columns) {
  visit_all(&app_program_root, "tetlap", check_layout);
}
END_TEST

// The list of all commands fits a screen of 40 lines and 79 columns, below headings.
START_TEST(the_list_of_commands_fits_a_screen) {
  output_for("%s %s --help", "tetlap");
  int lines = 0, headings = 0;
  for (const char *line = text; *line; line += *line == '\n') {
    const char *end = line + strcspn(line, "\n");
    ck_assert_msg(columns_of(line, end) <= 79, "too wide: %.*s", (int)(end - line), line);
    bool is_heading = *line != ' ' && line != end && strncmp(end, "\n  ", 3) == 0;
    headings += is_heading;
    lines++;
    line = end;
  }
  ck_assert_int_le(lines, 40);
  ck_assert_int_ge(headings, 5);
}
END_TEST

// What bash offers behind the words that call a command: its options, or a group's children.
static void check_bash(const AppCommand *command, const char *called) {
  static char options[MOST_OPTIONS][MOST_NAME];
  int count = help_options(command, called, options);
  char shell[2048];
  snprintf(shell, sizeof shell,
           "bash -c 'source <(%s completion bash); COMP_WORDS=(%s %s); COMP_CWORD=$((${#COMP_WORDS[@]} - "
           "1)); _tetlap; "
           "echo \"${COMPREPLY[*]} \"'",
           TETLAP_PROGRAM, called, command->children ? "\"\"" : "--");
  output_of(shell, text);
  for (int k = 0; k < count; k++) {
    const char *word = long_of(options[k]);
    ck_assert_msg(has_word(text, word), "bash does not complete %s %s: %s", called, word, text);
  }
  for (const AppCommand *const *child = command->children; child && *child; child++)
    ck_assert_msg(has_word(text, (*child)->name), "bash does not complete %s %s", called, (*child)->name);
}

START_TEST(bash_completes_every_option_of_every_help) {
  visit_all(&app_program_root, "tetlap", check_bash);
}
END_TEST

START_TEST(bash_completes_models_where_an_option_takes_them_and_nothing_for_numbers) {
  output_of("bash -c 'source <(" TETLAP_PROGRAM
            " completion bash); COMP_WORDS=(tetlap run --overlap cl); COMP_CWORD=3; "
            "_tetlap; echo \"${COMPREPLY[*]}\"'",
            text);
  ck_assert_ptr_nonnull(strstr(text, "clip-scalar"));
  ck_assert_ptr_null(strstr(text, "geo"));
  output_of("bash -c 'source <(" TETLAP_PROGRAM
            " completion bash); COMP_WORDS=(tetlap run --threads \"\"); COMP_CWORD=3; "
            "_tetlap; echo \"${#COMPREPLY[@]}\"'",
            text);
  ck_assert_str_eq(text, "0\n");
}
END_TEST

// The branch of zsh's script that belongs to a command, up to its end.
static void check_zsh(const AppCommand *command, const char *called) {
  static char options[MOST_OPTIONS][MOST_NAME];
  int count = help_options(command, called, options);
  char head[APP_CLI_MAX_CALL + 8];
  snprintf(head, sizeof head, "    '%s')\n", called);
  char *branch = strstr(script, head);
  ck_assert_msg(branch != NULL, "zsh has no branch for %s", called);
  char *end = strstr(branch, "\n      ;;\n");
  ck_assert_ptr_nonnull(end);
  *end = 0;
  for (int k = 0; k < count; k++) {
    const char *word = long_of(options[k]);
    ck_assert_msg(has_word(branch, word), "zsh does not complete %s %s", called, word);
  }
  *end = '\n';
}

START_TEST(zsh_completes_every_option_of_every_help) {
  output_of(TETLAP_PROGRAM " completion zsh", script);
  visit_all(&app_program_root, "tetlap", check_zsh);
}
END_TEST

static void check_fish(const AppCommand *command, const char *called) {
  static char options[MOST_OPTIONS][MOST_NAME];
  int count = help_options(command, called, options);
  for (int k = 0; k < count; k++) {
    char line[MOST_LINE];
    size_t used = 0;
    text_append(line, sizeof line, &used, "'__tetlap_is \"%s\"' -l %s", called, options[k]);
    ck_assert_msg(has_word(script, line), "fish does not complete %s --%s", called, options[k]);
  }
}

START_TEST(fish_completes_every_option_of_every_help) {
  output_of(TETLAP_PROGRAM " completion fish", script);
  visit_all(&app_program_root, "tetlap", check_fish);
}
END_TEST

static void expect_explanation(const AppCommand *group, const char *called, const char *word,
                               const char *next, const char *expected) {
  char message[512], *words[] = {(char *)word, (char *)next};
  app_cli_command_explain(group, called, next ? 2 : 1, words, message, sizeof message);
  ck_assert_str_eq(message, expected);
}

START_TEST(a_wrong_word_is_told_with_its_place_and_the_nearest_right_call) {
  const AppCommand *dataset = app_cli_command_find(&app_program_root, "dataset");
  expect_explanation(
      dataset, "tetlap dataset", "train.h5", NULL,
      "tetlap dataset: 'train.h5' is a file, where a verb is expected; did you mean: tetlap dataset info "
      "train.h5");
  expect_explanation(dataset, "tetlap dataset", "inof", "a.h5",
                     "tetlap dataset: there is no verb 'inof'; did you mean: tetlap dataset info a.h5");
  expect_explanation(&app_program_root, "tetlap", "rnu", "a.yaml",
                     "tetlap: there is no command 'rnu'; did you mean: tetlap run a.yaml");
  expect_explanation(
      &app_program_root, "tetlap", "a.yaml", "--json",
      "tetlap: 'a.yaml' is a file, where a command is expected; did you mean: tetlap run a.yaml --json");
  expect_explanation(&app_program_root, "tetlap", "merge", "a.h5",
                     "tetlap: there is no command 'merge'; did you mean: tetlap dataset merge a.h5");
  char message[512], *option = (char *)"--json";
  app_cli_command_explain(dataset, "tetlap dataset", 1, &option, message, sizeof message);
  ck_assert_ptr_nonnull(strstr(message, "found the option '--json' where a verb is expected; there are: "));
  ck_assert_ptr_nonnull(strstr(message, "info, merge, plot"));
}
END_TEST

// What cannot be written, read or begun is named, with the code of its kind.
START_TEST(a_command_that_fails_says_why) {
  static const struct {
    const char *words;
    int code;
    const char *named;
  } failures[] = {
      {"run " TETLAP_SOURCE_DIR "/examples/01_drop.yaml -o /tmp/tetlap_cli --capture /nowhere/x.h5", 74,
       "/nowhere/x.h5"},
      {"run " TETLAP_SOURCE_DIR "/examples/01_drop.yaml -o /proc/nowhere", 74, "/proc/nowhere"},
      {"run " TETLAP_SOURCE_DIR
       "/examples/01_drop.yaml -o /tmp/tetlap_cli -s 'contact.pairs=[{bodies: [none, such], friction: 1}]'",
       65, "01_drop.yaml with --set: contact.pairs: no body or obstacle has the name 'none'"},
      {"datagen -n 10 -o /nowhere/x.h5", 74, "/nowhere/x.h5"},
      {"report /nowhere", 74, "/nowhere"},
      {"view /nowhere", 74, "mkdir -p /nowhere"},
      {"weights nowhere", 64, "'nowhere'"},
      {"overlap " TETLAP_SOURCE_DIR "/README.md", 65, "README.md:"},
      {"stress --only nowhere", 64, "'nowhere'"},
  };
  for (size_t k = 0; k < sizeof failures / sizeof *failures; k++) {
    char command[1024], code[32];
    snprintf(command, sizeof command, "%s %s 2>&1; echo code $?", TETLAP_PROGRAM, failures[k].words);
    output_of(command, text);
    snprintf(code, sizeof code, "code %d\n", failures[k].code);
    ck_assert_msg(strstr(text, "error: ") && strstr(text, failures[k].named) && strstr(text, code), "%s: %s",
                  failures[k].words, text);
  }
  output_of("rm -rf /tmp/tetlap_cli", text);
}
END_TEST

// gmsh brings a hundred libraries along: they belong to the process that meshes.
START_TEST(the_program_starts_without_gmsh) {
  output_of("LD_TRACE_LOADED_OBJECTS=1 " TETLAP_PROGRAM, text);
  ck_assert_ptr_nonnull(strstr(text, "libc.so")); // the list is one
  ck_assert_ptr_null(strstr(text, "gmsh"));
  ck_assert_ptr_null(strstr(text, "libTK")); // OpenCASCADE's, which gmsh uses
}
END_TEST

// A command without threads is started once; others once more, with threads that sleep while they wait.
START_TEST(only_commands_with_threads_start_the_program_again) {
  static const struct {
    char *words[4];
    bool has_threads;
  } cases[] = {
      {{"tetlap"}, false},
      {{"tetlap", "--version"}, false},
      {{"tetlap", "check", "scene.yaml"}, false},
      {{"tetlap", "dataset", "info", "set.h5"}, false},
      {{"tetlap", "nonsense"}, false},
      {{"tetlap", "run", "--help"}, false},
      {{"tetlap", "run", "scene.yaml"}, true},
      {{"tetlap", "bench", "overlap"}, true},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    int count = 0;
    while (count < 4 && cases[i].words[count]) count++;
    ck_assert_msg(app_program_has_threads(&app_program_root, count, cases[i].words) == cases[i].has_threads,
                  "case %zu", i);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("cli");
  tcase_add_test(cases, every_option_of_every_help_is_in_the_manual);
  tcase_add_test(cases, every_help_is_laid_out_in_columns);
  tcase_add_test(cases, the_list_of_commands_fits_a_screen);
  tcase_add_test(cases, bash_completes_every_option_of_every_help);
  tcase_add_test(cases, bash_completes_models_where_an_option_takes_them_and_nothing_for_numbers);
  tcase_add_test(cases, zsh_completes_every_option_of_every_help);
  tcase_add_test(cases, fish_completes_every_option_of_every_help);
  tcase_add_test(cases, a_wrong_word_is_told_with_its_place_and_the_nearest_right_call);
  tcase_add_test(cases, a_command_that_fails_says_why);
  tcase_add_test(cases, the_program_starts_without_gmsh);
  tcase_add_test(cases, only_commands_with_threads_start_the_program_again);
  return suite_run("cli", cases, 60);
}
