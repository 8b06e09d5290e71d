// SPDX-License-Identifier: Apache-2.0
// Files that appear whole or not at all: written beside their final place under a temporary name, flushed,
// renamed. A pipe or a device, as /dev/stdout, receives the whole content at the end. Of several ranks
// (base/ranks.h) the first writes and removes; what others write is discarded.
#ifndef TETLAP_BASE_FILES_FILE_H
#define TETLAP_BASE_FILES_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/files/target.h"
#include "base/status.h"

typedef struct FileWriter {
  FILE *stream;      // write here; an error is found at commit
  char *path;        // as it was asked for, owned
  char *temporary;   // where it grows, owned
  FileTarget target; // the final place, behind all links
  bool is_real;      // else what is written goes nowhere
} FileWriter;

// Opens a temporary file beside `path`, or, if that is no file, in $TMPDIR. STATUS_IO names the path and the
// system's reason.
Status file_begin(FileWriter *writer, const char *path);
// The same where every rank has a file of its own.
Status file_begin_own(FileWriter *writer, const char *path);
// Flushes and renames; on failure nothing is left at `path` that was not there before.
Status file_commit(FileWriter *writer);
// Drops what was written; allowed after a commit and on a zeroed writer.
void file_abandon(FileWriter *writer);

// Removes the temporary files that killed processes left in a folder: those named as by file_begin whose
// process is gone.
void file_remove_parts(const char *directory);
// Removes the files of the directory whose names are prefix, a number of five digits or more, suffix; returns
// how many these were. Those with _ and another number before the suffix, which are pieces, are removed and
// not counted.
int file_remove_numbered(const char *directory, const char *prefix, const char *suffix);

// Removes a file; whether there was one and it is gone.
int file_remove(const char *path);

Status file_make_directories(const char *path); // like mkdir -p
int file_exists(const char *path);
// Whether both names are of one file or folder that is there, through links as well.
bool file_is_same(const char *a, const char *b);
// The whole file as text with a terminating 0, of those that base/files/confine.h allows; `*text` is owned by
// the caller (memory_free).
Status file_read(const char *path, char **text, size_t *size);
// "dir/name" or `name` itself if it is absolute; owned by the caller. NULL: no memory.
char *file_join(const char *directory, const char *name);
// The directory part of `path`, "." if none; owned by the caller. NULL: no memory.
char *file_directory_of(const char *path);

#endif
