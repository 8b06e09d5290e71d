// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a reader in a child process and brings its mesh, or its message, back through a pipe. Whatever the
// reader does (crash, print, change signal handlers or threads, leak, run away until Ctrl-C) stays there.
#ifndef TETLAP_FEM_MESH_READER_WORKER_H
#define TETLAP_FEM_MESH_READER_WORKER_H

#include <stddef.h>

#include "fem/mesh/validate.h"

typedef Status (*FemMeshReader)(FemMeshSource *source, const char *path, const FemMeshOptions *options);

// `memory_limit` [bytes]: what the reader may allocate beyond this process's own; 0: no limit. Without it a
// file whose counts are wrong can take all memory of the machine. STATUS_INPUT: the reader failed, or crashed
// on the file. STATUS_INTERRUPTED: a signal came that either the child did not survive or this process
// handles (its handler installed without SA_RESTART); the child is gone. STATUS_IO: no process or pipe to be
// had. The message does not name the file. The source is zeroed on failure.
Status fem_mesh_worker_run(FemMeshReader reader, FemMeshSource *source, const char *path,
                           const FemMeshOptions *options, size_t memory_limit);

#endif
