/* SPDX-License-Identifier: Apache-2.0 */
/*
 * libtetlap-overlap: how much volume two tetrahedra share, how that changes with their vertices, and where it
 * is.
 *
 *   pairs (n, 2, 4, 3) --> model --> V (n), dV/dx (n, 2, 4, 3), d2V/dx2 (n, 24, 24), centroid (n, 3), flags
 * (n) two meshes         --> model --> a list of (i, j, V, ...) of the tetrahedra that overlap
 *
 *   TetlapOverlap *overlap;
 *   TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
 *   batch.count = n, batch.pairs = pairs, batch.volume = volume, batch.gradient = gradient;
 *   if (tetlap_overlap_open(&overlap, "clip") || tetlap_overlap_eval(overlap, &batch))
 *     fprintf(stderr, "%s\n", tetlap_overlap_message());
 *   tetlap_overlap_close(overlap);
 *
 * Arrays are contiguous, row after row, in double precision, and the caller's unless said otherwise. Units:
 * any length [m]; V is in its cube, dV/dx in its square, d2V/dx2 in itself. A pair is tetrahedron 1's four
 * vertices, then tetrahedron 2's; either orientation is accepted and means the same set of points.
 *
 * Accuracy, of `clip`, with L the longest distance in a pair and v the smaller of its two tetrahedra:
 *
 *   |error of V|         <= 1e-9 V, or 1e-12 v where V is below 1e-6 v
 *   |error of V x|       <= L times that, x the centroid; of ordinary shapes with V > 1e-4 v: x within 1e-12
 * L sum of dV/dx         = 0, and sum of x cross dV/dx, to 1e-14 L^2 and L^3
 *
 * `exact` has V within 1 ulp. `clip32`: V within 1e-3 V, or 1e-4 v where V is below v/10. Learned models
 * (`geo`, `geo-small`, `tpn`, ...) have V, and the centroid where they predict one, within a few tenths of a
 * per cent of ordinary pairs: docs/models.md.
 *
 * Errors are a status and a message: nothing is printed, no process ended. Functions that fail leave what
 * they were given as it was, but for outputs, which are then undefined. Thread safety: a handle may be used
 * by several threads at once; closing it may not overlap with its use. Messages belong to the thread.
 *
 * Compatibility: structs carry their size, set by the ..._INIT macros. A later library takes the structs of
 * an earlier header; an earlier library refuses what it does not know, by a message, instead of ignoring it.
 */
#ifndef TETLAP_OVERLAP_H
#define TETLAP_OVERLAP_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define TETLAP_OVERLAP_API __attribute__((visibility("default")))
#else
#define TETLAP_OVERLAP_API
#endif

/* ---- Errors */

enum {
  TETLAP_OVERLAP_OK = 0,
  TETLAP_OVERLAP_INVALID = 1,  /* an argument is wrong: a name, a shape, a coordinate that is not finite */
  TETLAP_OVERLAP_NO_FILE = 2,  /* a weights file could not be read */
  TETLAP_OVERLAP_MEMORY = 3,   /* no memory */
  TETLAP_OVERLAP_INTERNAL = 4, /* the model gave up on a pair */
  TETLAP_OVERLAP_DEVICE = 5,   /* an accelerator is not there, or failed */
};

/* What went wrong in this thread's last call that failed, in English; "" if none did. Until its next failure.
 */
TETLAP_OVERLAP_API const char *tetlap_overlap_message(void);

/* The library's version, "MAJOR.MINOR.PATCH". */
TETLAP_OVERLAP_API const char *tetlap_overlap_version(void);

/* ---- Models */

/* What a model gives, and what is asked of meshes; bits. */
enum {
  TETLAP_OVERLAP_VOLUME = 1 << 0,
  TETLAP_OVERLAP_GRADIENT = 1 << 1,
  TETLAP_OVERLAP_HESSIAN = 1 << 2,
  TETLAP_OVERLAP_CENTROID = 1 << 3,
};

