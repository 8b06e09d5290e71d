// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/front/factor.h"

#include <omp.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "fem/sparse/front/dense.h"
#include "fem/sparse/front/sweep.h"
#include "fem/sparse/solver.h"
#include "fem/sparse/vector.h"

// Columns that are eliminated together in a front whose panel is cut into pieces, and the sides of a piece.
enum { BLOCK = 128, TILE = 256 };
// Rows and columns of a piece of a solution.
enum { ROWS = 512, COLUMNS = 16 };
// Multiplications of a front that is worth being cut in a factorisation, and in a solution.
static const double LARGE = 1e7, LONG = 1e5;
// A factorisation into fewer numbers, and a solution by fewer, is over before another thread is awake; the
// numbers stay near the processor, and half of the bytes take as long.
static const size_t FEW_VALUES = 500000, FEW_SOLVED = 2000000;
// What fronts leave keeps its memory up to this count of numbers, 16 MB: to get, clear and give back so
// little takes half as long as the elimination. All together it is about as large as the factor.
static const size_t KEPT_VALUES = 2000000;

// A factorisation while it goes on.
typedef struct Make {
  FemFrontFactor *factor;
  const double *values; // of the matrix
  atomic_int failure;   // a Status: the first that was seen
} Make;

// Tasks are done where they stand outside of parallel regions. In a region of one thread each waits in a
// queue, with calls of the system.
static bool is_alone(void) {
  return omp_get_max_threads() == 1;
}

static Status no_memory(void) {
  return status_no_memory("the factor of the condensed system (try solver.linear: pcg)");
}

// Numbers of any value. An eighth is to spare.
static bool make_room(void *array, size_t *room, size_t wanted, size_t size) {
  void **at = array;
  if (*at && wanted <= *room) return true;
  memory_free(*at);
  *room = wanted + wanted / 8;
  *at = memory_zeroed(*room, size);
  return *at;
}

static void free_stacks(FemFrontFactor *factor) {
  for (int t = 0; t < factor->stack_count; t++) memory_free(factor->stacks[t]);
  memory_free(factor->stacks);
  factor->stacks = NULL;
  factor->stack_count = 0;
}

static bool make_all_room(FemFrontFactor *factor, const FemFrontTree *tree) {
  FemFrontRoom *room = &factor->room;
  return make_room(&factor->values, &room->values, tree->value_count, sizeof *factor->values) &&
         make_room(&factor->updates, &room->updates, (size_t)tree->front_count, sizeof *factor->updates) &&
         make_room(&factor->x, &room->x, (size_t)tree->size, sizeof *factor->x) &&
         make_room(&factor->carried, &room->carried, tree->carried_count, sizeof *factor->carried);
}

static bool make_kept(FemFrontFactor *factor, const FemFrontTree *tree) {
  if (tree->left_count <= KEPT_VALUES)
    return make_room(&factor->kept, &factor->room.kept, tree->left_count, sizeof *factor->kept);
  memory_free(factor->kept);
  factor->kept = NULL;
  return true;
}

static bool make_rough(FemFrontFactor *factor, const FemFrontTree *tree, bool may_be_rough) {
  if (may_be_rough && tree->value_count > FEW_VALUES)
    return make_room(&factor->rough, &factor->room.rough, tree->value_count, sizeof *factor->rough);
  memory_free(factor->rough);
  factor->rough = NULL;
  return true;
}

Status fem_front_factor_lay_out(FemFrontFactor *factor, const FemFrontTree *tree, bool may_be_rough) {
  factor->tree = tree;
  if (factor->room.stack < tree->stack) free_stacks(factor);
  if (!make_all_room(factor, tree) || !make_kept(factor, tree) || !make_rough(factor, tree, may_be_rough)) {
    fem_front_factor_destroy(factor);
    return no_memory();
  }
  memset(factor->updates, 0, (size_t)tree->front_count * sizeof *factor->updates);
  return STATUS_OK;
}

void fem_front_factor_destroy(FemFrontFactor *factor) {
  free_stacks(factor);
  memory_free(factor->values), memory_free(factor->rough), memory_free(factor->updates);
  memory_free(factor->x), memory_free(factor->carried), memory_free(factor->kept);
  *factor = (FemFrontFactor){0};
}

