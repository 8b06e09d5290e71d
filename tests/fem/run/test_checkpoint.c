// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a checkpoint: it reads back to the last bit, appears whole or not at all, and damage of any
// kind is refused by name.
#include "fem/run/checkpoint/checkpoint.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "suite.h"

static char folder[64], path[96];

static void set_up(void) {
  snprintf(folder, sizeof folder, "/tmp/tetlap_checkpoint_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/checkpoint.h5", folder);
}

static void tear_down(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
}

static char *copy_text(const char *text) {
  return memory_copy(text, strlen(text) + 1, 1);
}

// Every kind of content: numbers that print badly, text of several lines, an effect with and one without
// history.
static FemCheckpoint example(void) {
  FemCheckpoint checkpoint;
  ck_assert_ok(fem_checkpoint_create(&checkpoint, 7));
  for (int i = 0; i < 21; i++)
    checkpoint.displacement[i] = 1.0 / (3 + i), checkpoint.velocity[i] = -exp(-30.0 * i);
  checkpoint.origin = copy_text("{\"scene\": \"ü\"}");
  checkpoint.history = (JournalMark){.size = 1LL << 40, .digest = 0xfedcba9876543210};
  checkpoint.time = 0.1, checkpoint.step = 1e-310; // not even a normal number
  checkpoint.next_frame = 3;
  checkpoint.audit = (FemAudit){.time = 0.1, .damped = 1, .dissipated = 2, .driven_work = 3, .work = 4};
  checkpoint.audit.total = -0.0, checkpoint.audit.lowest = -7, checkpoint.audit.gain = 1e-300;
  checkpoint.audit.driven_power = 11, checkpoint.audit.first = 12;
  checkpoint.so_far.min_det_F = INFINITY, checkpoint.so_far.cost.work_s = 1.25;
  checkpoint.so_far.integrator.steps = 1LL << 60;
  checkpoint.so_far.contact.pairs.beyond = 5;
  checkpoint.so_far.contact.pairs_max = 6;
  record_integer(checkpoint.so_far.counters, "friction_updates", 12);
  checkpoint.effect_count = 2;
  const double history[] = {0.3, -1e-17};
  checkpoint.effects[0] = (FemCheckpointEffect){"plasticity", memory_copy(history, 2, sizeof(double)), 2};
  checkpoint.effects[1] = (FemCheckpointEffect){"gravity", memory_zeroed(0, 1), 0};
  checkpoint.so_far.effects[1].cost = (FemEffectCost){.force_s = 0.5, .force_calls = 9, .bytes_max = 4096};
  return checkpoint;
}

static void check_equal(const FemCheckpoint *a, const FemCheckpoint *b) {
  ck_assert_int_eq(a->vertex_count, b->vertex_count);
  ck_assert_mem_eq(a->displacement, b->displacement, 21 * sizeof(double));
  ck_assert_mem_eq(a->velocity, b->velocity, 21 * sizeof(double));
  ck_assert_str_eq(a->origin, b->origin);
  ck_assert_int_eq(a->history.size, b->history.size);
  ck_assert_uint_eq(a->history.digest, b->history.digest);
  ck_assert_mem_eq(&a->time, &b->time, sizeof(double));
  ck_assert_mem_eq(&a->step, &b->step, sizeof(double));
  ck_assert_int_eq(a->next_frame, b->next_frame);
  ck_assert_mem_eq(&a->audit, &b->audit, sizeof a->audit);
  ck_assert_mem_eq(&a->so_far.integrator, &b->so_far.integrator, sizeof a->so_far.integrator);
  ck_assert_mem_eq(&a->so_far.contact.pairs, &b->so_far.contact.pairs, sizeof a->so_far.contact.pairs);
  ck_assert_int_eq(a->so_far.contact.pairs_max, b->so_far.contact.pairs_max);
  ck_assert(a->so_far.min_det_F == b->so_far.min_det_F);
  ck_assert_double_eq(a->so_far.cost.work_s, b->so_far.cost.work_s);
  RecordDifference difference;
  ck_assert(!record_differ(a->so_far.counters, b->so_far.counters, &difference));
  ck_assert_int_eq(a->effect_count, b->effect_count);
  for (int i = 0; i < a->effect_count; i++) {
    ck_assert_str_eq(a->effects[i].name, b->effects[i].name);
    ck_assert_uint_eq(a->effects[i].count, b->effects[i].count);
    for (size_t k = 0; k < a->effects[i].count; k++)
      ck_assert_mem_eq(&a->effects[i].values[k], &b->effects[i].values[k], sizeof(double));
    ck_assert_mem_eq(&a->so_far.effects[i].cost, &b->so_far.effects[i].cost, sizeof(FemEffectCost));
  }
}

