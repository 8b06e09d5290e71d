/* SPDX-License-Identifier: Apache-2.0 */
/*
 * An overlap model of your own as a shared library: how much volume two tetrahedra share, and where it is.
 *
 *   #include <tetlap/model.h>
 *
 *   static int evaluate(void *self, const TetlapModelBatch *batch, char *message, size_t size) { ... }
 *
 *   const TetlapModel *tetlap_model(void) {
 *     static const TetlapModel model = {sizeof model, TETLAP_MODEL_ABI, "mine", TETLAP_MODEL_CENTROID, NULL, evaluate, NULL};
 *     return &model;
 *   }
 *
 *   cc -O2 -shared -fPIC mine.c -o mine.so;   tetlap run scene.yaml --overlap ./mine.so
 *
 * Pairs are rows of 24 numbers: the four vertices of one tetrahedron, then those of the other, in metres.
 * Either orientation means the same set of points. Arrays are contiguous, in double precision, and the
 * caller's: they end with the call, may not be kept, and hold exactly `count` rows. An array that is NULL is
 * not wanted; all that are not NULL are filled. A row written beyond an end ends the run.
 *
 * One thread calls at a time. The library may start threads of its own. What it prints goes where the
 * program's goes. It is part of the process that loads it, with what the licence of that program, the GPL,
 * means for it; docs/own_model.md says what runs beside it instead.
 */
#ifndef TETLAP_MODEL_H
#define TETLAP_MODEL_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Changes where a program of today could no longer call a library of yesterday. */
enum { TETLAP_MODEL_ABI = 1 };

/* What a model gives besides the volume; bits. */
enum {
  TETLAP_MODEL_GRADIENT = 1 << 0, /* dV/dx, the derivative of the same V */
  TETLAP_MODEL_CENTROID = 1 << 1, /* of the intersection */
  TETLAP_MODEL_LOGIT = 1 << 2,    /* of "the two intersect": > 0 yes */
  TETLAP_MODEL_DOUBT = 1 << 3,    /* how far V may be off */
  TETLAP_MODEL_DISJOINT = 1 << 4, /* not an array: V of pairs without common interior is 0 as it stands, so
                                     that the program needs no test of its own before it asks */
  TETLAP_MODEL_ORIGINS = 1 << 5,  /* not an array: it wants to be told where a scene's pairs are from */
  TETLAP_MODEL_CURVATURE = 1 << 6, /* not an array: `pull_back` takes `by_gradient` */
  TETLAP_MODEL_DOUBT_GRADIENT = 1 << 7, /* of the doubt, by the pairs */
};

typedef struct TetlapModelBatch {
  size_t size;         /* of this struct, as the program knows it: a field beyond is not there */
  size_t count;        /* of pairs, 1 or more */
  const double *pairs; /* [m]               (count, 2, 4, 3) */
  double *volume;      /* V [m^3], 0 or more (count) */
  double *gradient;    /* dV/dx [m^2]       (count, 2, 4, 3), or NULL */
  double *centroid;    /* [m]               (count, 3), or NULL; of a pair with V = 0 anything finite */
  double *logit;       /*                   (count), or NULL */
  double *doubt;       /* [m^3]             (count), or NULL */
  /* Of pairs in a scene, where TETLAP_MODEL_ORIGINS asks for them; else NULL. Where contact cuts an element,
   * several tetrahedra have its number, each with a volume of its own. */
  const int32_t *elements; /* numbers of the two, as frames count them (count, 2) */
  const int32_t *bodies;   /* in the order of the scene                (count, 2) */
  const double *rest;      /* the tetrahedra's volumes at rest [m^3]   (count, 2) */
  double *doubt_gradient;  /* [m^2] (count, 2, 4, 3), or NULL; of an infinite doubt anything */
} TetlapModelBatch;

/* Of a number g that follows V, the centroid c and dV/dx: its derivative by the pairs,
 *   by_volume dV/dx + by_centroid dc/dx + by_gradient d2V/dx2. */
typedef struct TetlapModelPull {
  size_t size;
  size_t count;
  const double *pairs;       /* (count, 2, 4, 3) */
  const double *by_volume;   /* dg/dV (count) */
  const double *by_centroid; /* dg/dc (count, 3), or NULL: 0 */
  const double *by_gradient; /* dg/d(dV/dx) (count, 2, 4, 3), or NULL: 0 */
  double *slope;             /* to be filled: dg/dx (count, 2, 4, 3) */
} TetlapModelPull;

typedef struct TetlapModel {
  size_t size;      /* sizeof(TetlapModel) */
  uint32_t abi;     /* TETLAP_MODEL_ABI */
  const char *name; /* for messages; as long as the library is loaded */
  uint32_t gives;   /* TETLAP_MODEL_... */
  /* NULL, or called once before all else: what it stores in *self is handed to the others. Not 0: it failed;
   * a reason may stand in `message` (size characters, ended by a 0). */
  int (*open)(void **self, char *message, size_t size);
  /* Not 0: it failed, and the run ends with that message. */
  int (*evaluate)(void *self, const TetlapModelBatch *batch, char *message, size_t size);
  void (*close)(void *self); /* or NULL */
  /* Or NULL. dV/dx is taken from it where the model has no array of it. Like `evaluate`. A struct whose `size`
   * ends before it, as an older header has it, is as good as one with NULL; likewise below. */
  int (*pull_back)(void *self, const TetlapModelPull *pull, char *message, size_t size);
  /* NULL, or the pairs that it was made for, as long as the library is loaded; in metres:
   *   "radius 0.1 to 2, first volume 0.01 to 1, second volume 0.01 to 1, overlap to 0.3"
   * The radius is the root mean square distance of the eight vertices from the first one's centroid. */
  const char *range;
} TetlapModel;

/* The one function that a library exports. Never NULL; the struct lasts as long as the library is loaded. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const TetlapModel *tetlap_model(void);

#ifdef __cplusplus
}
#endif

#endif
