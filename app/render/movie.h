// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures one after another as a movie, by ffmpeg as a child process.
#ifndef TETLAP_APP_RENDER_MOVIE_H
#define TETLAP_APP_RENDER_MOVIE_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

#include "base/files/file.h"

typedef struct AppRenderMovie {
  pid_t process; // 0: none
  FILE *stream;
  FileWriter file; // where it grows, beside its place
} AppRenderMovie;

bool app_render_movie_is_known(const char *path); // whether its name ends in .mp4 or .gif

// Of the kind that the path's ending says. It appears at `path` when it has ended, whole. STATUS_IO: no
// process, or no such place. Abandon it always.
Status app_render_movie_begin(AppRenderMovie *movie, const char *path, int per_second);
Status app_render_movie_add(AppRenderMovie *movie, const unsigned char *png, size_t size);
// STATUS_IO: ffmpeg is not there (the message names the package), or failed.
Status app_render_movie_end(AppRenderMovie *movie);
void app_render_movie_abandon(AppRenderMovie *movie); // also one that has ended

#endif
