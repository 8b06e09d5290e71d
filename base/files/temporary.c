// SPDX-License-Identifier: Apache-2.0
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // mkostemps, nftw
#endif
#include "base/files/temporary.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

// "DIR/tetlap_NAME_XXXXXXENDING"; NULL: no memory.
static char *pattern_of(const char *name, const char *ending) {
  const char *set = getenv("TMPDIR"), *directory = set && *set ? set : "/tmp";
  size_t size = strlen(directory) + strlen(name) + strlen(ending) + sizeof "/tetlap__XXXXXX";
  char *pattern = memory_zeroed(size, 1);
  if (pattern) snprintf(pattern, size, "%s/tetlap_%s_XXXXXX%s", directory, name, ending);
  return pattern;
}

static Status conclude(bool is_made, const char *what, char **path) {
  if (is_made) return STATUS_OK;
  Status status = *path
                      ? status_fail(STATUS_IO, "%s: %s cannot be made there: %s; TMPDIR names another place",
                                    *path, what, strerror(errno))
                      : status_no_memory("a file name");
  memory_free(*path);
  *path = NULL;
  return status;
}

Status temporary_file(const char *name, const char *ending, char **path) {
  *path = pattern_of(name, ending);
  int file = *path ? mkostemps(*path, (int)strlen(ending), O_CLOEXEC) : -1;
  if (file >= 0) close(file);
  return conclude(file >= 0, "a file", path);
}

Status temporary_directory(const char *name, char **path) {
  *path = pattern_of(name, "");
  return conclude(*path && mkdtemp(*path), "a folder", path);
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *place) {
  (void)info, (void)kind, (void)place;
  return remove(path);
}

void temporary_remove(char *path) {
  enum { OPEN_AT_ONCE = 8 };
  if (path) nftw(path, remove_entry, OPEN_AT_ONCE, FTW_DEPTH | FTW_PHYS);
  memory_free(path);
}
