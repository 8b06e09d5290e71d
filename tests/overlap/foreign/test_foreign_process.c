// SPDX-License-Identifier: GPL-3.0-or-later
// Python files and commands of users (overlap/foreign/process.h). The oracle is what models.py says.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // memfd_create
#endif
#include <dirent.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <tetlap/model.h>
#include <unistd.h>

#include "base/machine/interrupt.h"
#include "model.h"
#include "overlap/pair/range.h"

#define PYTHON(name) TETLAP_SOURCE_DIR "/tests/overlap/foreign/models.py:" name

static bool has_numpy(void) {
  bool has = system(TETLAP_PYTHON " -c 'import numpy' 2>/dev/null") == 0;
  if (!has) suite_skip("%s has no NumPy", TETLAP_PYTHON);
  return has;
}

// V is `share` of what the bounding boxes have in common, x̄ its middle. Returns how many pairs have a V.
static int check_boxes(int count, double x[][24], const double *v, double middles[][3], double share) {
  int found = 0;
  for (int i = 0; i < count; i++) {
    double product = share;
    if (v[i] == 0) continue;
    found++;
    for (int c = 0; c < 3; c++) {
      double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
      for (int k = 0; k < 8; k++) {
        low[k / 4] = fmin(low[k / 4], x[i][3 * k + c]);
        high[k / 4] = fmax(high[k / 4], x[i][3 * k + c]);
      }
      double from = fmax(low[0], low[1]), to = fmin(high[0], high[1]);
      product *= to - from;
      ck_assert_double_eq(middles[i][c], (from + to) / 2);
    }
    ck_assert_near(v[i], product, 1e-15);
  }
  return found;
}

