// SPDX-License-Identifier: GPL-3.0-or-later
// How HDF5 fails: silently, with its reason in a Status, and without a crash when the program ends.
#ifndef TETLAP_DATAGEN_FILES_HDF5_H
#define TETLAP_DATAGEN_FILES_HDF5_H

#include "base/status.h"

// Before HDF5 is called for a file: nothing is printed, reasons from before are forgotten.
void datagen_hdf5_begin(void);

// "PATH: WHAT: REASON" of the first call that failed since datagen_hdf5_begin; the system's reason where it
// is one.
Status datagen_hdf5_fail(Status code, const char *path, const char *what);

#endif
