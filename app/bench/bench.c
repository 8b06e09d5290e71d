// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/bench.h"

#include <stdio.h>
#include <string.h>

#include "app/bench/beam.h"
#include "app/bench/datagen.h"
#include "app/bench/drop.h"
#include "app/bench/net.h"
#include "app/bench/overlap.h"
#include "app/bench/precision.h"
#include "app/bench/scaling.h"
#include "app/bench/scene.h"
#include "app/bench/solver.h"
#include "app/bench/step.h"
#include "app/bench/train.h"
#include "base/log.h"
#include "base/status.h"
#include "base/text.h"

typedef struct Bench {
  const char *name;
  const char *help;
  int (*run)(int argument_count, char **arguments);
} Bench;

static const Bench benches[] = {
    {"overlap", "overlap models: pairs of tetrahedra a second", app_bench_overlap_run},
    {"net", "networks alone, beside PyTorch: samples a second", app_bench_net_run},
    {"datagen", "labelled pairs a second", app_bench_datagen_run},
    {"train", "training, beside PyTorch: samples a second", app_bench_train_run},
    {"solver", "linear solvers: set-up and solution of a beam", app_bench_solver_run},
    {"beam", "linear solvers: a whole run of a beam", app_bench_beam_run},
    {"scene", "whole runs of scenes", app_bench_scene_run},
    {"step", "where the time of a run goes", app_bench_step_run},
    {"precision", "error of whole runs against their time, over tolerances and mesh levels",
     app_bench_precision_run},
    {"scaling", "how time grows with pairs and with vertices", app_bench_scaling_run},
    {"drop", "energy gain of a drop, over contact stiffness", app_bench_drop_run},
};
enum { BENCH_COUNT = sizeof benches / sizeof *benches };

static void print_benches(FILE *stream) {
  fputs("usage: tetlap bench NAME [OPTION…]\n\n", stream);
  for (int i = 0; i < BENCH_COUNT; i++) fprintf(stream, "  %-9s %s\n", benches[i].name, benches[i].help);
  fputs("\n`tetlap bench NAME --help` tells the options and what a row holds.\n", stream);
}

static int fail_unknown(const char *name) {
  TextGuess guess = text_guess_of(name);
  for (int i = 0; i < BENCH_COUNT; i++) text_guess_offer(&guess, benches[i].name);
  if (guess.best)
    log_error("unknown bench '%s'; did you mean '%s'?", name, guess.best);
  else
    log_error("unknown bench '%s'; `tetlap bench` lists the benches", name);
  return status_exit_code(STATUS_USAGE);
}

// Runs a bench as `tetlap bench NAME`: that is how its usage lines call it.
int app_bench_run(int argument_count, char **arguments) {
  if (argument_count < 2) {
    print_benches(stderr);
    return status_exit_code(STATUS_USAGE);
  }
  const char *name = arguments[1];
  if (text_lists("-h -? --help", name)) {
    print_benches(stdout);
    return 0;
  }
  for (int i = 0; i < BENCH_COUNT; i++) {
    if (strcmp(benches[i].name, name) != 0) continue;
    char called[128];
    snprintf(called, sizeof called, "%s %s", arguments[0], name);
    arguments[1] = called;
    return benches[i].run(argument_count - 1, arguments + 1);
  }
  return fail_unknown(name);
}
