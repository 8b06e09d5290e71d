// SPDX-License-Identifier: GPL-3.0-or-later
// A file that grows by whole pieces while others read it, and of which nothing is held in memory.
//
// The first piece puts a new file in the place of what was there (base/files/file.h); each later one is
// appended in one write and handed to the system at once. A write that fails is taken back, so the file ends
// with a whole piece; only a process that is killed during a write may leave a part of one. A mark describes
// the file up to a moment. A process that continues from it later checks that this part is unchanged and cuts
// off what came after it, or refuses the file. Of several ranks (base/ranks.h) the first writes.
#ifndef TETLAP_BASE_FILES_JOURNAL_H
#define TETLAP_BASE_FILES_JOURNAL_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

typedef struct JournalMark {
  long long size;  // bytes; 0: there is no file yet
  uint64_t digest; // of these bytes (base/files/digest.h)
} JournalMark;

typedef struct Journal {
  char *path;      // owned
  JournalMark end; // what this writer, and those before that it goes on from, have written
} Journal;

// Nothing is written or removed before the first piece. STATUS_MEMORY.
Status journal_create(Journal *journal, const char *path);
void journal_destroy(Journal *journal); // also of a zeroed one

// Goes on after the mark: what the file holds beyond it is cut off. STATUS_INPUT: the file is shorter, or
// another; STATUS_IO: it cannot be read or cut. After a failure the file is as it was.
Status journal_continue(Journal *journal, JournalMark mark);

// Appends a piece. STATUS_IO: it cannot be written, is gone, or another process has changed its length; the
// file is as it was.
Status journal_append(Journal *journal, const void *piece, size_t size);

#endif
