// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/overlap/pairs.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/random.h"
#include "overlap/clip/clip.h"

const char *const app_bench_sets[APP_BENCH_SET_COUNT] = {"near", "uniform", "disjoint"};

static void draw_uniform(Random *random, double pair[24]) {
  for (int i = 0; i < 24; i++) pair[i] = random_uniform(random);
}

// A mesh over all of space: its vertex (i, j, k) is at edge · (i, j, k), moved by a fixed random vector,
// turned about z and lifted.
typedef struct Lattice {
  uint64_t seed;
  double edge, cosine, sine, lift;
} Lattice;

static void place_vertex(const Lattice *lattice, const int index[3], double position[3]) {
  uint64_t number = 0;
  for (int c = 0; c < 3; c++) number = number << 20 | (uint64_t)(index[c] + (1 << 19));
  Random random = random_seeded(lattice->seed, number);
  double p[3];
  for (int c = 0; c < 3; c++) p[c] = lattice->edge * (index[c] + random_between(&random, -0.15, 0.15));
  position[0] = lattice->cosine * p[0] - lattice->sine * p[1];
  position[1] = lattice->sine * p[0] + lattice->cosine * p[1];
  position[2] = p[2] + lattice->lift;
}

// One of the cell's six tetrahedra: those of all paths along its edges from one corner to the opposite
// (Kuhn).
static void place_tet(const Lattice *lattice, const int cell[3], int which, double tet[12]) {
  static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  int index[3] = {cell[0], cell[1], cell[2]};
  for (int v = 0; v < 4; v++) {
    if (v > 0) index[order[which][v - 1]]++;
    place_vertex(lattice, index, tet + 3 * v);
  }
}

static void draw_near(Random *random, uint64_t seed, double pair[24]) {
  const double turn = 0.4, depth = 0.1;
  const Lattice lower = {.seed = seed, .edge = 1, .cosine = 1};
  const Lattice upper = {
      .seed = seed + 1, .edge = 0.77, .cosine = cos(turn), .sine = sin(turn), .lift = -depth};
  int below[3] = {random_below(random, 1000), random_below(random, 1000), -1}, above[3] = {0, 0, 0};
  // the upper cell that lies over a random point of the lower cell or beside it
  double x = below[0] + random_between(random, -0.5, 1.5), y = below[1] + random_between(random, -0.5, 1.5);
  above[0] = (int)floor((upper.cosine * x + upper.sine * y) / upper.edge);
  above[1] = (int)floor((upper.cosine * y - upper.sine * x) / upper.edge);
  place_tet(&lower, below, random_below(random, 6), pair);
  place_tet(&upper, above, random_below(random, 6), pair + 12);
}

static bool boxes_overlap(const double pair[24]) {
  for (int c = 0; c < 3; c++) {
    double low[2], high[2];
    for (int t = 0; t < 2; t++) {
      low[t] = high[t] = pair[12 * t + c];
      for (int i = 12 * t + c + 3; i < 12 * t + 12; i += 3)
        low[t] = fmin(low[t], pair[i]), high[t] = fmax(high[t], pair[i]);
    }
    if (!(low[0] < high[1] && low[1] < high[0])) return false;
  }
  return true;
}

static Status intersects(const double pair[24], bool *answer) {
  double volume;
  unsigned flags;
  TRY(overlap_clip_ops.eval_pair(NULL, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  *answer = volume > 0;
  return STATUS_OK;
}

Status app_bench_pairs_make(const char *set, int count, uint64_t seed, double *pairs) {
  bool is_near = strcmp(set, "near") == 0, is_disjoint = strcmp(set, "disjoint") == 0;
  if (!is_near && !is_disjoint && strcmp(set, "uniform") != 0)
    return status_fail(STATUS_USAGE, "there is no set '%s': give near, uniform or disjoint", set);
  Random random = random_seeded(seed, 0);
  for (int made = 0; made < count;) {
    double *pair = pairs + (size_t)made * OVERLAP_PAIR_SIZE;
    bool does_intersect;
    if (is_near)
      draw_near(&random, seed, pair);
    else
      draw_uniform(&random, pair);
    if (!boxes_overlap(pair)) continue;
    TRY(intersects(pair, &does_intersect));
    made += does_intersect != is_disjoint;
  }
  return STATUS_OK;
}

Status app_bench_pairs_fill(const char *set, int count, uint64_t seed, double *pairs) {
  int made = count < APP_BENCH_DIFFERENT_PAIRS ? count : APP_BENCH_DIFFERENT_PAIRS;
  TRY(app_bench_pairs_make(set, made, seed, pairs));
  for (size_t i = (size_t)made; i < (size_t)count; i++)
    memcpy(pairs + i * OVERLAP_PAIR_SIZE, pairs + i % (size_t)made * OVERLAP_PAIR_SIZE,
           OVERLAP_PAIR_SIZE * sizeof *pairs);
  return STATUS_OK;
}
