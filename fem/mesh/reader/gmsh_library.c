// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/gmsh_library.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static Status find_function(void *handle, const char *name, void *function) {
  void *found = dlsym(handle, name);
  if (!found)
    return status_fail(STATUS_IO, "gmsh's library %s has no %s; install the one that belongs to gmsh %s",
                       TETLAP_GMSH_LIBRARY, name, GMSH_API_VERSION);
  memcpy(function, &found, sizeof found); // ISO C converts no pointer to an object to one to a function
  return STATUS_OK;
}

Status fem_mesh_gmsh_library_load(FemMeshGmshLibrary *library) {
  void *handle = dlopen(TETLAP_GMSH_LIBRARY, RTLD_LAZY | RTLD_LOCAL);
  if (!handle)
    return status_fail(STATUS_IO,
                       "gmsh, which reads this, cannot be loaded (%s); install gmsh's library, version %s",
                       dlerror(), GMSH_API_VERSION);
#define FIND(name) TRY(find_function(handle, "gmsh" #name, &library->name));
  FEM_GMSH_FUNCTIONS(FIND)
#undef FIND
  return STATUS_OK;
}

Status fem_mesh_gmsh_library_fail(const FemMeshGmshLibrary *gmsh, const char *doing) {
  char **lines = NULL, reason[512] = "no reason given; a count in the file may be wrong";
  size_t count = 0;
  int error = 0;
  gmsh->LoggerGet(&lines, &count, &error);
  bool is_found = false;
  for (size_t k = 0; !error && k < count; k++) {
    if (!is_found && strncmp(lines[k], "Error: ", 7) == 0) {
      snprintf(reason, sizeof reason, "%s", lines[k] + 7);
      is_found = true;
    }
    gmsh->Free(lines[k]);
  }
  gmsh->Free(lines);
  return status_fail(STATUS_INPUT, "gmsh could not %s: %s", doing, reason);
}
