// SPDX-License-Identifier: GPL-3.0-or-later
// Devices by drivers of tests (fake/), which run kernels as plain C: everything between the program and a
// driver is what it is with a real one. Without faults the answers are those of `host` to the bit, through
// OpenCL and through CUDA. Then every call of a driver fails once: refused, with the device lost at it, or
// with a loss that shows at the next. What comes of it is one message, an exit code, and nothing half
// written; all that was made is given back.
#include "suite.h"

#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/bench/overlap/pairs.h"
#include "datagen/hard.h"
#include "device/overlap/overlap.h"
#include "fake/faults.h"

enum { COUNT = 24, HARD = 8, ALL = COUNT + HARD, CODES = 3, KINDS = 3 };

// A library of tests, as this program and those that it starts load it.
typedef struct Driver {
  const char *name, *device, *path;
  const int codes[CODES];       // that its calls fail with
  const Status statuses[CODES]; // what they mean
  const char *words[CODES];     // what a message quotes
  const char *forgiven[4];      // functions that may fail: what they say is not needed
  void (*set_fault)(const char *, int, int, FakeKind);
  int (*calls)(const char *);
  const char *(*failed)(void);
  int (*kept)(void);
} Driver;

enum { OPENCL, CUDA, NVRTC, DRIVERS };

static Driver drivers[DRIVERS] = {
    {.name = "OpenCL",
     .device = "opencl",
     .path = TETLAP_FAKE_OPENCL,
     .codes = {-36, -4, -5},
     .statuses = {STATUS_DEVICE, STATUS_MEMORY, STATUS_DEVICE},
     .words = {"error -36, ", "error -4, no memory", "error -5, out of resources"},
     .forgiven = {"clGetProgramInfo", "clCreateProgramWithBinary"}},
    {.name = "CUDA",
     .device = "cuda",
     .path = TETLAP_FAKE_CUDA,
     .codes = {719, 2, 701},
     .statuses = {STATUS_DEVICE, STATUS_MEMORY, STATUS_DEVICE},
     .words = {"CUDA_ERROR_LAUNCH_FAILED", "CUDA_ERROR_OUT_OF_MEMORY", "CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES"}},
    {.name = "NVRTC",
     .device = "cuda",
     .path = TETLAP_FAKE_NVRTC,
     .codes = {11, 1, 5},
     .statuses = {STATUS_DEVICE, STATUS_MEMORY, STATUS_DEVICE},
     .words = {"NVRTC_ERROR_INTERNAL_ERROR", "NVRTC_ERROR_OUT_OF_MEMORY", "NVRTC_ERROR_INVALID_OPTION"},
     .forgiven = {"nvrtcDestroyProgram", "nvrtcGetProgramLogSize", "nvrtcGetProgramLog"}},
};

// Functions that may fail: what they say is not needed, or they give back.
static bool is_forgiven(const Driver *driver, const char *function) {
  static const char *const giving_back[] = {"Release", "Destroy", "Free", "Unload"};
  for (size_t k = 0; k < sizeof giving_back / sizeof *giving_back; k++)
    if (strstr(function, giving_back[k])) return true;
  for (const char *const *name = driver->forgiven; *name; name++)
    if (strcmp(*name, function) == 0) return true;
  return false;
}

static bool find_function(void *library, const char *name, void *address) {
  void *found = dlsym(library, name);
  if (found) memcpy(address, &found, sizeof found);
  return found != NULL;
}

static bool open_driver(Driver *driver) {
  void *library = dlopen(driver->path, RTLD_NOW | RTLD_LOCAL);
  if (!library) fprintf(stderr, "%s\n", dlerror());
  return library && find_function(library, "fake_fail", &driver->set_fault) &&
         find_function(library, "fake_calls", &driver->calls) &&
         find_function(library, "fake_failed", &driver->failed) &&
         find_function(library, "fake_kept", &driver->kept);
}

static double pairs[ALL * 24];

typedef struct Answers {
  double volume[ALL], more[ALL * 24];
  unsigned flags[ALL];
} Answers;

static Status evaluate(DeviceOverlap *overlap, Answers *answers) {
  memset(answers, 0, sizeof *answers);
  const OverlapBatch batch = {.pair_count = ALL,
                              .pairs = pairs,
                              .volume = answers->volume,
                              .gradient = answers->more,
                              .flags = answers->flags};
  return device_overlap_eval(overlap, &batch);
}

