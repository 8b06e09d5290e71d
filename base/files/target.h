// SPDX-License-Identifier: Apache-2.0
// The place that a path to be written stands for: a link is followed, also to a file that does not exist yet.
// A file is replaced as a whole; a pipe, a terminal, a device or a descriptor (/dev/stdout, /dev/fd/3) is
// written into.
#ifndef TETLAP_BASE_FILES_TARGET_H
#define TETLAP_BASE_FILES_TARGET_H

#include <stdbool.h>

#include "base/status.h"

typedef struct FileTarget {
  char *path;      // of the file, behind all links; owned
  bool is_through; // it is no file: write into `descriptor`
  int descriptor;  // owned where is_through
} FileTarget;

// Opens what is no file, and waits for the reader of a pipe. STATUS_IO names `path` and the system's reason;
// a folder is refused.
Status file_target_find(FileTarget *target, const char *path);
// Writes the whole file `source` into the target's descriptor; 0, or the system's reason.
int file_target_copy(const FileTarget *target, const char *source);
void file_target_close(FileTarget *target); // a zeroed one is accepted

#endif
