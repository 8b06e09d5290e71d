// SPDX-License-Identifier: GPL-3.0-or-later
// base/files/journal: a file that grows by whole pieces, that a later process can go on with, and that no
// fault leaves with half a piece.
#include "base/files/journal.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "suite.h"

static char folder[64], path[96];

static void set_up(void) {
  snprintf(folder, sizeof folder, "/tmp/tetlap_journal_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/log.csv", folder);
}

static void tear_down(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  ck_assert_int_eq(system(command), 0);
}

static void check_file(const char *expected) {
  char *text;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  ck_assert_str_eq(text, expected);
  memory_free(text);
}

static void write_file(const char *text) {
  FILE *stream = fopen(path, "wb");
  ck_assert_ptr_nonnull(stream);
  fputs(text, stream);
  ck_assert_int_eq(fclose(stream), 0);
}

static Status append(Journal *journal, const char *text) {
  return journal_append(journal, text, strlen(text));
}

// A journal of two pieces.
static Journal create(void) {
  Journal journal;
  ck_assert_ok(journal_create(&journal, path));
  ck_assert_ok(append(&journal, "first\n"));
  ck_assert_ok(append(&journal, "second\n"));
  return journal;
}

static void check_message(const char *word) {
  ck_assert_msg(strstr(status_message(), path) && strstr(status_message(), word),
                "the message lacks '%s': %s", word, status_message());
}

START_TEST(pieces_come_one_after_another) {
  Journal journal = create();
  check_file("first\nsecond\n");
  ck_assert_int_eq(journal.end.size, 13);
  journal_destroy(&journal);
}
END_TEST

START_TEST(nothing_is_touched_before_the_first_piece_which_replaces_what_was_there) {
  write_file("of another run\n");
  FILE *reader = fopen(path, "rb"); // who reads the old file goes on reading it
  ck_assert_ptr_nonnull(reader);
  Journal journal;
  ck_assert_ok(journal_create(&journal, path));
  check_file("of another run\n");
  ck_assert_ok(append(&journal, "new\n"));
  check_file("new\n");
  char line[32];
  ck_assert_ptr_nonnull(fgets(line, sizeof line, reader));
  ck_assert_str_eq(line, "of another run\n");
  fclose(reader);
  journal_destroy(&journal);
}
END_TEST

START_TEST(what_comes_after_the_mark_is_cut_off) {
  Journal journal = create(), next;
  JournalMark mark = journal.end;
  ck_assert_ok(append(&journal, "beyond\n"));
  ck_assert_ok(journal_create(&next, path));
  ck_assert_ok(journal_continue(&next, mark));
  check_file("first\nsecond\n");
  ck_assert_ok(append(&next, "third\n"));
  check_file("first\nsecond\nthird\n");
  journal_destroy(&journal), journal_destroy(&next);
}
END_TEST

START_TEST(half_a_piece_after_the_mark_is_cut_off) {
  Journal journal = create(), next;
  write_file("first\nsecond\nthi");
  ck_assert_ok(journal_create(&next, path));
  ck_assert_ok(journal_continue(&next, journal.end));
  check_file("first\nsecond\n");
  journal_destroy(&journal), journal_destroy(&next);
}
END_TEST

START_TEST(the_beginning_is_a_mark_too) {
  JournalMark nothing = {0};
  Journal journal = create(), next;
  ck_assert_ok(journal_create(&next, path));
  ck_assert_ok(journal_continue(&next, nothing));
  check_file("first\nsecond\n"); // until there is something to put there
  ck_assert_ok(append(&next, "anew\n"));
  check_file("anew\n");
  journal_destroy(&journal), journal_destroy(&next);
}
END_TEST

static void expect_refusal(JournalMark mark, Status wanted, const char *word) {
  Journal next;
  ck_assert_ok(journal_create(&next, path));
  ck_assert_int_eq(journal_continue(&next, mark), wanted);
  check_message(word);
  journal_destroy(&next);
}

