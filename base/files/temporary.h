// SPDX-License-Identifier: Apache-2.0
// Temporary files and folders, in $TMPDIR or, if that is not set, in /tmp.
#ifndef TETLAP_BASE_FILES_TEMPORARY_H
#define TETLAP_BASE_FILES_TEMPORARY_H

#include "base/status.h"

// An empty file with a new name, "tetlap_NAME_…ENDING"; `*path` is owned by the caller, NULL after a failure.
// STATUS_IO names the place and the system's reason; STATUS_MEMORY.
Status temporary_file(const char *name, const char *ending, char **path);

// An empty folder, for this user alone; as above.
Status temporary_directory(const char *name, char **path);

// Removes a file, or a folder with all that is in it (links are removed, not followed), and frees the path;
// NULL: nothing.
void temporary_remove(char *path);

#endif
