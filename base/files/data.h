// SPDX-License-Identifier: Apache-2.0
// Files that tetlap comes with (weights, scenes of `tetlap stress`), wherever it was installed or moved to.
//
//   $TETLAP_DATA                    if it is set, and nothing else
//   DIR/share/tetlap, DIR the folder of the program or shared library that this is part of,
//   DIR/../share/tetlap             bin/tetlap, lib/libtetlap-overlap.so
//   DIR/../../share/tetlap          lib/x86_64-linux-gnu/libtetlap-overlap.so
//
// Below, names are those of the source tree; a folder that tetlap is built in has such a share/tetlap too.
#ifndef TETLAP_BASE_FILES_DATA_H
#define TETLAP_BASE_FILES_DATA_H

#include <stddef.h>

#include "base/status.h"

// The path of a file by its name in the source tree, as "net/weights/geo.safetensors". STATUS_IO: it is
// not found; the message says what to do; STATUS_INPUT: its path has `size` characters or more.
Status data_find(const char *name, char *path, size_t size);

#endif
