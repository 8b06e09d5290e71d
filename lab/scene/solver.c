// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/solver.h"

#include <math.h>
#include <omp.h>

#include "app/bench/command.h"
#include "app/bench/options.h"
#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/cli/argument.h"
#include "base/memory.h"
#include "fem/effect/system.h"
#include "fem/model/build.h"
#include "fem/sparse/solver.h"
#include "lab/scene/builtin.h"
#include "lab/scene/solvers.h"

// On more vertices the full system takes minutes and gigabytes: it is measured there only if it is asked for.
static const double LARGEST_KLU = 6000;
// How far the beam's end hangs down, as a share of its length.
static const double BEND = 0.05;

typedef struct Options {
  AppBenchOptions common;
  bool has_solvers, wants_solver[LAB_SCENE_SOLVER_COUNT];
  double nodes[APP_BENCH_MAX_LIST];
  int node_count;
  double slenderness;
  double step; // h [s]
} Options;

static const struct argp_option option_table[] = {
    {"solver", 's', "NAME,...", 0, "Solvers to measure (default: all; klu up to 6000 vertices)", 1},
    {"nodes", 'n', "N,...", 0, "Vertices of the beams (default: 5000,20000)", 1},
    {"slenderness", 'l', "RATIO", 0, "Length over thickness (default: 5)", 1},
    {"step", 'h', "SECONDS", 0, "Time step that the matrix belongs to (default: 0.005)", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 's':
    lab_scene_solvers_choose(state, text, options->wants_solver);
    options->has_solvers = true;
    return 0;
  case 'n':
    options->node_count = app_bench_options_numbers(state, "nodes", text, 24, 1e7, options->nodes);
    return 0;
  case 'h':
    options->step = app_argument_number(state, "step", text, 1e-9, 1e9);
    return 0;
  case 'l':
    options->slenderness = app_argument_number(state, "slenderness", text, 1, 1000);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

// The beam and its matrices at the bent state. Must not be moved: the model points at the scene.
typedef struct Beam {
  FemSceneDef scene;
  FemModel model;
  FemSystem system;
  FemState state; // bent
  double c;
  FemMatrix condensed, stiffness, damping;
  double *mass;     // of the unknowns                          (n)
  double *force;    // right side of the condensed system       (n)
  double *right;    // of the full system: 0, then force        (2n)
  double *residual; // scratch                                  (n)
} Beam;

typedef struct Contestant {
  Beam *beam; // borrowed
  const FemSolverOps *ops;
  void *solver;
  double *solution; //                                          (2n)
  double relative_residual;
  AppBenchTimer assembly, factorisation, solve, set_up_and_solve;
} Contestant;

// u_z = −BEND · x²/L: clamped where x = 0.
static void bend(const FemSystem *system, double *u) {
  const FemModel *model = system->model;
  double length = 0;
  for (int v = 0; v < model->vertex_count; v++) length = fmax(length, model->rest[3 * v]);
  for (int i = 0; i < system->numbering.count; i++) {
    int dof = system->numbering.dof_of_unknown[i];
    double x = model->rest[dof - dof % 3];
    u[i] = dof % 3 == 2 ? -BEND * x * x / length : 0;
  }
}

static Status fill_beam(Beam *beam) {
  const FemNumbering *numbering = &beam->system.numbering;
  size_t n = (size_t)numbering->count;
  double **arrays[] = {&beam->mass, &beam->force, &beam->right, &beam->residual};
  for (int i = 0; i < 4; i++)
    if (!(*arrays[i] = memory_zeroed(2 * n, sizeof(double)))) return status_no_memory("the beam");
  TRY(fem_matrix_copy_layout(&beam->condensed, &beam->system.matrix));
  TRY(fem_matrix_copy_layout(&beam->stiffness, &beam->system.matrix));
  TRY(fem_matrix_copy_layout(&beam->damping, &beam->system.matrix));
  double *u = beam->residual;
  bend(&beam->system, u);
  TRY(fem_system_create_state(&beam->system, &beam->state));
  fem_system_scatter(&beam->system, 0, u, NULL, &beam->state);
  TRY(fem_system_forces(&beam->system, &beam->state));
  for (size_t i = 0; i < n; i++) {
    beam->mass[i] = beam->model.mass[numbering->dof_of_unknown[i] / 3];
    beam->force[i] = beam->right[n + i] = beam->system.forces[numbering->dof_of_unknown[i]];
  }
  return fem_system_assemble(&beam->system, &beam->state, 1, beam->c, beam->c * beam->c, &beam->condensed);
}

static Status make_beam(Beam *beam, int nodes, const Options *options) {
  TRY(lab_scene_builtin_beam(nodes, options->slenderness, &beam->scene));
  beam->c = 1.5 / options->step;
  TRY(fem_model_create(&beam->model, &beam->scene));
  TRY(fem_system_create(&beam->system, &beam->model));
  return fill_beam(beam);
}

static void destroy_beam(Beam *beam) {
  fem_matrix_destroy(&beam->condensed), fem_matrix_destroy(&beam->stiffness);
  fem_matrix_destroy(&beam->damping);
  fem_state_destroy(&beam->state);
  fem_system_destroy(&beam->system);
  fem_model_destroy(&beam->model);
  fem_scene_destroy(&beam->scene);
  memory_free(beam->mass), memory_free(beam->force);
  memory_free(beam->right), memory_free(beam->residual);
}

// What a Newton set-up assembles: D, and S or K.
static Status assemble(Contestant *contestant) {
  Beam *beam = contestant->beam;
  TRY(fem_system_assemble(&beam->system, &beam->state, 0, 1, 0, &beam->damping));
  if (contestant->ops->is_condensed)
    return fem_system_assemble(&beam->system, &beam->state, 1, beam->c, beam->c * beam->c, &beam->condensed);
  return fem_system_assemble(&beam->system, &beam->state, 1, 0, 0, &beam->stiffness);
}

static Status factorise(Contestant *contestant) {
  Beam *beam = contestant->beam;
  if (contestant->ops->is_condensed)
    return contestant->ops->factorise(contestant->solver, &beam->condensed, NULL, NULL, beam->c);
  return contestant->ops->factorise(contestant->solver, &beam->stiffness, &beam->damping, beam->mass,
                                    beam->c);
}

// The full system with r₁ = 0 has the condensed one's solution in its first half.
static Status solve(Contestant *contestant) {
  const Beam *beam = contestant->beam;
  return contestant->ops->solve(contestant->solver, contestant->ops->is_condensed ? beam->force : beam->right,
                                contestant->solution);
}

// ‖S x − b‖ / ‖b‖
static double residual_of(const Contestant *contestant) {
  const Beam *beam = contestant->beam;
  double error = 0, size = 0;
  fem_matrix_multiply(&beam->condensed, contestant->solution, beam->residual);
  for (int i = 0; i < beam->model.free_count; i++) {
    error += (beam->residual[i] - beam->force[i]) * (beam->residual[i] - beam->force[i]);
    size += beam->force[i] * beam->force[i];
  }
  return sqrt(error / size);
}

static Status measure(Contestant *contestant, int round) {
  app_bench_timer_start(&contestant->assembly);
  TRY(assemble(contestant));
  app_bench_timer_stop(&contestant->assembly, round, 1);
  if (contestant->ops->forget) contestant->ops->forget(contestant->solver);
  app_bench_timer_start(&contestant->set_up_and_solve);
  app_bench_timer_start(&contestant->factorisation);
  TRY(factorise(contestant));
  app_bench_timer_stop(&contestant->factorisation, round, 1);
  app_bench_timer_start(&contestant->solve);
  TRY(solve(contestant));
  app_bench_timer_stop(&contestant->solve, round, 1);
  app_bench_timer_stop(&contestant->set_up_and_solve, round, 1);
  contestant->relative_residual = residual_of(contestant);
  return STATUS_OK;
}

static Status take_turn(void *self, int round) {
  Contestant *contestant = self;
  Status status = measure(contestant, round);
  return status ? status_prefix(status, "%s", contestant->ops->name) : STATUS_OK;
}

typedef struct Row {
  const char *solver;
  long long vertices, unknowns, iterations;
  double slenderness, step, assembly, analysis, factorisation, solve, set_up_and_solve, set_up_and_solve_cpu,
      spread;
  double factor_entries, residual;
} Row;

static const AppBenchColumn columns[] = {
    {"solver", APP_BENCH_TEXT, offsetof(Row, solver), "solver", "linear solver"},
    {"vertices", APP_BENCH_INTEGER, offsetof(Row, vertices), "vertices", "vertices of the beam"},
    {"slenderness", APP_BENCH_NUMBER, offsetof(Row, slenderness), "L/d", "length over thickness of the beam"},
    {"unknowns", APP_BENCH_INTEGER, offsetof(Row, unknowns), "unknowns",
     "n; the condensed system has n rows, the full one 2n"},
    {"step", APP_BENCH_NUMBER, offsetof(Row, step), NULL, "time step that the matrix belongs to [s]"},
    {"analysis_s", APP_BENCH_NUMBER, offsetof(Row, analysis), "analysis s", "analysis of the layout, once"},
    {"assembly_s", APP_BENCH_NUMBER, offsetof(Row, assembly), "assembly s", "the matrices of one set-up"},
    {"factorisation_s", APP_BENCH_NUMBER, offsetof(Row, factorisation), "factorisation s",
     "new numbers in the analysed layout"},
    {"solve_s", APP_BENCH_NUMBER, offsetof(Row, solve), "solve s", "one right side"},
    {"setup_solve_s", APP_BENCH_NUMBER, offsetof(Row, set_up_and_solve), "set-up + solve s",
     "factorisation and solution, one after the other"},
    {"setup_solve_cpu_s", APP_BENCH_NUMBER, offsetof(Row, set_up_and_solve_cpu), "cpu s",
     "processor time of both"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), "spread", "of both: (max − min) / median"},
    {"factor_entries", APP_BENCH_COUNT, offsetof(Row, factor_entries), "factor entries",
     "numbers in the factor"},
    {"iterations", APP_BENCH_INTEGER, offsetof(Row, iterations), "iterations",
     "of a solution, if the solver iterates"},
    {"residual", APP_BENCH_NUMBER, offsetof(Row, residual), "residual",
     "‖S x − b‖ / ‖b‖ of the condensed system"},
};
static const AppBenchReport report = {"solver", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      false};

static Row row_of(const Contestant *contestant, const Options *options) {
  int rounds = options->common.repeats;
  AppBenchTime both = app_bench_timer_time(&contestant->set_up_and_solve, rounds);
  const FemSolverStats *stats = contestant->ops->stats(contestant->solver);
  return (Row){.solver = contestant->ops->name,
               .vertices = contestant->beam->model.vertex_count,
               .slenderness = options->slenderness,
               .unknowns = contestant->beam->model.free_count,
               .iterations = stats->iterations / stats->solves,
               .step = options->step,
               .assembly = app_bench_timer_time(&contestant->assembly, rounds).wall,
               .analysis = stats->analyse_s,
               .factorisation = app_bench_timer_time(&contestant->factorisation, rounds).wall,
               .solve = app_bench_timer_time(&contestant->solve, rounds).wall,
               .set_up_and_solve = both.wall,
               .set_up_and_solve_cpu = both.cpu,
               .spread = (both.wall_max - both.wall_min) / both.wall,
               .factor_entries = stats->factor_entries,
               .residual = contestant->relative_residual};
}

// One beam and the solvers that are measured on it.
typedef struct Bench {
  Beam beam;
  Contestant contestants[LAB_SCENE_SOLVER_COUNT];
  int contestant_count;
} Bench;

static Status add_contestant(Bench *bench, FemSolverKind kind, const Options *options) {
  Contestant *contestant = &bench->contestants[bench->contestant_count];
  *contestant = (Contestant){.beam = &bench->beam, .ops = fem_solver_ops(kind)};
  contestant->solution = memory_zeroed(2 * (size_t)bench->beam.model.free_count, sizeof(double));
  if (!contestant->solution) return status_no_memory("a solution");
  bench->contestant_count++;
  TRY(contestant->ops->create(&contestant->solver, options->common.threads,
                              fem_solver_tolerance(contestant->ops, bench->beam.scene.solver_tolerance)));
  return contestant->ops->analyse(contestant->solver, &bench->beam.condensed);
}

static bool is_wanted(int solver, double nodes, const Options *options) {
  if (options->has_solvers) return options->wants_solver[solver];
  return lab_scene_solvers[solver] != FEM_SOLVER_KLU || nodes <= LARGEST_KLU;
}

static Status measure_beam(Bench *bench, double nodes, const Options *options, Row *rows, int *row_count) {
  TRY(make_beam(&bench->beam, (int)nodes, options));
  for (int s = 0; s < LAB_SCENE_SOLVER_COUNT; s++)
    if (is_wanted(s, nodes, options)) TRY(add_contestant(bench, lab_scene_solvers[s], options));
  TRY(app_bench_timer_take_turns(bench->contestants, sizeof *bench->contestants, bench->contestant_count,
                                 options->common.repeats, true, take_turn));
  for (int c = 0; c < bench->contestant_count; c++)
    rows[(*row_count)++] = row_of(&bench->contestants[c], options);
  return STATUS_OK;
}

static void destroy(Bench *bench) {
  for (int c = 0; c < bench->contestant_count; c++) {
    bench->contestants[c].ops->destroy(bench->contestants[c].solver);
    memory_free(bench->contestants[c].solution);
  }
  destroy_beam(&bench->beam);
  memory_free(bench);
}

static Status run(const Options *options) {
  Row rows[LAB_SCENE_SOLVER_COUNT * APP_BENCH_MAX_LIST];
  int row_count = 0;
  Status status = STATUS_OK;
  omp_set_num_threads(options->common.threads);
  for (int i = 0; i < options->node_count && status == STATUS_OK; i++) {
    Bench *bench = memory_zeroed(1, sizeof *bench);
    if (!bench) return status_no_memory("the bench");
    status = measure_beam(bench, options->nodes[i], options, rows, &row_count);
    destroy(bench);
  }
  return status ? status : app_bench_report_print(&report, &options->common, rows, row_count);
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc = "Measure what the linear solvers take for a Newton set-up and a solution of a clamped beam.",
    .children = app_bench_command_children,
    .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = {.threads = 1, .repeats = 5},
                     .nodes = {5000, 20000},
                     .node_count = 2,
                     .slenderness = 5,
                     .step = 0.005};
  app_bench_command_read(&lab_solver, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_solver = {.name = "solver",
                               .help = "linear solvers: set-up and solution of a beam",
                               .argp = &argp,
                               .run = run_command,
                               .has_threads = true,
                               .rows = &report,
                               .describe_rows = app_bench_command_rows};
