// SPDX-License-Identifier: Apache-2.0
// Zeroed arrays whose size cannot overflow, growth, and an allocation that fails on purpose for tests.
#ifndef TETLAP_BASE_MEMORY_H
#define TETLAP_BASE_MEMORY_H

#include <stddef.h>

// A zeroed array, NULL if it does not fit. `count` 0 gives a valid pointer. Free with memory_free.
void *memory_zeroed(size_t count, size_t size);

// A copy of `count` elements, NULL if it does not fit.
void *memory_copy(const void *source, size_t count, size_t size);

// Makes room for `wanted` elements (grown by half at least), new ones zeroed. Returns 0 and leaves array and
// capacity as they were if it does not fit: `if (!memory_reserve((void **)&list, &capacity, n, sizeof
// *list))`.
int memory_reserve(void **array, size_t *capacity, size_t wanted, size_t size);

void memory_free(void *array);

// What an array of the above takes of the heap, rounding included [bytes]; 0 for NULL.
size_t memory_held(const void *array);
size_t memory_held_by(size_t count, const void *const *arrays); // of several

// Hands what is free in the heap back to the system: after much was freed that is not soon needed again.
void memory_trim(void);

// Gives large arrays memory of their own, which takes no room before it is used and goes back to the system
// when the array is freed. The C library does so by default, but moves the limit up as large arrays are
// freed. A loaded library may have switched it off, as SuperLU_DIST, part of PETSc, does. To be called first
// in a program.
void memory_separate(void);

// Tests: the k-th allocation from now on (1 = the next) fails once; 0 switches it off.
void memory_fail_at(long k);

// The largest resident set of this process so far [bytes].
size_t memory_peak_bytes(void);

#endif