static void check_same(const Answers *a, const Answers *b, const char *what) {
  for (int i = 0; i < ALL; i++) {
    ck_assert_msg(memcmp(&a->volume[i], &b->volume[i], sizeof(double)) == 0 && a->flags[i] == b->flags[i],
                  "%s, pair %d: V = %.17g, flags %u; host %.17g, flags %u", what, i, a->volume[i],
                  a->flags[i], b->volume[i], b->flags[i]);
    ck_assert_msg(memcmp(&a->more[24 * i], &b->more[24 * i], 24 * sizeof(double)) == 0, "%s, pair %d: ∇V",
                  what, i);
  }
}

typedef struct Outcome {
  Status status;
  char message[1000];
  const char *failed; // the function that failed first, before all is given back; NULL: none
  int calls;          // of the driver, to the end
} Outcome;

// From opening the device to closing it, with a fault of `driver`. A model that is there when a call fails
// answers the next time, if the device is still there.
static Outcome ask(Driver *driver, int call, int code, FakeKind kind, const char *model, Answers *answers,
                   const Answers *expected) {
  Device device;
  DeviceOverlap overlap = {0};
  for (int k = 0; k < DRIVERS; k++) drivers[k].set_fault(NULL, -1, 0, FAKE_ONCE);
  driver->set_fault(NULL, call, code, kind);
  Outcome outcome = {.status = device_open(&device, driver->device)};
  if (!outcome.status) outcome.status = device_overlap_create(&overlap, &device, model);
  const bool is_made = !outcome.status;
  if (is_made) outcome.status = evaluate(&overlap, answers);
  if (outcome.status) snprintf(outcome.message, sizeof outcome.message, "%s", status_message());
  outcome.failed = driver->failed();
  const int calls = driver->calls(NULL);
  const bool is_asked_again = is_made && outcome.status && kind == FAKE_ONCE;
  if (is_asked_again) ck_assert_ok(evaluate(&overlap, answers));
  if (is_asked_again) check_same(answers, expected, "after a failure");
  device_overlap_destroy(&overlap);
  device_close(&device);
  outcome.calls = is_asked_again ? calls : driver->calls(NULL);
  for (int k = 0; k < DRIVERS; k++) {
    const int kept = drivers[k].kept();
    ck_assert_msg(kept == 0, "%s, %s, call %d: %d objects are kept", drivers[k].name, model, call, kept);
  }
  return outcome;
}

static void ask_host(const char *model, Answers *answers) {
  Device device;
  DeviceOverlap overlap;
  ck_assert_ok(device_open(&device, "host"));
  ck_assert_ok(device_overlap_create(&overlap, &device, model));
  ck_assert_ok(evaluate(&overlap, answers));
  // all ways are gone: stages, and pairs that the host answers
  ck_assert_int_gt(overlap.handed_on[overlap.stage_count - 1], 0);
  device_overlap_destroy(&overlap);
  device_close(&device);
}

// tpn-bf16 too: kernels that are run are those of `host`, with the emulated product.
START_TEST(without_faults_the_answers_are_those_of_host) {
  static Answers expected, answers;
  const char *model = device_overlap_models[_i];
  ask_host(model, &expected);
  for (int k = OPENCL; k <= CUDA; k++) {
    const Outcome outcome = ask(&drivers[k], -1, 0, FAKE_ONCE, model, &answers, NULL);
    ck_assert_msg(!outcome.status, "%s", outcome.message);
    check_same(&answers, &expected, drivers[k].name);
    ck_assert_int_gt(outcome.calls, 60);
  }
}
END_TEST

// The message names the device, or the compiler, and quotes the code.
static void check_message(const Driver *driver, int k, const char *message, const char *what) {
  const bool is_named = strstr(message, "device '") == message || strstr(message, "NVRTC") == message;
  ck_assert_msg(is_named && strstr(message, driver->words[k]) != NULL, "%s: %s", what, message);
  ck_assert_msg(strchr(message, '\n') == NULL, "%s: %s", what, message);
}

// A device that its driver does not describe is none, whatever the reason. -5 is OpenCL's word for no memory
// where that is asked for, and elsewhere of drivers for a device that they lost.
static bool is_right(const Driver *driver, const char *function, int k, Status status, const char *message) {
  const bool is_query = strstr(function, "Get") != NULL || strstr(function, "TotalMem") != NULL ||
                        strcmp(function, "cuInit") == 0;
  if (driver->codes[k] == -5 && strstr(message, ": taking ")) return status == STATUS_MEMORY;
  return status == driver->statuses[k] || (is_query && status == STATUS_DEVICE);
}