static Status make_stacks(FemFrontFactor *factor, int count) {
  if (factor->stack_count >= count) return STATUS_OK;
  free_stacks(factor);
  factor->stacks = memory_zeroed((size_t)count, sizeof *factor->stacks);
  if (!factor->stacks) return no_memory();
  factor->room.stack = factor->tree->stack + factor->tree->stack / 8;
  for (int t = 0; t < count; t++) {
    factor->stacks[t] = memory_zeroed(factor->room.stack, sizeof **factor->stacks);
    factor->stack_count = t + 1;
    if (factor->stacks[t]) continue;
    free_stacks(factor);
    return no_memory();
  }
  return STATUS_OK;
}

static int below_of(const FemFront *front) {
  return front->height - front->own;
}

static void place_block(const FemFrontBlock *block, const double *values, double *to, int stride) {
  for (int c = 0; c < block->width; c++) {
    const double *from = values + block->source[c];
    if (block->is_own)
      for (int r = c; r < block->height; r++) to[stride * c + r] = from[r - c];
    else if (block->is_turned)
      for (int r = 0; r < block->height; r++) to[stride * r + c] = from[r];
    else
      for (int r = 0; r < block->height; r++) to[stride * c + r] = from[r];
  }
}

// The matrix's entries in the front's panel.
static void place_entries(const Make *make, const FemFront *front, double *panel) {
  const FemFrontTree *tree = make->factor->tree;
  memset(panel, 0, (size_t)front->own * (size_t)front->height * sizeof *panel);
  for (int b = front->block_begin; b < front->block_end; b++) {
    const FemFrontBlock *block = &tree->blocks[b];
    place_block(block, make->values, panel + (size_t)block->column * (size_t)front->height + block->row,
                front->height);
  }
}

// One column of what a child leaves, from its diagonal down: into a column of the panel, or of the update.
static void add_column(const FemFrontRun *run, const FemFrontRun *end, int skipped, const double *from,
                       double *to) {
  for (; run < end; run++, skipped = 0)
    for (int r = skipped; r < run->count; r++) to[run->to + r] += from[run->from + r];
}

// The lower triangle of what a child leaves.
static void add_update(const FemFrontTree *tree, const FemFront *child, const FemFront *front,
                       const double *left, double *panel, double *update) {
  int below = below_of(front);
  const FemFrontRun *end = tree->runs + child->run_end;
  for (const FemFrontRun *run = tree->runs + child->run_begin; run < end; run++)
    for (int c = 0; c < run->count; c++) {
      int column = run->to + c;
      double *to = column < front->own ? panel + (size_t)column * (size_t)front->height
                                       : update + (size_t)(column - front->own) * (size_t)below - front->own;
      add_column(run, end, c, left + (size_t)(run->from + c) * (size_t)below_of(child), to);
    }
}

// A front's panel and update before its columns are eliminated, from the matrix and what its children leave.
static void assemble(const Make *make, int f, double *update) {
  const FemFrontFactor *factor = make->factor;
  const FemFrontTree *tree = factor->tree;
  const FemFront *front = &tree->fronts[f];
  double *panel = factor->values + front->values;
  size_t below = (size_t)below_of(front);
  place_entries(make, front, panel);
  for (size_t c = 0; c < below; c++) memset(update + c * below + c, 0, (below - c) * sizeof *update);
  for (int k = tree->child_begin[f]; k < tree->child_begin[f + 1]; k++)
    add_update(tree, &tree->fronts[tree->children[k]], front, factor->updates[tree->children[k]], panel,
               update);
}

static FemDense part(FemDense whole, int row, int column) {
  return (FemDense){whole.at + (size_t)column * (size_t)whole.stride + row, whole.stride};
}

static bool eliminate_small(int own, int height, FemDense panel, FemDense update) {
  if (!fem_dense_factorise(own, panel)) return false;
  if (height == own) return true;
  fem_dense_divide(height - own, own, panel, part(panel, own, 0));
  fem_dense_subtract_square(height - own, own, part(panel, own, 0), update);
  return true;
}

static int smaller(int a, int b) {
  return a < b ? a : b;
}

