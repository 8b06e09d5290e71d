// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/goal.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/gradient/quantity.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/model/limits.h"

// Cuts "a, b, c" in place; returns how many.
static int cut_line(char *line, char *cells[4]) {
  int count = 0;
  for (char *at = line; at && count < 4; count++) {
    char *comma = strchr(at, ',');
    if (comma) *comma = 0;
    while (isspace((unsigned char)*at)) at++;
    for (char *end = at + strlen(at); end > at && isspace((unsigned char)end[-1]);) *--end = 0;
    cells[count] = at;
    at = comma ? comma + 1 : NULL;
  }
  return count;
}

static bool read_number(const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  return end != text && *end == 0 && isfinite(*value);
}

// "QUANTITY@TIME", or QUANTITY alone, which is taken `at` a time; cuts in place.
static Status read_quantity(const FemModel *model, char *text, double at, FemTerm *term) {
  char *mark = strrchr(text, '@');
  double end = model->scene->end;
  if (mark) *mark = 0;
  TRY(app_gradient_read_quantity(model, text, &term->quantity));
  term->time = at;
  if (mark && !read_number(mark + 1, &term->time))
    return status_fail(STATUS_INPUT, "'@%s' is no time; expected %s@TIME in seconds", mark + 1, text);
  if (term->time > FEM_TIME_RESOLUTION * end &&
      (isinf(term->time) || term->time <= end * (1 + FEM_TIME_RESOLUTION)))
    return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: the time %.9g s is not within the run, 0 to time.end = %.9g s", text,
                     term->time, end);
}

static Status read_term(const FemModel *model, char *line, bool is_misfit, double at, FemTerm *term) {
  char *cells[4];
  int count = cut_line(line, cells);
  *term = (FemTerm){0};
  if (count != (is_misfit ? 3 : 2) || !read_number(cells[1], &term->weight) ||
      (is_misfit && !read_number(cells[2], &term->data)))
    return status_fail(STATUS_INPUT, "expected %s",
                       is_misfit ? "quantity, weight, data" : "quantity, weight");
  return read_quantity(model, cells[0], at, term);
}

static Status read_lines(const FemModel *model, const char *path, char *text, double time, FemGoal *goal) {
  int lines = 1;
  for (const char *at = text; *at; at++) lines += *at == '\n';
  goal->terms = memory_zeroed((size_t)lines, sizeof *goal->terms);
  if (!goal->terms) return status_no_memory("a sum of quantities");
  char *at = text;
  for (int line = 1; at; line++) {
    char *end = strchr(at, '\n'), *own = at;
    if (end) *end = 0;
    at = end ? end + 1 : NULL;
    while (isspace((unsigned char)*own)) own++;
    if (*own == 0 || *own == '#') continue;
    FemTerm *term = &goal->terms[goal->term_count];
    TRY(status_prefix(read_term(model, own, goal->is_misfit, time, term), "%s:%d", path, line));
    goal->term_count++;
  }
  return goal->term_count > 0 ? STATUS_OK : status_fail(STATUS_INPUT, "%s: no quantity stands in it", path);
}

static Status read_file(const FemModel *model, const char *path, double at, FemGoal *goal) {
  char *text;
  size_t size;
  TRY(file_read(path, &text, &size));
  Status status = read_lines(model, path, text, at, goal);
  memory_free(text);
  return status;
}

static Status read_one(const FemModel *model, const char *text, double at, FemTerm *term) {
  char *own = memory_copy(text, strlen(text) + 1, 1);
  Status status = own ? read_quantity(model, own, at, term) : status_no_memory("a quantity");
  memory_free(own);
  return status;
}

Status app_gradient_read_goal(const FemModel *model, const char *text, double at, FemGoal *goal) {
  static const char sum[] = "sum:", misfit[] = "misfit:";
  *goal = (FemGoal){0};
  if (strncmp(text, sum, strlen(sum)) == 0) return read_file(model, text + strlen(sum), at, goal);
  goal->is_misfit = strncmp(text, misfit, strlen(misfit)) == 0;
  if (goal->is_misfit) return read_file(model, text + strlen(misfit), at, goal);
  goal->terms = memory_zeroed(1, sizeof *goal->terms);
  if (!goal->terms) return status_no_memory("a quantity");
  goal->term_count = 1;
  goal->terms->weight = 1;
  return read_one(model, text, at, goal->terms);
}

void app_gradient_destroy_goal(FemGoal *goal) {
  memory_free(goal->terms);
  *goal = (FemGoal){0};
}

const char *app_gradient_unit(const FemGoal *goal, const char *text) {
  bool is_file = goal->is_misfit || strncmp(text, "sum:", 4) == 0;
  return is_file ? "" : fem_quantity_unit(&goal->terms->quantity);
}
