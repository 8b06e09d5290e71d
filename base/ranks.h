// SPDX-License-Identifier: Apache-2.0
// The processes (ranks) that share one run, behind one table. Without MPI there is one, and nothing happens.
//
// Every rank goes through the same states to the last bit: its own work is returned to all as sums or pieces,
// and whatever decides is the same on all. So all ranks call these functions in the same order; only the
// first rank writes files and messages.
#ifndef TETLAP_BASE_RANKS_H
#define TETLAP_BASE_RANKS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

enum { RANKS_MOST = 4096 };

// A graph in compressed rows, both directions of every edge.
typedef struct RanksGraph {
  int node_count;
  int *begin;     // of each node's neighbours                  (node_count + 1)
  int *neighbour; //                                            (begin[node_count])
} RanksGraph;

// The traffic of this rank.
typedef struct RanksStats {
  long long sums, pieces, decisions; // calls
  long long bytes;                   // that this rank gave
  double waiting_s;                  // wall time in these calls
  double inside_s;                   // processor time within MPI, also of libraries that call it
} RanksStats;

typedef struct Ranks {
  int number, count; // of this rank, from 0; how many there are
  // values = Σ over ranks, the same bits on each.
  void (*sum)(double *values, size_t count);
  // values = the largest over ranks.
  void (*most)(double *values, size_t count);
  // Rank r has filled items begin[r] … begin[r + 1] − 1 of `size` bytes each; then all have all.
  void (*join)(void *items, size_t size, const int *begin);
  // What the first rank has, to all.
  void (*tell)(void *bytes, size_t size);
  // The worst of all ranks' states, with its message: fatal before retry before ok.
  Status (*worst)(Status status);
  bool divides; // whether the next operation divides; else all nodes go to the first rank
  // Called by the first rank alone: as many nodes to each rank as to the others, few edges between.
  Status (*divide)(const RanksGraph *graph, int rank_count, int *rank_of_node);
  const RanksStats *(*stats)(void);
} Ranks;

const Ranks *ranks(void);
// NULL: one process. The table is borrowed. Before a scene is read.
void ranks_set(const Ranks *table);

// Whether this is the first rank, which writes files and messages.
bool ranks_is_first(void);
// Whether any rank says so.
bool ranks_any(bool is_so);
// Where each rank's share of `count` items begins, as equal as can be (ranks()->count + 1); valid until the
// next call.
const int *ranks_split(int count);

#endif
