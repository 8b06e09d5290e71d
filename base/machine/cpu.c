// SPDX-License-Identifier: Apache-2.0
#include "base/machine/cpu.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>

const char *cpu_name(void) {
  static char name[128];
  if (name[0]) return name;
  FILE *info = fopen("/proc/cpuinfo", "r");
  char line[512];
  while (info && fgets(line, sizeof line, info)) {
    const char *colon = strchr(line, ':');
    if (strncmp(line, "model name", 10) != 0 || !colon) continue;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
    break;
  }
  if (info) fclose(info);
  if (!name[0]) snprintf(name, sizeof name, "unknown");
  return name;
}

#if defined(__x86_64__)
bool cpu_has_avx2(void) {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
bool cpu_has_avx512(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
}
#else
bool cpu_has_avx2(void) {
  return false;
}
bool cpu_has_avx512(void) {
  return false;
}
#endif

int cpu_thread_count(void) {
  return omp_get_max_threads();
}
