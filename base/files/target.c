// SPDX-License-Identifier: Apache-2.0
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // realpath, fdopen
#endif
#include "base/files/target.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

enum { MOST_LINKS = 40 };

static bool is_link(const char *path) {
  struct stat info;
  return lstat(path, &info) == 0 && S_ISLNK(info.st_mode);
}

// The number of a descriptor of this process that the path stands for; −1: it stands for none.
static int own_descriptor(const char *path) {
  char folder[PATH_MAX], real[PATH_MAX], own[64];
  const char *slash = strrchr(path, '/');
  if (!slash || slash == path || slash - path >= PATH_MAX) return -1;
  memcpy(folder, path, (size_t)(slash - path));
  folder[slash - path] = 0;
  snprintf(own, sizeof own, "/proc/%ld/fd", (long)getpid());
  if (!realpath(folder, real) || strcmp(real, own) != 0) return -1;
  char *end;
  long number = strtol(slash + 1, &end, 10);
  return end != slash + 1 && !*end && number >= 0 && number <= INT_MAX ? (int)number : -1;
}

// What a link names, seen from where the link is; false: it cannot be read, or the name is too long.
static bool follow(char path[PATH_MAX]) {
  char named[PATH_MAX];
  ssize_t length = readlink(path, named, sizeof named - 1);
  if (length < 0) return false;
  named[length] = 0;
  char *slash = named[0] == '/' ? NULL : strrchr(path, '/');
  size_t folder = slash ? (size_t)(slash + 1 - path) : 0;
  errno = ENAMETOOLONG;
  if (folder + (size_t)length >= PATH_MAX) return false;
  memcpy(path + folder, named, (size_t)length + 1);
  return true;
}

static Status fail(const char *path, int reason) {
  return status_fail(STATUS_IO, "%s: cannot be written: %s", path, strerror(reason));
}

static Status open_through(FileTarget *target, const char *path, int from) {
  target->descriptor = from >= 0 ? dup(from) : open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (target->descriptor < 0) return STATUS_IO;
  target->is_through = true;
  int flags = fcntl(target->descriptor, F_GETFL);
  errno = EBADF;
  return (flags & O_ACCMODE) != O_RDONLY ? STATUS_OK : STATUS_IO;
}

static Status find(FileTarget *target, char path[PATH_MAX]) {
  int links = 0, number = own_descriptor(path);
  for (; number < 0 && is_link(path); number = own_descriptor(path)) {
    if (!follow(path)) return STATUS_IO;
    errno = ELOOP;
    if (++links > MOST_LINKS) return STATUS_IO;
  }
  if (number >= 0) return open_through(target, path, number);
  struct stat info;
  bool is_there = stat(path, &info) == 0;
  errno = EISDIR;
  if (is_there && S_ISDIR(info.st_mode)) return STATUS_IO;
  return is_there && !S_ISREG(info.st_mode) ? open_through(target, path, -1) : STATUS_OK;
}

Status file_target_find(FileTarget *target, const char *path) {
  char real[PATH_MAX];
  size_t length = strlen(path);
  *target = (FileTarget){0};
  if (length >= PATH_MAX) return fail(path, ENAMETOOLONG);
  memcpy(real, path, length + 1);
  if (find(target, real)) {
    int reason = errno;
    file_target_close(target);
    return fail(path, reason);
  }
  target->path = memory_copy(real, strlen(real) + 1, 1);
  if (target->path) return STATUS_OK;
  file_target_close(target);
  return status_no_memory("a file name");
}

// All of the bytes; 0, or the system's reason.
static int put(int descriptor, const char *bytes, ssize_t count) {
  while (count > 0) {
    ssize_t done = write(descriptor, bytes, (size_t)count);
    if (done < 0 && errno != EINTR) return errno;
    if (done > 0) bytes += done, count -= done;
  }
  return 0;
}

int file_target_copy(const FileTarget *target, const char *source) {
  char bytes[65536];
  int file = open(source, O_RDONLY | O_CLOEXEC), reason = file < 0 ? errno : 0;
  fflush(stdout); // what was printed before comes before
  while (!reason) {
    ssize_t got = read(file, bytes, sizeof bytes);
    if (got == 0) break;
    reason = got < 0 ? errno : put(target->descriptor, bytes, got);
    if (got < 0 && reason == EINTR) reason = 0;
  }
  if (file >= 0) close(file);
  return reason;
}

void file_target_close(FileTarget *target) {
  if (target->is_through) close(target->descriptor);
  memory_free(target->path);
  *target = (FileTarget){0};
}
