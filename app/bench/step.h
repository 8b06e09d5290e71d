// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench step SCENE`: where the time of a run goes, one row a phase.
#ifndef TETLAP_APP_BENCH_STEP_H
#define TETLAP_APP_BENCH_STEP_H

// Runs the bench; arguments[0] is what the usage line begins with. Returns the exit code.
int app_bench_step_run(int argument_count, char **arguments);

#endif
