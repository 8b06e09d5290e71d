// SPDX-License-Identifier: Apache-2.0
#include "base/files/file.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/confine.h"
#include "base/files/temporary.h"
#include "base/memory.h"
#include "base/ranks.h"

char *file_join(const char *directory, const char *name) {
  if (name[0] == '/') return memory_copy(name, strlen(name) + 1, 1);
  size_t size = strlen(directory) + strlen(name) + 2;
  char *path = memory_zeroed(size, 1);
  if (path) snprintf(path, size, "%s/%s", directory, name);
  return path;
}

char *file_directory_of(const char *path) {
  const char *slash = strrchr(path, '/');
  if (!slash) return memory_copy(".", 2, 1);
  size_t length = slash == path ? 1 : (size_t)(slash - path);
  char *directory = memory_zeroed(length + 1, 1);
  if (directory) memcpy(directory, path, length);
  return directory;
}

int file_exists(const char *path) {
  return access(path, F_OK) == 0;
}

// The name of the temporary file: beside the target, so that it can be renamed.
static Status name_temporary(FileWriter *writer) {
  if (writer->target.is_through) return temporary_file("output", "", &writer->temporary);
  size_t size = strlen(writer->target.path) + 32;
  writer->temporary = memory_zeroed(size, 1);
  if (!writer->temporary) return status_no_memory("a file name");
  snprintf(writer->temporary, size, "%s.%ld.part", writer->target.path, (long)getpid());
  return STATUS_OK;
}

static Status open_stream(FileWriter *writer, const char *path) {
  writer->path = memory_copy(path, strlen(path) + 1, 1);
  if (!writer->path) return status_no_memory("a file name");
  if (writer->is_real) {
    TRY(file_target_find(&writer->target, path));
    TRY(name_temporary(writer));
  } else {
    writer->temporary = memory_zeroed(1, 1);
    if (!writer->temporary) return status_no_memory("a file name");
  }
  writer->stream = fopen(writer->is_real ? writer->temporary : "/dev/null", "wb");
  if (writer->stream) return STATUS_OK;
  return status_fail(STATUS_IO, "%s: cannot be written: %s", path, strerror(errno));
}

bool file_is_same(const char *a, const char *b) {
  struct stat left, right;
  return stat(a, &left) == 0 && stat(b, &right) == 0 && left.st_dev == right.st_dev &&
         left.st_ino == right.st_ino;
}

static Status begin(FileWriter *writer, const char *path, bool is_real) {
  *writer = (FileWriter){.is_real = is_real};
  Status status = open_stream(writer, path);
  if (status) file_abandon(writer);
  return status;
}

Status file_begin(FileWriter *writer, const char *path) {
  return begin(writer, path, ranks_is_first());
}

Status file_begin_own(FileWriter *writer, const char *path) {
  return begin(writer, path, true);
}

// What was written goes to its place; 0, or the system's reason.
static int deliver(FileWriter *writer) {
  if (!writer->is_real) return 0;
  if (writer->target.is_through) return file_target_copy(&writer->target, writer->temporary);
  if (rename(writer->temporary, writer->target.path) != 0) return errno;
  writer->temporary[0] = 0;
  return 0;
}

Status file_commit(FileWriter *writer) {
  // Of a write that failed before, the reason is still there, unless it shows again.
  int failed = ferror(writer->stream), reason = failed ? errno : 0;
  // By renaming, readers see the whole file or none, also after a kill. Against a power cut it would have to
  // be synced as well, which costs more than a step of a small scene.
  if (fflush(writer->stream) != 0) failed = 1, reason = errno;
  if (fclose(writer->stream) != 0 && !failed) failed = 1, reason = errno;
  writer->stream = NULL;
  if (!failed) reason = deliver(writer), failed = reason != 0;
  Status status = STATUS_OK;
  if (failed)
    status = status_fail(
        STATUS_IO, "%s: writing failed: %s; %s", writer->path, reason ? strerror(reason) : "write error",
        writer->target.is_through ? "what it got may be incomplete" : "nothing was left there");
  file_abandon(writer);
  return status;
}

void file_abandon(FileWriter *writer) {
  if (writer->stream) fclose(writer->stream);
  if (writer->temporary && writer->temporary[0]) unlink(writer->temporary);
  memory_free(writer->path);
  memory_free(writer->temporary);
  file_target_close(&writer->target);
  *writer = (FileWriter){0};
}

