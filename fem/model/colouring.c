// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/colouring.h"

#include <stdint.h>

#include "base/memory.h"

// A vertex has rarely more than 60 tetrahedra; four of them conflict with fewer than 256 others.
enum { COLOURING_WORDS = 8, COLOURING_MAX = 64 * COLOURING_WORDS };

typedef struct ColourSet {
  uint64_t words[COLOURING_WORDS];
} ColourSet;

static int smallest_free(const ColourSet *used, const int tet[4]) {
  for (int w = 0; w < COLOURING_WORDS; w++) {
    uint64_t taken = 0;
    for (int k = 0; k < 4; k++) taken |= used[tet[k]].words[w];
    if (~taken) return 64 * w + __builtin_ctzll(~taken);
  }
  return -1;
}

// Gives each tetrahedron its colour; −1 in *colour_count: a vertex has too many tetrahedra.
static void choose_colours(ColourSet *used, const int (*tets)[4], int tet_count, int *colour_of,
                           int *colour_count) {
  *colour_count = 0;
  for (int e = 0; e < tet_count; e++) {
    int colour = smallest_free(used, tets[e]);
    colour_of[e] = colour;
    if (colour < 0) {
      *colour_count = -1;
      return;
    }
    for (int k = 0; k < 4; k++) used[tets[e][k]].words[colour / 64] |= UINT64_C(1) << (colour % 64);
    if (colour >= *colour_count) *colour_count = colour + 1;
  }
}

// Counting sort of the tetrahedra by colour.
static Status group(FemColouring *colouring, const int *colour_of, int tet_count) {
  int count = colouring->colour_count;
  colouring->begin = memory_zeroed((size_t)count + 2, sizeof *colouring->begin);
  colouring->tets = memory_zeroed((size_t)tet_count, sizeof *colouring->tets);
  if (!colouring->begin || !colouring->tets) return status_no_memory("the colouring of the mesh");
  int *next = colouring->begin + 1;
  for (int e = 0; e < tet_count; e++) next[colour_of[e] + 1]++;
  for (int c = 0; c < count; c++) next[c + 1] += next[c];
  for (int e = 0; e < tet_count; e++) colouring->tets[next[colour_of[e]]++] = e;
  return STATUS_OK;
}

Status fem_colouring_create(FemColouring *colouring, int vertex_count, const int (*tets)[4], int tet_count) {
  *colouring = (FemColouring){0};
  ColourSet *used = memory_zeroed((size_t)vertex_count, sizeof *used);
  int *colour_of = memory_zeroed((size_t)tet_count, sizeof *colour_of);
  Status status = used && colour_of ? STATUS_OK : status_no_memory("the colouring of the mesh");
  if (!status) {
    choose_colours(used, tets, tet_count, colour_of, &colouring->colour_count);
    if (colouring->colour_count < 0)
      status =
          status_fail(STATUS_INPUT, "a vertex has more than %d tetrahedra; remesh it", COLOURING_MAX / 4);
  }
  if (!status) status = group(colouring, colour_of, tet_count);
  memory_free(used);
  memory_free(colour_of);
  if (status) fem_colouring_destroy(colouring);
  return status;
}

void fem_colouring_destroy(FemColouring *colouring) {
  memory_free(colouring->begin);
  memory_free(colouring->tets);
  *colouring = (FemColouring){0};
}
