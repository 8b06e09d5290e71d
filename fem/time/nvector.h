// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of SUNDIALS whose operations are those of fem/sparse/vector.h: on all threads, the same bits on any
// number of them.
#ifndef TETLAP_FEM_TIME_NVECTOR_H
#define TETLAP_FEM_TIME_NVECTOR_H

#include <nvector/nvector_serial.h>

// All zero; its clones have the same operations. NULL: no memory. The caller destroys it by N_VDestroy,
// before the context.
N_Vector fem_nvector_create(int length, SUNContext context);

// √(Σ (x w)² / n) over all ranks' values.
sunrealtype fem_nvector_norm(N_Vector x, N_Vector weights);

#endif