// That call of a driver fails. False: there are not so many.
static bool fail_at(Driver *driver, const char *model, int call, FakeKind kind, const Answers *expected) {
  static Answers answers;
  char what[200];
  const int k = call % CODES;
  const Outcome outcome = ask(driver, call, driver->codes[k], kind, model, &answers, expected);
  snprintf(what, sizeof what, "%s, %s, call %d (%s)", driver->name, model, call,
           outcome.failed ? outcome.failed : "none");
  if (outcome.status == STATUS_OK) {
    ck_assert_msg(!outcome.failed || is_forgiven(driver, outcome.failed), "%s: no failure", what);
    check_same(&answers, expected, what);
    return outcome.calls > call;
  }
  ck_assert_msg(outcome.failed && is_right(driver, outcome.failed, k, outcome.status, outcome.message),
                "%s: status %d: %s", what, (int)outcome.status, outcome.message);
  check_message(driver, k, outcome.message, what);
  return true;
}

START_TEST(every_call_of_a_driver_that_fails_is_told_and_nothing_is_kept) {
  // whose programs are those of all models, or differ by a number
  static const char *const models[] = {"clip32", "tpn-bf16", "geo-small"};
  static Answers expected;
  const char *model = models[_i / DRIVERS];
  Driver *driver = &drivers[_i % DRIVERS];
  ask_host(model, &expected);
  for (int kind = 0; kind < KINDS; kind++) {
    int calls = 0;
    while (fail_at(driver, model, calls, (FakeKind)kind, &expected)) calls++;
    ck_assert_int_ge(calls, 10);
    if (kind == 0) printf("%s, %s: %d calls\n", model, driver->name, calls);
  }
}
END_TEST

// --- The program by itself, in a folder of its own.

static char folder[] = "/tmp/tetlap-driver-XXXXXX";

static const char scene[] =
    "bodies:\n"
    "- {name: upper, mesh: {box: {size: [1, 1, 1], cells: 1}}, place: {translate: [-0.4, -0.3, 0]},\n"
    "   material: {young: 1e5, poisson: 0.3, density: 1000}}\n"
    "- {name: lower, mesh: {box: {size: [2, 2, 2], cells: 1}}, place: {translate: [-1, -1, -2]},\n"
    "   material: {young: 1e5, poisson: 0.3, density: 1000}}\n"
    "time: {end: 1}\n";
// The second touches: faces in one plane, doubtful pairs.
static const char pose_list[] = "1 0 0 0 1 0 0 0 1 0.01 -0.02 -0.2\n"
                                "1 0 0 0 1 0 0 0 1 0.4 0.3 -1\n"
                                "0 -1 0 1 0 0 0 0 1 0.1 0 -0.3\n";

static void write_file(const char *name, const char *content) {
  char path[300];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fputs(content, file);
  fclose(file);
}

// The caller's.
static char *read_file(const char *name) {
  enum { MOST = 100000 };
  char path[300], *content = calloc(MOST, 1);
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "r");
  ck_assert_msg(file != NULL, "no %s", path);
  ck_assert_uint_lt(fread(content, 1, MOST, file), MOST);
  fclose(file);
  return content;
}

static int file_count(void) {
  int count = 0;
  DIR *directory = opendir(folder);
  ck_assert_ptr_nonnull(directory);
  while (readdir(directory)) count++;
  closedir(directory);
  return count - 2; // . and ..
}

