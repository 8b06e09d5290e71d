// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of tetrahedra, 24 doubles: what overlap models promise of any of them, held against exact rational
// arithmetic.
//
//   exact, clip-scalar, clip, geo   finite numbers; 0 ≤ V ≤ the smaller volume; Σ∇V = 0, Σ x×∇V = 0,
//                                   Σ x·∇V = 3V; disjoint means ∇V = 0; a flat tetrahedron is told as such
//   clip-scalar, clip               V as exact within what clip.h states
//   clip, geo                       the same bits in whichever lane, beside whichever neighbours; nothing
//                                   depends on the order of vertices and tetrahedra
//   geo                             no overlap is missed, beyond what geo/gate.h calls noise
//
// Numbers that are not finite must be refused. Lengths beyond 2^±60 and volumes below 2^−960 are evaluated,
// too, but V and ∇V may overflow or underflow there and nothing is claimed of them.
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "datagen/hard.h"
#include "overlap/geo/gate.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"
#include "pairs.h"
#include "target.h"

enum { SIZE = OVERLAP_PAIR_SIZE, PAIR_BYTES = SIZE * sizeof(double) };

// Limits relative to the pair's own size; the reason stands in each.
static const double
    // V of a model in double precision is cut to [0, smaller]: rounding of that volume.
    BOUNDS = 4e-16,
    // Sums of 24 terms of the size L², in units of L²: some hundred roundings.
    BALANCE = 1e-13,
    // Of `geo`, whose frame is an orthogonalisation of eight planes.
    BALANCE_GEO = 1e-12,
    // `geo` is learned, and shapes as they come here are not what it learned of: 0.14 of the smaller volume
    // has been seen. Claimed is that no overlap is missed or counted twice.
    ERROR_GEO = 0.5;

typedef struct Answer {
  double volume, gradient[SIZE];
  unsigned flags;
} Answer;

// The pair, its neighbours in other orders, and the pair once more: two vectors of eight lanes and a rest.
enum { VARIANTS = 19, LAST = VARIANTS - 1 };
typedef struct Batch {
  double pairs[VARIANTS][SIZE];
  double volumes[VARIANTS], gradients[VARIANTS][SIZE];
  unsigned flags[VARIANTS];
} Batch;

static const char *const names[] = {"exact", "clip-scalar", "clip", "geo"};
typedef enum Model { EXACT, CLIP_SCALAR, CLIP, GEO, MODEL_COUNT } Model;

static const OverlapModel *model_of(Model model) {
  static OverlapModel models[MODEL_COUNT];
  if (!models[model].ops)
    FUZZ_CLAIM(overlap_models_create(&models[model], names[model]) == STATUS_OK, "%s", status_message());
  return &models[model];
}

static void ask(Model model, int count, const double *pairs, double *volumes, double *gradients,
                unsigned *flags) {
  OverlapBatch batch = {
      .pair_count = count, .pairs = pairs, .volume = volumes, .gradient = gradients, .flags = flags};
  FUZZ_CLAIM(overlap_model_eval(model_of(model), &batch) == STATUS_OK, "%s: %s", names[model],
             status_message());
}

static Answer answer_of(Model model, const double x[SIZE]) {
  Answer answer;
  ask(model, 1, x, &answer.volume, answer.gradient, &answer.flags);
  return answer;
}

// Variant k: neighbours of the same size in other orders, and half of them moved.
static void fill_batch(const double x[SIZE], Batch *batch) {
  memcpy(batch->pairs[0], x, PAIR_BYTES);
  memcpy(batch->pairs[LAST], x, PAIR_BYTES);
  for (int k = 1; k < LAST; k++) {
    double swapped[SIZE];
    overlap_ops_swap(x, swapped);
    const double *from = k & 1 ? swapped : x;
    datagen_hard_permute(from, (5 * k) % 24, batch->pairs[k]);
    datagen_hard_permute(from + 12, (7 * k + 3) % 24, batch->pairs[k] + 12);
    for (int i = 0; k > 8 && i < 12; i++) batch->pairs[k][i] *= 1 + 0.03125 * (k - 8);
  }
}

static bool is_finite(const Answer *answer) {
  double sum = answer->volume;
  for (int i = 0; i < SIZE; i++) sum += answer->gradient[i] - answer->gradient[i];
  return isfinite(sum);
}

