// SPDX-License-Identifier: Apache-2.0
// What an overlap model is: for pairs of tetrahedra the volume V of their intersection, its derivatives by
// the 24 coordinates, and its centroid. One interface, many answers; each gradient is the derivative of the
// same model's V.
//
//   pairs (n, 2, 4, 3) ──► model ──► V (n), ∇V (n, 2, 4, 3), ∇²V (n, 24, 24), x̄ (n, 3), flags (n)
//
// Either orientation of a tetrahedron is accepted and means the same set of points. With exact arithmetic
// Σ ∇V = 0, Σ x × ∇V = 0, Σ x·∇V = 3V, and the sum of ∇V over one tetrahedron's vertices is minus the
// integral of the other's outward normal over its part of the boundary: contact normal times area.
//
// V x̄ is the integral of x over the intersection; of a model that has no x̄ of its own it follows from V and
// ∇V (overlap/pair/centroid.h). Where V is 0, x̄ is written as (0, 0, 0): a number that any weight V makes
// vanish.
#ifndef TETLAP_OVERLAP_OPS_H
#define TETLAP_OVERLAP_OPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "overlap/options.h"

enum { OVERLAP_PAIR_SIZE = 24 }; // coordinates of a pair: 2 tetrahedra × 4 vertices × 3

// What a model says of one pair besides its numbers; bits.
typedef enum OverlapFlag {
  OVERLAP_DISJOINT = 1 << 0, // no common interior: V, ∇V, ∇²V, x̄ are exactly 0
  OVERLAP_FLAT = 1 << 1,     // a tetrahedron has no volume: V, ∇V, ∇²V, x̄ are exactly 0
  OVERLAP_FALLBACK = 1 << 2, // answered by a more careful model than the one asked
  OVERLAP_ENCLOSED = 1 << 3, // one tetrahedron lies wholly inside the other: ∇V pushes nothing apart
  OVERLAP_BLENDED = 1 << 4,  // answered partly by a more careful model
  OVERLAP_NET = 1 << 5,      // a TetrahedronPairNet's volume is part of the answer
  OVERLAP_BEYOND = 1 << 6,   // the pair is unlike those that the model was made for
  OVERLAP_UNSOUND = 1 << 7,  // V was negative or not finite, and is 0, or is above the smaller tetrahedron
} OverlapFlag;

// Where the pairs of a scene are from; all NULL: not known.
typedef struct OverlapOrigins {
  const int32_t *elements; // as frames number them                (pair_count, 2)
  const int32_t *bodies;   // in the order of the scene            (pair_count, 2)
  const double *rest;      // the tetrahedra's volumes at rest [m³] (pair_count, 2)
} OverlapOrigins;

// A batch of pairs; all arrays are the caller's.
typedef struct OverlapBatch {
  int pair_count;
  const double *pairs;    // vertices [m]                     (pair_count, 2, 4, 3)
  double *volume;         // out: V [m³]                      (pair_count)
  double *gradient;       // out, or NULL: dV/dx [m²]         (pair_count, 2, 4, 3)
  double *hessian;        // out, or NULL: d²V/dx² [m]        (pair_count, 24, 24), symmetric
  unsigned *flags;        // out, or NULL: OverlapFlag (pair_count)
  double *centroid;       // out, or NULL: x̄ of the intersection [m] (pair_count, 3)
  double *doubt;          // out, or NULL: how far V may be off [m³]  (pair_count); where it gives_doubt
  double *doubt_gradient; // out, or NULL: its derivative (pair_count, 2, 4, 3); where it gives_doubt_gradient
  OverlapOrigins origins; // for models that want them
  const int *numbers;     // what messages call the pairs            (pair_count); NULL: their places
} OverlapBatch;

// Derivatives backwards: of a number g that follows V, x̄ and ∇V, by the coordinates of the pairs.
typedef struct OverlapPull {
  int pair_count;
  const double *pairs;       // [m]                      (pair_count, 2, 4, 3)
  const double *by_volume;   // ∂g/∂V                    (pair_count)
  const double *by_centroid; // ∂g/∂x̄, or NULL: 0        (pair_count, 3)
  const double *by_gradient; // ∂g/∂(∇V), or NULL: 0     (pair_count, 2, 4, 3)
  double *slope;             // out: ∂g/∂x               (pair_count, 2, 4, 3)
  const int *numbers;        // what messages call the pairs (pair_count); NULL: their places
} OverlapPull;

// Where the answer for one pair goes.
typedef struct OverlapAnswer {
  double *volume;   // V [m³]
  double *gradient; // or NULL: dV/dx [m²]       (2, 4, 3)
  double *hessian;  // or NULL: d²V/dx² [m]      (24, 24)
  double *centroid; // or NULL: x̄ [m]            (3)
  unsigned *flags;  // OverlapFlag
} OverlapAnswer;

