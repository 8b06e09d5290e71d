// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench datagen`: labelled pairs a second, in memory and into a file.
#ifndef TETLAP_APP_BENCH_DATAGEN_H
#define TETLAP_APP_BENCH_DATAGEN_H

// Runs the bench; arguments[0] is what the usage line begins with. Returns the exit code.
int app_bench_datagen_run(int argument_count, char **arguments);

#endif