// What rounding of products of three lengths is to the smaller volume: large if that is flat or small.
static double flatness_of(const double x[SIZE]) {
  double extent = overlap_invariant_extent(x);
  return extent / overlap_invariant_smaller_volume(x) * extent * extent;
}

// `geo` knows a slice by the angle between its faces, which is rounded by some ε: of the slice's thickness,
// and so of the forces on it, that is ε · smaller/V. Normals of a flat tetrahedron are rounded by more, as
// `flatness_of` has it, so extent³ stands beside the smaller volume, which rounding may make 0.
static double slice_doubt(const double x[SIZE], const Answer *answer) {
  double largest = 0, extent = overlap_invariant_extent(x);
  for (int i = 0; i < SIZE; i++) largest = fmax(largest, fabs(answer->gradient[i]));
  return DBL_EPSILON * largest / (extent * extent) *
         (overlap_invariant_smaller_volume(x) + 1e-3 * pow(extent, 3)) / answer->volume;
}

static void check_answer(Model model, const double x[SIZE], const Answer *answer) {
  const char *name = names[model];
  bool is_flat = (answer->flags & OVERLAP_FLAT) != 0;
  double least = overlap_invariant_smaller_volume(x), flatness = flatness_of(x),
         balance = (model == GEO ? BALANCE_GEO : BALANCE) * (1 + 1e-3 * flatness);
  FUZZ_CLAIM(is_finite(answer), "%s: V = %g", name, answer->volume);
  FUZZ_CLAIM(answer->volume >= 0, "%s: V = %g", name, answer->volume);
  if (answer->flags & (OVERLAP_FLAT | OVERLAP_DISJOINT)) // else V may have underflowed
    for (int i = 0; i < SIZE; i++)
      FUZZ_CLAIM(answer->gradient[i] == 0, "%s: component %d is %g", name, i, answer->gradient[i]);
  if (is_flat) FUZZ_CLAIM(answer->volume == 0, "%s: V = %g", name, answer->volume);
  if (answer->volume == 0) return;
  double above = overlap_invariant_bounds(x, answer->volume);
  FUZZ_CLAIM(above <= (model == GEO ? ERROR_GEO : 0) + BOUNDS * (1 + flatness),
             "%s: V = %.17g, smaller %.17g, beyond by %g", name, answer->volume, least, above);
  if (model == GEO) balance += slice_doubt(x, answer);
  double residuals[3] = {overlap_invariant_translation(x, answer->gradient),
                         overlap_invariant_rotation(x, answer->gradient),
                         overlap_invariant_scaling(x, answer->volume, answer->gradient)};
  for (int k = 0; k < 3; k++)
    FUZZ_CLAIM(residuals[k] <= balance, "%s: sum %d of dV/dx is %g, V = %g", name, k, residuals[k],
               answer->volume);
}

static double tet_extent(const double tet[12]) {
  double longest = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++)
      longest = fmax(longest, vec3_length(vec3_sub(vec3_at(tet + 3 * i), vec3_at(tet + 3 * j))));
  return longest;
}

// How far off a plane of the tetrahedron `geo` takes a point for on it (overlap/geo/gate.h).
static double plane_doubt(const double tet[12]) {
  double extent = tet_extent(tet), det = 6 * overlap_invariant_tet_volume(tet),
         flatness = fmin(extent * extent * extent / det, 1 / OVERLAP_GEO_FLATTEST);
  return fmax(OVERLAP_GEO_NOISE, OVERLAP_GEO_ROUNDING * flatness) * extent;
}

// An overlap that is called none may be some 24 times as thick.
static double doubt_of_geo(const double x[SIZE]) {
  double smaller = fmin(tet_extent(x), tet_extent(x + 12));
  return 24 * fmax(plane_doubt(x), plane_doubt(x + 12)) * smaller * smaller;
}