// Derivatives by the parameters w of a model's network.
typedef struct OverlapTraining {
  size_t (*count)(const void *self); // of the parameters
  void (*read)(const void *self, double *parameters);
  // Adds ∂g/∂w (count), given ∂g/∂V and ∂g/∂x̄ of pairs: `by` (pair_count, 4).
  Status (*pull)(const void *self, int pair_count, const double *pairs, const double *by, double *slope);
  // Numbers (count) as a weights file of the same shape.
  Status (*write)(const void *self, const double *numbers, const char *path);
} OverlapTraining;

// What a model implements. One per model, `static const`, listed in models.c.
typedef struct OverlapOps {
  const char *name;
  const char *help;        // one line for lists and the manual
  double seconds_per_pair; // rough cost of V + ∇V on one core, to announce how long a run will take [s]
  // Allocates what the model keeps; NULL where it keeps nothing. `weights`: the path of a weights file, or
  // the name of one that ships; NULL: the model's own. `options`, NULL: the model's own, matter to some.
  Status (*create)(void **self, const char *weights, const OverlapOptions *options);
  // Evaluates one pair; must be safe to call from several threads. All outputs that are wanted are written;
  // none that the model has not are. The coordinates are finite. RETRY is not used; fatal: message names the
  // reason only.
  Status (*eval_pair)(const void *self, const double pair[24], const OverlapAnswer *answer);
  // Evaluates a batch at once; NULL: eval_pair over OpenMP threads, of pairs that no face separates for
  // certain. The others are DISJOINT unasked, unless the model sees ghosts or `rejects_disjoint` itself.
  Status (*eval_batch)(const void *self, const OverlapBatch *batch);
  void (*destroy)(void *self);
  // Whether pairs that share no volume may get one, and want to be asked for; NULL: never.
  bool (*has_ghosts)(const void *self);
  // Begins each pair by asking whether a face separates the two.
  bool rejects_disjoint;
  // Logits of "the two intersect" of pairs (count, 24), where a model tells them apart from V; NULL: V > 0.
  Status (*eval_logits)(const void *self, int count, const double *pairs, double *logits);
  // V of pairs (count, 24) by its network alone, and a bound of what each is off at a stated confidence;
  // NULL: it tells none. `has_bounds`: whether it does as it was made; NULL: always.
  Status (*eval_bounds)(const void *self, int count, const double *pairs, double *volumes, double *bounds);
  bool (*has_bounds)(const void *self);
  // Whether it has second derivatives, and a centroid of its own, as it was made; NULL: never.
  bool (*has_hessian)(const void *self);
  bool (*has_centroid)(const void *self);
  // Whether it has ∇V; NULL: always.
  bool (*has_gradient)(const void *self);
  // eval_batch fails where a coordinate is not finite; without it, all are looked through before.
  bool checks_finite;
  // V does not follow the size of the pair: it means something of pairs as large as those of its training, a
  // scene's forces mean nothing.
  bool lacks_scale;
  // The shipped weights that it takes, where they go by another name than its own; NULL: no others.
  const char *weights;
  // What OverlapPull asks for; NULL: it cannot. Pairs that it answers unasked have the slope 0.
  Status (*eval_pull)(const void *self, const OverlapPull *pull);
  // ∂x̄/∂x of pairs (count, 24), (count, 3, 24), of a model with a centroid of its own; where V is 0 anything
  // finite. Called from several threads at once. NULL: eval_pull is asked, or there are none.
  Status (*eval_slopes)(const void *self, int count, const double *pairs, double *slopes);
  // NULL: its parameters have no derivatives.
  const OverlapTraining *training;
  // Whether it wants to know the origins of pairs; NULL: no.
  bool (*wants_origins)(const void *self);
  // Batches may want its doubt, and with ∇V the doubt's gradient.
  bool gives_doubt, gives_doubt_gradient;
  // The pairs that it was made for, in measures of the pairs as they stand; NULL: it does not say, or sees to
  // it itself.
  const struct OverlapRange *range;
} OverlapOps;

// Whether all `numbers` are finite; of NULL true.
bool overlap_ops_are_finite(size_t count, const double *numbers);

// Whether two tetrahedra, the smaller one of this volume, may share V, but for rounding; false for NaN.
bool overlap_ops_is_possible(double volume, double smaller);
// STATUS_SOLVER, with the message of a model whose V of a pair is not.
Status overlap_ops_fail_impossible(const char *model, int pair, double volume, double smaller);

// A capability that a model has however it was made.
bool overlap_ops_always(const void *self);

// The batch of one pair, with the answer's places.
OverlapBatch overlap_ops_single(const double pair[24], const OverlapAnswer *answer);

// The places of pair i of a batch; its flags go to `flags` where the batch wants none.
OverlapAnswer overlap_ops_answer(const OverlapBatch *batch, int i, unsigned *flags);

// Writes what a pair without common interior gets: zeros, but for the flags.
void overlap_ops_write_nothing(const OverlapAnswer *answer);

// The batch of its pairs from `begin` on, at most `count`.
OverlapBatch overlap_ops_part(const OverlapBatch *batch, int begin, int count);

// A pair's other order; the same function turns it back.
void overlap_ops_swap(const double pair[24], double swapped[24]);

#endif
