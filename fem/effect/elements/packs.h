// SPDX-License-Identifier: GPL-3.0-or-later
// The linear or the quadratic elements of a model in packs for vector lanes (fem/lanes/lanes.h). What is near
// in space is near in memory: they follow a Morton curve, in chunks of some packs of one part of a body.
// Chunks are coloured: those of a colour share no vertex and may be added at the same time. Within a chunk
// elements are added one after another, so every sum has a fixed order.
#ifndef TETLAP_FEM_EFFECT_ELEMENTS_PACKS_H
#define TETLAP_FEM_EFFECT_ELEMENTS_PACKS_H

#include <stdbool.h>
#include <stddef.h>

#include "fem/lanes/lanes.h"
#include "fem/model/model.h"
#include "fem/sparse/matrix.h"

typedef struct FemPacks {
  bool is_quadratic;
  int element_count, pack_count, chunk_count, colour_count;
  FemLanesElements *packs;        // of linear ones                            (pack_count)
  FemLanesQuadratics *quadratics; // of quadratic ones                         (pack_count)
  // Places in the matrix, of one kind or the other; NULL: not looked up            (pack_count)
  int (*slots)[FEM_LANES_SLOTS][FEM_LANES];
  int (*half_slots)[FEM_LANES_HALF][FEM_LANES];
  long long layout;  // of the matrix that they are of; 0: not looked up
  int *chunk_begin;  // of each chunk in the packs            (chunk_count + 1)
  int *chunk_part;   //                                       (chunk_count)
  int *colour_begin; // of each colour among the chunks       (colour_count + 1)
} FemPacks;

// All elements of one kind of bodies, which obstacles are not, that this rank has and `takes` accepts (NULL:
// all). A zeroed one, and one whose creation failed, can be destroyed.
Status fem_packs_create(FemPacks *packs, const FemModel *model, bool is_quadratic,
                        bool (*takes)(const FemModelPart *part));
void fem_packs_destroy(FemPacks *packs);
size_t fem_packs_bytes(const FemPacks *packs); // on the heap

// Looks up where the elements' entries lie, if the matrix has been laid out anew; allocates the first time.
Status fem_packs_find_slots(FemPacks *packs, const FemMatrix *matrix);

#endif
