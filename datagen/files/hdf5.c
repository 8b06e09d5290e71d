// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/files/hdf5.h"

#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REASON_SIZE = 160 };

static char reason[REASON_SIZE]; // of the first failure; "": none

// From the call that failed down to its cause: the last description stays. The system's error is in its midst
// ("errno = 28").
static herr_t keep_description(unsigned level, const H5E_error2_t *error, void *unused) {
  (void)level, (void)unused;
  const char *number = error->desc ? strstr(error->desc, "errno = ") : NULL;
  int code = number ? atoi(number + strlen("errno = ")) : 0;
  if (error->desc) snprintf(reason, sizeof reason, "%s", code > 0 ? strerror(code) : error->desc);
  return 0;
}

// HDF5 calls it when a call has failed, in place of printing; the next call forgets the reason.
static herr_t remember(hid_t stack, void *unused) {
  (void)unused;
  if (!reason[0]) H5Ewalk2(stack, H5E_WALK_DOWNWARD, keep_description, NULL);
  return 0;
}

void datagen_hdf5_begin(void) {
  // A file that could not be written cannot be closed either, and HDF5 crashes when it tries that again at
  // the program's end. All files are closed by who opened them.
  static bool has_begun;
  if (!has_begun) H5dont_atexit();
  has_begun = true;
  H5Eset_auto2(H5E_DEFAULT, remember, NULL);
  reason[0] = 0;
}

Status datagen_hdf5_fail(Status code, const char *path, const char *what) {
  Status status = status_fail(code, "%s: %s: %s", path, what, reason[0] ? reason : "HDF5 gives no reason");
  reason[0] = 0;
  H5Eclear2(H5E_DEFAULT);
  return status;
}