// Whether the name is that of a temporary file, and its writer is no more.
static bool is_left_over(const char *name) {
  const char *end = strrchr(name, '.');
  if (!end || strcmp(end, ".part") != 0) return false;
  const char *number = end;
  while (number > name && isdigit((unsigned char)number[-1])) number--;
  if (number == end || number == name || number[-1] != '.') return false;
  long process = strtol(number, NULL, 10);
  return process > 0 && process != getpid() && kill((pid_t)process, 0) != 0 && errno == ESRCH;
}

void file_remove_parts(const char *directory) {
  DIR *folder = ranks_is_first() ? opendir(directory) : NULL;
  if (!folder) return;
  const struct dirent *entry;
  while ((entry = readdir(folder)))
    if (is_left_over(entry->d_name)) unlinkat(dirfd(folder), entry->d_name, 0);
  closedir(folder);
}

static bool is_numbered(const char *name, const char *prefix, const char *suffix, bool *is_piece) {
  enum { FEWEST_DIGITS = 5 };
  static const char digits[] = "0123456789";
  size_t begin = strlen(prefix);
  if (strncmp(name, prefix, begin) != 0) return false;
  size_t count = strspn(name + begin, digits);
  const char *end = name + begin + count;
  size_t piece_count = *end == '_' ? strspn(end + 1, digits) : 0;
  *is_piece = piece_count > 0;
  return count >= FEWEST_DIGITS && strcmp(*is_piece ? end + 1 + piece_count : end, suffix) == 0;
}

int file_remove_numbered(const char *directory, const char *prefix, const char *suffix) {
  DIR *folder = ranks_is_first() ? opendir(directory) : NULL;
  int count = 0;
  if (!folder) return 0;
  const struct dirent *entry;
  bool is_piece;
  while ((entry = readdir(folder)))
    if (is_numbered(entry->d_name, prefix, suffix, &is_piece))
      count += unlinkat(dirfd(folder), entry->d_name, 0) == 0 && !is_piece;
  closedir(folder);
  return count;
}

int file_remove(const char *path) {
  return ranks_is_first() && remove(path) == 0;
}

static Status make_one(const char *path) {
  if (mkdir(path, 0777) == 0 || errno == EEXIST) return STATUS_OK;
  return status_fail(STATUS_IO, "%s: the directory cannot be made: %s", path, strerror(errno));
}

Status file_make_directories(const char *path) {
  char *copy = memory_copy(path, strlen(path) + 1, 1);
  if (!copy) return status_no_memory("a directory name");
  Status status = STATUS_OK;
  for (char *slash = copy[0] ? strchr(copy + 1, '/') : NULL; slash && !status;
       slash = strchr(slash + 1, '/')) {
    *slash = 0;
    status = make_one(copy);
    *slash = '/';
  }
  if (!status) status = make_one(copy);
  memory_free(copy);
  struct stat info;
  if (!status && (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)))
    return status_fail(STATUS_IO, "%s: is not a directory; name another with -o", path);
  return status;
}

Status file_read(const char *path, char **text, size_t *size) {
  *text = NULL;
  *size = 0;
  struct stat info;
  int file = confine_open(path);
  FILE *stream = file >= 0 ? fdopen(file, "rb") : NULL;
  if (!stream && file >= 0) close(file);
  if (!stream)
    return status_fail(STATUS_IO, "%s: cannot be opened: %s", path,
                       confine_has_refused() ? "it leads out of the folder, or is a link or no file"
                                             : strerror(errno));
  Status status = STATUS_OK;
  if (fstat(fileno(stream), &info) == 0 && S_ISDIR(info.st_mode))
    status = status_fail(STATUS_IO, "%s: is a directory, a file was expected", path);
  size_t capacity = 0, used = 0;
  while (!status) {
    if (!memory_reserve((void **)text, &capacity, used + 65536, 1)) {
      status = status_no_memory(path);
      break;
    }
    size_t got = fread(*text + used, 1, capacity - used - 1, stream);
    used += got;
    if (got == 0) break;
  }
  if (!status && ferror(stream))
    status = status_fail(STATUS_IO, "%s: reading failed: %s", path, strerror(errno));
  fclose(stream);
  if (status) {
    memory_free(*text);
    *text = NULL;
    return status;
  }
  (*text)[used] = 0;
  *size = used;
  return STATUS_OK;
}
