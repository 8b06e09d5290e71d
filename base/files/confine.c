// SPDX-License-Identifier: Apache-2.0
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // O_PATH
#endif
#include "base/files/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct {
  const char *directory; // NULL: not confined
  int folder;            // −1: there is none
  bool has_refused;
} confinement = {.folder = -1};

Status confine_begin(const char *directory) {
  confine_end();
  confinement.directory = directory;
  confinement.folder = open(directory, O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (confinement.folder >= 0) return STATUS_OK;
  return status_fail(STATUS_IO, "%s: cannot be opened: %s", directory, strerror(errno));
}

void confine_end(void) {
  if (confinement.folder >= 0) close(confinement.folder);
  confinement.directory = NULL;
  confinement.folder = -1;
  confinement.has_refused = false;
}

bool confine_has_refused(void) {
  return confinement.has_refused;
}

static int refuse(void) {
  confinement.has_refused = true;
  errno = EACCES;
  return -1;
}

// What follows the folder's name; NULL: the path does not lead there.
static const char *below(const char *path) {
  size_t length = strlen(confinement.directory);
  if (strncmp(path, confinement.directory, length) != 0) return NULL;
  if (path[length] != '/' && (length == 0 || path[length - 1] != '/')) return NULL;
  return path + length + strspn(path + length, "/");
}

static int keep_regular(int file) {
  struct stat info;
  if (file >= 0 && fstat(file, &info) == 0 && S_ISREG(info.st_mode)) return file;
  if (file >= 0) {
    close(file);
    return refuse();
  }
  return errno == ELOOP || errno == ENOTDIR || errno == ENXIO ? refuse() : -1;
}

// The file `name` of a folder, or the folder of that name, no link in either case.
static int open_in(int folder, const char *name, bool is_last) {
  int flags = O_CLOEXEC | O_NOFOLLOW | (is_last ? O_RDONLY | O_NONBLOCK : O_PATH | O_DIRECTORY);
  return openat(folder, name, flags);
}

static int open_below(const char *rest) {
  char name[256];
  int folder = dup(confinement.folder), next = -1;
  for (bool is_last = false; folder >= 0 && !is_last; folder = next) {
    size_t length = strcspn(rest, "/");
    const char *after = rest + length + strspn(rest + length, "/");
    is_last = !*after;
    bool is_name = length > 0 && length < sizeof name;
    if (is_name) memcpy(name, rest, length), name[length] = 0;
    bool is_up = is_name && strcmp(name, "..") == 0;
    errno = is_up ? ENOTDIR : ENOENT;
    next = is_name && !is_up ? open_in(folder, name, is_last) : -1;
    int reason = errno;
    close(folder);
    errno = reason;
    rest = after;
  }
  return keep_regular(folder);
}

int confine_open(const char *path) {
  if (!confinement.directory) return open(path, O_RDONLY | O_CLOEXEC);
  const char *rest = below(path);
  return rest ? open_below(rest) : refuse();
}
