// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE 1 // dladdr
#endif
#include "fem/sparse/petsc/petsc_library.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"

static FemPetscLibrary functions;
static void *handle;
static int is_ready;

static Status find(const char *name, void *pointer) {
  void *found = dlsym(handle, name);
  if (!found)
    return status_fail(STATUS_IO, "PETSc's library %s has no %s; install the one of PETSc %d.%d",
                       TETLAP_PETSC_LIBRARY, name, PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR);
  memcpy(pointer, &found, sizeof found); // ISO C converts no pointer to an object to one to a function
  return STATUS_OK;
}

static bool load(void) {
  if (handle) return true;
  handle = dlopen(TETLAP_PETSC_LIBRARY, RTLD_LAZY | RTLD_LOCAL);
  if (handle) memory_separate(); // as before what it has brought
  return handle != NULL;
}

static Status find_functions(void) {
#define FIND(name) TRY(find(#name, &functions.name));
  FEM_PETSC_FUNCTIONS(FIND)
#undef FIND
  PetscInt major, minor, subminor, release;
  functions.PetscGetVersionNumber(&major, &minor, &subminor, &release);
  if (major == PETSC_VERSION_MAJOR && minor == PETSC_VERSION_MINOR) return STATUS_OK;
  return status_fail(STATUS_IO, "PETSc's library is of version %d.%d, and tetlap was compiled for %d.%d",
                     (int)major, (int)minor, PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR);
}

bool fem_petsc_library_has_hypre(void) {
  return load() && find_functions() == STATUS_OK && dlsym(handle, "PCCreate_HYPRE");
}

// One process that was not started by mpiexec: Open MPI need not look for neighbours, networks or a shell to
// start others with. What the user has set stays.
static void keep_mpi_to_itself(void) {
  static const char *const settings[][2] = {
      {"OMPI_MCA_ess_singleton_isolated", "1"},
      {"OMPI_MCA_btl", "self"},
      {"OMPI_MCA_pml", "ob1"},
      {"OMPI_MCA_oob_tcp_if_include", "lo"},
      {"OMPI_MCA_plm", "isolated"},
      {"OMPI_MCA_mpi_warn_on_fork", "0"},
      {"OMPI_MCA_opal_signal", ""},
      {"OMPI_MCA_rmaps_base_oversubscribe", "1"},
      // PMIx of Open MPI 5 would load a part, wherever it was built to lie, that compresses messages to
      // others
      {"PMIX_MCA_pcompress", "^zlib"},
      // hwloc would look for accelerators, and load an OpenCL compiler to do so: 36 MB of heap
      {"HWLOC_COMPONENTS", "-opencl,-cuda,-nvml,-rsmi,-levelzero,-gl"},
  };
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) setenv(settings[i][0], settings[i][1], 0);
}

// Open MPI and hwloc look for their parts where they were built to lie; a bundle (tools/bundle) has
// those of Open MPI beside PETSc's library, and must not take the machine's, which may be of other versions.
static void tell_mpi_its_place(void) {
  Dl_info info;
  char path[PATH_MAX];
  const char *slash =
      dladdr((void *)(size_t)functions.PetscInitialize, &info) ? strrchr(info.dli_fname, '/') : NULL;
  if (!slash) return;
  int folder = (int)(slash - info.dli_fname);
  int length = snprintf(path, sizeof path, "%.*s/openmpi-components", folder, info.dli_fname);
  if (length < 0 || (size_t)length >= sizeof path || !file_exists(path)) return;
  setenv("OMPI_MCA_mca_base_component_path", path, 0);
  setenv("HWLOC_PLUGINS_PATH", path, 0);
}

static void finalize(void) {
  functions.PetscFinalize();
}

// Signals and messages are ours; files of options in a home or a folder would change results unseen.
static Status initialize(void) {
  char *own[] = {(char[]){"tetlap"},
                 (char[]){"-skip_petscrc"},
                 (char[]){"-no_signal_handler"},
                 (char[]){"-options_left"},
                 (char[]){"0"},
                 NULL};
  char **arguments = own;
  int count = 5;
  keep_mpi_to_itself();
  tell_mpi_its_place();
  if (functions.PetscInitialize(&count, &arguments, "", NULL) != 0)
    return status_fail(STATUS_SOLVER, "PETSc could not be initialised: use solver.linear: cholmod");
  MPI_Comm *world = NULL;
  TRY(find("PETSC_COMM_WORLD", &world));
  functions.self = *world;
  __typeof__(functions.release) *to_free = NULL;
  TRY(find("PetscTrFree", &to_free));
  functions.release = *to_free;
  functions.PetscPushErrorHandler(functions.PetscIgnoreErrorHandler, NULL);
  atexit(finalize);
  return STATUS_OK;
}

Status fem_petsc_library(const FemPetscLibrary **library) {
  *library = &functions;
  if (is_ready) return STATUS_OK;
  if (!load())
    return status_fail(
        STATUS_IO,
        "solver.linear: amg and gamg are PETSc's, which cannot be loaded (%s); install the package of %s "
        "or use solver.linear: cholmod",
        dlerror(), TETLAP_PETSC_LIBRARY);
  TRY(find_functions());
  TRY(initialize());
  is_ready = 1;
  return STATUS_OK;
}