/* The models' names, from 0 on, the fastest first; NULL: no more. */
TETLAP_OVERLAP_API const char *tetlap_overlap_model(int index);

typedef struct TetlapOverlapOptions {
  size_t size;         /* sizeof(TetlapOverlapOptions) */
  const char *model;   /* a name, or the path of a weights file (....safetensors) */
  const char *weights; /* of a learned model: a file, or the name of one that ships; NULL: its own */
  int threads;         /* how many evaluate a batch; 0: as many as OpenMP would use */
} TetlapOverlapOptions;
#define TETLAP_OVERLAP_OPTIONS_INIT                                                                          \
  { sizeof(TetlapOverlapOptions), NULL, NULL, 0 }

typedef struct TetlapOverlap TetlapOverlap;

/* Makes a model; close it with tetlap_overlap_close. On failure *overlap is NULL. */
TETLAP_OVERLAP_API int tetlap_overlap_open(TetlapOverlap **overlap, const char *model);
TETLAP_OVERLAP_API int tetlap_overlap_open_with(TetlapOverlap **overlap, const TetlapOverlapOptions *options);

/* NULL is fine. */
TETLAP_OVERLAP_API void tetlap_overlap_close(TetlapOverlap *overlap);

typedef struct TetlapOverlapInfo {
  size_t size;             /* sizeof(TetlapOverlapInfo), set before the call */
  const char *name;        /* valid as long as the handle, as the next */
  const char *description; /* one line */
  unsigned gives;          /* TETLAP_OVERLAP_VOLUME | ... */
  int threads;             /* how many evaluate a batch */
  double seconds_per_pair; /* rough cost of V and dV/dx on one core [s] */
} TetlapOverlapInfo;
#define TETLAP_OVERLAP_INFO_INIT                                                                             \
  { sizeof(TetlapOverlapInfo), NULL, NULL, 0, 0, 0 }

TETLAP_OVERLAP_API int tetlap_overlap_info(const TetlapOverlap *overlap, TetlapOverlapInfo *info);

/* ---- Pairs */

/* What is said of a pair besides its numbers; bits. */
enum {
  TETLAP_OVERLAP_DISJOINT = 1 << 0, /* no common interior: all outputs are exactly 0 */
  TETLAP_OVERLAP_FLAT = 1 << 1,     /* a tetrahedron has no volume: all outputs are exactly 0 */
  TETLAP_OVERLAP_FALLBACK = 1 << 2, /* answered by a more careful model than the one asked */
  TETLAP_OVERLAP_ENCLOSED = 1 << 3, /* one tetrahedron lies wholly inside the other */
  TETLAP_OVERLAP_BLENDED = 1 << 4,  /* answered partly by a more careful model */
  TETLAP_OVERLAP_NET = 1 << 5,      /* a TetrahedronPairNet's volume is part of the answer */
  TETLAP_OVERLAP_BEYOND = 1 << 6,   /* the pair is unlike those that the network was trained on */
};

typedef struct TetlapOverlapBatch {
  size_t size;             /* sizeof(TetlapOverlapBatch) */
  size_t count;            /* pairs, at most INT_MAX; 0 is fine */
  const double *pairs;     /* vertices                                (count, 2, 4, 3) */
  double *volume;          /* out: V                                  (count) */
  double *gradient;        /* out, or NULL: dV/dx                     (count, 2, 4, 3) */
  double *hessian;         /* out, or NULL: d2V/dx2, symmetric        (count, 24, 24) */
  double *centroid;        /* out, or NULL: of the intersection; (0, 0, 0) where V is 0    (count, 3) */
  const double *direction; /* u, or NULL                              (count, 2, 4, 3) */
  double *product;         /* out, or NULL: d2V/dx2 times u, which it needs   (count, 2, 4, 3) */
  unsigned *flags;         /* out, or NULL                            (count) */
} TetlapOverlapBatch;
#define TETLAP_OVERLAP_BATCH_INIT                                                                            \
  { sizeof(TetlapOverlapBatch), 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL }

