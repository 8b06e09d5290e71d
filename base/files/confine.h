// SPDX-License-Identifier: Apache-2.0
// Confines a process that serves files to one folder: file_read (base/files/file.h) then opens only regular
// files beneath that folder, by paths that begin with its name, and follows no link. Each component is opened
// from the one before, so a folder that is replaced by a link meanwhile is not followed; a pipe cannot block
// it.
#ifndef TETLAP_BASE_FILES_CONFINE_H
#define TETLAP_BASE_FILES_CONFINE_H

#include <stdbool.h>

#include "base/status.h"

// Until confine_end; the name is borrowed. STATUS_IO: there is no such folder; then nothing can be read.
Status confine_begin(const char *directory);
void confine_end(void);
bool confine_has_refused(void); // since confine_begin

// A descriptor for reading; −1, with errno: EACCES where the confinement refuses. Without one, any file.
int confine_open(const char *path);

#endif
