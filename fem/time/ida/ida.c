// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/ida/ida.h"

void fem_ida_scatter(FemIda *ida, double time, N_Vector y) {
  const double *u = fem_part_join(&ida->part, fem_ida_values(y));
  fem_system_scatter(ida->system, time, u, u + ida->part.n, ida->state);
}
