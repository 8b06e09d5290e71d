// SPDX-License-Identifier: GPL-3.0-or-later
// How benches list and choose overlap models (overlap/model.h).
#ifndef TETLAP_APP_BENCH_MODELS_H
#define TETLAP_APP_BENCH_MODELS_H

#include <argp.h>
#include <stdbool.h>

enum { APP_BENCH_MAX_MODELS = 32 };

// The names of all, in their order, and how many they are.
int app_bench_models_list(const char *names[APP_BENCH_MAX_MODELS]);

// Fills `sources` from a comma-separated list of models by name, weights files and `hybrid=` with one of both;
// returns how many there are. Ends the program where a word is none of these.
int app_bench_models_read(struct argp_state *state, const char *option, char *text,
                          const char *sources[APP_BENCH_MAX_MODELS]);

// Marks each model of a comma-separated list in `wanted`, the others not; ends the program where a name is
// wrong.
void app_bench_models_choose(struct argp_state *state, const char *option, char *text,
                             bool wanted[APP_BENCH_MAX_MODELS]);

#endif
