// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/tolerances.h"

#include <stddef.h>
#include <string.h>

// 1.5 times the worst of 100 members a class (cgal is held to the standard, with 3): volume, bounds, balance,
// order, motion, parts, gradient, flags.
static const AppStressTolerance tolerances[] = {
    {"clip32", {3.8e-6, 6.6e-7, 4.7e-7, 1.6e-5, 7.2e-6, 3.8e-6, 5.1e-3, 0}, "single precision", NULL},
    {"geo-small",
     {4.3e-2, 3.4e-2, 1e-14, 3e-12, 6.5e-13, 3.7e-2, 1e-7, 0},
     "a learned volume; its gradient is its own derivative",
     "overlap_fallbacks"},
    {"geo",
     {2.4e-2, 1.3e-2, 1e-14, 3.1e-12, 1.5e-12, 2.1e-2, 1e-7, 0},
     "a learned volume; its gradient is its own derivative",
     "overlap_fallbacks"},
    {"tpn",
     {1.5e1, 1.5e1, 1e-14, 2.5e9, 5.3e-1, 5.4e1, 6.7e-3, 1},
     "the paper's network as published: it knows volumes of its training only, sees vertices in an order, "
     "and gives disjoint pairs ghosts",
     "beyond_range_pairs"},
    {"tpn-bf16",
     {1.5e1, 1.5e1, 1e-14, 2.5e9, 5.3e-1, 5.4e1, 1.2e1, 1},
     "as tpn; V is a stair of roundings, which differences meet and its gradient leaves out",
     "beyond_range_pairs"},
    {"tpn-scene",
     {5.2e9, 5.2e9, 1.9e-10, 2.6e9, 5.4e1, 2.7e9, 6.7e-3, 0},
     "a network of the paper's kind: it knows volumes of its training only; slivers, which are beyond it, in "
     "units of their own volume",
     "beyond_range_pairs"},
    {"hybrid",
     {1.6e0, 6e-1, 1e-14, 1.3e0, 1e-12, 1.6e0, 5e-3, 0},
     "a network where it is sure, blended into exact over a band",
     "overlap_blended"},
};

const AppStressTolerance *app_stress_tolerances_find(const char *model) {
  for (size_t t = 0; t < sizeof tolerances / sizeof *tolerances; t++)
    if (strcmp(tolerances[t].model, model) == 0) return &tolerances[t];
  return NULL;
}
