// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a run, while it may still go on: how far it is, and the page about it. Nothing outside of the
// folder is read, whatever links lie in it and whatever its lists name.
#ifndef TETLAP_APP_VIEW_FOLDER_H
#define TETLAP_APP_VIEW_FOLDER_H

#include "base/record.h"
#include "base/status.h"

typedef struct AppViewFolder {
  const char *directory; // borrowed
  int max_frames;        // of a run that goes on; all of one that has ended
} AppViewFolder;

// STATUS_INPUT: a file that would be read lies outside the folder; STATUS_MEMORY.
Status app_view_folder_check(const AppViewFolder *folder);

// `outcome`: "waiting" (nothing to see yet), "running", "gone" (its process has ended without a word), or
// what summary.json says; what progress.json says; and `stamp`, which changes with what the page would show.
// Owned by the caller.
Status app_view_folder_state(const AppViewFolder *folder, Record **state);

// The whole page as text (memory_free is not for it: free), with the state in it.
Status app_view_folder_page(const AppViewFolder *folder, char **page, size_t *size);

#endif
