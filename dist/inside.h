// SPDX-License-Identifier: GPL-3.0-or-later
// How long this rank has been within MPI, whoever called it: tetlap, PETSc or hypre. Waiting ranks ask for
// messages all the time, which is no work of theirs.
#ifndef TETLAP_DIST_INSIDE_H
#define TETLAP_DIST_INSIDE_H

// Processor time of this thread within MPI's calls that wait or move data [s]; those of MUMPS, which is
// Fortran, are not among them.
double dist_inside_s(void);

#endif