// At every length, and with every byte changed in its turn.
START_TEST(a_file_that_is_shorter_or_another_is_refused_and_left_alone) {
  static const char whole[] = "first\nsecond\nbeyond\n";
  Journal journal = create();
  const size_t size = (size_t)journal.end.size;
  for (size_t length = 0; length < size; length++) {
    char text[sizeof whole] = "";
    memcpy(text, whole, length);
    write_file(text);
    expect_refusal(journal.end, STATUS_INPUT, "cut short");
    check_file(text);
  }
  for (size_t byte = 0; byte < size; byte++) {
    char text[sizeof whole];
    memcpy(text, whole, sizeof whole);
    text[byte] ^= 1;
    write_file(text);
    expect_refusal(journal.end, STATUS_INPUT, "was changed");
    check_file(text);
  }
  ck_assert_int_eq(unlink(path), 0);
  expect_refusal(journal.end, STATUS_IO, "No such file or directory");
  journal_destroy(&journal);
}
END_TEST

START_TEST(a_mark_holds_for_a_file_longer_than_is_read_at_once) {
  static char piece[10000];
  Journal journal, next;
  memset(piece, 'x', sizeof piece);
  ck_assert_ok(journal_create(&journal, path));
  for (int k = 0; k < 3; k++) ck_assert_ok(journal_append(&journal, piece, sizeof piece));
  ck_assert_ok(journal_create(&next, path));
  ck_assert_ok(journal_continue(&next, journal.end));
  journal.end.digest++;
  expect_refusal(journal.end, STATUS_INPUT, "was changed");
  journal_destroy(&journal), journal_destroy(&next);
}
END_TEST

// A limit on the size of files stands for a full disk: it takes the piece in part.
START_TEST(a_piece_that_does_not_fit_is_taken_back) {
  Journal journal = create();
  signal(SIGXFSZ, SIG_IGN);
  const struct rlimit narrow = {.rlim_cur = 16, .rlim_max = RLIM_INFINITY};
  ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &narrow), 0);
  Status status = append(&journal, "third\n");
  const struct rlimit wide = {.rlim_cur = RLIM_INFINITY, .rlim_max = RLIM_INFINITY};
  ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &wide), 0);
  ck_assert_int_eq(status, STATUS_IO);
  check_message("too large");
  check_message("is whole");
  check_file("first\nsecond\n");
  ck_assert_ok(append(&journal, "third\n")); // once there is room
  check_file("first\nsecond\nthird\n");
  journal_destroy(&journal);
}
END_TEST

START_TEST(a_file_that_is_gone_is_not_made_anew) {
  Journal journal = create();
  ck_assert_int_eq(unlink(path), 0);
  ck_assert_int_eq(append(&journal, "third\n"), STATUS_IO);
  check_message("No such file or directory");
  ck_assert(!file_exists(path));
  journal_destroy(&journal);
}
END_TEST

START_TEST(a_file_that_another_process_writes_is_told) {
  Journal journal = create(), other = create();
  ck_assert_ok(append(&other, "of the other\n"));
  ck_assert_int_eq(append(&journal, "third\n"), STATUS_IO);
  check_message("another process");
  check_file("first\nsecond\nof the other\n");
  journal_destroy(&journal), journal_destroy(&other);
}
END_TEST

START_TEST(a_folder_that_is_not_there_is_named) {
  Journal journal;
  ck_assert_ok(journal_create(&journal, "/tmp/no_such_directory/log.csv"));
  ck_assert_int_eq(append(&journal, "first\n"), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "/tmp/no_such_directory/log.csv"));
  journal_destroy(&journal);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("journal");
  tcase_add_checked_fixture(cases, set_up, tear_down);
  tcase_add_test(cases, pieces_come_one_after_another);
  tcase_add_test(cases, nothing_is_touched_before_the_first_piece_which_replaces_what_was_there);
  tcase_add_test(cases, what_comes_after_the_mark_is_cut_off);
  tcase_add_test(cases, half_a_piece_after_the_mark_is_cut_off);
  tcase_add_test(cases, the_beginning_is_a_mark_too);
  tcase_add_test(cases, a_file_that_is_shorter_or_another_is_refused_and_left_alone);
  tcase_add_test(cases, a_mark_holds_for_a_file_longer_than_is_read_at_once);
  tcase_add_test(cases, a_piece_that_does_not_fit_is_taken_back);
  tcase_add_test(cases, a_file_that_is_gone_is_not_made_anew);
  tcase_add_test(cases, a_file_that_another_process_writes_is_told);
  tcase_add_test(cases, a_folder_that_is_not_there_is_named);
  return suite_run("journal", cases, 30);
}
