// SPDX-License-Identifier: GPL-3.0-or-later
// The elimination tree of a symmetric matrix by fronts: sets of columns with the same rows. A front's dense
// panel holds its columns of the factor; what it leaves to later columns goes to its parent, the front that
// has the first of its rows below.
//
//   children ──► front: own columns │ rows below ──► parent (the first row below is one of its columns)
//
// Columns and rows are those of nodes (vertices with one to three unknowns each), in the order of
// elimination. Subtrees with little work are domains: each is handled by one thread. Which they are depends
// on the matrix alone.
#ifndef TETLAP_FEM_SPARSE_FRONT_TREE_H
#define TETLAP_FEM_SPARSE_FRONT_TREE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

// Consecutive rows below of a front that are consecutive rows of its parent, all of its own columns' or none.
typedef struct FemFrontRun {
  int from;  // row below, counted from the first
  int to;    // row of the parent's panel
  int count; // rows
} FemFrontRun;

// Consecutive rows below of a front that are consecutive unknowns in the order of elimination.
typedef struct FemFrontSpan {
  int begin, count;
} FemFrontSpan;

// Where the matrix's entries of two nodes, or of a node with itself, go.
typedef struct FemFrontBlock {
  int source[3];      // of each column of the node with the lower number: in the matrix's values
  int row, column;    // in the front's panel
  signed char width;  // columns in the matrix
  signed char height; // rows in the matrix; of a node with itself: as many as columns, from the diagonal
  bool is_own;        // of a node with itself
  bool is_turned;     // columns of the matrix are rows of the panel
} FemFrontBlock;

typedef struct FemFront {
  int parent;               // −1: none
  int begin;                // its first unknown in the order of elimination
  int own, height;          // columns; rows of the panel, the first `own` of which are the columns'
  int first;                // first front of its subtree, which is [first, itself]
  bool is_top;              // not part of a domain
  int run_begin, run_end;   // in runs: the rows below
  int span_begin, span_end; // in spans: the rows below
  int block_begin, block_end;
  size_t values;  // of the panel (own, height), a column after the other
  size_t carried; // of the rows below in a vector of all fronts' rows below
  size_t left;    // of what it leaves among all that outlives a domain
  double work;    // of the subtree [multiplications]
} FemFront;

typedef struct FemFrontTree {
  int front_count, size; // size: unknowns
  FemFront *fronts;      // children before their parents                     (front_count)
  int *child_begin;      // of each front in children                         (front_count + 1)
  int *children;         // ascending                                         (…)
  int *unknown;          // of the matrix, at each place of the order         (size)
  FemFrontRun *runs;
  FemFrontSpan *spans;
  FemFrontBlock *blocks;
  size_t value_count, carried_count;
  size_t stack;       // most that a domain holds of what fronts leave [numbers]
  size_t left_count;  // what the roots of domains and fronts above them leave, all together [numbers]
  double entry_count; // of the factor
} FemFrontTree;

// What the analysis of a graph gives. All borrowed.
typedef struct FemFrontDef {
  int node_count;
  const int *first;       // first unknown of each node                        (node_count + 1)
  const int *begin, *row; // the graph: lower triangle with diagonal, ascending (node_count + 1), (…)
  const int *col_begin;   // of the matrix: an unknown's column begins with the own rows of its node
  const int *order;       // node at each place                                (node_count)
  int front_count;
  const int *place;     // first place of each front                         (front_count + 1)
  const int *row_begin; // of each front in rows                             (front_count + 1)
  const int *rows;      // places, ascending, own ones first
} FemFrontDef;

// A zeroed tree can be destroyed.
Status fem_front_tree_create(FemFrontTree *tree, const FemFrontDef *def);
void fem_front_tree_destroy(FemFrontTree *tree);

#endif