/* INVALID: a coordinate is NaN or infinite (the message names pair, vertex and coordinate), or something is
   asked that the model does not give (it names the model). */
TETLAP_OVERLAP_API int tetlap_overlap_eval(const TetlapOverlap *overlap, const TetlapOverlapBatch *batch);

/* ---- Meshes */

typedef struct TetlapOverlapMesh {
  size_t size; /* sizeof(TetlapOverlapMesh) */
  size_t point_count;
  const double *points; /* (point_count, 3) */
  size_t tet_count;     /* at most INT_MAX */
  const int32_t *tets;  /* numbers of points, from 0      (tet_count, 4) */
} TetlapOverlapMesh;
#define TETLAP_OVERLAP_MESH_INIT                                                                             \
  { sizeof(TetlapOverlapMesh), 0, NULL, 0, NULL }

/* The tetrahedra of two meshes with V > 0, sorted by `first`, then by `second`. The library's. */
typedef struct TetlapOverlapList {
  size_t size;       /* what the library knows of this struct */
  size_t count;      /* entries */
  int32_t *first;    /* tetrahedron of the first mesh          (count) */
  int32_t *second;   /* tetrahedron of the second              (count) */
  double *volume;    /* V                                      (count) */
  double *gradient;  /* dV/dx, or NULL                         (count, 2, 4, 3) */
  double *centroid;  /* or NULL                                (count, 3) */
  unsigned *flags;   /*                                        (count) */
  size_t candidates; /* pairs that the model was asked about: those whose boxes overlap */
} TetlapOverlapList;

/* Which tetrahedra of two meshes overlap, and by how much: what conservative remapping needs. `wanted`:
   VOLUME, or with it GRADIENT, CENTROID. The meshes need not be conforming, nor fill the same domain.
   INVALID: a tetrahedron names a point that is not there, a coordinate is not finite; the message says which.
   On failure *list is NULL. */
TETLAP_OVERLAP_API int tetlap_overlap_meshes(const TetlapOverlap *overlap, const TetlapOverlapMesh *a,
                                             const TetlapOverlapMesh *b, unsigned wanted,
                                             TetlapOverlapList **list);

/* NULL is fine. */
TETLAP_OVERLAP_API void tetlap_overlap_list_free(TetlapOverlapList *list);

/* ---- Poses */

/* Rigid poses x' = R x + t of one mesh. Of each
 *
 *   V = sum of V_ij,   f = -dV/dt,   m = -dV/d(omega), omega a turn about the moved centre R c + t,
 *
 * a force and a moment for a pressure of 1 Pa. All sums have one order, so that the processor and every
 * accelerator give the same bits, with any number of threads. */
typedef struct TetlapOverlapPoses {
  size_t size;         /* sizeof(TetlapOverlapPoses) */
  size_t count;        /* poses, at most INT_MAX; 0 is fine */
  const double *poses; /* R row by row, then t                         (count, 12) */
  double *sums;        /* out: V, f, m                                 (count, 7) */
  double centre[3];    /* c, in the moved mesh as it is given */
  const char *device;  /* NULL: this processor's vectors; "auto": the first GPU; "cuda", "opencl", "host" */
} TetlapOverlapPoses;
#define TETLAP_OVERLAP_POSES_INIT                                                                            \
  { sizeof(TetlapOverlapPoses), 0, NULL, NULL, {0, 0, 0}, NULL }

/* Meshes stay on the device for a call: pass many poses in one. The handle must be of `clip`. DEVICE: the
   device is not there or failed; the message quotes its driver. INVALID: as for meshes, or a pose is not
   finite. */
TETLAP_OVERLAP_API int tetlap_overlap_poses(const TetlapOverlap *overlap, const TetlapOverlapMesh *moved,
                                            const TetlapOverlapMesh *others, const TetlapOverlapPoses *poses);

#ifdef __cplusplus
}
#endif

#endif
