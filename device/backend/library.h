// SPDX-License-Identifier: Apache-2.0
// Libraries that are looked for at run time, and functions in them.
#ifndef TETLAP_DEVICE_BACKEND_LIBRARY_H
#define TETLAP_DEVICE_BACKEND_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>

#include "device/device.h"

// A function's name and where its address goes: a pointer to a function pointer.
typedef struct DeviceSymbol {
  const char *name;
  void *address;
} DeviceSymbol;

// Opens the library that the environment's `variable` names, else the first of `names` (ended by NULL) that
// is there, and finds the functions. NULL: `reason` says why not. It stays open.
void *device_library_open(const char *variable, const char *const *names, const DeviceSymbol *symbols,
                          int symbol_count, char reason[DEVICE_TEXT]);

#endif