// The command, in that folder; the exit code.
static int run(const char *environment, const char *words) {
  char command[3000];
  snprintf(command, sizeof command, "cd %s && %s %s > out.txt 2> error.txt", folder, environment, words);
  const int status = system(command);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

#define POSES TETLAP_PROGRAM " poses scene.yaml --poses poses.txt -t 1 -o table.csv --device "
#define BENCH TETLAP_LAB " device --model clip --set near --quantity V --batch 200 --repeat 1 --json -t 1 "

// A command on a device whose driver fails. What it ends with, and what it leaves.
static void check_command(const Driver *driver, const char *arguments, const char *function, int call, int k,
                          const char *kind, const char *expected) {
  char environment[200], command[600], what[1300];
  snprintf(environment, sizeof environment, "FAKE_FAIL=%s:%d:%d:%s", function, call, driver->codes[k], kind);
  snprintf(command, sizeof command, "%s%s", arguments, driver->device);
  write_file("table.csv", "an earlier one\n");
  const int code = run(environment, command);
  char *error = read_file("error.txt"), *output = read_file("out.txt"), *table = read_file("table.csv");
  snprintf(what, sizeof what, "%s %s: exit code %d: %s", environment, command, code, error);
  ck_assert_msg(file_count() == 5, "%s: %d files", what, file_count());
  if (code == 0) {
    ck_assert_msg(strstr(error, "objects are kept") == NULL, "%s", what);
    ck_assert_msg(!expected || strcmp(table, expected) == 0, "%s: %s", what, table);
  } else {
    ck_assert_msg(is_right(driver, function, k, (Status)-code, error), "%s", what);
    ck_assert_msg(strchr(error, '\n') == error + strlen(error) - 1, "%s: not one line", what);
    ck_assert_msg(strstr(error, driver->words[k]) != NULL, "%s", what);
    ck_assert_msg(strcmp(output, "") == 0 && strcmp(table, "an earlier one\n") == 0, "%s: %s%s", what, output,
                  table);
  }
  // where nothing waits for kernels, clFinish is part of closing; what is lost with the last call shows
  // nowhere
  const bool is_last = strcmp(function, "clFinish") == 0 || strcmp(kind, "later") == 0;
  ck_assert_msg(code != 0 || is_forgiven(driver, function) || is_last, "%s: no failure", what);
  free(error), free(output), free(table);
}

// The functions that a command calls and how often, of the driver: lines of FAKE_CALLS.
static int count_calls(const Driver *driver, const char *arguments, char names[][64], int counts[]) {
  char command[600];
  snprintf(command, sizeof command, "%s%s", arguments, driver->device);
  ck_assert_int_eq(run("FAKE_CALLS=calls.txt", command), 0);
  char *lines = read_file("calls.txt"), *rest = lines;
  const char *prefix = driver == &drivers[OPENCL] ? "cl" : driver == &drivers[CUDA] ? "cu" : "nvrtc";
  int count = 0, used;
  while (sscanf(rest, "%63s %d %n", names[count], &counts[count], &used) == 2) {
    if (strncmp(names[count], prefix, strlen(prefix)) == 0) count++;
    rest += used;
  }
  free(lines);
  char path[300];
  snprintf(path, sizeof path, "%s/calls.txt", folder);
  remove(path);
  return count;
}

enum { MOST_NAMES = 40 };

START_TEST(a_table_of_poses_is_that_of_host_or_the_earlier_one) {
  const Driver *driver = &drivers[_i];
  char names[MOST_NAMES][64];
  int counts[MOST_NAMES];
  ck_assert_int_eq(run("", POSES "host"), 0);
  char *expected = read_file("table.csv");
  const int count = count_calls(driver, POSES, names, counts);
  char *table = read_file("table.csv");
  ck_assert_str_eq(table, expected);
  ck_assert_int_ge(count, driver == &drivers[NVRTC] ? 5 : 15);
  for (int f = 0; f < count; f++) {
    const int calls[] = {0, counts[f] / 2, counts[f] - 1};
    for (int c = 0; c < 3; c++)
      if (c == 0 || calls[c] > calls[c - 1])
        check_command(driver, POSES, names[f], calls[c], (f + c) % CODES, "once", expected);
    check_command(driver, POSES, names[f], counts[f] / 2, f % CODES, "lost", expected);
    check_command(driver, POSES, names[f], 0, f % CODES, "later", expected);
  }
  free(expected), free(table);
}
END_TEST

START_TEST(a_bench_that_fails_prints_one_message) {
  const Driver *driver = &drivers[_i];
  char names[MOST_NAMES][64];
  int counts[MOST_NAMES];
  const int count = count_calls(driver, BENCH, names, counts);
  for (int f = 0; f < count; f++) {
    check_command(driver, BENCH, names[f], 0, f % CODES, "once", NULL);
    check_command(driver, BENCH, names[f], counts[f] > 3 ? 3 : 0, (f + 1) % CODES, "lost", NULL);
    check_command(driver, BENCH, names[f], 0, (f + 2) % CODES, "later", NULL);
  }
}
END_TEST

static double number_after(const char *text, const char *key) {
  const char *at = strstr(text, key);
  ck_assert_msg(at != NULL, "no %s in %s", key, text);
  return strtod(at + strlen(key), NULL); // 0 for null
}

// CUDA's driver of tests has one multiprocessor at 1 GHz, which issues four instructions of 32 items a cycle
// and does 64 fused multiply-adds in double, 128 in float. Of OpenCL's, which calls itself a GPU, the peak is
// measured by a kernel, of the processor by a loop.
START_TEST(shares_of_peak_and_issue_are_of_what_the_device_can_do) {
  enum { WANTED = 4 };
  static const struct {
    const char *arguments;
    double flops, instructions, peak; // instructions 0: not told
  } wanted[WANTED] = {{"cuda --model clip --quantity V", 1557, 1153, 128e9},
                      {"cuda --model clip32 --quantity V+grad", 2138, 1582, 256e9},
                      {"opencl --model clip --quantity V", 0, 0, 1},
                      {"host --model clip --quantity V", 0, 0, 1}};
  for (int k = 0; k < WANTED; k++) {
    char arguments[600];
    snprintf(arguments, sizeof arguments,
             TETLAP_LAB " device --set near --residence device --batch 200 --repeat 1 --json -t 1 %s",
             wanted[k].arguments);
    ck_assert_int_eq(run("", arguments), 0);
    char *output = read_file("out.txt");
    const double rate = number_after(output, "\"kernel_pairs_s\":");
    const double issue = number_after(output, "\"of_issue\":"), peak = number_after(output, "\"of_peak\":");
    ck_assert_near(issue / (wanted[k].instructions * rate / 128e9 + (wanted[k].instructions == 0)),
                   wanted[k].instructions > 0, 1e-9);
    if (wanted[k].flops > 0) ck_assert_near(peak / (wanted[k].flops * rate / wanted[k].peak), 1, 1e-9);
    ck_assert_msg(peak > 0 && isfinite(peak), "%s: %g of the peak", wanted[k].arguments, peak);
    free(output);
  }
}
END_TEST

START_TEST(devices_are_listed_though_a_driver_fails) {
  ck_assert_int_eq(run("FAKE_FAIL=clGetDeviceInfo:2:-2", TETLAP_PROGRAM " devices"), 0);
  char *output = read_file("out.txt");
  ck_assert_msg(strstr(output, "not usable: its driver does not describe it: error -2, device not available"),
                "%s", output);
  ck_assert_msg(strstr(output, "cuda:0  a device of tests"), "%s", output);
  free(output);
}
END_TEST

static void make_folder(void) {
  ck_assert_ptr_nonnull(mkdtemp(folder));
  write_file("scene.yaml", scene);
  write_file("poses.txt", pose_list);
}

static void remove_folder(void) {
  char command[100];
  snprintf(command, sizeof command, "rm -r %s", folder);
  if (system(command) != 0) fprintf(stderr, "%s stays\n", folder);
}

static bool make_pairs(void) {
  if (app_bench_pairs_make("uniform", COUNT, 3, pairs) != STATUS_OK) return false;
  for (int i = 0; i < HARD; i++)
    memcpy(pairs + (size_t)(COUNT + i) * 24, datagen_hard_make(i % DATAGEN_HARD_CLASS_COUNT, i).x,
           24 * sizeof *pairs);
  // The first flat: the host's, except for networks that choose which one comes first. Both flat: the host's.
  memset(pairs, 0, 12 * sizeof *pairs);
  memset(pairs + 24, 0, 24 * sizeof *pairs);
  return true;
}

int main(void) {
  setenv("CK_FORK", "no", 1); // the drivers' counts are of this process
  setenv("TETLAP_OPENCL", TETLAP_FAKE_OPENCL, 1);
  setenv("TETLAP_CUDA", TETLAP_FAKE_CUDA, 1);
  setenv("TETLAP_NVRTC", TETLAP_FAKE_NVRTC, 1);
  setenv("TETLAP_CACHE", "/dev/null", 1);
  for (int k = 0; k < DRIVERS; k++)
    if (!open_driver(&drivers[k])) return EXIT_FAILURE;
  if (!make_pairs()) return EXIT_FAILURE;
  TCase *cases = tcase_create("device_driver");
  tcase_add_loop_test(cases, without_faults_the_answers_are_those_of_host, 0, DEVICE_OVERLAP_MODELS);
  tcase_add_loop_test(cases, every_call_of_a_driver_that_fails_is_told_and_nothing_is_kept, 0, 3 * DRIVERS);
  tcase_add_loop_test(cases, a_table_of_poses_is_that_of_host_or_the_earlier_one, 0, DRIVERS);
  tcase_add_loop_test(cases, a_bench_that_fails_prints_one_message, 0, DRIVERS);
  tcase_add_test(cases, devices_are_listed_though_a_driver_fails);
  tcase_add_test(cases, shares_of_peak_and_issue_are_of_what_the_device_can_do);
  tcase_add_unchecked_fixture(cases, make_folder, remove_folder);
  return suite_run("device driver", cases, 300);
}
