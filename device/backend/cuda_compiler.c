// SPDX-License-Identifier: Apache-2.0
#include "device/backend/cuda.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "device/backend/library.h"

typedef struct Program *ProgramId;

enum { SUCCESS = 0, OUT_OF_MEMORY = 1, COMPILATION_FAILED = 6 };

static struct {
  int (*create)(ProgramId *, const char *, const char *, int, const char *const *, const char *const *);
  int (*destroy)(ProgramId *);
  int (*compile)(ProgramId, int, const char *const *);
  int (*log_size)(ProgramId, size_t *);
  int (*log)(ProgramId, char *);
  int (*code_size)(ProgramId, size_t *);
  int (*code)(ProgramId, char *);
  const char *(*word)(int);
} nvrtc;

static const DeviceSymbol symbols[] = {
    {"nvrtcCreateProgram", &nvrtc.create},   {"nvrtcDestroyProgram", &nvrtc.destroy},
    {"nvrtcCompileProgram", &nvrtc.compile}, {"nvrtcGetProgramLogSize", &nvrtc.log_size},
    {"nvrtcGetProgramLog", &nvrtc.log},      {"nvrtcGetCUBINSize", &nvrtc.code_size},
    {"nvrtcGetCUBIN", &nvrtc.code},          {"nvrtcGetErrorString", &nvrtc.word},
};

static pthread_once_t once = PTHREAD_ONCE_INIT;
static void *library;
static char library_reason[DEVICE_TEXT];

static void load(void) {
  static const char *const names[] = {"libnvrtc.so.13",
                                      "libnvrtc.so.12",
                                      "libnvrtc.so",
                                      "/usr/local/cuda/lib64/libnvrtc.so",
                                      "/usr/local/cuda/lib/libnvrtc.so",
                                      NULL};
  library =
      device_library_open("TETLAP_NVRTC", names, symbols, sizeof symbols / sizeof *symbols, library_reason);
}

bool device_cuda_compiler(char reason[DEVICE_TEXT]) {
  pthread_once(&once, load);
  memcpy(reason, library_reason, DEVICE_TEXT);
  return library != NULL;
}

static Status status_of(int error) {
  return error == OUT_OF_MEMORY ? STATUS_MEMORY : STATUS_DEVICE;
}

// The compiler's log, the caller's; NULL: no memory.
static char *log_of(ProgramId program) {
  size_t size = 0;
  nvrtc.log_size(program, &size);
  char *log = memory_zeroed(size + 1, 1);
  if (log && size > 0) nvrtc.log(program, log);
  return log;
}

static Status fail_build(ProgramId program, const DeviceProgram *what, const char *target) {
  char *log = log_of(program), first[1200] = "no reason given";
  if (log && log[0]) snprintf(first, sizeof first, "%s", log);
  memory_free(log);
  return status_fail(STATUS_DEVICE, "NVRTC rejected program '%s' for %s: %s", what->name, target, first);
}

static Status fetch_code(ProgramId program, char **code, size_t *size) {
  *code = NULL;
  int error = nvrtc.code_size(program, size);
  if (error == SUCCESS && !(*code = memory_zeroed(*size, 1))) return status_no_memory("machine code");
  if (error == SUCCESS) error = nvrtc.code(program, *code);
  if (error == SUCCESS) return STATUS_OK;
  memory_free(*code);
  *code = NULL;
  return status_fail(status_of(error), "NVRTC returned no machine code: %s", nvrtc.word(error));
}

static Status compile(ProgramId program, const DeviceProgram *what, const char *target, bool tells,
                      char **code, size_t *size, char **log) {
  char architecture[64];
  snprintf(architecture, sizeof architecture, "--gpu-architecture=%s", target);
  const char *options[] = {architecture, "--device-as-default-execution-space", "--fmad=false", "--std=c++20",
                           "--ptxas-options=-v"};
  int error = nvrtc.compile(program, tells ? 5 : 4, options);
  if (error == COMPILATION_FAILED) return fail_build(program, what, target);
  if (error != SUCCESS)
    return status_fail(status_of(error), "NVRTC, program '%s' for %s: %s", what->name, target,
                       nvrtc.word(error));
  TRY(fetch_code(program, code, size));
  if (log) *log = log_of(program);
  return STATUS_OK;
}

Status device_cuda_compile(const DeviceProgram *what, const char *target, bool tells, char **code,
                           size_t *size, char **log) {
  char reason[DEVICE_TEXT], *text;
  if (!device_cuda_compiler(reason)) return status_fail(STATUS_DEVICE, "NVRTC: %s", reason);
  TRY(device_source_text(what, DEVICE_CUDA_CPP, &text));
  ProgramId program;
  int error = nvrtc.create(&program, text, what->name, 0, NULL, NULL);
  memory_free(text);
  if (error != SUCCESS) return status_fail(status_of(error), "NVRTC: %s", nvrtc.word(error));
  Status status = compile(program, what, target, tells, code, size, log);
  nvrtc.destroy(&program);
  return status;
}
