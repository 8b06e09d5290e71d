// SPDX-License-Identifier: Apache-2.0
// A model in a shared library that exports `tetlap_model` (include/tetlap/model.h).
#ifndef TETLAP_OVERLAP_FOREIGN_LIBRARY_H
#define TETLAP_OVERLAP_FOREIGN_LIBRARY_H

#include "overlap/foreign/port.h"

// STATUS_IO: there is no such file. STATUS_INPUT: it is no whole library for this machine, exports no
// function `tetlap_model`, or was built for another version of the interface; the message says which.
Status overlap_foreign_library_open(OverlapForeignPort *port, const char *path);

#endif