static void check_against_exact(Model model, const double x[SIZE], const Answer *answer,
                                const Answer *exact) {
  const char *name = names[model];
  bool is_flat = (answer->flags & OVERLAP_FLAT) != 0, is_truly_flat = (exact->flags & OVERLAP_FLAT) != 0;
  FUZZ_CLAIM(is_flat == is_truly_flat, "%s: flags %u, exact %u", name, answer->flags, exact->flags);
  if (model == GEO) {
    double error = fabs(answer->volume - exact->volume);
    FUZZ_CLAIM(!(answer->flags & OVERLAP_DISJOINT) ||
                   exact->volume <= 1e-9 * overlap_invariant_smaller_volume(x) + doubt_of_geo(x),
               "%s: disjoint, exact V = %.17g", name, exact->volume);
    FUZZ_CLAIM(is_truly_flat || error <= ERROR_GEO * overlap_invariant_smaller_volume(x) + doubt_of_geo(x),
               "V = %.17g, exact %.17g, flags %u", answer->volume, exact->volume, answer->flags);
  } else if (!is_truly_flat) {
    double allowed = overlap_invariant_allowed(x, exact->volume);
    FUZZ_CLAIM(fabs(answer->volume - exact->volume) <= allowed, "%s: V = %.17g, exact %.17g, allowed %g",
               name, answer->volume, exact->volume, allowed);
  }
}

// The same pair alone, in the first lane and in the last.
static void check_lanes(Model model, const Answer *alone, const Batch *batch) {
  for (int k = 0; k < VARIANTS; k += LAST) {
    FUZZ_CLAIM(memcmp(&alone->volume, &batch->volumes[k], sizeof(double)) == 0,
               "%s: V = %.17g alone, %.17g in place %d", names[model], alone->volume, batch->volumes[k], k);
    FUZZ_CLAIM(memcmp(alone->gradient, batch->gradients[k], PAIR_BYTES) == 0, "%s: dV/dx in place %d",
               names[model], k);
    FUZZ_CLAIM(alone->flags == batch->flags[k], "%s: flags %u alone, %u in place %d", names[model],
               alone->flags, batch->flags[k], k);
  }
}

// Variants 1 … 8 are the pair in another order.
static void check_orders(Model model, const double x[SIZE], const Answer *answer, const Batch *batch) {
  double least = overlap_invariant_smaller_volume(x);
  for (int k = 1; k <= 8; k++) {
    double difference = fabs(batch->volumes[k] - answer->volume);
    double allowed =
        model == GEO ? 1e-9 * least + doubt_of_geo(x) : 2 * overlap_invariant_allowed(x, answer->volume);
    FUZZ_CLAIM(difference <= allowed || least == 0, "%s: V = %.17g, in order %d %.17g, smaller %g",
               names[model], answer->volume, k, batch->volumes[k], least);
  }
}

bool fuzz_pairs_is_moderate(const double x[SIZE]) {
  double largest = 0;
  for (int i = 0; i < SIZE; i++) largest = fmax(largest, fabs(x[i]));
  double least = overlap_invariant_smaller_volume(x); // parts of it are to be normal numbers, too
  return largest < 0x1p60 && overlap_invariant_extent(x) > 0x1p-60 && (least == 0 || least > 0x1p-960);
}

static void check_refused(const double x[SIZE]) {
  for (int m = 0; m < MODEL_COUNT; m++) {
    double volume;
    OverlapBatch batch = {.pair_count = 1, .pairs = x, .volume = &volume};
    Status status = overlap_model_eval(model_of((Model)m), &batch);
    FUZZ_CLAIM(status == STATUS_INPUT, "%s: status %d", names[m], (int)status);
  }
}

static void run(const uint8_t *data, size_t size) {
  double x[SIZE] = {0}, sum = 0;
  memcpy(x, data, size < sizeof x ? size : sizeof x);
  for (int i = 0; i < SIZE; i++) sum += x[i] - x[i];
  if (sum != 0) {
    check_refused(x);
    return;
  }
  static Batch batch;
  bool is_checked = fuzz_pairs_is_moderate(x);
  Answer exact = answer_of(EXACT, x);
  if (is_checked) check_answer(EXACT, x, &exact);
  for (Model model = CLIP_SCALAR; model < MODEL_COUNT; model++) {
    Answer answer = answer_of(model, x);
    if (is_checked) check_answer(model, x, &answer);
    if (is_checked) check_against_exact(model, x, &answer, &exact);
    if (model == CLIP_SCALAR || !is_checked) continue;
    fill_batch(x, &batch);
    ask(model, VARIANTS, batch.pairs[0], batch.volumes, batch.gradients[0], batch.flags);
    check_lanes(model, &answer, &batch);
    check_orders(model, x, &answer, &batch);
  }
}

