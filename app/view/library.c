// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/view/library.h"

#include <dlfcn.h>
#include <string.h>

static Status find_function(void *handle, const char *name, void *function) {
  void *found = dlsym(handle, name);
  if (!found)
    return status_fail(STATUS_IO, "%s has no %s; install the version that tetlap was built with",
                       TETLAP_MICROHTTPD_LIBRARY, name);
  memcpy(function, &found, sizeof found); // ISO C converts no pointer to an object to one to a function
  return STATUS_OK;
}

Status app_view_library_load(AppViewLibrary *library) {
  void *handle = dlopen(TETLAP_MICROHTTPD_LIBRARY, RTLD_LAZY | RTLD_LOCAL);
  if (!handle)
    return status_fail(STATUS_IO,
                       "the library that serves pages cannot be loaded (%s); install it (Debian: "
                       "libmicrohttpd12), or use `tetlap report DIR`",
                       dlerror());
#define FIND(name) TRY(find_function(handle, "MHD_" #name, &library->name));
  APP_VIEW_FUNCTIONS(FIND)
#undef FIND
  return STATUS_OK;
}
