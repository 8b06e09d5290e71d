// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/plot/gnuplot.h"

#include <errno.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static bool ends_with(const char *text, const char *end) {
  size_t length = strlen(text), wanted = strlen(end);
  return length >= wanted && strcmp(text + length - wanted, end) == 0;
}

void app_gnuplot_quote(FILE *script, const char *text) {
  fputc('"', script);
  for (; *text; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', script);
    fputc(*text == '\n' ? ' ' : *text, script);
  }
  fputc('"', script);
}

Status app_gnuplot_open(FILE *script, const char *picture, int width, int height) {
  if (ends_with(picture, ".svg"))
    fprintf(script,
            "set terminal svg size %d,%d dynamic background 'white' font 'sans-serif,12'\nsmall = ',10'\n",
            width, height);
  else if (ends_with(picture, ".pdf"))
    fprintf(script, "set terminal pdfcairo size %.3fin,%.3fin font 'sans,9'\nsmall = ',7.5'\n", width / 96.0,
            height / 96.0);
  else if (ends_with(picture, ".png"))
    fprintf(script,
            "set terminal pngcairo size %d,%d font 'sans,18' linewidth 2 background 'white'\nsmall = ',14'\n",
            2 * width, 2 * height);
  else
    return status_fail(STATUS_USAGE, "%s: name a picture that ends in .svg, .pdf or .png", picture);
  fputs("set output ", script);
  app_gnuplot_quote(script, picture);
  fputc('\n', script);
  return STATUS_OK;
}

Status app_gnuplot_run(const char *script) {
  char program[] = "gnuplot", name[4096];
  if (snprintf(name, sizeof name, "%s", script) >= (int)sizeof name)
    return status_fail(STATUS_USAGE, "the picture's name is too long");
  char *arguments[] = {program, name, NULL};
  pid_t child;
  int failed = posix_spawnp(&child, program, NULL, NULL, arguments, environ), ended;
  if (failed)
    return status_fail(STATUS_IO, "gnuplot cannot be run: %s; the script is %s", strerror(failed), script);
  while (waitpid(child, &ended, 0) < 0)
    if (errno != EINTR) return status_fail(STATUS_IO, "gnuplot was lost: %s", strerror(errno));
  if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0)
    return status_fail(STATUS_IO, "gnuplot failed on %s", script);
  return STATUS_OK;
}