START_TEST(a_checkpoint_reads_back_bit_for_bit) {
  FemCheckpoint written = example(), copy, read;
  ck_assert_ok(fem_checkpoint_write(&written, path));
  ck_assert_ok(fem_checkpoint_read(&read, path));
  check_equal(&written, &read);
  ck_assert_ok(fem_checkpoint_copy(&copy, &written));
  check_equal(&written, &copy);
  fem_checkpoint_destroy(&written), fem_checkpoint_destroy(&read), fem_checkpoint_destroy(&copy);
}
END_TEST

START_TEST(a_new_checkpoint_is_a_runs_beginning) {
  FemCheckpoint written, read;
  ck_assert_ok(fem_checkpoint_create(&written, 4));
  ck_assert_ok(fem_checkpoint_write(&written, path));
  ck_assert_ok(fem_checkpoint_read(&read, path));
  ck_assert_double_eq(read.time, 0);
  ck_assert_int_eq(read.next_frame, 0);
  ck_assert_int_eq(read.effect_count, 0);
  ck_assert_int_eq(read.history.size, 0);
  fem_checkpoint_destroy(&written), fem_checkpoint_destroy(&read);
}
END_TEST

static void read_file(char **text, size_t *size) {
  ck_assert_ok(file_read(path, text, size));
}

static void write_file(const char *text, size_t size) {
  FILE *stream = fopen(path, "wb");
  ck_assert_ptr_nonnull(stream);
  ck_assert_uint_eq(fwrite(text, 1, size, stream), size);
  ck_assert_int_eq(fclose(stream), 0);
}

START_TEST(the_same_checkpoint_makes_the_same_file) {
  FemCheckpoint written = example();
  char *first, *second;
  size_t first_size, second_size;
  ck_assert_ok(fem_checkpoint_write(&written, path));
  read_file(&first, &first_size);
  ck_assert_ok(fem_checkpoint_write(&written, path));
  read_file(&second, &second_size);
  ck_assert_uint_eq(first_size, second_size);
  ck_assert_mem_eq(first, second, first_size);
  memory_free(first), memory_free(second);
  fem_checkpoint_destroy(&written);
}
END_TEST

// The status and whether the message names the file and says `word`.
static void expect(Status wanted, const char *word) {
  FemCheckpoint read;
  Status status = fem_checkpoint_read(&read, path);
  ck_assert_msg(status == wanted && strstr(status_message(), path) && strstr(status_message(), word),
                "%d: %s; expected %d and '%s'", (int)status, status_message(), (int)wanted, word);
  ck_assert_ptr_null(read.displacement);
}

START_TEST(a_file_cut_short_anywhere_is_refused) {
  FemCheckpoint written = example();
  char *text;
  size_t size;
  ck_assert_ok(fem_checkpoint_write(&written, path));
  read_file(&text, &size);
  for (size_t length = 0; length < size; length += length < 1100 ? 9 : 997) {
    write_file(text, length);
    expect(STATUS_INPUT, length < sizeof "tetlap checkpoint" ? "is no checkpoint" : "truncated");
  }
  write_file(text, size - 1);
  expect(STATUS_INPUT, "truncated");
  memory_free(text);
  fem_checkpoint_destroy(&written);
}
END_TEST

