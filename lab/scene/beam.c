// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/beam.h"

#include "app/bench/command.h"
#include "app/bench/report.h"
#include "app/cli/argument.h"
#include "base/memory.h"
#include "fem/sparse/solver.h"
#include "lab/scene/builtin.h"
#include "lab/scene/solvers.h"
#include "lab/trial.h"

typedef struct Options {
  AppBenchOptions common;
  bool wants_solver[LAB_SCENE_SOLVER_COUNT];
  int nodes, steps;
  double slenderness;
} Options;

static const struct argp_option option_table[] = {
    {"solver", 's', "NAME,...", 0, "Solvers to measure (default: all)", 1},
    {"nodes", 'n', "N", 0, "Vertices of the beam (default: 5000)", 1},
    {"slenderness", 'l', "RATIO", 0, "Length over thickness (default: 5)", 1},
    {"steps", 'k', "N", 0, "Steps of a run (default: 20)", 1},
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
    return 0;
  case 'n':
    options->nodes = (int)app_argument_number(state, "nodes", text, 24, 1e7);
    return 0;
  case 'l':
    options->slenderness = app_argument_number(state, "slenderness", text, 1, 1000);
    return 0;
  case 'k':
    options->steps = (int)app_argument_integer(state, "steps", text, 1, 1000000000);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Row {
  const char *solver;
  long long vertices, unknowns, steps, newton_iterations, factorisations, linear_solves, linear_iterations;
  double slenderness, wall, cpu, spread, ratio, end_time;
  double forces, assembly, analysis, factorisation, solve;
} Row;

static const AppBenchColumn columns[] = {
    {"solver", APP_BENCH_TEXT, offsetof(Row, solver), "solver", "linear solver"},
    {"vertices", APP_BENCH_INTEGER, offsetof(Row, vertices), "vertices", "vertices of the beam"},
    {"slenderness", APP_BENCH_NUMBER, offsetof(Row, slenderness), "L/d", "length over thickness of the beam"},
    {"unknowns", APP_BENCH_INTEGER, offsetof(Row, unknowns), NULL, "degrees of freedom that are not fixed"},
    {"steps", APP_BENCH_INTEGER, offsetof(Row, steps), "steps", "accepted steps"},
    {"newton_iterations", APP_BENCH_INTEGER, offsetof(Row, newton_iterations), "Newton", "Newton iterations"},
    {"factorisations", APP_BENCH_INTEGER, offsetof(Row, factorisations), "factorisations",
     "factorisations (pcg: preconditioners)"},
    {"linear_solves", APP_BENCH_INTEGER, offsetof(Row, linear_solves), NULL, "linear systems solved"},
    {"linear_iterations", APP_BENCH_INTEGER, offsetof(Row, linear_iterations), NULL,
     "iterations of an iterative solver"},
    {"end_time", APP_BENCH_NUMBER, offsetof(Row, end_time), "t s", "time reached [s]"},
    {"wall_s", APP_BENCH_NUMBER, offsetof(Row, wall), "wall s", "whole run"},
    {"cpu_s", APP_BENCH_NUMBER, offsetof(Row, cpu), "cpu s", "whole run"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), NULL, "of the wall time: (max − min) / median"},
    {"forces_s", APP_BENCH_NUMBER, offsetof(Row, forces), NULL, "wall time of the forces"},
    {"assembly_s", APP_BENCH_NUMBER, offsetof(Row, assembly), "assembly s", "wall time of assembly"},
    {"analysis_s", APP_BENCH_NUMBER, offsetof(Row, analysis), "analysis s", "wall time of analysis"},
    {"factorisation_s", APP_BENCH_NUMBER, offsetof(Row, factorisation), "factorisation s",
     "wall time of factorisation"},
    {"solve_s", APP_BENCH_NUMBER, offsetof(Row, solve), "solve s", "wall time of solution"},
    {"ratio", APP_BENCH_NUMBER, offsetof(Row, ratio), "ratio", "wall time over that of the first row"},
};
static const AppBenchReport report = {"beam", columns, sizeof columns / sizeof *columns, sizeof(Row), false};

static Row row_of(const LabTrial *trial, const Options *options) {
  int rounds = options->common.repeats;
  AppBenchTime time = app_bench_timer_time(&trial->timer, rounds);
  FemRunPhases phases = lab_trial_phases(trial, rounds);
  const FemRunResult *result = &trial->result;
  return (Row){.solver = result->solver_name,
               .vertices = trial->model.vertex_count,
               .slenderness = options->slenderness,
               .unknowns = trial->model.free_count,
               .steps = result->integrator.steps,
               .newton_iterations = result->integrator.newton_iterations,
               .factorisations = result->solver.factorisations,
               .linear_solves = result->solver.solves,
               .linear_iterations = result->solver.iterations,
               .wall = time.wall,
               .cpu = time.cpu,
               .spread = (time.wall_max - time.wall_min) / time.wall,
               .end_time = result->end_time,
               .forces = phases.forces,
               .assembly = phases.assembly,
               .analysis = phases.analysis,
               .factorisation = phases.factorisation,
               .solve = phases.solve};
}

static Status measure(LabTrial *trials, const Options *options) {
  int count = 0, rounds = options->common.repeats;
  for (int s = 0; s < LAB_SCENE_SOLVER_COUNT; s++) {
    if (!options->wants_solver[s]) continue;
    LabTrial *trial = &trials[count++];
    TRY(lab_scene_builtin_beam(options->nodes, options->slenderness, &trial->scene));
    trial->scene.solver = lab_scene_solvers[s];
    TRY(lab_trial_begin(trial, &options->common, options->steps));
  }
  TRY(app_bench_timer_take_turns(trials, sizeof *trials, count, rounds, false, lab_trial_run));
  Row rows[LAB_SCENE_SOLVER_COUNT];
  for (int t = 0; t < count; t++) {
    rows[t] = row_of(&trials[t], options);
    rows[t].ratio = rows[t].wall / rows[0].wall;
  }
  return app_bench_report_print(&report, &options->common, rows, count);
}

static Status run(const Options *options) {
  LabTrial *trials = memory_zeroed(LAB_SCENE_SOLVER_COUNT, sizeof *trials);
  if (!trials) return status_no_memory("the runs");
  Status status = measure(trials, options);
  for (int t = 0; t < LAB_SCENE_SOLVER_COUNT; t++) lab_trial_end(&trials[t]);
  memory_free(trials);
  return status;
}

static const struct argp argp = {.options = option_table,
                                 .parser = parse,
                                 .doc = "Measure the same run of a clamped beam with each linear solver.",
                                 .children = app_bench_command_children,
                                 .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = {.threads = 1, .repeats = 1},
                     .wants_solver = {true, true, true, true, true},
                     .nodes = 5000,
                     .slenderness = 5,
                     .steps = 20};
  app_bench_command_read(&lab_beam, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_beam = {.name = "beam",
                             .help = "linear solvers: a whole run of a beam",
                             .argp = &argp,
                             .run = run_command,
                             .has_threads = true,
                             .rows = &report,
                             .describe_rows = app_bench_command_rows};
