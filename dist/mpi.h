// SPDX-License-Identifier: GPL-3.0-or-later
// MPI: the table of base/ranks.h for a program that mpiexec has started on several processes, and how all of
// them end together.
#ifndef TETLAP_DIST_MPI_H
#define TETLAP_DIST_MPI_H

// Whether mpiexec, or a batch system in its place, has started more than this process.
int dist_mpi_is_wanted(void);

// One process that can tell how several would divide a mesh. Before a scene is read.
void dist_mpi_begin_alone(void);

// Starts MPI and sets the table; from here on only the first rank is heard. At exit, however that comes
// about, all ranks end with one exit code: what all agree on, or that of a rank that failed by itself. Such a
// rank is heard and ends the others within some two seconds. `close` is called before, where all end in
// order.
void dist_mpi_begin(int *argument_count, char ***arguments, void (*close)(void));

#endif
