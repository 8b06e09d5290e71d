// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures and movies of runs: the page of app/report in a browser without a window.
#ifndef TETLAP_APP_RENDER_RENDER_H
#define TETLAP_APP_RENDER_RENDER_H

#include <signal.h>
#include <stdbool.h>

#include "app/report/report.h"

typedef struct AppRenderOptions {
  const char *picture;             // FILE.png; NULL: none
  const char *movie;               // FILE.mp4 or FILE.gif; NULL: none
  int frame;                       // of the picture; negative: from the end
  int per_second;                  // frames of a movie
  int width, height;               // in pixels
  const char *field, *cut, *theme; // NULL: the page's own
  double cut_share;                // place of the cut, 0 … 1
  const double *range; // (2): ends of the colours' scale, in the field's unit; NULL: those of its values
  const double
      *view;        // the camera's azimuth about z from x, and elevation [degrees] (2); NULL: the page's own
  bool hides_edges; // of elements
  const volatile sig_atomic_t *stop; // ends it when it is raised
} AppRenderOptions;

// Whether a picture may have that name: FILE.png, or a device such as /dev/stdout.
bool app_render_is_picture(const char *path);

// Draws the runs of the report, whose records it takes. STATUS_USAGE: no such frame or field, with those that
// there are. STATUS_IO: Chromium or ffmpeg is missing.
Status app_render(AppReport *report, const AppRenderOptions *options);

#endif
