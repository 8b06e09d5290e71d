// SPDX-License-Identifier: GPL-3.0-or-later
// Condensed system by a supernodal Cholesky factorisation: CHOLMOD orders and analyses, the numbers are those
// of front/factor.h. Unknowns of one vertex have the same neighbours, so all of the analysis is done on the
// graph of vertices (a third of the nodes, a ninth of the edges).
//
// CHOLMOD's own numbers would not be the same on any number of threads: OpenBLAS divides its work by their
// number, and the last bits of a factor with it. On one thread it would have one core.
#include "fem/sparse/solver.h"

#include <string.h>
#include <suitesparse/cholmod.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/sparse/front/factor.h"
#include "fem/sparse/vector.h"

// Smaller graphs are ordered by minimum degree: nested dissection gains nothing there.
enum { SMALL_GRAPH = 300 };

// CHOLMOD's own 4, 16 and 48 columns of small fronts that are joined, for nodes of three.
static const size_t FEW_COLUMNS[3] = {2, 6, 16};

// The order of elimination of an earlier pattern is kept as long as the factor that it gives has at most this
// much more entries than the one it was made for. Contacts come and go, and few of them change the best
// order.
static const double KEPT_FILL = 1.05;

typedef struct CholmodSolver {
  cholmod_common common;
  FemFrontTree tree;
  FemFrontFactor factor;
  int *order;        // of the vertices, kept                                (order_count)
  int order_count;   // 0: none
  double order_fill; // entries of the factor that it was made for
  long long layout;  // that was analysed; 0: none
  bool is_factorised;
  bool is_rough; // solutions serve as a preconditioner only
  FemSolverStats stats;
} CholmodSolver;

static Status fail_in(const CholmodSolver *solver, const char *what) {
  int status = solver->common.status;
  if (status == CHOLMOD_OUT_OF_MEMORY)
    return status_no_memory("the factor of the condensed system (try solver.linear: pcg)");
  if (status == CHOLMOD_TOO_LARGE)
    return status_fail(STATUS_SOLVER,
                       "cholmod: the factor is too large to be numbered: use solver.linear: pcg");
  return status_fail(STATUS_SOLVER, "cholmod: %s failed with status %d", what, status);
}

static Status create(void **self, int threads, double tolerance) {
  (void)threads, (void)tolerance;
  CholmodSolver *solver = memory_zeroed(1, sizeof *solver);
  *self = solver;
  if (!solver) return status_no_memory("the solver cholmod");
  cholmod_common *common = &solver->common;
  cholmod_start(common);
  common->print = 0;
  common->error_handler = NULL;
  common->supernodal = CHOLMOD_SUPERNODAL;
  common->final_ll = 1;
  common->quick_return_if_not_posdef = 1;
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_GIVEN;
  common->postorder = 1;
  for (int k = 0; k < 3; k++) common->nrelax[k] = FEW_COLUMNS[k];
  return STATUS_OK;
}

// Its memory is kept.
static void forget_factor(CholmodSolver *solver) {
  fem_front_tree_destroy(&solver->tree);
  solver->layout = 0;
  solver->is_factorised = false;
}

static void destroy(void *self) {
  CholmodSolver *solver = self;
  if (!solver) return;
  forget_factor(solver);
  fem_front_factor_destroy(&solver->factor);
  cholmod_finish(&solver->common);
  memory_free(solver->order);
  memory_free(solver);
}

// The graph of vertices that have unknowns, numbered anew: lower triangle with diagonal.
typedef struct VertexGraph {
  int node_count;
  int *begin; //                                (node_count + 1)
  int *row;   //                                (begin[node_count])
  int *first; // first unknown of each node     (node_count + 1)
  int *order; // node at each place             (node_count)
} VertexGraph;

static void free_graph(VertexGraph *graph) {
  memory_free(graph->begin), memory_free(graph->row), memory_free(graph->first);
  memory_free(graph->order);
  *graph = (VertexGraph){0};
}

