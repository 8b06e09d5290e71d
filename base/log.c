// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/machine/clock.h"

static LogLevel level = LOG_SILENT;
static bool progress_is_shown;

void log_set_level(LogLevel new_level) {
  level = new_level;
}

LogLevel log_level(void) {
  return level;
}

// Colours on a terminal unless NO_COLOR is set (no-color.org).
static bool has_colour(void) {
  const char *no_color = getenv("NO_COLOR");
  return isatty(STDERR_FILENO) && !(no_color && no_color[0]);
}

static void write_line(LogLevel at, const char *label, const char *colour, const char *format, va_list args) {
  if (level < at) return;
  log_progress_end();
  if (has_colour())
    fprintf(stderr, "%s%s\033[0m", colour, label);
  else
    fputs(label, stderr);
  vfprintf(stderr, format, args);
  fputc('\n', stderr);
}

void log_error(const char *format, ...) {
  va_list args;
  va_start(args, format);
  write_line(LOG_ERROR, "error: ", "\033[1;31m", format, args);
  va_end(args);
}

void log_warning(const char *format, ...) {
  va_list args;
  va_start(args, format);
  write_line(LOG_WARNING, "warning: ", "\033[1;33m", format, args);
  va_end(args);
}

void log_info(const char *format, ...) {
  va_list args;
  va_start(args, format);
  write_line(LOG_INFO, "", "", format, args);
  va_end(args);
}

void log_debug(const char *format, ...) {
  va_list args;
  va_start(args, format);
  write_line(LOG_DEBUG, "debug: ", "\033[2m", format, args);
  va_end(args);
}

// As many columns as the terminal has now, less one; characters of several bytes are not torn.
static void cut_to_terminal(char *text) {
  struct winsize window;
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col < 2) return;
  int columns = 0;
  for (char *at = text; *at; at++) {
    bool begins_character = ((unsigned char)*at & 0xC0) != 0x80;
    if (begins_character && ++columns >= window.ws_col) *at = 0;
    if (!*at) return;
  }
}

void log_progress(const char *format, ...) {
  static double shown_at = -1;
  if (level < LOG_INFO || !isatty(STDERR_FILENO)) return;
  double now = clock_wall_s();
  if (shown_at >= 0 && now - shown_at < 0.1) return;
  shown_at = now;
  va_list args;
  va_start(args, format);
  char line[512];
  vsnprintf(line, sizeof line, format, args);
  va_end(args);
  cut_to_terminal(line);
  fprintf(stderr, "\r\033[K%s", line);
  fflush(stderr);
  progress_is_shown = true;
}

bool log_pace_is_due(LogPace *pace, double share) {
  static const double LONGEST_SILENCE_S = 60;
  double now = clock_wall_s();
  int tenth = (int)(10 * share);
  bool is_due = tenth > pace->tenth || (pace->due_s > 0 && now >= pace->due_s);
  if (is_due || !(pace->due_s > 0)) pace->due_s = now + LONGEST_SILENCE_S;
  pace->tenth = tenth;
  return is_due && share < 1 && !isatty(STDERR_FILENO);
}

void log_progress_end(void) {
  if (!progress_is_shown) return;
  fputs("\r\033[K", stderr);
  progress_is_shown = false;
}
