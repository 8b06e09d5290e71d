// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/poses/list.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "base/text.h"

enum { SIZE = 12 };
static const double ROTATION_ERROR = 1e-6; // of a rotation in a file

// The line's numbers, at most one more than asked; −1: something else is in it.
static int read_numbers(const char *at, const char *end, double numbers[SIZE + 1]) {
  int count = 0;
  while (at < end && *at != '#') {
    if (isspace((unsigned char)*at) || *at == ',') {
      at++;
      continue;
    }
    char *after;
    double number = strtod(at, &after);
    if (after == at || after > end || count > SIZE) return count > SIZE ? count : -1;
    numbers[count++] = number;
    at = after;
  }
  return count;
}

static bool is_rotation(const double r[9]) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double product = 0;
      for (int k = 0; k < 3; k++) product += r[3 * i + k] * r[3 * j + k];
      if (!(fabs(product - (i == j)) <= ROTATION_ERROR)) return false;
    }
  double det = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
               r[2] * (r[3] * r[7] - r[4] * r[6]);
  return det > 0;
}

static Status check(const double numbers[SIZE + 1], int count, const char *path, int line) {
  if (count != SIZE)
    return status_fail(STATUS_INPUT,
                       "%s, line %d: a pose is 12 numbers, the rotation row by row and the shift; %s", path,
                       line, count < 0 ? "here is something else" : "here are others than 12");
  for (int k = 0; k < SIZE; k++)
    if (!isfinite(numbers[k]))
      return status_fail(STATUS_INPUT, "%s, line %d: number %d must be finite", path, line, k + 1);
  if (!is_rotation(numbers))
    return status_fail(STATUS_INPUT, "%s, line %d: the first nine numbers are not a rotation (to %g)", path,
                       line, ROTATION_ERROR);
  return STATUS_OK;
}

static Status append(AppPosesList *list, size_t *capacity, const double numbers[SIZE]) {
  size_t count = (size_t)list->count + 1;
  if (count > INT_MAX / SIZE ||
      !memory_reserve((void **)&list->poses, capacity, count * SIZE, sizeof *numbers))
    return status_no_memory("the poses");
  memcpy(list->poses + (count - 1) * SIZE, numbers, SIZE * sizeof *numbers);
  list->count = (int)count;
  return STATUS_OK;
}

static Status read_text(AppPosesList *list, const char *path, const char *text) {
  size_t capacity = 0;
  for (int line = 1; *text; line++) {
    const char *end = strchr(text, '\n');
    if (!end) end = text + strlen(text);
    double numbers[SIZE + 1];
    int count = read_numbers(text, end, numbers);
    if (count != 0) {
      TRY(check(numbers, count, path, line));
      TRY(append(list, &capacity, numbers));
    }
    text = *end ? end + 1 : end;
  }
  return list->count > 0 ? STATUS_OK : status_fail(STATUS_INPUT, "%s: there are no poses in it", path);
}

Status app_poses_list_read(AppPosesList *list, const char *path) {
  char *text;
  size_t size;
  *list = (AppPosesList){0};
  TRY(file_read(path, &text, &size));
  Status status = read_text(list, path, text + text_mark_length(text, size));
  memory_free(text);
  if (status != STATUS_OK) app_poses_list_destroy(list);
  return status;
}

// Of an angle about an axis (Rodrigues).
static void rotation_of(const double axis[3], double angle, double r[9]) {
  double c = cos(angle), s = sin(angle);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) r[3 * i + j] = (1 - c) * axis[i] * axis[j] + (i == j ? c : 0);
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    r[3 * i + j] -= s * axis[k], r[3 * j + i] += s * axis[k];
  }
}

static void draw(Random *random, const double centre[3], double shift, double turn, double *pose) {
  double axis[3];
  random_direction(random, axis);
  rotation_of(axis, turn * random_uniform(random), pose);
  for (int c = 0; c < 3; c++) {
    double moved = 0;
    for (int k = 0; k < 3; k++) moved += pose[3 * c + k] * centre[k];
    pose[9 + c] = centre[c] - moved + random_between(random, -shift, shift);
  }
}

Status app_poses_list_draw(AppPosesList *list, int count, uint64_t seed, const double centre[3], double shift,
                           double turn) {
  *list = (AppPosesList){.count = count, .poses = memory_zeroed((size_t)count * SIZE, sizeof(double))};
  if (!list->poses) return status_no_memory("the poses");
  for (int i = 0; i < count; i++) {
    Random random = random_seeded(seed, (uint64_t)i);
    draw(&random, centre, shift, turn, list->poses + (size_t)i * SIZE);
  }
  return STATUS_OK;
}

void app_poses_list_destroy(AppPosesList *list) {
  memory_free(list->poses);
  *list = (AppPosesList){0};
}
