// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of a test's own: made before it and removed after it (tcase_add_checked_fixture).
#ifndef TETLAP_TESTS_FOLDER_H
#define TETLAP_TESTS_FOLDER_H

#include "base/files/file.h"
#include "suite.h"

static char folder[64];

static inline void folder_make(void) {
  strcpy(folder, "/tmp/tetlap_test_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
}

static inline void folder_remove(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  ck_assert_int_eq(system(command), 0);
}

// The text of a file in it, the caller's (memory_free).
static inline char *folder_read(const char *name) {
  char path[256], *text;
  size_t size;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  ck_assert_ok(file_read(path, &text, &size));
  return text;
}

#endif
