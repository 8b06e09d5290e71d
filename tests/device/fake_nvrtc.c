// SPDX-License-Identifier: GPL-3.0-or-later
// A compiler for tests in place of libnvrtc.so: it takes every program for right and makes four bytes of
// machine code, unless FAKE_NVRTC is "refuse".
#include <stdlib.h>
#include <string.h>

enum { COMPILATION_FAILED = 6 };
static const char code_of_all[] = "\177ELF", log_of_all[] = "kernel(1): error: the compiler of tests refuses";

#define FUNCTION(name, ...)                                                                                  \
  int name(__VA_ARGS__);                                                                                     \
  int name(__VA_ARGS__)

FUNCTION(nvrtcCreateProgram, void **program, const char *text, const char *name, int count,
         const char *const *headers, const char *const *names) {
  (void)name, (void)count, (void)headers, (void)names;
  *program = (void *)(size_t)text;
  return 0;
}
FUNCTION(nvrtcDestroyProgram, void **program) {
  *program = NULL;
  return 0;
}
FUNCTION(nvrtcCompileProgram, void *program, int count, const char *const *options) {
  (void)program, (void)count, (void)options;
  const char *told = getenv("FAKE_NVRTC");
  return told && strcmp(told, "refuse") == 0 ? COMPILATION_FAILED : 0;
}
FUNCTION(nvrtcGetProgramLogSize, void *program, size_t *size) {
  (void)program;
  *size = sizeof log_of_all;
  return 0;
}
FUNCTION(nvrtcGetProgramLog, void *program, char *log) {
  (void)program;
  memcpy(log, log_of_all, sizeof log_of_all);
  return 0;
}
FUNCTION(nvrtcGetCUBINSize, void *program, size_t *size) {
  (void)program;
  *size = sizeof code_of_all;
  return 0;
}
FUNCTION(nvrtcGetCUBIN, void *program, char *code) {
  (void)program;
  memcpy(code, code_of_all, sizeof code_of_all);
  return 0;
}

const char *nvrtcGetErrorString(int code);
const char *nvrtcGetErrorString(int code) {
  return code == COMPILATION_FAILED ? "NVRTC_ERROR_COMPILATION" : "NVRTC_SUCCESS";
}
