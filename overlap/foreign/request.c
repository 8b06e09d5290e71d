// SPDX-License-Identifier: Apache-2.0
#include "overlap/foreign/request.h"

#include <stdbool.h>
#include <string.h>

#include "base/memory.h"

enum { ARRAYS = OVERLAP_FOREIGN_ARRAYS };

static const struct {
  const char *name;
  size_t width; // numbers a pair
} shapes[ARRAYS] = {
    [OVERLAP_FOREIGN_PAIRS] = {"pairs", 24},
    [OVERLAP_FOREIGN_VOLUME] = {"volume", 1},
    [OVERLAP_FOREIGN_GRADIENT] = {"gradient", 24},
    [OVERLAP_FOREIGN_CENTROID] = {"centroid", 3},
    [OVERLAP_FOREIGN_LOGIT] = {"logit", 1},
    [OVERLAP_FOREIGN_DOUBT] = {"doubt", 1},
    [OVERLAP_FOREIGN_DOUBT_GRADIENT] = {"doubt_gradient", 24},
    [OVERLAP_FOREIGN_REST] = {"rest", 2},
    [OVERLAP_FOREIGN_BY_VOLUME] = {"by_volume", 1},
    [OVERLAP_FOREIGN_BY_CENTROID] = {"by_centroid", 3},
    [OVERLAP_FOREIGN_BY_GRADIENT] = {"by_gradient", 24},
    [OVERLAP_FOREIGN_SLOPE] = {"slope", 24},
};

// Numbers behind each array: a row of the widest.
enum { FENCE = 24 };
static const unsigned char FENCE_BYTE = 0xA5;

// What a model fills.
static const unsigned OUTPUTS = 1u << OVERLAP_FOREIGN_VOLUME | 1u << OVERLAP_FOREIGN_GRADIENT |
                                1u << OVERLAP_FOREIGN_CENTROID | 1u << OVERLAP_FOREIGN_LOGIT |
                                1u << OVERLAP_FOREIGN_DOUBT | 1u << OVERLAP_FOREIGN_DOUBT_GRADIENT |
                                1u << OVERLAP_FOREIGN_SLOPE;

void overlap_foreign_request_destroy(OverlapForeignRequest *request) {
  for (int a = 0; a < ARRAYS; a++) memory_free(request->arrays[a]);
  memory_free(request->elements), memory_free(request->bodies);
  *request = (OverlapForeignRequest){0};
}

Status overlap_foreign_request_reserve(OverlapForeignRequest *request, size_t count, unsigned wanted) {
  bool fits = true;
  for (int a = 0; a < ARRAYS && fits; a++)
    if (wanted & 1u << a)
      fits = memory_reserve((void **)&request->arrays[a], &request->capacities[a],
                            count * shapes[a].width + FENCE, sizeof(double));
  if (wanted & 1u << OVERLAP_FOREIGN_REST)
    fits =
        fits &&
        memory_reserve((void **)&request->elements, &request->element_capacity, 2 * count, sizeof(int32_t)) &&
        memory_reserve((void **)&request->bodies, &request->body_capacity, 2 * count, sizeof(int32_t));
  return fits ? STATUS_OK : status_no_memory("pairs for a model");
}

static unsigned char *fence_of(const OverlapForeignRequest *request, int array) {
  return (unsigned char *)(request->arrays[array] + request->count * shapes[array].width);
}

// The arrays that are wanted, those that the model fills without an answer, each with its fence; others NULL.
static void prepare(const OverlapForeignRequest *request, unsigned wanted, double *arrays[ARRAYS]) {
  for (int a = 0; a < ARRAYS; a++) {
    arrays[a] = wanted & 1u << a ? request->arrays[a] : NULL;
    if (!arrays[a]) continue;
    if (OUTPUTS & 1u << a) memset(arrays[a], 0xFF, request->count * shapes[a].width * sizeof(double));
    memset(fence_of(request, a), FENCE_BYTE, FENCE * sizeof(double));
  }
}

