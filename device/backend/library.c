// SPDX-License-Identifier: Apache-2.0
#include "device/backend/library.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool find_symbols(void *library, const char *name, const DeviceSymbol *symbols, int count,
                         char reason[DEVICE_TEXT]) {
  for (int k = 0; k < count; k++) {
    void *address = dlsym(library, symbols[k].name);
    if (!address) {
      snprintf(reason, DEVICE_TEXT, "%s has no function %s: is it of the right version?", name,
               symbols[k].name);
      return false;
    }
    memcpy(symbols[k].address, &address, sizeof address); // a function's address is one of data for POSIX
  }
  return true;
}

void *device_library_open(const char *variable, const char *const *names, const DeviceSymbol *symbols,
                          int symbol_count, char reason[DEVICE_TEXT]) {
  const char *own[2] = {getenv(variable), NULL};
  if (own[0] && own[0][0]) names = own;
  void *library = NULL;
  const char *const *name = names;
  for (; *name && !library; name++) library = dlopen(*name, RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    snprintf(reason, DEVICE_TEXT, "%s was not found; %s may name it", names[0], variable);
    return NULL;
  }
  if (find_symbols(library, name[-1], symbols, symbol_count, reason)) return library;
  dlclose(library);
  return NULL;
}
