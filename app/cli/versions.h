// SPDX-License-Identifier: GPL-3.0-or-later
// What this program was built from and how it was called, for manifests.
#ifndef TETLAP_APP_CLI_VERSIONS_H
#define TETLAP_APP_CLI_VERSIONS_H

#include "base/files/record.h"

// The program's version, "0.1.0".
const char *app_versions_program(void);
// Adds the program's, the compiler's and the libraries' versions.
void app_versions_record(Record *record);
// The same on one line: "tetlap 0.1.0; GNU 12.2.0 Release; SUNDIALS 6.4.1; …".
const char *app_versions_line(void);
// The widest vectors that kernels find on this processor: "avx512", "avx2", "none".
const char *app_versions_simd(void);
// Remembers the command line once, at the start; and gives it back as one line, "" before.
void app_versions_set_command(int argument_count, char **arguments);
const char *app_versions_command(void);

#endif