// Nodes, and for each unknown the node it belongs to, in `node_of_unknown`.
static void number_nodes(const FemMatrix *matrix, VertexGraph *graph, int *node_of_unknown) {
  int unknown = 0;
  for (int v = 0; v < matrix->vertex_count; v++) {
    int before = unknown;
    for (int c = 0; c < 3; c++)
      if (matrix->unknown_of_dof[3 * v + c] >= 0) node_of_unknown[unknown++] = graph->node_count;
    if (unknown > before) graph->first[graph->node_count++] = before;
  }
  graph->first[graph->node_count] = unknown;
}

// Each node's first column holds all its neighbours, one run of rows for each.
static int list_edges(const FemMatrix *matrix, const VertexGraph *graph, const int *node_of_unknown,
                      int *begin, int *row) {
  int end = 0;
  for (int node = 0; node < graph->node_count; node++) {
    int column = graph->first[node], last = -1;
    if (begin) begin[node] = end;
    for (int k = matrix->col_begin[column]; k < matrix->col_begin[column + 1]; k++) {
      int other = node_of_unknown[matrix->row[k]];
      if (other == last) continue;
      if (row) row[end] = other;
      end++;
      last = other;
    }
  }
  if (begin) begin[graph->node_count] = end;
  return end;
}

static Status build_graph(const FemMatrix *matrix, VertexGraph *graph, int *node_of_unknown) {
  size_t size = (size_t)matrix->size;
  graph->first = memory_zeroed(size + 1, sizeof *graph->first);
  graph->begin = memory_zeroed(size + 1, sizeof *graph->begin);
  graph->order = memory_zeroed(size, sizeof *graph->order);
  if (!graph->first || !graph->begin || !graph->order) return status_no_memory("the graph of the matrix");
  number_nodes(matrix, graph, node_of_unknown);
  int edge_count = list_edges(matrix, graph, node_of_unknown, NULL, NULL);
  graph->row = memory_zeroed((size_t)edge_count, sizeof *graph->row);
  if (!graph->row) return status_no_memory("the graph of the matrix");
  list_edges(matrix, graph, node_of_unknown, graph->begin, graph->row);
  return STATUS_OK;
}

// Our arrays as CHOLMOD sees them; nothing is copied.
static cholmod_sparse view(const VertexGraph *graph) {
  size_t count = (size_t)graph->node_count;
  return (cholmod_sparse){.nrow = count,
                          .ncol = count,
                          .nzmax = (size_t)graph->begin[count],
                          .p = graph->begin,
                          .i = graph->row,
                          .stype = -1,
                          .itype = CHOLMOD_INT,
                          .xtype = CHOLMOD_PATTERN,
                          .dtype = CHOLMOD_DOUBLE,
                          .sorted = 1,
                          .packed = 1};
}

static Status order_graph(CholmodSolver *solver, VertexGraph *graph) {
  cholmod_sparse pattern = view(graph);
  int is_ok = graph->node_count < SMALL_GRAPH
                  ? cholmod_amd(&pattern, NULL, 0, graph->order, &solver->common)
                  : cholmod_metis(&pattern, NULL, 0, 1, graph->order, &solver->common);
  return is_ok ? STATUS_OK : fail_in(solver, "ordering");
}

static Status make_graph(const FemMatrix *matrix, VertexGraph *graph) {
  int *node_of_unknown = memory_zeroed((size_t)matrix->size, sizeof *node_of_unknown);
  if (!node_of_unknown) return status_no_memory("the graph of the matrix");
  Status status = build_graph(matrix, graph, node_of_unknown);
  memory_free(node_of_unknown);
  return status;
}

static Status find_fronts(CholmodSolver *solver, const VertexGraph *graph, cholmod_factor **symbolic) {
  cholmod_sparse pattern = view(graph);
  *symbolic = cholmod_analyze_p(&pattern, graph->order, NULL, 0, &solver->common);
  return *symbolic ? STATUS_OK : fail_in(solver, "analysis");
}

// NULL: there is no order of that many vertices, or it is no longer good.
static Status find_fronts_by_kept(CholmodSolver *solver, VertexGraph *graph, cholmod_factor **symbolic) {
  *symbolic = NULL;
  if (solver->order_count == 0 || solver->order_count != graph->node_count) return STATUS_OK;
  memcpy(graph->order, solver->order, (size_t)graph->node_count * sizeof *graph->order);
  TRY(find_fronts(solver, graph, symbolic));
  if (!(solver->common.lnz <= KEPT_FILL * solver->order_fill)) cholmod_free_factor(symbolic, &solver->common);
  return STATUS_OK;
}