START_TEST(a_python_function_answers_with_all_that_it_has) {
  OverlapModel model;
  if (!has_numpy()) return;
  open_model(&model, PYTHON("box"));
  ck_assert(overlap_model_has_own_centroid(&model) && !overlap_model_has_gradient(&model));
  OverlapBatch batch = batch_of(PAIRS, false, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_int_gt(check_boxes(PAIRS, pairs, volume, centroid, 1), PAIRS / 10);
  overlap_model_destroy(&model);
  static double logits[PAIRS], bounds[PAIRS];
  open_model(&model, PYTHON("with_all"));
  batch = batch_of(2, true, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_ok(model.ops->eval_logits(model.self, PAIRS, pairs[0], logits));
  ck_assert_ok(model.ops->eval_bounds(model.self, PAIRS, pairs[0], volume, bounds));
  ck_assert(logits[0] == -1.5 && logits[PAIRS - 1] == PAIRS - 2.5 && bounds[7] == 0.25);
  overlap_model_destroy(&model);
  open_model(&model, PYTHON("Made")); // a class is called first
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(a_python_function_declares_its_range_and_differentiates_its_doubt) {
  static double doubts[PAIRS], slopes[PAIRS][24];
  OverlapModel model;
  int beyond = 0, asked = 0;
  if (!has_numpy()) return;
  open_model(&model, PYTHON("ranged"));
  ck_assert(model.ops->gives_doubt_gradient && model.ops->range);
  ck_assert(model.ops->range->radius[0] == 0.1 && model.ops->range->overlap == 0.3);
  OverlapBatch batch = batch_of(PAIRS, true, false);
  batch.doubt = doubts, batch.doubt_gradient = slopes[0];
  ck_assert_ok(overlap_model_eval(&model, &batch));
  for (int i = 0; i < PAIRS; i++) {
    if (flags[i] & OVERLAP_DISJOINT) continue;
    ck_assert(doubts[i] == pairs[i][0] / 3 && slopes[i][0] == 1.0 / 3 && slopes[i][23] == 0);
    beyond += (flags[i] & OVERLAP_BEYOND) != 0, asked++;
  }
  ck_assert(beyond > 5 && beyond < asked - 5);
  overlap_model_destroy(&model);
}
END_TEST

// A force needs a place: that of clip, where the model has none.
START_TEST(a_model_of_v_alone_runs_where_its_volumes_are_placed) {
  static const char *const words[] = {PYTHON("alone"), "placed=" PYTHON("alone")};
  if (!has_numpy()) return;
  for (int k = 0; k < 2; k++) {
    char text[20000], folder[] = "/tmp/tetlap-foreign-XXXXXX", command[1500];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(command, sizeof command,
             "run %s/examples/02_two_blocks.yaml --set time.end=0.02 --set output.vtu=false --overlap %s -o "
             "%s",
             TETLAP_SOURCE_DIR, words[k], folder);
    const int code = run_program(command, text);
    ck_assert_msg(code == (k == 0 ? 65 : 0), "%s", text);
    ck_assert_msg(strstr(text, k == 0 ? "02_two_blocks.yaml with --overlap or --set: contact.overlap: '"
                                      : "overlap model placed=models:alone"),
                  "%s", text);
    ck_assert_msg(k > 0 || strstr(text, "gives V alone"), "%s", text);
    snprintf(command, sizeof command, "rm -r %s", folder);
    ck_assert_int_eq(system(command), 0);
  }
}
END_TEST

// The example of a command has a sixth of what the Python function above has.
START_TEST(a_command_answers_as_a_function_does) {
  enum { MANY = 3000 }; // more than the memory has room for at first
  OverlapModel model;
  static double x[MANY][24], v[MANY], middles[MANY][3];
  for (int i = 0; i < MANY; i++) memcpy(x[i], pairs[i % PAIRS], sizeof *x);
  open_model(&model, "exec:" TETLAP_MODEL_SERVE);
  for (int count = 10; count <= MANY; count *= 300) {
    OverlapBatch batch = {.pair_count = count, .pairs = x[0], .volume = v, .centroid = middles[0]};
    ck_assert_ok(overlap_model_eval(&model, &batch));
    ck_assert_int_gt(check_boxes(count, x, v, middles, 1.0 / 6), count / 10);
  }
  overlap_model_destroy(&model);
}
END_TEST

// More pairs than the memory that is shared at first has room for.
START_TEST(the_shared_memory_grows) {
  enum { MANY = 5000 };
  OverlapModel model;
  if (!has_numpy()) return;
  double(*x)[24] = calloc(MANY, sizeof *x), *v = calloc(MANY, sizeof *v);
  ck_assert(x && v);
  open_model(&model, PYTHON("box"));
  for (int i = 0; i < MANY; i++) memcpy(x[i], pairs[i % PAIRS], sizeof *x);
  for (int count = 1; count <= MANY; count = count * 9 + 1) {
    OverlapBatch batch = {.pair_count = count, .pairs = x[0], .volume = v};
    ck_assert_ok(overlap_model_eval(&model, &batch));
    for (int i = PAIRS; i < count; i++) ck_assert_double_eq(v[i], v[i % PAIRS]);
  }
  overlap_model_destroy(&model);
  free(x), free(v);
}
END_TEST

START_TEST(python_that_is_wrong) {
  if (!has_numpy()) return;
  setenv("TETLAP_MODEL_SECONDS", "20", 1);
  expect_refused(PYTHON("nothing"), STATUS_INPUT, "has no 'nothing'; it has box");
  expect_refused(PYTHON("NUMBER"), STATUS_INPUT, "NUMBER is int, expected a callable");
  expect_refused(PYTHON("wrong_shape"), STATUS_INPUT,
                 "volume of shape (1, 1), expected (1,); take the column out: squeeze(1)");
  expect_refused(PYTHON("ranged_wrong"), STATUS_INPUT,
                 "the range of ranged_wrong is (0.1, 0.7), expected a text");
  expect_refused(PYTHON("wrong_key"), STATUS_INPUT, "'volumes', which is none of volume");
  expect_refused(PYTHON("no_numbers"), STATUS_INPUT, "no array of numbers");
  expect_refused(PYTHON("complex_numbers"), STATUS_INPUT, "its type is complex128, expected float64");
  expect_refused(PYTHON("texts"), STATUS_INPUT, "its type is <U1, expected float64");
  expect_refused(PYTHON("forgets"), STATUS_INPUT, "returned None as volume: is a `return` missing?");
  expect_refused(TETLAP_SOURCE_DIR "/tests/overlap/foreign/torn.py", STATUS_INPUT, "SyntaxError");
  expect_refused("none.py:f", STATUS_INPUT, "there is no such file");
  expect_failure(PYTHON("raises"), STATUS_SOLVER, "raises: ValueError: no more than one");
  expect_refused(PYTHON("no_volume"), STATUS_INPUT, "no_volume returned no volume");
  expect_failure(PYTHON("changes_its_mind"), STATUS_SOLVER, "returned no centroid this time");
  expect_failure(PYTHON("dies"), STATUS_DEVICE, "ended by signal 9");
  expect_failure(PYTHON("leaves"), STATUS_SOLVER, "SystemExit");
  expect_failure(PYTHON("shrinks"), STATUS_SOLVER, "Operation not permitted");
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, false, true);
  open_model(&model, PYTHON("whole_numbers"));
  ck_assert_ok(overlap_model_eval(&model, &batch));
  overlap_model_destroy(&model);
  open_model(&model, PYTHON("alone"));
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "gives V alone"), "%s", status_message());
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(what_a_model_cannot_give_is_said_before_anything_is_written) {
  static const struct {
    const char *model, *order, *told;
    int code;
  } cases[] = {{PYTHON("whole_numbers"), "1", "gives no gradient; take --order 0", 64},
               {PYTHON("whole_numbers"), "0", "volume,centroid_x", 0},
               {PYTHON("alone"), "0", "gives V alone", 64}};
  if (!has_numpy()) return;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char text[20000], file[] = "/tmp/tetlap-foreign-XXXXXX", command[1500];
    static const char pair[] = "0,0,0,1,0,0,0,1,0,0,0,1,.1,.1,.1,1,0,0,0,1,0,0,0,1\n";
    const int descriptor = mkstemp(file);
    ck_assert(descriptor >= 0 && write(descriptor, pair, strlen(pair)) == (ssize_t)strlen(pair));
    ck_assert_int_eq(close(descriptor), 0);
    snprintf(command, sizeof command, "overlap %s --model %s --order %s", file, cases[k].model,
             cases[k].order);
    ck_assert_int_eq(run_program(command, text), cases[k].code);
    ck_assert_msg(strstr(text, cases[k].told), "%s", text);
    ck_assert(cases[k].code == 0 || !strstr(text, "centroid_x"));
    ck_assert_int_eq(remove(file), 0);
  }
}
END_TEST

