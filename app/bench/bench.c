// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/bench.h"

#include "app/bench/net/net.h"
#include "app/bench/net/train.h"
#include "app/bench/overlap/datagen.h"
#include "app/bench/overlap/overlap.h"
#include "app/bench/precision/precision.h"
#include "app/bench/scene/beam.h"
#include "app/bench/scene/drop.h"
#include "app/bench/scene/elements.h"
#include "app/bench/scene/ranks.h"
#include "app/bench/scene/scaling.h"
#include "app/bench/scene/scene.h"
#include "app/bench/scene/solver.h"
#include "app/bench/scene/step.h"
#include "app/bench/unseen/unseen.h"

static const AppCommand *const benches[] = {
    &app_bench_overlap,
    &app_bench_net,
    &app_bench_datagen,
    &app_bench_train,
    &app_bench_elements,
    &app_bench_solver,
    &app_bench_beam,
    &app_bench_scene,
    &app_bench_step,
    &app_bench_precision,
    &app_bench_scaling,
    &app_bench_ranks,
    &app_bench_drop,
    &app_bench_unseen,
    NULL,
};

const AppCommand app_bench_bench = {
    .name = "bench",
    .help = "measure overlap models and solvers",
    .children = benches,
    .child_word = "bench",
    .doc = "Measures how fast parts of the program and whole runs are.",
    .ending = "`tetlap bench BENCH --help` lists the options and the columns of a row.",
};
