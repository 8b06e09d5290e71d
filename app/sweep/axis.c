// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "overlap/source.h"

enum { NUMBER_SIZE = 32 };

static Status fail(const char *text, const char *reason) {
  return status_fail(STATUS_USAGE,
                     "--vary %s: %s; expected a key and its values, as contact.stiffness=1e5..1e9:5,log or "
                     "contact.overlap=clip,geo",
                     text, reason);
}

static char *copy(const char *text, size_t length) {
  char *part = memory_zeroed(length + 1, 1);
  if (part) memcpy(part, text, length);
  return part;
}

static Status add(AppSweepAxis *axis, const char *value, size_t length) {
  while (length > 0 && *value == ' ') value++, length--;
  while (length > 0 && value[length - 1] == ' ') length--;
  axis->values[axis->value_count] = copy(value, length);
  return axis->values[axis->value_count++] ? STATUS_OK : status_no_memory("the values of --vary");
}

// "1e+05" as people write it, 1e5.
static void shorten_exponent(char *text) {
  char *mark = strchr(text, 'e');
  if (!mark) return;
  char *digits = mark + (mark[1] == '-' ? 2 : 1), *rest = digits + (mark[1] == '+');
  while (*rest == '0' && rest[1]) rest++;
  memmove(digits, rest, strlen(rest) + 1);
}

// The shortest text that reads back to the same number.
static void print_number(double value, char text[NUMBER_SIZE]) {
  for (int digits = 1; digits <= 17; digits++) {
    snprintf(text, NUMBER_SIZE, "%.*g", digits, value);
    if (strtod(text, NULL) == value) break;
  }
  shorten_exponent(text);
}

typedef struct Range {
  double low, high;
  int count;
  bool is_log;
} Range;

static bool read_number(const char *begin, size_t length, double *value) {
  char text[NUMBER_SIZE], *end;
  if (length == 0 || length >= sizeof text) return false;
  memcpy(text, begin, length);
  text[length] = 0;
  *value = strtod(text, &end);
  return !*end && isfinite(*value);
}

// "low..high:count" or "low..high:count,log". False: it is no range.
static bool read_range(const char *values, Range *range) {
  const char *dots = strstr(values, ".."), *colon = dots ? strchr(dots, ':') : NULL;
  if (!colon || !read_number(values, (size_t)(dots - values), &range->low) ||
      !read_number(dots + 2, (size_t)(colon - dots - 2), &range->high))
    return false;
  char *end;
  long count = strtol(colon + 1, &end, 10);
  range->is_log = strcmp(end, ",log") == 0;
  range->count = count > APP_SWEEP_MAX_VALUES ? APP_SWEEP_MAX_VALUES + 1 : (int)count;
  return end != colon + 1 && (range->is_log || !*end);
}

static double value_of(const Range *range, int k) {
  if (k == 0) return range->low;
  if (k == range->count - 1) return range->high;
  double share = (double)k / (range->count - 1);
  // Few digits, since a folder is named by them: powers of ten between two of these, and tenths, are such.
  char text[NUMBER_SIZE];
  if (range->is_log)
    snprintf(text, sizeof text, "%.6g", range->low * pow(range->high / range->low, share));
  else
    snprintf(text, sizeof text, "%.12g", range->low + share * (range->high - range->low));
  return strtod(text, NULL);
}

static Status fill_range(AppSweepAxis *axis, const char *text, const Range *range) {
  if (range->count < 2 || range->count > APP_SWEEP_MAX_VALUES)
    return fail(text, "the count behind ':' is not from 2 to 1000");
  if (range->is_log && !(range->low > 0 && range->high > 0))
    return fail(text, "a logarithmic range needs two numbers above 0");
  axis->values = memory_zeroed((size_t)range->count, sizeof *axis->values);
  if (!axis->values) return status_no_memory("the values of --vary");
  for (int k = 0; k < range->count; k++) {
    char number[NUMBER_SIZE];
    print_number(value_of(range, k), number);
    TRY(add(axis, number, strlen(number)));
  }
  return STATUS_OK;
}

// Where the value that begins here ends: at a comma outside brackets and quotes, or with the text.
static const char *end_of(const char *value) {
  int depth = 0;
  char quote = 0;
  for (; *value; value++) {
    if (quote)
      quote = *value == quote ? 0 : quote;
    else if (*value == '"' || *value == '\'')
      quote = *value;
    else if (*value == ',' && depth == 0)
      break;
    else
      depth += (strchr("[{", *value) != NULL) - (strchr("]}", *value) != NULL);
  }
  return value;
}

