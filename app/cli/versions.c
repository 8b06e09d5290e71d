// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/versions.h"

#include <stdio.h>
#include <string.h>

#include "base/machine/cpu.h"

static char command[4096];

const char *app_versions_program(void) {
  return TETLAP_VERSION;
}

void app_versions_record(Record *record) {
  record_text(record, "tetlap", TETLAP_VERSION);
  record_text(record, "compiler", TETLAP_COMPILER);
  record_text(record, "sundials", TETLAP_SUNDIALS_VERSION);
  record_text(record, "suitesparse", TETLAP_SUITESPARSE_VERSION);
  record_text(record, "cgal", TETLAP_CGAL_VERSION);
  record_text(record, "gmsh", TETLAP_GMSH_VERSION);
}

const char *app_versions_line(void) {
  return "tetlap " TETLAP_VERSION "; " TETLAP_COMPILER "; SUNDIALS " TETLAP_SUNDIALS_VERSION
         "; SuiteSparse " TETLAP_SUITESPARSE_VERSION "; CGAL " TETLAP_CGAL_VERSION
         "; gmsh " TETLAP_GMSH_VERSION;
}

const char *app_versions_simd(void) {
  return cpu_has_avx512() ? "avx512" : cpu_has_avx2() ? "avx2" : "none";
}

void app_versions_set_command(int argument_count, char **arguments) {
  command[0] = 0;
  for (int i = 0; i < argument_count; i++) {
    size_t used = strlen(command);
    snprintf(command + used, sizeof command - used, "%s%s", i ? " " : "", arguments[i]);
  }
}

const char *app_versions_command(void) {
  return command;
}