// C −= A Aᵀ of rows [begin, end) of A (…, k): columns up to `last` of its lower triangle, by tiles.
// A taskloop over nothing makes 2³² tasks where clang compiles it, so there is none.
static void subtract_tiles(int begin, int end, int last, int k, FemDense a, FemDense c) {
  if (begin >= last) return;
#pragma omp taskloop collapse(2) grainsize(1) firstprivate(begin, end, last, k, a, c)
  for (int column = begin; column < last; column += TILE)
    for (int row = begin; row < end; row += TILE) {
      if (row + TILE <= column) continue;
      int n = smaller(TILE, last - column), m = smaller(TILE, end - row);
      if (row == column && m == n)
        fem_dense_subtract_square(n, k, part(a, row, 0), part(c, row, column));
      else
        fem_dense_subtract(m, n, k, part(a, row, 0), part(a, column, 0), part(c, row, column));
    }
}

static bool eliminate_large(int own, int height, FemDense panel, FemDense update) {
  for (int at = 0; at < own; at += BLOCK) {
    int width = smaller(BLOCK, own - at), next = at + width;
    FemDense block = part(panel, 0, at);
    if (!fem_dense_factorise(width, part(block, at, 0))) return false;
    if (next == height) break;
#pragma omp taskloop grainsize(1) firstprivate(block, at, width, next, height)
    for (int row = next; row < height; row += TILE)
      fem_dense_divide(smaller(TILE, height - row), width, part(block, at, 0), part(block, row, 0));
    subtract_tiles(next, height, own, width, block, panel);
  }
  subtract_tiles(0, height - own, height - own, own, part(panel, own, 0), update);
  return true;
}

// The panel in single precision.
static void round_panel(FemFrontFactor *factor, const FemFront *front) {
  const double *from = factor->values + front->values;
  float *to = factor->rough + front->values;
  size_t count = (size_t)front->own * (size_t)front->height;
  for (size_t i = 0; i < count; i++) to[i] = (float)from[i];
}

static void fail(Make *make, Status status) {
  atomic_store(&make->failure, status);
}

static bool has_failed(const Make *make) {
  return atomic_load(&make->failure) != STATUS_OK;
}

static void eliminate(Make *make, const FemFront *front, double *update) {
  int below = below_of(front);
  FemDense panel = {make->factor->values + front->values, front->height};
  FemDense left = {update, below > 0 ? below : 1};
  double own = front->own, height = front->height;
  bool is_cut = front->is_top && own * height * height > LARGE;
  bool is_ok = is_cut ? eliminate_large(front->own, front->height, panel, left)
                      : eliminate_small(front->own, front->height, panel, left);
  if (!is_ok) fail(make, STATUS_RETRY);
  if (make->factor->rough) round_panel(make->factor, front);
}

static size_t update_size(const FemFront *front) {
  return (size_t)below_of(front) * (size_t)below_of(front);
}

// What outlives a domain, or is above them.
static double *create_update(Make *make, const FemFront *front) {
  if (make->factor->kept) return make->factor->kept + front->left;
  double *update = memory_zeroed(update_size(front), sizeof *update);
  if (!update) fail(make, STATUS_MEMORY);
  return update;
}

static void free_update(FemFrontFactor *factor, int f) {
  if (!factor->kept) memory_free(factor->updates[f]);
  factor->updates[f] = NULL;
}

// All fronts of a domain, on this thread. Their updates stand on a stack, a front's children last.
static void make_domain(Make *make, int root) {
  FemFrontFactor *factor = make->factor;
  const FemFrontTree *tree = factor->tree;
  double *stack = factor->stacks[omp_get_thread_num()];
  size_t used = 0;
  for (int f = tree->fronts[root].first; f <= root && !has_failed(make); f++) {
    const FemFront *front = &tree->fronts[f];
    double *update = f == root ? create_update(make, front) : stack + used;
    if (!update) return;
    assemble(make, f, update);
    eliminate(make, front, update);
    for (int k = tree->child_begin[f]; k < tree->child_begin[f + 1]; k++)
      used -= update_size(&tree->fronts[tree->children[k]]);
    factor->updates[f] = f == root ? update : stack + used;
    if (f == root) return;
    memmove(stack + used, update, update_size(front) * sizeof *update);
    used += update_size(front);
  }
}

static void make_subtree(Make *make, int f);

