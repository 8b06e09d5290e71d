// SPDX-License-Identifier: Apache-2.0
// Keeps a process that shows files to others within one folder: while it is confined, file_read
// (base/files/file.h) opens regular files beneath that folder alone, by paths that begin with its name, and
// follows no link on the way. Each component is opened from the one before, so nobody who swaps a folder for
// a link meanwhile is faster; a pipe cannot make it wait.
#ifndef TETLAP_BASE_CONFINE_H
#define TETLAP_BASE_CONFINE_H

#include <stdbool.h>

#include "base/status.h"

// Until confine_end; the name is borrowed. STATUS_IO: there is no such folder; then nothing can be read.
Status confine_begin(const char *directory);
void confine_end(void);
bool confine_has_refused(void); // since confine_begin

// A descriptor for reading; −1, with errno: EACCES where the confinement refuses. Without one, any file.
int confine_open(const char *path);

#endif
