// SPDX-License-Identifier: GPL-3.0-or-later
// The folder of a run, while it may still go on: how far it is, and the page about it. Nothing outside of the
// folder is read, whatever links lie in it, whatever its lists name and whoever changes it meanwhile.
#ifndef TETLAP_APP_VIEW_FOLDER_H
#define TETLAP_APP_VIEW_FOLDER_H

#include "base/files/record.h"
#include "base/status.h"

typedef struct AppViewFolder {
  const char *directory; // borrowed
  int max_frames;        // of a run that goes on; all of one that has ended
} AppViewFolder;

typedef enum AppViewRefusal { APP_VIEW_ALLOWED, APP_VIEW_MISSING, APP_VIEW_FORBIDDEN } AppViewRefusal;

// To be called before the folder is looked at, each time: confines this process to it (base/files/confine.h).
// STATUS_IO: it is not there; STATUS_INPUT: a file of the page is a link, or none; STATUS_MEMORY. `refusal`
// tells which.
Status app_view_folder_open(const AppViewFolder *folder, AppViewRefusal *refusal);

// `outcome`: "waiting" (nothing to see yet), "running", "gone" (its process has ended without a word), or
// what summary.json says; what progress.json says; and `stamp`, which changes with what the page would show.
// Owned by the caller.
Status app_view_folder_state(const AppViewFolder *folder, Record **state);

// The whole page as text (memory_free is not for it: free), with the state in it.
Status app_view_folder_page(const AppViewFolder *folder, char **page, size_t *size);

#endif