// A front above domains: its children first, side by side.
static void make_top(Make *make, int f) {
  FemFrontFactor *factor = make->factor;
  const FemFrontTree *tree = factor->tree;
  for (int k = tree->child_begin[f]; k < tree->child_begin[f + 1]; k++) {
    int child = tree->children[k];
#pragma omp task firstprivate(make, child)
    make_subtree(make, child);
  }
#pragma omp taskwait
  double *update = has_failed(make) ? NULL : create_update(make, &tree->fronts[f]);
  if (update) assemble(make, f, update);
  for (int k = tree->child_begin[f]; k < tree->child_begin[f + 1]; k++)
    free_update(factor, tree->children[k]);
  if (update) eliminate(make, &tree->fronts[f], update);
  factor->updates[f] = update;
}

static void make_subtree(Make *make, int f) {
  if (has_failed(make)) return;
  if (make->factor->tree->fronts[f].is_top)
    make_top(make, f);
  else
    make_domain(make, f);
}

static void make_root(Make *make, int f) {
  make_subtree(make, f);
  free_update(make->factor, f);
}

static void make_all(Make *make) {
  const FemFrontTree *tree = make->factor->tree;
  for (int f = 0; f < tree->front_count; f++)
    if (tree->fronts[f].parent < 0) {
#pragma omp task firstprivate(make, f)
      make_root(make, f);
    }
}

Status fem_front_factor_make(FemFrontFactor *factor, const double *values) {
  Make make = {.factor = factor, .values = values};
  const int before = fem_solver_use_threads(factor->tree->value_count <= FEW_VALUES ? 1 : 0);
  Status room = make_stacks(factor, omp_get_max_threads());
  if (room == STATUS_OK && is_alone()) {
    make_all(&make);
  } else if (room == STATUS_OK) {
#pragma omp parallel
#pragma omp single
    make_all(&make);
  }
  fem_solver_use_threads(before);
  TRY(room);
  Status status = atomic_load(&make.failure);
  if (status == STATUS_RETRY)
    return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite");
  return status == STATUS_OK ? STATUS_OK : no_memory();
}

static void add_carried(FemFrontFactor *factor, int f) {
  const FemFrontTree *tree = factor->tree;
  const FemFront *front = &tree->fronts[f];
  double *own = factor->x + front->begin, *below = factor->carried + front->carried - front->own;
  memset(below + front->own, 0, (size_t)below_of(front) * sizeof *below);
  for (int k = tree->child_begin[f]; k < tree->child_begin[f + 1]; k++) {
    const FemFront *child = &tree->fronts[tree->children[k]];
    const double *from = factor->carried + child->carried;
    for (int run = child->run_begin; run < child->run_end; run++) {
      const FemFrontRun *rows = &tree->runs[run];
      double *to = rows->to < front->own ? own : below;
      for (int r = 0; r < rows->count; r++) to[rows->to + r] += from[rows->from + r];
    }
  }
}

static void gather_below(FemFrontFactor *factor, const FemFront *front) {
  double *to = factor->carried + front->carried;
  for (int s = front->span_begin; s < front->span_end; s++) {
    FemFrontSpan span = factor->tree->spans[s];
    memcpy(to, factor->x + span.begin, (size_t)span.count * sizeof *to);
    to += span.count;
  }
}

static FemSweepPanel panel_of(const FemFrontFactor *factor, const FemFront *front) {
  FemSweepPanel panel = {.own = front->own, .height = front->height};
  if (factor->is_rough)
    panel.rough = factor->rough + front->values;
  else
    panel.values = factor->values + front->values;
  return panel;
}

// A panel that is worth being cut into pieces.
static bool is_long(const FemFront *front) {
  return front->is_top && (double)front->own * front->height > LONG;
}

static void go_down(FemFrontFactor *factor, int f) {
  const FemFront *front = &factor->tree->fronts[f];
  FemSweepPanel panel = panel_of(factor, front);
  double *x = factor->x + front->begin, *below = factor->carried + front->carried;
  add_carried(factor, f);
  if (!is_long(front)) {
    fem_sweep_forward(&panel, 0, front->own, x);
    fem_sweep_subtract(&panel, 0, front->own, front->own, front->height, x, below);
    return;
  }
  for (int at = 0; at < front->own; at += BLOCK) {
    int end = smaller(at + BLOCK, front->own);
    fem_sweep_forward(&panel, at, end, x);
    if (end == panel.height) break;
#pragma omp taskloop grainsize(1) firstprivate(panel, at, end, x, below)
    for (int row = end; row < panel.height; row += ROWS) {
      int last = smaller(row + ROWS, panel.height), middle = smaller(last, panel.own);
      if (row < middle) fem_sweep_subtract(&panel, at, end, row, middle, x, x + row);
      int first = row < panel.own ? middle : row;
      if (first < last) fem_sweep_subtract(&panel, at, end, first, last, x, below + first - panel.own);
    }
  }
}

