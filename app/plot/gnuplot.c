// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/plot/gnuplot.h"

#include <errno.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/text.h"

extern char **environ;

void app_gnuplot_quote(FILE *script, const char *text) {
  fputc('"', script);
  for (; *text; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', script);
    fputc(*text == '\n' ? ' ' : *text, script);
  }
  fputc('"', script);
}

Status app_gnuplot_open(FILE *script, const char *picture, int width, int height) {
  if (text_ends_in(picture, ".svg"))
    fprintf(script,
            "set terminal svg size %d,%d dynamic background 'white' font 'sans-serif,12'\nsmall = ',10'\n",
            width, height);
  else if (text_ends_in(picture, ".pdf"))
    fprintf(script, "set terminal pdfcairo size %.3fin,%.3fin font 'sans,9'\nsmall = ',7.5'\n", width / 96.0,
            height / 96.0);
  else if (text_ends_in(picture, ".png"))
    fprintf(script,
            "set terminal pngcairo size %d,%d font 'sans,18' linewidth 2 background 'white'\nsmall = ',14'\n",
            2 * width, 2 * height);
  else
    return status_fail(STATUS_USAGE, "%s: name a picture that ends in .svg, .pdf or .png", picture);
  app_gnuplot_output(script, picture);
  return STATUS_OK;
}

void app_gnuplot_output(FILE *script, const char *picture) {
  fputs("if (!exists('picture')) picture = ", script);
  app_gnuplot_quote(script, picture);
  fputs("\nset output picture\n", script);
}

static bool holds(const char *bytes, size_t length, const char *part) {
  size_t size = strlen(part);
  for (size_t i = 0; i + size <= length; i++)
    if (memcmp(bytes + i, part, size) == 0) return true;
  return false;
}

// What the last bytes of a whole picture hold.
static bool is_whole(const char *path, const char *picture) {
  static const struct {
    const char *ending, *last;
  } kinds[] = {{".svg", "</svg>"}, {".pdf", "%%EOF"}, {".png", "IEND\xae\x42\x60\x82"}};
  char tail[32];
  FILE *file = fopen(path, "rb");
  if (!file) return false;
  bool is_long = fseek(file, -(long)sizeof tail, SEEK_END) == 0;
  size_t length = is_long ? fread(tail, 1, sizeof tail, file) : 0;
  fclose(file);
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    if (text_ends_in(picture, kinds[k].ending)) return holds(tail, length, kinds[k].last);
  return false;
}

// `set`: what gnuplot does before the script.
static Status run(char *set, const char *script) {
  char program[] = "gnuplot", option[] = "-e", name[4096];
  if (snprintf(name, sizeof name, "%s", script) >= (int)sizeof name)
    return status_fail(STATUS_USAGE, "the picture's name is too long");
  char *arguments[] = {program, option, set, name, NULL};
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

static Status draw(const char *script, const char *picture, const char *temporary) {
  char *set = NULL;
  size_t size;
  FILE *stream = open_memstream(&set, &size);
  if (!stream) return status_no_memory("a picture's name");
  fputs("picture = ", stream);
  app_gnuplot_quote(stream, temporary);
  bool is_written = fclose(stream) == 0;
  Status status = is_written ? run(set, script) : status_no_memory("a picture's name");
  free(set);
  if (!status && !is_whole(temporary, picture))
    return status_fail(STATUS_IO, "gnuplot did not draw all of %s; is there room for it? The script is %s",
                       picture, script);
  return status;
}

Status app_gnuplot_run(const char *script, const char *picture) {
  FileWriter writer;
  TRY(file_begin(&writer, picture));
  Status status = draw(script, picture, writer.temporary);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}
