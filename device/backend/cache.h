// SPDX-License-Identifier: Apache-2.0
// Machine code that was compiled before, in the user's cache folder: $TETLAP_CACHE, else
// $XDG_CACHE_HOME/tetlap, else ~/.cache/tetlap. A file's name is a digest of what the code was made of. Its
// first bytes hold this digest and that of the code: a file that is not what it says is compiled anew.
// Without a folder nothing is kept, which is no failure.
#ifndef TETLAP_DEVICE_BACKEND_CACHE_H
#define TETLAP_DEVICE_BACKEND_CACHE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Of texts: source, options, device, driver.
uint64_t device_cache_key(int count, const char *const *texts);

// The code, the caller's (memory_free); false: there is none.
bool device_cache_read(uint64_t key, char **code, size_t *size);
void device_cache_write(uint64_t key, const void *code, size_t size);

#endif