// The model of this is the test: it answers before it is asked.
START_TEST(a_reply_that_comes_too_late_answers_no_other_request) {
  static const uint64_t done[4] = {0};
  OverlapModel model;
  char word[64];
  int ends[2], memory = memfd_create("memory", 0);
  OverlapBatch batch = batch_of(PAIRS, false, false);
  ck_assert(memory >= 0 && socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
  snprintf(word, sizeof word, "channel:%d:%d:late", ends[0], memory);
  setenv("TETLAP_MODEL_SECONDS", "0.2", 1);
  ck_assert_int_eq(send(ends[1], done, sizeof done, 0), sizeof done);
  open_model(&model, word);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_DEVICE);
  ck_assert_msg(strstr(status_message(), "late: the model has not answered within 0.2 s. "), "%s",
                status_message());
  send(ends[1], done, sizeof done, MSG_NOSIGNAL);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_DEVICE);
  overlap_model_destroy(&model);
  close(ends[0]), close(ends[1]), close(memory);
}
END_TEST

// What it leaves unwritten is what the memory held before: no answer.
START_TEST(a_model_that_writes_nothing_has_not_answered) {
  static const uint64_t done[4] = {0, 0, TETLAP_MODEL_LOGIT, 0};
  static double logits[PAIRS];
  OverlapModel model;
  char word[64];
  int ends[2], memory = memfd_create("memory", 0);
  OverlapBatch batch = batch_of(PAIRS, false, false);
  ck_assert(memory >= 0 && socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
  snprintf(word, sizeof word, "channel:%d:%d:silent", ends[0], memory);
  for (int i = 0; i < 3; i++) ck_assert_int_eq(send(ends[1], done, sizeof done, 0), sizeof done);
  open_model(&model, word);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "its volume is not a finite number"), "%s", status_message());
  ck_assert_int_eq(model.ops->eval_logits(model.self, PAIRS, pairs[0], logits), STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "its logit"), "%s", status_message());
  overlap_model_destroy(&model);
  close(ends[0]), close(ends[1]), close(memory);
  expect_failure(TETLAP_MODEL_10, STATUS_SOLVER, "its volume is not a finite number");
}
END_TEST

