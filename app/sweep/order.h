// SPDX-License-Identifier: GPL-3.0-or-later
// The observed order of convergence along an axis of a sweep: of three runs whose values stand in one ratio
// r, the coarsest first, p = log(|f₁ − f₂| / |f₂ − f₃|) / |log r| (Roache 1994).
#ifndef TETLAP_APP_SWEEP_ORDER_H
#define TETLAP_APP_SWEEP_ORDER_H

// NaN: the values are no positive numbers in one ratio (to 1 %), or f does not go one way.
double app_sweep_order_observed(const char *const values[3], const double f[3]);

#endif
