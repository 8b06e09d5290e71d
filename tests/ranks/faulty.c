// SPDX-License-Identifier: GPL-3.0-or-later
// tetlap-mpi in which one call on one rank fails: FAULT_RANK, FAULT_CALL (the k-th) of FAULT_KIND: `retry`
// (an effect asks for a smaller step), `memory` (an allocation after the first step fails, and all after it),
// `disk` (a file cannot be put into its place).
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fem/effect/system.h"

static long calls;

static bool is_here(const char *kind) {
  const char *wanted = getenv("FAULT_KIND"), *rank = getenv("FAULT_RANK");
  return wanted && rank && strcmp(wanted, kind) == 0 &&
         atoi(rank) == atoi(getenv("OMPI_COMM_WORLD_RANK") ? getenv("OMPI_COMM_WORLD_RANK") : "0");
}

static bool is_due(const char *kind) {
  return is_here(kind) && ++calls == atol(getenv("FAULT_CALL"));
}

// An effect without forces, which asks for a smaller step.
static bool is_wanted(const FemSceneDef *scene) {
  return scene->body_count > 0;
}

static Status create(void **self, const FemModel *model) {
  (void)model;
  *self = &calls;
  return STATUS_OK;
}

static Status add_force(void *self, const FemState *state, double *force) {
  (void)self, (void)state, (void)force;
  return is_due("retry") ? status_fail(STATUS_RETRY, "a test asks for a smaller step") : STATUS_OK;
}

static void destroy(void *self) {
  (void)self;
}

static const FemEffectOps fault = {.name = "fault",
                                   .is_divided = true,
                                   .is_wanted = is_wanted,
                                   .create = create,
                                   .add_force = add_force,
                                   .destroy = destroy};

const FemEffectOps *const *__real_fem_effect_list(int *count);
const FemEffectOps *const *__wrap_fem_effect_list(int *count);

const FemEffectOps *const *__wrap_fem_effect_list(int *count) {
  static const FemEffectOps *list[FEM_MAX_EFFECTS];
  const FemEffectOps *const *real = __real_fem_effect_list(count);
  for (int i = 0; i < *count; i++) list[i] = real[i];
  list[(*count)++] = &fault;
  return list;
}

void *__real_memory_zeroed(size_t count, size_t size);
void *__wrap_memory_zeroed(size_t count, size_t size);

void *__wrap_memory_zeroed(size_t count, size_t size) {
  if (is_here("memory") && ++calls >= atol(getenv("FAULT_CALL"))) return NULL;
  return __real_memory_zeroed(count, size);
}

int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);

int __wrap_rename(const char *from, const char *to) {
  if (is_due("disk")) {
    errno = ENOSPC;
    return -1;
  }
  return __real_rename(from, to);
}
