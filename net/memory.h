// SPDX-License-Identifier: Apache-2.0
// Zeroed arrays that begin on a cache line and whose size cannot overflow.
#ifndef NET_MEMORY_H
#define NET_MEMORY_H

#include <stddef.h>

enum { NET_MEMORY_ALIGNMENT = 64 }; // [bytes]; one vector of the widest processor that we know

// A zeroed array, NULL if it does not fit. `count` 0 gives a valid pointer. Free with net_memory_free.
void *net_memory_zeroed(size_t count, size_t size);

// A copy of a text, NULL if it does not fit.
char *net_memory_text(const char *text);

void net_memory_free(void *array);

// Tests: the k-th allocation from now on (1 = the next) fails once; 0 switches it off.
void net_memory_fail_at(long k);

#endif