// Of each class of hard pairs the first two members.
static size_t seed(int k, uint8_t *data) {
  if (k >= 2 * DATAGEN_HARD_CLASS_COUNT) return 0;
  DatagenHardPair pair = datagen_hard_make(k / 2, k % 2);
  memcpy(data, pair.x, sizeof pair.x);
  return sizeof pair.x;
}

// A vertex or a coordinate in a special place relative to the others; what random bytes would never hit.
static void change_pair(double x[SIZE], uint64_t random) {
  int vertex = (int)(random >> 8 & 7), other = (int)(random >> 11 & 7), third = (int)(random >> 14 & 7),
      c = (int)((random >> 17) % 3), d = (int)((random >> 19) % 3);
  double *p = x + 3 * vertex, *q = x + 3 * other, *r = x + 3 * third;
  double weight = (double)(random >> 24 & 31) / 16 - 0.5, tiny = ldexp(1, -(int)(random >> 32 & 63));
  switch (random & 15) {
  case 0: // onto another vertex
    memcpy(p, q, 3 * sizeof *p);
    break;
  case 1: // onto the line through two others
    for (int i = 0; i < 3; i++) p[i] = q[i] + weight * (r[i] - q[i]);
    break;
  case 2: // onto the plane through a face of the other tetrahedron
    for (int i = 0, first = vertex < 4 ? 4 : 0; i < 3; i++)
      p[i] = x[3 * first + i] + weight * (x[3 * (first + 1) + i] - x[3 * first + i]) +
             0.25 * (x[3 * (first + 2) + i] - x[3 * first + i]);
    break;
  case 3: // near another vertex
    for (int i = 0; i < 3; i++) p[i] = q[i] + tiny * (r[i] - q[i]);
    break;
  case 4: // the next number up or down
    p[c] = nextafter(p[c], random >> 40 & 1 ? INFINITY : -INFINITY);
    break;
  case 5: // a coordinate of another
    p[c] = q[d];
    break;
  case 6: // the grid
    p[c] = ldexp((double)(int8_t)(random >> 40), -(int)(random >> 48 & 7));
    break;
  case 7: // flatten one tetrahedron in one direction
    for (int v = vertex & 4; v < (vertex & 4) + 4; v++)
      x[3 * v + c] = x[3 * (vertex & 4) + c] + tiny * (x[3 * v + c] - x[3 * (vertex & 4) + c]);
    break;
  case 8: // grow or shrink all
    for (int i = 0; i < SIZE; i++) x[i] *= ldexp(1, (int)(random >> 40 & 31) - 16);
    break;
  case 9: // shift all far away
    for (int v = 0; v < 8; v++) x[3 * v + c] += ldexp(1, (int)(random >> 40 & 31));
    break;
  case 10: // one tetrahedron in place of the other
    memcpy(x + 12, x, 12 * sizeof *x);
    break;
  case 11: // one moved by a little
    for (int v = vertex & 4; v < (vertex & 4) + 4; v++) x[3 * v + c] += tiny;
    break;
  case 12: // mirrored
    for (int v = vertex & 4; v < (vertex & 4) + 4; v++) x[3 * v + c] = 2 * q[c] - x[3 * v + c];
    break;
  case 13: // one shrunk about one of its vertices
    for (int v = vertex & 4; v < (vertex & 4) + 4; v++)
      for (int i = 0; i < 3; i++) x[3 * v + i] = p[i] + (v == vertex ? 0 : tiny * (x[3 * v + i] - p[i]));
    break;
  default: // a share of itself
    p[c] *= 1 + weight * tiny;
  }
}

static size_t mutate(uint8_t *data, size_t size, size_t room, unsigned number, FuzzPlainMutation plain) {
  if (room < PAIR_BYTES || number % 16 == 0) return plain(data, size, room);
  double x[SIZE] = {0};
  Random random = random_seeded(number, 0);
  memcpy(x, data, size < PAIR_BYTES ? size : PAIR_BYTES);
  for (int k = 0; k <= (int)(number % 3); k++) change_pair(x, random_bits(&random));
  memcpy(data, x, PAIR_BYTES);
  return PAIR_BYTES;
}

const FuzzTarget fuzz_pairs = {.name = "pairs", .run = run, .seed = seed, .mutate = mutate};
