// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures by gnuplot, from scripts that are kept beside them.
#ifndef TETLAP_APP_PLOT_GNUPLOT_H
#define TETLAP_APP_PLOT_GNUPLOT_H

#include <stdio.h>

#include "base/status.h"

// Runs the script and waits. STATUS_IO: gnuplot is missing or failed; the script is there all the same.
Status app_gnuplot_run(const char *script);

// Writes `set terminal`, a font for labels as the variable `small`, and `set output` for a picture `width` ×
// `height` (in pixels at 96 an inch): SVG, PDF or PNG by the ending of its name. STATUS_USAGE: another
// ending.
Status app_gnuplot_open(FILE *script, const char *picture, int width, int height);

// Writes text in gnuplot's double quotes.
void app_gnuplot_quote(FILE *script, const char *text);

#endif
