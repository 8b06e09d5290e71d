// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/files/journal.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/ranks.h"

Status journal_create(Journal *journal, const char *path) {
  *journal = (Journal){.end.digest = DIGEST_START};
  journal->path = memory_copy(path, strlen(path) + 1, 1);
  return journal->path ? STATUS_OK : status_no_memory("a file name");
}

void journal_destroy(Journal *journal) {
  memory_free(journal->path);
  *journal = (Journal){0};
}

static Status fail_input(const Journal *journal, const char *what) {
  return status_fail(STATUS_INPUT, "%s: %s since the last checkpoint; restore it, or start again",
                     journal->path, what);
}

// Whether the file begins with what the mark names.
static Status verify(const Journal *journal, JournalMark mark) {
  FILE *stream = fopen(journal->path, "rb");
  if (!stream) return status_fail(STATUS_IO, "%s: cannot be opened: %s", journal->path, strerror(errno));
  unsigned char bytes[4096];
  uint64_t digest = DIGEST_START;
  long long left = mark.size;
  while (left > 0) {
    size_t wanted = left < (long long)sizeof bytes ? (size_t)left : sizeof bytes;
    size_t got = fread(bytes, 1, wanted, stream);
    if (got == 0) break;
    digest = digest_bytes(digest, bytes, got);
    left -= (long long)got;
  }
  int reason = ferror(stream) ? errno : 0;
  fclose(stream);
  if (reason) return status_fail(STATUS_IO, "%s: reading failed: %s", journal->path, strerror(reason));
  if (left > 0) return fail_input(journal, "was cut short");
  return digest == mark.digest ? STATUS_OK : fail_input(journal, "was changed");
}

Status journal_continue(Journal *journal, JournalMark mark) {
  if (mark.size == 0) return STATUS_OK; // the first piece makes a new file
  TRY(verify(journal, mark));
  if (ranks_is_first() && truncate(journal->path, (off_t)mark.size) != 0)
    return status_fail(STATUS_IO, "%s: cannot be cut to %lld bytes: %s", journal->path, mark.size,
                       strerror(errno));
  journal->end = mark;
  return STATUS_OK;
}

static Status write_first(const Journal *journal, const void *piece, size_t size) {
  FileWriter writer;
  TRY(file_begin(&writer, journal->path));
  fwrite(piece, 1, size, writer.stream);
  return file_commit(&writer);
}

// A file of another length is not what this writer left.
static Status check_length(const Journal *journal) {
  struct stat info;
  if (stat(journal->path, &info) != 0)
    return status_fail(STATUS_IO, "%s: cannot be written on: %s", journal->path, strerror(errno));
  if ((long long)info.st_size != journal->end.size)
    return status_fail(STATUS_IO,
                       "%s: has %lld bytes where this run left %lld: another process writes there; let each "
                       "run have a folder of its own (-o)",
                       journal->path, (long long)info.st_size, journal->end.size);
  return STATUS_OK;
}

// It is opened anew for each piece: what was moved or removed in between is reported, not written to unseen.
static Status write_next(const Journal *journal, const void *piece, size_t size) {
  TRY(check_length(journal));
  FILE *stream = fopen(journal->path, "r+b");
  if (!stream) return status_fail(STATUS_IO, "%s: cannot be written: %s", journal->path, strerror(errno));
  setvbuf(stream, NULL, _IONBF, 0); // the piece in one write
  errno = 0;
  int failed = fseek(stream, 0, SEEK_END) != 0 || fwrite(piece, 1, size, stream) != size, reason = errno;
  if (fclose(stream) != 0 && !failed) failed = 1, reason = errno;
  if (!failed) return STATUS_OK;
  int is_cut = truncate(journal->path, (off_t)journal->end.size) == 0;
  return status_fail(STATUS_IO, "%s: writing failed: %s; %s", journal->path,
                     reason ? strerror(reason) : "write error",
                     is_cut ? "what was there before is whole" : "its last line may be incomplete");
}

Status journal_append(Journal *journal, const void *piece, size_t size) {
  bool is_first = journal->end.size == 0;
  if (ranks_is_first()) TRY(is_first ? write_first(journal, piece, size) : write_next(journal, piece, size));
  journal->end.size += (long long)size;
  journal->end.digest = digest_bytes(journal->end.digest, piece, size);
  return STATUS_OK;
}
