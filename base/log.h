// SPDX-License-Identifier: GPL-3.0-or-later
// Lines for a person, on stderr. Nothing is printed until a program sets a level: libraries stay silent.
#ifndef TETLAP_BASE_LOG_H
#define TETLAP_BASE_LOG_H

#include <stdbool.h>

typedef enum LogLevel {
  LOG_SILENT,
  LOG_ERROR,
  LOG_WARNING,
  LOG_INFO,
  LOG_DEBUG,
} LogLevel;

void log_set_level(LogLevel level);
LogLevel log_level(void);

void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_debug(const char *format, ...) __attribute__((format(printf, 1, 2)));

// One line that is overwritten in place, on a terminal only and at most ten times a second.
void log_progress(const char *format, ...) __attribute__((format(printf, 1, 2)));
// Where standard error is no terminal, progress is lines: one is due at each tenth of the way, and a minute
// after the last. None is due on a terminal or at the end (`share` 1), which the caller reports anyway.
typedef struct LogPace {
  int tenth;    // that the last line was in
  double due_s; // by the wall clock; 0: nothing has been asked yet
} LogPace;      // zeroed: at the beginning
bool log_pace_is_due(LogPace *pace, double share);
// Removes the progress line, before other output or at the end.
void log_progress_end(void);

#endif
