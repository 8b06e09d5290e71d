// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures by gnuplot, from scripts that are kept beside them.
#ifndef TETLAP_APP_GNUPLOT_H
#define TETLAP_APP_GNUPLOT_H

#include "base/status.h"

// Runs the script and waits. STATUS_IO: gnuplot is missing or failed; the script is there all the same.
Status app_gnuplot_run(const char *script);

#endif
