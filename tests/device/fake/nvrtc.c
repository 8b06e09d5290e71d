// SPDX-License-Identifier: GPL-3.0-or-later
// A compiler for tests in place of libnvrtc.so: the machine code that it makes is a program's text behind
// what an ELF file begins with; cuda.c runs it. FAKE_NVRTC=refuse: it rejects all. Which call fails:
// faults.h.
#include <stdlib.h>
#include <string.h>

#include "faults.h"

enum { COMPILATION_FAILED = 6 };
static const char log_of_all[] = "kernel(1): error: the compiler of tests refuses";

FAKE(int, nvrtcCreateProgram, void **program, const char *text, const char *name, int count,
     const char *const *headers, const char *const *names) {
  (void)name, (void)count, (void)headers, (void)names;
  FAKE_ASK;
  char *copy = calloc(strlen(text) + 1, 1);
  strcpy(copy, text);
  *program = copy;
  fake_keep(1);
  return 0;
}

FAKE(int, nvrtcDestroyProgram, void **program) {
  free(*program);
  *program = NULL;
  fake_keep(-1);
  return fake_ask(__func__);
}

FAKE(int, nvrtcCompileProgram, void *program, int count, const char *const *options) {
  (void)program, (void)count, (void)options;
  FAKE_ASK;
  const char *told = getenv("FAKE_NVRTC");
  return told && strcmp(told, "refuse") == 0 ? COMPILATION_FAILED : 0;
}

FAKE(int, nvrtcGetProgramLogSize, void *program, size_t *size) {
  (void)program;
  FAKE_ASK;
  *size = sizeof log_of_all;
  return 0;
}

FAKE(int, nvrtcGetProgramLog, void *program, char *log) {
  (void)program;
  FAKE_ASK;
  memcpy(log, log_of_all, sizeof log_of_all);
  return 0;
}

FAKE(int, nvrtcGetCUBINSize, void *program, size_t *size) {
  FAKE_ASK;
  *size = 4 + strlen(program) + 1;
  return 0;
}

FAKE(int, nvrtcGetCUBIN, void *program, char *code) {
  FAKE_ASK;
  memcpy(code, "\177ELF", 4);
  strcpy(code + 4, program);
  return 0;
}

FAKE(const char *, nvrtcGetErrorString, int code) {
  return code == COMPILATION_FAILED ? "NVRTC_ERROR_COMPILATION"
         : code == 1                ? "NVRTC_ERROR_OUT_OF_MEMORY"
         : code == 5                ? "NVRTC_ERROR_INVALID_OPTION"
         : code == 0                ? "NVRTC_SUCCESS"
                                    : "NVRTC_ERROR_INTERNAL_ERROR";
}