// What else was overwritten, where a fence is not whole, nobody knows.
static Status check_fences(const OverlapForeignRequest *request, unsigned wanted, const char *name) {
  for (int a = 0; a < ARRAYS; a++) {
    const unsigned char *fence = wanted & 1u << a ? fence_of(request, a) : NULL;
    // All bytes are as the one before, and the first as it should be.
    if (fence && (fence[0] != FENCE_BYTE || memcmp(fence, fence + 1, FENCE * sizeof(double) - 1) != 0))
      return status_fail(
          STATUS_SOLVER,
          "overlap model '%s' wrote beyond the end of `%s`, which has %zu rows of %zu: it must "
          "write `count` rows of each array and no more",
          name, shapes[a].name, request->count, shapes[a].width);
  }
  return STATUS_OK;
}

static Status pull(OverlapForeignRequest *request, const OverlapForeignPort *port, const char *name,
                   unsigned wanted, int into) {
  double *arrays[ARRAYS];
  wanted |= 1u << OVERLAP_FOREIGN_PAIRS | 1u << OVERLAP_FOREIGN_BY_VOLUME | 1u << into;
  prepare(request, wanted, arrays);
  TetlapModelPull it = {.size = sizeof it,
                        .count = request->count,
                        .pairs = request->pairs,
                        .by_volume = arrays[OVERLAP_FOREIGN_BY_VOLUME],
                        .by_centroid = arrays[OVERLAP_FOREIGN_BY_CENTROID],
                        .by_gradient = arrays[OVERLAP_FOREIGN_BY_GRADIENT],
                        .slope = arrays[into]};
  TRY(port->pull(port->self, &it));
  return check_fences(request, wanted, name);
}

Status overlap_foreign_request_pull(OverlapForeignRequest *request, const OverlapForeignPort *port,
                                    const char *name, unsigned wanted) {
  return pull(request, port, name, wanted, OVERLAP_FOREIGN_SLOPE);
}

static Status pull_gradient(OverlapForeignRequest *request, const OverlapForeignPort *port,
                            const char *name) {
  TRY(overlap_foreign_request_reserve(request, request->count, 1u << OVERLAP_FOREIGN_BY_VOLUME));
  for (size_t i = 0; i < request->count; i++) request->arrays[OVERLAP_FOREIGN_BY_VOLUME][i] = 1;
  return pull(request, port, name, 0, OVERLAP_FOREIGN_GRADIENT);
}

Status overlap_foreign_request_ask(OverlapForeignRequest *request, const OverlapForeignPort *port,
                                   const char *name, unsigned wanted) {
  double *arrays[ARRAYS];
  const bool pulls =
      wanted & 1u << OVERLAP_FOREIGN_GRADIENT && !(port->gives & TETLAP_MODEL_GRADIENT) && port->pull;
  if (pulls) wanted &= ~(1u << OVERLAP_FOREIGN_GRADIENT);
  const bool tells = wanted & 1u << OVERLAP_FOREIGN_REST;
  prepare(request, wanted, arrays);
  TetlapModelBatch it = {.size = sizeof it,
                         .count = request->count,
                         .pairs = request->pairs,
                         .volume = arrays[OVERLAP_FOREIGN_VOLUME],
                         .gradient = arrays[OVERLAP_FOREIGN_GRADIENT],
                         .centroid = arrays[OVERLAP_FOREIGN_CENTROID],
                         .logit = arrays[OVERLAP_FOREIGN_LOGIT],
                         .doubt = arrays[OVERLAP_FOREIGN_DOUBT],
                         .elements = tells ? request->elements : NULL,
                         .bodies = tells ? request->bodies : NULL,
                         .rest = arrays[OVERLAP_FOREIGN_REST],
                         .doubt_gradient = arrays[OVERLAP_FOREIGN_DOUBT_GRADIENT]};
  TRY(port->ask(port->self, &it));
  TRY(check_fences(request, wanted, name));
  return pulls ? pull_gradient(request, port, name) : STATUS_OK;
}