START_TEST(a_model_gets_no_file_of_the_program) {
  OverlapModel model;
  if (!has_numpy()) return;
  ck_assert_int_eq(dup2(2, 77), 77);
  open_model(&model, PYTHON("has_no_77")); // which fails where it has
  overlap_model_destroy(&model);
  close(77);
}
END_TEST

// How many processes this one has started, and not yet ended.
static int count_children(void) {
  int count = 0;
  DIR *processes = opendir("/proc");
  ck_assert_ptr_nonnull(processes);
  for (struct dirent *entry; (entry = readdir(processes));) {
    char path[300];
    int parent = 0;
    snprintf(path, sizeof path, "/proc/%.64s/stat", entry->d_name);
    FILE *stream = fopen(path, "r");
    if (!stream) continue;
    if (fscanf(stream, "%*d (%*[^)]) %*c %d", &parent) == 1) count += parent == getpid();
    fclose(stream);
  }
  closedir(processes);
  return count;
}

START_TEST(commands_that_are_wrong_leave_no_process) {
  expect_refused("exec:no-such-command-anywhere", STATUS_INPUT, "the command was not found");
  expect_refused("exec:false", STATUS_DEVICE, "ended with exit code 1 and without an answer");
  expect_refused("exec: ", STATUS_INPUT, "a command is missing behind it, as in exec:./model");
  setenv("TETLAP_MODEL_SECONDS", "0.3", 1);
  expect_refused("exec:sleep 1000", STATUS_DEVICE, "has not answered within 0.3 s");
  if (has_numpy()) {
    setenv("TETLAP_MODEL_SECONDS", "20", 1);
    OverlapModel model;
    open_model(&model, PYTHON("hangs"));
    ck_assert_int_eq(count_children(), 1);
    overlap_model_destroy(&model);
  }
  setenv("TETLAP_MODEL_SECONDS", "5 min", 1);
  expect_refused("exec:true", STATUS_USAGE, "must be a number of seconds");
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

// A process that has not ended; a zombie has.
static bool is_alive(pid_t pid) {
  char path[64], state = 'X';
  snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
  FILE *stream = fopen(path, "r");
  if (!stream) return false;
  if (fscanf(stream, "%*d (%*[^)]) %c", &state) != 1) state = 'X';
  fclose(stream);
  return state != 'Z' && state != 'X';
}

START_TEST(what_a_model_has_started_ends_with_it) {
  if (!has_numpy()) return;
  setenv("TETLAP_MODEL_SECONDS", "100", 1);
  OverlapModel model;
  OverlapBatch batch = batch_of(1, false, false);
  memcpy(pairs[0] + 12, pairs[0], 12 * sizeof pairs[0][0]);
  open_model(&model, PYTHON("starts_another"));
  ck_assert_ok(overlap_model_eval(&model, &batch));
  const pid_t other = (pid_t)volume[0];
  ck_assert(is_alive(other));
  overlap_model_destroy(&model);
  for (int k = 0; k < 200 && is_alive(other); k++) usleep(10000); // SIGKILL is under way
  ck_assert(!is_alive(other));
  expect_failure(PYTHON("dies_and_leaves_another"), STATUS_DEVICE, "ended by signal 9");
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

// Else two would answer one request, and the second answer be taken for the next one's.
START_TEST(a_model_that_forks_answers_once) {
  if (!has_numpy()) return;
  OverlapModel model;
  double answers[PAIRS];
  open_model(&model, PYTHON("box"));
  OverlapBatch batch = batch_of(PAIRS, false, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  memcpy(answers, volume, sizeof answers);
  overlap_model_destroy(&model);
  open_model(&model, PYTHON("forks"));
  for (int k = 0; k < 5; k++) {
    batch = batch_of(PAIRS - 10 * k, false, true);
    ck_assert_ok(overlap_model_eval(&model, &batch));
    ck_assert_int_eq(memcmp(answers, volume, (size_t)batch.pair_count * sizeof *answers), 0);
  }
  overlap_model_destroy(&model);
  open_model(&model, PYTHON("spoils")); // nor does what it writes over its input matter
  batch = batch_of(PAIRS, false, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_int_eq(memcmp(answers, volume, sizeof answers), 0);
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(what_a_model_prints_is_no_output_of_the_program) {
  if (!has_numpy()) return;
  OverlapModel model;
  char text[1000] = "";
  OverlapBatch batch = batch_of(PAIRS, false, true);
  FILE *out = tmpfile(), *err = tmpfile();
  ck_assert(out && err);
  fflush(NULL);
  const int stdout_before = dup(1), stderr_before = dup(2);
  dup2(fileno(out), 1), dup2(fileno(err), 2);
  open_model(&model, PYTHON("prints"));
  Status status = overlap_model_eval(&model, &batch);
  overlap_model_destroy(&model);
  dup2(stdout_before, 1), dup2(stderr_before, 2);
  close(stdout_before), close(stderr_before);
  ck_assert_int_eq(status, STATUS_OK);
  ck_assert_int_eq(lseek(fileno(out), 0, SEEK_END), 0);
  rewind(err);
  text[fread(text, 1, sizeof text - 1, err)] = 0;
  ck_assert_msg(strstr(text, "one 1\none "), "%s", text);
  fclose(out), fclose(err);
}
END_TEST

START_TEST(a_python_that_lacks_something_says_what_to_do) {
  setenv("TETLAP_PYTHON", "/no/such/python", 1);
  expect_refused(PYTHON("box"), STATUS_INPUT, "there is no Python to run it: set TETLAP_PYTHON");
  setenv("TETLAP_PYTHON", TETLAP_SOURCE_DIR "/tests/overlap/foreign/bare_python", 1);
  expect_refused(PYTHON("box"), STATUS_INPUT, "set TETLAP_PYTHON to a Python that has it");
  ck_assert_msg(strstr(status_message(), "has no NumPy"), "%s", status_message());
  setenv("TETLAP_PYTHON", TETLAP_PYTHON, 1);
  if (!has_numpy()) return;
  expect_refused(TETLAP_SOURCE_DIR "/tests/overlap/foreign/unmet.py", STATUS_INPUT,
                 "No module named 'a_module_that_nobody_has' in /");
  ck_assert_msg(strstr(status_message(), "set TETLAP_PYTHON to a Python that has it"), "%s",
                status_message());
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

// A wish to end that came before the request, or between it and the wait for its answer, which no signal
// interrupts any more.
START_TEST(a_wish_to_end_is_seen_while_a_model_computes) {
  if (!has_numpy()) return;
  OverlapModel model;
  setenv("TETLAP_MODEL_SECONDS", "300", 1);
  open_model(&model, PYTHON("hangs"));
  *interrupt_flag() = 1;
  double v[PAIRS];
  OverlapBatch batch = {.pair_count = PAIRS, .pairs = pairs[0], .volume = v};
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INTERRUPTED);
  overlap_model_destroy(&model);
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("processes of users");
  draw();
  setenv("TETLAP_PYTHON", TETLAP_PYTHON, 1);
  tcase_add_test(cases, a_python_function_answers_with_all_that_it_has);
  tcase_add_test(cases, a_python_function_declares_its_range_and_differentiates_its_doubt);
  tcase_add_test(cases, a_model_of_v_alone_runs_where_its_volumes_are_placed);
  tcase_add_test(cases, a_command_answers_as_a_function_does);
  tcase_add_test(cases, the_shared_memory_grows);
  tcase_add_test(cases, python_that_is_wrong);
  tcase_add_test(cases, a_reply_that_comes_too_late_answers_no_other_request);
  tcase_add_test(cases, what_a_model_cannot_give_is_said_before_anything_is_written);
  tcase_add_test(cases, a_model_that_writes_nothing_has_not_answered);
  tcase_add_test(cases, a_model_gets_no_file_of_the_program);
  tcase_add_test(cases, commands_that_are_wrong_leave_no_process);
  tcase_add_test(cases, what_a_model_has_started_ends_with_it);
  tcase_add_test(cases, a_model_that_forks_answers_once);
  tcase_add_test(cases, what_a_model_prints_is_no_output_of_the_program);
  tcase_add_test(cases, a_python_that_lacks_something_says_what_to_do);
  tcase_add_test(cases, a_wish_to_end_is_seen_while_a_model_computes);
  return suite_run("processes of users", cases, 60);
}