static Status fill_list(AppSweepAxis *axis, const char *text, const char *values) {
  int count = 1;
  for (const char *end = end_of(values); *end; end = end_of(end + 1)) count++;
  if (count > APP_SWEEP_MAX_VALUES) return fail(text, "more than 1000 values");
  axis->values = memory_zeroed((size_t)count, sizeof *axis->values);
  if (!axis->values) return status_no_memory("the values of --vary");
  for (const char *begin = values; axis->value_count < count;) {
    const char *end = end_of(begin);
    TRY(add(axis, begin, (size_t)(end - begin)));
    if (!axis->values[axis->value_count - 1][0]) return fail(text, "a value is empty");
    begin = end + 1;
  }
  return STATUS_OK;
}

static Status check_distinct(const AppSweepAxis *axis, const char *text) {
  for (int a = 0; a < axis->value_count; a++)
    for (int b = 0; b < a; b++)
      if (strcmp(axis->values[a], axis->values[b]) == 0) return fail(text, "a value stands there twice");
  return STATUS_OK;
}

Status app_sweep_axis_parse(AppSweepAxis *axis, const char *text) {
  *axis = (AppSweepAxis){0};
  const char *equals = strchr(text, '=');
  if (!equals) return fail(text, "no '='");
  if (equals == text) return fail(text, "no key before the '='");
  Range range;
  axis->key = copy(text, (size_t)(equals - text));
  Status status = axis->key ? STATUS_OK : status_no_memory("the key of --vary");
  if (!status)
    status =
        read_range(equals + 1, &range) ? fill_range(axis, text, &range) : fill_list(axis, text, equals + 1);
  if (!status) status = check_distinct(axis, text);
  if (status) app_sweep_axis_destroy(axis);
  return status;
}

static Status parse_next(AppSweepAxis *axes, int most, int *count, const char *text, int first) {
  if (*count == most) return fail(text, "too many keys");
  TRY(app_sweep_axis_parse(&axes[*count], text));
  AppSweepAxis *axis = &axes[(*count)++];
  axis->is_linked = axis != &axes[first];
  if (axis->value_count == axes[first].value_count) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "--vary: '%s' has %d values and '%s', which changes with it, %d; give as many to both",
                     axes[first].key, axes[first].value_count, axis->key, axis->value_count);
}

Status app_sweep_axis_parse_linked(AppSweepAxis *axes, int most, int *count, const char *text) {
  static const char link[] = " with ";
  Status status = STATUS_OK;
  int first = *count;
  while (text && !status) {
    const char *end = strstr(text, link);
    char *part = copy(text, end ? (size_t)(end - text) : strlen(text));
    status = part ? parse_next(axes, most, count, part, first) : status_no_memory("the keys of --vary");
    memory_free(part);
    text = end ? end + sizeof link - 1 : NULL;
  }
  return status;
}

bool app_sweep_axis_locate(const AppSweepAxis *axis, int k, const char *scene_path, char path[PATH_MAX]) {
  char from[PATH_MAX], *folder = file_directory_of(scene_path);
  bool is_file = folder && overlap_source_from(axis->values[k], folder, from, sizeof from) &&
                 app_model_names_settle(from, path);
  memory_free(folder);
  return is_file;
}

static Status find_labels(AppSweepAxis *axis, const char *scene_path, char (*paths)[PATH_MAX],
                          const char **sources) {
  bool has_files = false;
  for (int k = 0; k < axis->value_count; k++) {
    bool is_file = app_sweep_axis_locate(axis, k, scene_path, paths[k]);
    sources[k] = is_file ? paths[k] : axis->values[k];
    has_files = has_files || is_file;
  }
  if (!has_files) return STATUS_OK;
  axis->labels = memory_zeroed((size_t)axis->value_count, sizeof *axis->labels);
  if (!axis->labels) return status_no_memory("the values of --vary");
  return app_model_names_find(axis->value_count, sources, axis->labels);
}

Status app_sweep_axis_label(AppSweepAxis *axis, const char *scene_path) {
  char(*paths)[PATH_MAX] = memory_zeroed((size_t)axis->value_count, sizeof *paths);
  const char **sources = memory_zeroed((size_t)axis->value_count, sizeof *sources);
  Status status = paths && sources ? find_labels(axis, scene_path, paths, sources)
                                   : status_no_memory("the values of --vary");
  memory_free(paths), memory_free(sources);
  return status;
}

const char *app_sweep_axis_name(const AppSweepAxis *axis, int k) {
  return axis->labels ? axis->labels[k] : axis->values[k];
}

void app_sweep_axis_destroy(AppSweepAxis *axis) {
  for (int k = 0; k < axis->value_count; k++) memory_free(axis->values[k]);
  memory_free(axis->values);
  memory_free(axis->labels);
  memory_free(axis->key);
  *axis = (AppSweepAxis){0};
}
