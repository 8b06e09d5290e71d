// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of gmsh's C API that we call, found in its library when a mesh is first read by it. The
// program is not linked to gmsh: with the hundred libraries that gmsh brings along, each start took half a
// second.
#ifndef TETLAP_FEM_MESH_READER_GMSH_LIBRARY_H
#define TETLAP_FEM_MESH_READER_GMSH_LIBRARY_H

#include <gmshc.h>

#include "base/status.h"

// Names without their "gmsh".
#define FEM_GMSH_FUNCTIONS(FUNCTION)                                                                         \
  FUNCTION(Finalize)                                                                                         \
  FUNCTION(Free)                                                                                             \
  FUNCTION(Initialize)                                                                                       \
  FUNCTION(LoggerGet)                                                                                        \
  FUNCTION(LoggerStart)                                                                                      \
  FUNCTION(ModelGeoAddSurfaceLoop)                                                                           \
  FUNCTION(ModelGeoAddVolume)                                                                                \
  FUNCTION(ModelGeoSynchronize)                                                                              \
  FUNCTION(ModelGetBoundingBox)                                                                              \
  FUNCTION(ModelGetEntities)                                                                                 \
  FUNCTION(ModelGetEntitiesForPhysicalGroup)                                                                 \
  FUNCTION(ModelGetPhysicalGroups)                                                                           \
  FUNCTION(ModelGetPhysicalName)                                                                             \
  FUNCTION(ModelMeshClassifySurfaces)                                                                        \
  FUNCTION(ModelMeshClear)                                                                                   \
  FUNCTION(ModelMeshCreateGeometry)                                                                          \
  FUNCTION(ModelMeshGenerate)                                                                                \
  FUNCTION(ModelMeshGetElementProperties)                                                                    \
  FUNCTION(ModelMeshGetElementTypes)                                                                         \
  FUNCTION(ModelMeshGetElements)                                                                             \
  FUNCTION(ModelMeshGetElementsByType)                                                                       \
  FUNCTION(ModelMeshGetNodes)                                                                                \
  FUNCTION(ModelMeshGetNodesForPhysicalGroup)                                                                \
  FUNCTION(ModelMeshPreallocateElementsByType)                                                               \
  FUNCTION(ModelMeshRefine)                                                                                  \
  FUNCTION(Open)                                                                                             \
  FUNCTION(OptionSetNumber)

typedef struct FemMeshGmshLibrary {
#define FEM_GMSH_FIELD(name) __typeof__(gmsh##name) *name;
  FEM_GMSH_FUNCTIONS(FEM_GMSH_FIELD)
#undef FEM_GMSH_FIELD
} FemMeshGmshLibrary;

// Without command line, configuration files and windows. gmsh 4.8 (Debian 12) cannot be asked to run as its
// own program would; later ones can.
static inline void fem_mesh_gmsh_library_start(const FemMeshGmshLibrary *library, int *error) {
#if GMSH_API_VERSION_MAJOR == 4 && GMSH_API_VERSION_MINOR < 9
  library->Initialize(0, NULL, 0, error);
#else
  library->Initialize(0, NULL, 0, 0, error);
#endif
}

// The library stays loaded until the process ends. STATUS_IO: it is not installed, or is another than the one
// whose header tetlap was compiled with; the message names it.
Status fem_mesh_gmsh_library_load(FemMeshGmshLibrary *library);
// STATUS_INPUT, "gmsh could not DOING", with what it logged as its first error; later ones only repeat that
// it failed.
Status fem_mesh_gmsh_library_fail(const FemMeshGmshLibrary *gmsh, const char *doing);

#endif