START_TEST(a_flipped_bit_anywhere_is_refused) {
  FemCheckpoint written = example();
  char *text;
  size_t size, tried = 0;
  ck_assert_ok(fem_checkpoint_write(&written, path));
  read_file(&text, &size);
  for (size_t byte = 0; byte < size; byte += byte < 600 ? 5 : 211, tried++) {
    text[byte] = (char)(text[byte] ^ (1 << byte % 8));
    write_file(text, size);
    expect(STATUS_INPUT, byte < 17 ? "is no checkpoint" : byte < 512 ? "" : "is damaged");
    text[byte] = (char)(text[byte] ^ (1 << byte % 8));
  }
  ck_assert_uint_gt(tried, 200);
  write_file(text, size); // and the file as it was is read
  FemCheckpoint read;
  ck_assert_ok(fem_checkpoint_read(&read, path));
  memory_free(text);
  fem_checkpoint_destroy(&read), fem_checkpoint_destroy(&written);
}
END_TEST

START_TEST(foreign_files_are_refused_by_name) {
  expect(STATUS_IO, "cannot be opened");
  write_file("", 0);
  expect(STATUS_INPUT, "is no checkpoint");
  write_file("\211HDF\r\n\032\n", 8);
  expect(STATUS_INPUT, "is no checkpoint");
  ck_assert_int_eq(unlink(path), 0);
  ck_assert_int_eq(mkdir(path, 0700), 0);
  expect(STATUS_IO, "is a directory");
}
END_TEST

// A head that is right about a content that is not HDF5, or of another format.
START_TEST(a_right_head_does_not_make_a_checkpoint) {
  char file[560], digest[DIGEST_TEXT];
  static const char *const heads[] = {
      "tetlap checkpoint 20\nbytes %d\ndigest %s\nHDF5 follows: h5dump reads this file\n",
      "tetlap checkpoint 2\nbytes %d\ndigest %s\nHDF5 follows: h5dump reads this file\n"};
  static const char *const words[] = {"is damaged", "is of format 2, written by another program"};
  for (int k = 0; k < 2; k++) {
    memset(file, ' ', sizeof file);
    digest_print(digest_bytes(DIGEST_START, file + 512, 48), digest);
    int used = snprintf(file, 512, heads[k], 48, digest);
    file[used] = ' ', file[511] = '\n';
    write_file(file, sizeof file);
    expect(STATUS_INPUT, words[k]);
  }
}
END_TEST

START_TEST(a_checkpoint_of_another_format_names_the_program_that_wrote_it) {
  FemCheckpoint written = example();
  char *text;
  size_t size;
  memory_free(written.origin);
  written.origin = copy_text("{\"program\": \"tetlap 0.0.9; GNU 12\"}");
  ck_assert_ok(fem_checkpoint_write(&written, path));
  read_file(&text, &size);
  char *number = strstr(text, "checkpoint ") + strlen("checkpoint ");
  memcpy(number, "10", 2);
  write_file(text, size);
  expect(STATUS_INPUT, "is of format 10, written by tetlap 0.0.9; this program reads format 20");
  memory_free(text);
  fem_checkpoint_destroy(&written);
}
END_TEST

START_TEST(seconds_that_no_effect_can_have_taken_are_refused) {
  static const double wrong[] = {-INFINITY, NAN, -1e-9, 0x1p63};
  for (int k = 0; k < 4; k++) {
    FemCheckpoint checkpoint = example();
    checkpoint.so_far.effects[1].cost.force_s = wrong[k];
    ck_assert_ok(fem_checkpoint_write(&checkpoint, path));
    expect(STATUS_INPUT, "no fitting 'effects/01/cost'");
    fem_checkpoint_destroy(&checkpoint);
  }
}
END_TEST

static int count_files(void) {
  char command[128], text[16] = "";
  snprintf(command, sizeof command, "ls -A %s | wc -l", folder);
  FILE *stream = popen(command, "r");
  ck_assert_ptr_nonnull(stream);
  ck_assert_ptr_nonnull(fgets(text, sizeof text, stream));
  pclose(stream);
  return atoi(text);
}