static void go_up(FemFrontFactor *factor, int f) {
  const FemFront *front = &factor->tree->fronts[f];
  FemSweepPanel panel = panel_of(factor, front);
  double *x = factor->x + front->begin, *below = factor->carried + front->carried;
  gather_below(factor, front);
  if (!is_long(front)) {
    fem_sweep_project(&panel, 0, front->own, front->own, front->height, below, x);
    fem_sweep_backward(&panel, 0, front->own, x);
    return;
  }
  int at = (front->own - 1) / BLOCK * BLOCK;
  for (; at >= 0; at -= BLOCK) {
    int end = smaller(at + BLOCK, front->own);
#pragma omp taskloop grainsize(1) firstprivate(panel, at, end, x, below)
    for (int column = at; column < end; column += COLUMNS) {
      int last = smaller(column + COLUMNS, end);
      fem_sweep_project(&panel, column, last, end, panel.own, x + end, x);
      fem_sweep_project(&panel, column, last, panel.own, panel.height, below, x);
    }
    fem_sweep_backward(&panel, at, end, x);
  }
}

static void go_down_subtree(FemFrontFactor *factor, int root) {
  const FemFrontTree *tree = factor->tree;
  if (!tree->fronts[root].is_top) {
    for (int f = tree->fronts[root].first; f <= root; f++) go_down(factor, f);
    return;
  }
  for (int k = tree->child_begin[root]; k < tree->child_begin[root + 1]; k++) {
    int child = tree->children[k];
#pragma omp task firstprivate(factor, child)
    go_down_subtree(factor, child);
  }
#pragma omp taskwait
  go_down(factor, root);
}

static void go_up_subtree(FemFrontFactor *factor, int root) {
  const FemFrontTree *tree = factor->tree;
  if (!tree->fronts[root].is_top) {
    for (int f = root; f >= tree->fronts[root].first; f--) go_up(factor, f);
    return;
  }
  go_up(factor, root);
  for (int k = tree->child_begin[root]; k < tree->child_begin[root + 1]; k++) {
    int child = tree->children[k];
#pragma omp task firstprivate(factor, child)
    go_up_subtree(factor, child);
  }
}

static void sweep_root(FemFrontFactor *factor, int root) {
  go_down_subtree(factor, root);
  go_up_subtree(factor, root);
}

static void sweep_all(FemFrontFactor *factor) {
  const FemFrontTree *tree = factor->tree;
  for (int f = 0; f < tree->front_count; f++)
    if (tree->fronts[f].parent < 0) {
#pragma omp task firstprivate(factor, f)
      sweep_root(factor, f);
    }
}

static void solve(FemFrontFactor *factor, bool is_rough, const double *b, double *x) {
  const FemFrontTree *tree = factor->tree;
  factor->is_rough = is_rough;
#pragma omp parallel for schedule(static) if (tree->size > FEM_VECTOR_LONG)
  for (int i = 0; i < tree->size; i++) factor->x[i] = b[tree->unknown[i]];
  const int before = fem_solver_use_threads(tree->value_count <= FEW_SOLVED ? 1 : 0);
  if (is_alone()) {
    sweep_all(factor);
  } else {
#pragma omp parallel
#pragma omp single
    sweep_all(factor);
  }
  fem_solver_use_threads(before);
#pragma omp parallel for schedule(static) if (tree->size > FEM_VECTOR_LONG)
  for (int i = 0; i < tree->size; i++) x[tree->unknown[i]] = factor->x[i];
}

void fem_front_factor_solve(FemFrontFactor *factor, const double *b, double *x) {
  solve(factor, false, b, x);
}

void fem_front_factor_solve_roughly(FemFrontFactor *factor, const double *b, double *x) {
  solve(factor, factor->rough != NULL, b, x);
}
