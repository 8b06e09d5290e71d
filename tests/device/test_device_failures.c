// SPDX-License-Identifier: GPL-3.0-or-later
// What devices do when something is not there or fails: one message, an exit code. A driver that refuses
// stands in for libcuda (fake/cuda.c), one for
// libOpenCL (fake/opencl.c). Where NVRTC is found, every program compiles for GPUs without spills.
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory.h"
#include "device/backend/cache.h"
#include "device/backend/cuda.h"
#include "device/overlap/overlap.h"
#include "fake/programs.h"

typedef struct Outcome {
  int code;
  char text[6000]; // of both streams
} Outcome;

static Outcome run(const char *environment, const char *arguments) {
  char command[6000];
  Outcome outcome;
  snprintf(command, sizeof command, "%s %s 2>&1", environment, arguments);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  size_t size = fread(outcome.text, 1, sizeof outcome.text - 1, pipe);
  outcome.text[size] = 0;
  int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

static int lines_of(const char *text) {
  int lines = 0;
  for (; *text; text++) lines += *text == '\n';
  return lines;
}

static void check_refused(const char *environment, const char *arguments, int code, const char *word) {
  Outcome outcome = run(environment, arguments);
  ck_assert_msg(outcome.code == code, "%s: exit code %d: %s", environment, outcome.code, outcome.text);
  ck_assert_msg(strstr(outcome.text, word) != NULL, "%s: '%s' is not in: %s", environment, word,
                outcome.text);
  ck_assert_msg(lines_of(outcome.text) == 1, "%s: more than one line: %s", environment, outcome.text);
}

#define BENCH TETLAP_LAB " device --model clip --set near --quantity V --batch 200 --repeat 1 "

START_TEST(what_is_not_there_is_said) {
  check_refused("TETLAP_CUDA=/nowhere.so", BENCH "cuda", 69, "/nowhere.so was not found");
  check_refused("TETLAP_OPENCL=/nowhere.so", BENCH "opencl", 69, "/nowhere.so was not found");
  check_refused("TETLAP_CUDA=/nowhere.so TETLAP_OPENCL=/nowhere.so", BENCH "auto", 69, "no GPU");
  check_refused("", BENCH "gpu", 64, "host, opencl, cuda or auto");
  check_refused("", BENCH "host:7", 69, "none of that number");
  check_refused("TETLAP_CUDA=libm.so.6", BENCH "cuda", 69, "has no function cuInit");
}
END_TEST

#define FAKE "TETLAP_NVRTC=" TETLAP_FAKE_NVRTC " TETLAP_CACHE=/dev/null TETLAP_CUDA=" TETLAP_FAKE_CUDA " "
#define FAKE_OPENCL "TETLAP_CACHE=/dev/null TETLAP_OPENCL=" TETLAP_FAKE_OPENCL " "

START_TEST(a_driver_that_refuses_is_quoted) {
  check_refused(FAKE "FAKE_FAIL=cuInit:0:3", BENCH "cuda", 69, "CUDA_ERROR_NOT_INITIALIZED");
  check_refused(FAKE "FAKE_CUDA=device", BENCH "cuda", 69, "no device");
  check_refused(FAKE "FAKE_CUDA=old", BENCH "cuda", 69, "compute capability 5.0");
  check_refused(FAKE "TETLAP_NVRTC=/nowhere.so", BENCH "cuda", 69, "/nowhere.so was not found");
}
END_TEST

static bool has_compiler(void) {
  char reason[DEVICE_TEXT];
  if (device_cuda_compiler(reason)) return true;
  suite_skip("NVRTC: %s", reason);
  return false;
}

// By a driver and a compiler of tests; whatever is kept would be a second line. Models with a network besides
// one that clips.
START_TEST(a_device_that_fails_on_the_way_is_quoted) {
  static const char *const models[] = {"clip", "tpn", "tpn-bf16", "geo"};
  const char *model = models[_i];
  char bench[600], refused[100];
  snprintf(bench, sizeof bench,
           TETLAP_LAB " device --model %s --set near --quantity V+grad --batch 200 --repeat 1 ", model);
  snprintf(refused, sizeof refused, "NVRTC rejected program '%s' for sm_90", model);
  char cuda[620], opencl[620];
  snprintf(cuda, sizeof cuda, "%scuda", bench), snprintf(opencl, sizeof opencl, "%sopencl", bench);
  check_refused("TETLAP_OPENCL=/nowhere.so", opencl, 69, "/nowhere.so was not found");
  check_refused(FAKE "FAKE_CUDA=device", cuda, 69, "no device");
  check_refused(FAKE "FAKE_NVRTC=refuse", cuda, 69, refused);
  check_refused(FAKE "FAKE_FAIL=cuModuleLoadData:0:200", cuda, 69, "CUDA_ERROR_INVALID_IMAGE");
  check_refused(FAKE "FAKE_FAIL=cuMemAlloc_v2:3:2", cuda, 71, "CUDA_ERROR_OUT_OF_MEMORY");
  check_refused(FAKE "FAKE_FAIL=cuLaunchKernel:0:701", cuda, 69, "CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES");
  check_refused(FAKE "FAKE_FAIL=cuLaunchKernel:0:719:later", cuda, 69, "CUDA_ERROR_LAUNCH_FAILED");
  check_refused(FAKE "FAKE_FAIL=cuLaunchKernel:3:719:later", cuda, 69, "CUDA_ERROR_LAUNCH_FAILED");
  snprintf(refused, sizeof refused, "rejected program '%s': kernel.cl:1: error: the compiler of tests",
           model);
  check_refused(FAKE_OPENCL "FAKE_FAIL=clBuildProgram:0:-11", opencl, 69, refused);
  check_refused(FAKE_OPENCL "FAKE_FAIL=clCreateBuffer:3:-4", opencl, 71, "no memory for the object");
  check_refused(FAKE_OPENCL "FAKE_FAIL=clEnqueueNDRangeKernel:0:-54", opencl, 69, "invalid work-group size");
  check_refused(FAKE_OPENCL "FAKE_FAIL=clEnqueueNDRangeKernel:3:-5:later", opencl, 69, "the device is lost");
}
END_TEST

START_TEST(devices_lists_all_kinds_and_reasons) {
  Outcome outcome = run("TETLAP_CUDA=/nowhere.so TETLAP_OPENCL=/nowhere.so", TETLAP_PROGRAM " devices");
  ck_assert_int_eq(outcome.code, 0);
  ck_assert_ptr_nonnull(strstr(outcome.text, "host:0"));
  ck_assert_ptr_nonnull(strstr(outcome.text, "none: /nowhere.so was not found"));
  outcome = run(FAKE "TETLAP_OPENCL=/nowhere.so", TETLAP_PROGRAM " devices --json");
  ck_assert_int_eq(outcome.code, 0);
  ck_assert_ptr_nonnull(strstr(outcome.text, "\"a device of tests\""));
  ck_assert_ptr_nonnull(strstr(outcome.text, "\"reason\": \"/nowhere.so was not found"));
}
END_TEST

// The largest number that the compiler's account has before `word`.
static int largest_before(const char *log, const char *word) {
  int largest = -1;
  for (const char *at = strstr(log, word); at; at = strstr(at + 1, word)) {
    const char *begin = at;
    while (begin > log && begin[-1] >= '0' && begin[-1] <= '9') begin--;
    int number = atoi(begin);
    largest = number > largest ? number : largest;
  }
  return largest;
}

START_TEST(programs_compile_for_gpus_without_spills) {
  static const char *const targets[] = {"sm_80", "sm_90"};
  if (!has_compiler()) return;
  for (int k = 0; k < 2 * PROGRAM_COUNT; k++) {
    const DeviceProgram *program = programs[k / 2];
    char *code = NULL, *log = NULL;
    size_t size = 0;
    ck_assert_ok(device_cuda_compile(program, targets[k % 2], true, &code, &size, &log));
    int spilled = largest_before(log, " bytes spill stores"), registers = largest_before(log, " registers");
    printf("%s, %s: at most %d registers, %d bytes spilled\n", program->name, targets[k % 2], registers,
           spilled);
    ck_assert_int_eq(spilled, 0);
    ck_assert_int_le(registers, 255); // four groups of 64 a multiprocessor
    ck_assert_int_gt(registers, 0);
    ck_assert_uint_gt(size, 1000);
    memory_free(code), memory_free(log);
  }
}
END_TEST

static const DeviceProgram wrong = {.name = "wrong",
                                    .defines = "",
                                    .pieces = {"KERNEL(1, wrong, int x) { this is no C }"},
                                    .kernels = {"wrong"},
                                    .items = 1};

START_TEST(a_refused_build_is_quoted) {
  char *code, *log;
  size_t size;
  Device device;
  void *module;
  DeviceKernel kernels[DEVICE_MAX_KERNELS];
  if (has_compiler()) {
    ck_assert_int_eq(device_cuda_compile(&wrong, "sm_90", false, &code, &size, &log), STATUS_DEVICE);
    ck_assert_msg(strstr(status_message(), "NVRTC rejected program 'wrong' for sm_90") != NULL, "%s",
                  status_message());
  }
  if (device_open(&device, "opencl") == STATUS_OK) {
    ck_assert_int_eq(device_build(&device, &wrong, &module, kernels), STATUS_DEVICE);
    ck_assert_msg(strstr(status_message(), "rejected program 'wrong'") != NULL, "%s", status_message());
    device_close(&device);
  }
  ck_assert_ok(device_open(&device, "host"));
  ck_assert_int_eq(device_build(&device, &wrong, &module, kernels), STATUS_DEVICE);
  device_close(&device);
}
END_TEST

START_TEST(no_memory_on_the_device_is_a_status) {
  static const char *const names[] = {"host", "opencl"};
  for (int k = 0; k < 2; k++) {
    Device device;
    DeviceMemory memory;
    if (device_open(&device, names[k]) != STATUS_OK) continue;
    ck_assert_int_eq(device_take(&device, (size_t)1 << 52, 1, NULL, &memory), STATUS_MEMORY);
    device_close(&device);
  }
}
END_TEST

// Kept code that is not what its name says is compiled anew.
START_TEST(kept_code_is_what_was_kept_or_nothing) {
  char folder[] = "/tmp/tetlap-cache-XXXXXX", path[256], command[300], *code;
  size_t size;
  ck_assert_ptr_nonnull(mkdtemp(folder));
  setenv("TETLAP_CACHE", folder, 1);
  const char *const texts[2] = {"one", "two"};
  uint64_t key = device_cache_key(2, texts);
  ck_assert(!device_cache_read(key, &code, &size));
  device_cache_write(key, "machine code", 12);
  ck_assert(device_cache_read(key, &code, &size));
  ck_assert_uint_eq(size, 12);
  ck_assert_mem_eq(code, "machine code", 12);
  memory_free(code);
  snprintf(path, sizeof path, "%s/%016llx.kernel", folder, (unsigned long long)key);
  FILE *file = fopen(path, "r+b");
  ck_assert_ptr_nonnull(file);
  ck_assert_int_eq(fseek(file, -1, SEEK_END), 0);
  fputc('x', file);
  fclose(file);
  ck_assert(!device_cache_read(key, &code, &size));
  unsetenv("TETLAP_CACHE");
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
}
END_TEST

int main(void) {
  setenv("CK_FORK", "no", 1); // a driver's threads do not survive a fork
  TCase *cases = tcase_create("device_failures");
  tcase_add_test(cases, what_is_not_there_is_said);
  tcase_add_test(cases, a_driver_that_refuses_is_quoted);
  tcase_add_loop_test(cases, a_device_that_fails_on_the_way_is_quoted, 0, 4);
  tcase_add_test(cases, devices_lists_all_kinds_and_reasons);
  tcase_add_test(cases, programs_compile_for_gpus_without_spills);
  tcase_add_test(cases, a_refused_build_is_quoted);
  tcase_add_test(cases, no_memory_on_the_device_is_a_status);
  tcase_add_test(cases, kept_code_is_what_was_kept_or_nothing);
  return suite_run("device failures", cases, 300);
}