static Status find_fronts_anew(CholmodSolver *solver, VertexGraph *graph, cholmod_factor **symbolic) {
  TRY(order_graph(solver, graph));
  TRY(find_fronts(solver, graph, symbolic));
  memory_free(solver->order);
  solver->order_count = 0;
  solver->order = memory_copy(graph->order, (size_t)graph->node_count, sizeof *graph->order);
  if (!solver->order) {
    cholmod_free_factor(symbolic, &solver->common);
    return status_no_memory("the order of elimination");
  }
  solver->order_count = graph->node_count;
  solver->order_fill = solver->common.lnz;
  solver->stats.orders++;
  return STATUS_OK;
}

static Status build_tree(CholmodSolver *solver, const FemMatrix *matrix, VertexGraph *graph) {
  cholmod_factor *symbolic;
  TRY(find_fronts_by_kept(solver, graph, &symbolic));
  if (!symbolic) TRY(find_fronts_anew(solver, graph, &symbolic));
  FemFrontDef def = {.node_count = graph->node_count,
                     .first = graph->first,
                     .begin = graph->begin,
                     .row = graph->row,
                     .col_begin = matrix->col_begin,
                     .order = symbolic->Perm,
                     .front_count = (int)symbolic->nsuper,
                     .place = symbolic->super,
                     .row_begin = symbolic->pi,
                     .rows = symbolic->s};
  Status status = fem_front_tree_create(&solver->tree, &def);
  cholmod_free_factor(&symbolic, &solver->common);
  return status;
}

static Status analyse_matrix(CholmodSolver *solver, const FemMatrix *matrix) {
  VertexGraph graph = {0};
  Status status = make_graph(matrix, &graph);
  if (status == STATUS_OK) status = build_tree(solver, matrix, &graph);
  free_graph(&graph);
  TRY(status);
  return fem_front_factor_lay_out(&solver->factor, &solver->tree, solver->is_rough);
}

static Status analyse(void *self, const FemMatrix *pattern) {
  CholmodSolver *solver = self;
  double began = clock_wall_s();
  forget_factor(solver);
  TRY(analyse_matrix(solver, pattern));
  solver->layout = pattern->layout;
  solver->stats.analyses++;
  solver->stats.factor_entries = solver->tree.entry_count;
  solver->stats.analyse_s += clock_wall_s() - began;
  return STATUS_OK;
}

static Status refactor(CholmodSolver *solver, const FemMatrix *matrix) {
  if (!fem_vector_is_finite(matrix->entry_count, matrix->value))
    return status_fail(STATUS_RETRY, "the condensed matrix is not finite");
  return fem_front_factor_make(&solver->factor, matrix->value);
}

static Status factorise(void *self, const FemMatrix *stiffness, const FemMatrix *damping,
                        const double *mass_of_unknown, double c) {
  CholmodSolver *solver = self;
  (void)damping, (void)mass_of_unknown, (void)c;
  if (solver->layout == 0 || stiffness->layout != solver->layout)
    return status_fail(STATUS_SOLVER, "cholmod: this layout of the matrix has not been analysed");
  double began = clock_wall_s();
  Status status = refactor(solver, stiffness);
  solver->is_factorised = status == STATUS_OK;
  if (status == STATUS_OK)
    solver->stats.factorisations++;
  else
    solver->stats.failed_factorisations++;
  solver->stats.factorise_s += clock_wall_s() - began;
  return status;
}

static Status solve(void *self, const double *b, double *x) {
  CholmodSolver *solver = self;
  if (!solver->is_factorised) return status_fail(STATUS_SOLVER, "cholmod: no factor to solve with");
  double began = clock_wall_s();
  if (solver->is_rough)
    fem_front_factor_solve_roughly(&solver->factor, b, x);
  else
    fem_front_factor_solve(&solver->factor, b, x);
  solver->stats.solves++;
  solver->stats.solve_s += clock_wall_s() - began;
  if (!fem_vector_is_finite(solver->tree.size, x))
    return status_fail(STATUS_RETRY, "the solution of the condensed system is not finite");
  return STATUS_OK;
}

