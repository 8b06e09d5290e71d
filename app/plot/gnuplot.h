// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures by gnuplot, from scripts that are kept beside them.
#ifndef TETLAP_APP_PLOT_GNUPLOT_H
#define TETLAP_APP_PLOT_GNUPLOT_H

#include <stdio.h>

#include "base/status.h"

// Runs the script, whose output app_gnuplot_output has set, and waits. The picture appears whole or not at
// all. STATUS_IO: gnuplot is missing or failed, or what it drew has no end; the script is there all the same.
Status app_gnuplot_run(const char *script, const char *picture);

// Writes `set terminal`, a font for labels as the variable `small`, and the output for a picture `width` ×
// `height` (in pixels at 96 an inch): SVG, PDF or PNG by the ending of its name. STATUS_USAGE: another
// ending.
Status app_gnuplot_open(FILE *script, const char *picture, int width, int height);

// Writes `set output` for the picture, or for what the variable `picture` names when the script begins.
void app_gnuplot_output(FILE *script, const char *picture);

// Writes text in gnuplot's double quotes.
void app_gnuplot_quote(FILE *script, const char *text);

#endif