// A limit on the size of files stands for a full disk: the write is cut short in the middle.
START_TEST(a_disk_that_is_full_leaves_the_last_checkpoint_whole) {
  FemCheckpoint written = example(), read;
  ck_assert_ok(fem_checkpoint_write(&written, path));
  signal(SIGXFSZ, SIG_IGN);
  const struct rlimit narrow = {.rlim_cur = 4096, .rlim_max = RLIM_INFINITY};
  ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &narrow), 0);
  written.time = 0.2;
  Status status = fem_checkpoint_write(&written, path);
  const struct rlimit wide = {.rlim_cur = RLIM_INFINITY, .rlim_max = RLIM_INFINITY};
  ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &wide), 0);
  ck_assert_int_eq(status, STATUS_IO);
  ck_assert_msg(strstr(status_message(), path) && strstr(status_message(), "too large"), "%s",
                status_message());
  ck_assert_int_eq(count_files(), 1);
  ck_assert_ok(fem_checkpoint_read(&read, path));
  ck_assert_double_eq(read.time, 0.1);
  fem_checkpoint_destroy(&written), fem_checkpoint_destroy(&read);
}
END_TEST

START_TEST(a_folder_that_is_not_there_is_named) {
  FemCheckpoint written = example();
  char nowhere[128];
  snprintf(nowhere, sizeof nowhere, "%s/none/checkpoint.h5", folder);
  ck_assert_int_eq(fem_checkpoint_write(&written, nowhere), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), nowhere));
  fem_checkpoint_destroy(&written);
}
END_TEST

// With every allocation failing in its turn: an error, no leak (under the sanitizer), no crash.
START_TEST(every_allocation_may_fail) {
  FemCheckpoint written = example(), read = {0};
  Status status = STATUS_MEMORY;
  long k = 1;
  for (; status != STATUS_OK && k < 200; k++) {
    memory_fail_at(k);
    status = fem_checkpoint_write(&written, path);
    memory_fail_at(0);
    ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
  }
  ck_assert_int_gt((int)k, 3);
  for (k = 1, status = STATUS_MEMORY; status != STATUS_OK && k < 200; k++) {
    memory_fail_at(k);
    status = fem_checkpoint_read(&read, path);
    memory_fail_at(0);
  }
  ck_assert_ok(status);
  ck_assert_int_gt((int)k, 8);
  check_equal(&written, &read);
  fem_checkpoint_destroy(&read);
  for (k = 1, status = STATUS_MEMORY; status != STATUS_OK && k < 200; k++) {
    memory_fail_at(k);
    status = fem_checkpoint_copy(&read, &written);
    memory_fail_at(0);
    ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
  }
  check_equal(&written, &read);
  fem_checkpoint_destroy(&read), fem_checkpoint_destroy(&written);
}
END_TEST

START_TEST(h5dump_reads_the_file) {
  if (system("command -v h5dump >/dev/null 2>&1") != 0) {
    printf("skipped: no h5dump, which comes with hdf5-tools\n");
    return;
  }
  FemCheckpoint written = example();
  ck_assert_ok(fem_checkpoint_write(&written, path));
  char command[256];
  snprintf(command, sizeof command, "h5dump -d /time %s | grep -q '(0): 0.1'", path);
  ck_assert_int_eq(system(command), 0);
  snprintf(command, sizeof command, "h5dump -a /velocity/unit %s | grep -q 'm/s'", path);
  ck_assert_int_eq(system(command), 0);
  fem_checkpoint_destroy(&written);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("checkpoint");
  tcase_add_checked_fixture(test_case, set_up, tear_down);
  tcase_add_test(test_case, a_checkpoint_reads_back_bit_for_bit);
  tcase_add_test(test_case, a_new_checkpoint_is_a_runs_beginning);
  tcase_add_test(test_case, the_same_checkpoint_makes_the_same_file);
  tcase_add_test(test_case, a_file_cut_short_anywhere_is_refused);
  tcase_add_test(test_case, a_flipped_bit_anywhere_is_refused);
  tcase_add_test(test_case, foreign_files_are_refused_by_name);
  tcase_add_test(test_case, a_right_head_does_not_make_a_checkpoint);
  tcase_add_test(test_case, a_checkpoint_of_another_format_names_the_program_that_wrote_it);
  tcase_add_test(test_case, seconds_that_no_effect_can_have_taken_are_refused);
  tcase_add_test(test_case, a_disk_that_is_full_leaves_the_last_checkpoint_whole);
  tcase_add_test(test_case, a_folder_that_is_not_there_is_named);
  tcase_add_test(test_case, every_allocation_may_fail);
  tcase_add_test(test_case, h5dump_reads_the_file);
  return suite_run("checkpoint", test_case, 60);
}
