// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/vtu_copy.h"

#include <string.h>

#include "base/memory.h"

enum { FILLED_AT_ONCE = 512 }; // tuples

static size_t tuples_of(const FemVtuFrame *frame, const FemVtuArray *array) {
  return (size_t)(array->is_cell ? frame->cell_count : frame->vertex_count);
}

// Numbers of all arrays and of the positions.
static void count(const FemVtuFrame *frame, size_t *reals, size_t *integers) {
  *reals = 3 * (size_t)frame->vertex_count, *integers = 0;
  for (int k = 0; k < frame->array_count; k++) {
    const FemVtuArray *array = &frame->arrays[k];
    *(array->integers ? integers : reals) += tuples_of(frame, array) * (size_t)array->components;
  }
}

size_t fem_vtu_copy_bytes(const FemVtuFrame *frame) {
  size_t reals, integers;
  count(frame, &reals, &integers);
  return reals * sizeof(double) + integers * sizeof(int);
}

static Status reserve(FemVtuCopy *copy, const FemVtuFrame *frame) {
  size_t reals, integers;
  count(frame, &reals, &integers);
  bool fits =
      memory_reserve((void **)&copy->reals, &copy->real_capacity, reals, sizeof *copy->reals) &&
      memory_reserve((void **)&copy->integers, &copy->integer_capacity, integers, sizeof *copy->integers) &&
      memory_reserve((void **)&copy->arrays, &copy->array_capacity, (size_t)frame->array_count,
                     sizeof *copy->arrays);
  return fits ? STATUS_OK : status_no_memory("the copy of a frame");
}

static void take_reals(const FemVtuArray *array, size_t tuples, double *to) {
  const size_t components = (size_t)array->components;
  if (array->reals) {
    memcpy(to, array->reals, tuples * components * sizeof *to);
    return;
  }
#pragma omp parallel for schedule(static) if (tuples > FILLED_AT_ONCE)
  for (size_t first = 0; first < tuples; first += FILLED_AT_ONCE) {
    size_t left = tuples - first;
    array->fill(array->self, first, left < FILLED_AT_ONCE ? left : FILLED_AT_ONCE, to + components * first);
  }
}

Status fem_vtu_copy_take(FemVtuCopy *copy, const FemVtuFrame *frame) {
  TRY(reserve(copy, frame));
  double *reals = copy->reals;
  int *integers = copy->integers;
  copy->frame = *frame;
  copy->frame.arrays = copy->arrays;
  copy->frame.positions = reals;
  memcpy(reals, frame->positions, 3 * (size_t)frame->vertex_count * sizeof *reals);
  reals += 3 * (size_t)frame->vertex_count;
  if (frame->history_time) copy->history_time = *frame->history_time;
  if (frame->history_time) copy->frame.history_time = &copy->history_time;
  for (int k = 0; k < frame->array_count; k++) {
    const FemVtuArray *array = &frame->arrays[k];
    const size_t tuples = tuples_of(frame, array), numbers = tuples * (size_t)array->components;
    FemVtuArray *own = &copy->arrays[k];
    *own = (FemVtuArray){.name = array->name, .is_cell = array->is_cell, .components = array->components};
    if (array->integers) {
      memcpy(integers, array->integers, numbers * sizeof *integers);
      own->integers = integers, integers += numbers;
    } else {
      take_reals(array, tuples, reals);
      own->reals = reals, reals += numbers;
    }
  }
  return STATUS_OK;
}

void fem_vtu_copy_destroy(FemVtuCopy *copy) {
  memory_free(copy->arrays);
  memory_free(copy->reals);
  memory_free(copy->integers);
  *copy = (FemVtuCopy){0};
}
