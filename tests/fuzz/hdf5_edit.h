// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files that are not what they should be: a good file in memory, changed through HDF5 itself as a list
// of edits says. Random bytes would only find what HDF5 makes of them; this finds what we make of HDF5's
// answers.
//
// An edit is eight bytes: what is done, to which object (its number in the file), and up to six bytes more.
// What HDF5 refuses to do is left out.
#ifndef TETLAP_TESTS_FUZZ_HDF5_EDIT_H
#define TETLAP_TESTS_FUZZ_HDF5_EDIT_H

#include <stddef.h>
#include <stdint.h>

#include "target.h"

enum { FUZZ_HDF5_EDIT = 8 };

typedef struct FuzzImage {
  uint8_t *bytes; // owned, malloc
  size_t size;
} FuzzImage;

// The edited file; `edits` (size / FUZZ_HDF5_EDIT). What cannot be opened or saved ends the program.
FuzzImage fuzz_hdf5_edit(const uint8_t *bytes, size_t byte_count, const uint8_t *edits, size_t size);

// Whether the sequence of edits changes bytes behind HDF5's back, too.
int fuzz_hdf5_has_damage(const uint8_t *edits, size_t size);

// Seeds and mutations of lists of edits, as FuzzTarget has them: no edit, one of each kind to each of the
// first objects; edits are changed in one byte, added, taken away, put together.
size_t fuzz_hdf5_seed(int k, uint8_t *data);
size_t fuzz_hdf5_mutate(uint8_t *data, size_t size, size_t room, unsigned number, FuzzPlainMutation plain);

#endif
