// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/pairs/csv.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static const char byte_order_mark[] = "\xef\xbb\xbf";

static Status fail_read(const AppPairsCsv *csv) {
  if (errno == EINTR) return status_fail(STATUS_INTERRUPTED, "interrupted");
  return status_fail(STATUS_IO, "%s: cannot be read: %s", csv->name, strerror(errno));
}

// The next line that holds something, without its end.
static Status read_line(AppPairsCsv *csv, bool *is_end) {
  for (;;) {
    errno = 0;
    ssize_t length = getline(&csv->line, &csv->capacity, csv->stream);
    *is_end = length < 0;
    if (length < 0) return ferror(csv->stream) || errno == ENOMEM ? fail_read(csv) : STATUS_OK;
    csv->line_number++;
    if (strlen(csv->line) < (size_t)length)
      return status_fail(STATUS_INPUT, "%s:%lld:%zu: a zero byte; this is neither text nor a .npy file",
                         csv->name, csv->line_number, strlen(csv->line) + 1);
    if (csv->line_number == 1 && strncmp(csv->line, byte_order_mark, 3) == 0) memset(csv->line, ' ', 3);
    csv->line[strcspn(csv->line, "\r\n")] = 0;
    const char *text = csv->line + strspn(csv->line, " \t");
    if (*text && *text != '#') return STATUS_OK;
  }
}

static char find_separator(const char *line) {
  return strchr(line, ',') ? ',' : strchr(line, ';') ? ';' : ' ';
}

static bool is_blank(char letter) {
  return letter == ' ' || letter == '\t';
}

// The end of the field that begins at `text`, and where the next one begins; NULL: it was the last.
static char *find_end(const AppPairsCsv *csv, char *text, char **next) {
  char *end = text;
  while (*end && (csv->separator == ' ' ? !is_blank(*end) : *end != csv->separator)) end++;
  *next = *end ? end + 1 : NULL;
  if (csv->separator == ' ' && *end && !end[strspn(end, " \t")]) *next = NULL; // blanks at the line's end
  while (end > text && is_blank(end[-1])) end--;
  return end;
}

static int column_of(const AppPairsCsv *csv, const char *place) {
  int line, column;
  text_place(csv->line, (size_t)(place - csv->line), &line, &column);
  return column;
}

// Cuts the line into its fields; their columns are counted before the cuts.
static Status split(AppPairsCsv *csv) {
  char *ends[APP_PAIRS_MAX_COLUMNS];
  csv->field_count = 0;
  for (char *text = csv->line; text;) {
    if (csv->field_count == APP_PAIRS_MAX_COLUMNS)
      return status_fail(STATUS_INPUT, "%s:%lld: more than %d columns", csv->name, csv->line_number,
                         APP_PAIRS_MAX_COLUMNS);
    text += strspn(text, " \t");
    csv->fields[csv->field_count] = text;
    csv->field_places[csv->field_count] = column_of(csv, text);
    ends[csv->field_count++] = find_end(csv, text, &text);
  }
  for (int f = 0; f < csv->field_count; f++) *ends[f] = 0;
  return STATUS_OK;
}

static bool is_number(const char *text) {
  char *end;
  strtod(text, &end);
  return end != text && !*end;
}

// "a0x" in quotation marks is a0x.
static void strip_quotes(AppPairsCsv *csv) {
  for (int f = 0; f < csv->field_count; f++) {
    char *name = csv->line + (csv->fields[f] - csv->line);
    size_t length = strlen(name);
    if (length < 2 || name[0] != '"' || name[length - 1] != '"') continue;
    name[length - 1] = 0;
    csv->fields[f] = name + 1;
  }
}

Status app_pairs_csv_open(AppPairsCsv *csv, FILE *stream, const char *name) {
  *csv = (AppPairsCsv){.stream = stream, .name = name};
  bool is_end;
  TRY(read_line(csv, &is_end));
  if (is_end) return status_fail(STATUS_INPUT, "%s: is empty; a row for each pair is expected", name);
  csv->separator = find_separator(csv->line);
  TRY(split(csv));
  csv->has_header = true;
  for (int f = 0; f < csv->field_count; f++)
    if (is_number(csv->fields[f])) csv->has_header = false;
  csv->is_pending = !csv->has_header;
  if (csv->has_header) strip_quotes(csv);
  return STATUS_OK;
}

static Status read_number(const AppPairsCsv *csv, int f, double *value) {
  const char *text = csv->fields[f];
  char *end;
  *value = strtod(text, &end);
  if (end == text || *end)
    return status_fail(STATUS_INPUT, "%s:%lld:%d: %s%.40s%s; a number is expected", csv->name,
                       csv->line_number, csv->field_places[f], *text ? "'" : "nothing stands here", text,
                       *text ? "' is none" : "");
  if (!isfinite(*value))
    return status_fail(STATUS_INPUT, "%s:%lld:%d: '%.40s' is not finite; a finite number is expected",
                       csv->name, csv->line_number, csv->field_places[f], text);
  return STATUS_OK;
}

Status app_pairs_csv_read(AppPairsCsv *csv, int count, double *row, bool *is_end) {
  *is_end = false;
  if (!csv->is_pending) {
    TRY(read_line(csv, is_end));
    if (*is_end) return STATUS_OK;
    TRY(split(csv));
  }
  csv->is_pending = false;
  if (csv->field_count != count)
    return status_fail(STATUS_INPUT, "%s:%lld:%d: %d numbers; the first line has %d", csv->name,
                       csv->line_number, csv->field_places[csv->field_count - 1], csv->field_count, count);
  for (int f = 0; f < count; f++) TRY(read_number(csv, f, &row[f]));
  return STATUS_OK;
}

void app_pairs_csv_close(AppPairsCsv *csv) {
  free(csv->line);
  *csv = (AppPairsCsv){0};
}