// Without exchanges of rows, as CHOLMOD factorises: signs are right as long as no pivot is near zero.
static Status count_pivots(const FemMatrix *matrix, cholmod_common *common, int *count) {
  cholmod_sparse lower = {.nrow = (size_t)matrix->size,
                          .ncol = (size_t)matrix->size,
                          .nzmax = (size_t)matrix->entry_count,
                          .p = matrix->col_begin,
                          .i = matrix->row,
                          .x = matrix->value,
                          .stype = -1,
                          .itype = CHOLMOD_INT,
                          .xtype = CHOLMOD_REAL,
                          .dtype = CHOLMOD_DOUBLE,
                          .sorted = 1,
                          .packed = 1};
  cholmod_factor *factor = cholmod_analyze(&lower, common);
  bool is_made = factor && cholmod_factorize(&lower, factor, common) && common->status == CHOLMOD_OK;
  *count = 0;
  for (int j = 0; j < matrix->size && is_made; j++)
    *count += ((const double *)factor->x)[((const int *)factor->p)[j]] < 0;
  cholmod_free_factor(&factor, common);
  return is_made ? STATUS_OK : status_fail(STATUS_RETRY, "the pivots of the matrix cannot be counted");
}

static Status count_negative(const FemMatrix *matrix, int *count) {
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  common.error_handler = NULL;
  common.supernodal = CHOLMOD_SIMPLICIAL;
  common.final_ll = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_AMD;
  Status status = count_pivots(matrix, &common, count);
  cholmod_finish(&common);
  return status;
}

// The graph of a pattern whose vertices have one unknown each.
static Status copy_pattern(const FemPattern *pattern, VertexGraph *graph) {
  const int nodes = graph->node_count = fem_pattern_vertex_count(pattern);
  int count, end = 0;
  for (int v = 0; v < nodes; v++) {
    fem_pattern_above(pattern, v, &count);
    end += count + 1;
  }
  graph->begin = memory_zeroed((size_t)nodes + 1, sizeof *graph->begin);
  graph->row = memory_zeroed((size_t)end, sizeof *graph->row);
  graph->order = memory_zeroed((size_t)nodes, sizeof *graph->order);
  if (!graph->begin || !graph->row || !graph->order) return status_no_memory("the graph of the mesh");
  end = 0;
  for (int v = 0; v < nodes; v++) {
    const int *above = fem_pattern_above(pattern, v, &count);
    graph->begin[v] = end;
    graph->row[end++] = v;
    for (int k = 0; k < count; k++) graph->row[end++] = above[k];
  }
  graph->begin[nodes] = end;
  return STATUS_OK;
}

static Status count_work(CholmodSolver *solver, const FemPattern *pattern, VertexGraph *graph, double *work) {
  cholmod_factor *symbolic;
  TRY(copy_pattern(pattern, graph));
  TRY(order_graph(solver, graph));
  TRY(find_fronts(solver, graph, &symbolic));
  *work = solver->common.fl;
  cholmod_free_factor(&symbolic, &solver->common);
  return STATUS_OK;
}

Status fem_solver_factor_work(const FemPattern *pattern, double *work) {
  void *solver;
  VertexGraph graph = {0};
  Status status = create(&solver, 1, 0);
  if (!status) status = count_work(solver, pattern, &graph, work);
  free_graph(&graph);
  destroy(solver);
  return status;
}

static void be_rough(void *self) {
  ((CholmodSolver *)self)->is_rough = true;
}

static const FemSolverStats *stats(const void *self) {
  return &((const CholmodSolver *)self)->stats;
}

const FemSolverOps fem_solver_cholmod = {
    .name = "cholmod",
    .help = "condensed system, supernodal Cholesky factorisation (CHOLMOD)",
    .is_condensed = true,
    .create = create,
    .analyse = analyse,
    .factorise = factorise,
    .solve = solve,
    .be_rough = be_rough,
    .count_negative = count_negative,
    .destroy = destroy,
    .stats = stats,
};
