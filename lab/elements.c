// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab elements`: forces and matrices of elements in vector lanes beside one element at a time, for
// every law and both kinds of elements, on one thread.
#include "lab/program.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/cli/parse.h"
#include "app/scene/read.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/effect/elements/packs.h"
#include "fem/model/build.h"

enum { TEXT_SIZE = 1024, KINDS = 2, MATERIALS = FEM_MATERIAL_LAW_COUNT + 1 };
// What is measured of each material and kind; damping does not go by the law and is measured of one.
typedef enum What { FORCE, MATRIX, DAMPING_FORCE, DAMPING_MATRIX, WHAT_COUNT } What;
static const char *const whats[WHAT_COUNT] = {"force", "matrix", "damping force", "damping matrix"};
static const char *const kinds[KINDS] = {"linear", "quadratic"};
enum { MAX_ROWS = KINDS * (2 * MATERIALS + 2) };
static const double BETA = 1e-3;

typedef struct Options {
  AppBenchOptions common;
  int passes;
} Options;

static const AppOption option_table[] = {
    {"passes", 'p', "N", "Passes over the elements a round (default: 20)", 1, CLI_INTEGER,
     CLI_TO(Options, passes), 1, 1000000},
    {.table = app_bench_options, .offset = offsetof(Options, common)},
    {0},
};

// A block of one kind of elements, bent out of shape and moving.
typedef struct Block {
  FemSceneDef scene;
  FemModel model;
  FemPacks packs;
  FemElement *elements; // one by one, as many as there are tetrahedra
  double *positions, *velocities;
} Block;

typedef struct Contestant {
  const Block *block;
  FemMaterial material;
  What what;
  bool is_in_lanes;
  int passes;
  AppBenchTimer timer; // of an element
} Contestant;

typedef struct Bench {
  const Options *options;
  Block blocks[KINDS];
  Contestant contestants[2 * MAX_ROWS]; // one by one, in lanes, in turns
  int count;
} Bench;

static Status block_create(Block *block, int kind) {
  static const double amount = 0.03; // of an edge
  char text[TEXT_SIZE];
  int cells = kind == 0 ? 7 : 3;
  snprintf(text, sizeof text,
           "bodies:\n"
           "  - name: block\n"
           "    element: %s\n"
           "    mesh: {box: {size: [%d, %d, %d], cells: %d}}\n"
           "    material: {young: 1e6, poisson: 0.45, density: 1000}\n"
           "time: {end: 1}\n",
           kinds[kind], cells, cells, cells, cells);
  TRY(app_scene_read_text("(block)", text, strlen(text), &block->scene));
  TRY(fem_model_create(&block->model, &block->scene));
  TRY(fem_packs_create(&block->packs, &block->model, kind == 1, NULL));
  int count = 3 * block->model.vertex_count;
  block->elements = memory_zeroed((size_t)block->model.tet_count, sizeof *block->elements);
  block->positions = memory_zeroed((size_t)count, sizeof(double));
  block->velocities = memory_zeroed((size_t)count, sizeof(double));
  if (!block->elements || !block->positions || !block->velocities) return status_no_memory("the block");
  for (int e = 0; e < block->model.tet_count; e++) block->elements[e] = fem_model_element(&block->model, e);
  Random random = random_seeded(1, 0);
  for (int k = 0; k < count; k++) {
    block->positions[k] = block->model.rest[k] + amount * random_between(&random, -1, 1);
    block->velocities[k] = random_between(&random, -1, 1);
  }
  return STATUS_OK;
}

static void block_destroy(Block *block) {
  memory_free(block->elements), memory_free(block->positions), memory_free(block->velocities);
  fem_packs_destroy(&block->packs);
  fem_model_destroy(&block->model);
  fem_scene_destroy(&block->scene);
}

static void gather(const Block *block, const int *nodes, int count, double *x, double *v) {
  for (int a = 0; a < count; a++)
    for (int c = 0; c < 3; c++) {
      x[3 * a + c] = block->positions[3 * (size_t)nodes[a] + (size_t)c];
      v[3 * a + c] = block->velocities[3 * (size_t)nodes[a] + (size_t)c];
    }
}

static void pass_linear(const Contestant *contestant, const FemMaterial *material) {
  const FemModel *model = &contestant->block->model;
  for (int e = 0; e < model->tet_count; e++) {
    const FemElement *element = &contestant->block->elements[e];
    double x[12], v[12], own[144];
    gather(contestant->block, model->tets[e], 4, x, v);
    switch (contestant->what) {
    case FORCE:
      fem_element_force(element, material, x, own);
      break;
    case MATRIX:
      fem_element_stiffness(element, material, x, own);
      break;
    case DAMPING_FORCE:
      fem_element_damping_force(element, material, BETA, x, v, own);
      break;
    default:
      fem_element_damping_matrix(element, material, BETA, x, own);
      fem_element_damping_stiffness(element, material, BETA, x, v, own);
    }
  }
}

static void pass_quadratic(const Contestant *contestant, FemQuadraticLaw law) {
  const FemModel *model = &contestant->block->model;
  for (int e = 0; e < model->quadratic_count; e++) {
    const FemQuadratic *element = &model->quadratics[e];
    double x[30], v[30], own[900];
    gather(contestant->block, model->quadratic_nodes[e], FEM_QUADRATIC_NODES, x, v);
    switch (contestant->what) {
    case FORCE:
      fem_quadratic_force(element, law, x, own);
      break;
    case MATRIX:
      fem_quadratic_stiffness(element, law, x, own);
      break;
    case DAMPING_FORCE:
      fem_quadratic_damping_force(element, law.local, BETA, x, v, own);
      break;
    default:
      fem_quadratic_damping_matrix(element, law.local, BETA, x, v, 1, 1, own);
    }
  }
}

static void pass_linear_lanes(const Contestant *contestant, const FemMaterial *material) {
  const FemLanes *lanes = fem_lanes();
  const Block *block = contestant->block;
  FemLanesRow own[FEM_LANES_ENTRIES];
  for (int p = 0; p < block->packs.pack_count; p++) {
    const FemLanesElements *e = &block->packs.packs[p];
    switch (contestant->what) {
    case FORCE:
      lanes->force(material, e, block->positions, own);
      break;
    case MATRIX:
      lanes->matrix(material, e, block->positions, 1, own);
      break;
    case DAMPING_FORCE:
      lanes->damping_force(material, BETA, e, block->positions, block->velocities, own);
      break;
    default:
      lanes->damping_matrix(material, BETA, e, block->positions, block->velocities, 1, 1, own);
    }
  }
}

static void pass_quadratic_lanes(const Contestant *contestant, FemQuadraticLaw law) {
  const FemLanes *lanes = fem_lanes();
  const Block *block = contestant->block;
  FemLanesRow own[FEM_LANES_HALF];
  for (int p = 0; p < block->packs.pack_count; p++) {
    const FemLanesQuadratics *e = &block->packs.quadratics[p];
    switch (contestant->what) {
    case FORCE:
      lanes->quadratic_force(law, e, block->positions, own);
      break;
    case MATRIX:
      lanes->quadratic_matrix(law, e, block->positions, 1, own);
      break;
    case DAMPING_FORCE:
      lanes->quadratic_damping_force(law.local, BETA, e, block->positions, block->velocities, own);
      break;
    default:
      lanes->quadratic_damping_matrix(law.local, BETA, e, block->positions, block->velocities, 1, 1, own);
    }
  }
}

static Status take_turn(void *self, int round) {
  Contestant *contestant = self;
  FemMaterial local = fem_material_local(&contestant->material);
  FemQuadraticLaw law = {&local,
                         fem_material_lame(&contestant->material).lambda - fem_material_lame(&local).lambda};
  app_bench_timer_start(&contestant->timer);
  for (int pass = 0; pass < contestant->passes; pass++) {
    if (contestant->block->packs.is_quadratic && contestant->is_in_lanes)
      pass_quadratic_lanes(contestant, law);
    else if (contestant->block->packs.is_quadratic)
      pass_quadratic(contestant, law);
    else if (contestant->is_in_lanes)
      pass_linear_lanes(contestant, &contestant->material);
    else
      pass_linear(contestant, &contestant->material);
  }
  app_bench_timer_stop(&contestant->timer, round,
                       (double)contestant->passes * contestant->block->packs.element_count);
  return STATUS_OK;
}

typedef struct Row {
  const char *element, *law, *what;
  double single_s, lanes_s, ratio, spread;
} Row;

static const AppTableColumn columns[] = {
    {"element", APP_TABLE_TEXT, offsetof(Row, element), "element", "linear or quadratic"},
    {"law", APP_TABLE_TEXT, offsetof(Row, law), "law", "of the material, or stvk with fibres"},
    {"what", APP_TABLE_TEXT, offsetof(Row, what), "what",
     "computed of each element; adding it to the model's is not measured"},
    {"single_s", APP_TABLE_NUMBER, offsetof(Row, single_s), "single s",
     "processor time of an element, one at a time [s]"},
    {"lanes_s", APP_TABLE_NUMBER, offsetof(Row, lanes_s), "lanes s", "in vector lanes [s]"},
    {"ratio", APP_TABLE_NUMBER, offsetof(Row, ratio), "×", "single over lanes, median of the rounds"},
    {"spread", APP_TABLE_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median of the lanes' time"},
};
static const AppBenchReport report = {"elements", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      false};

static FemMaterial material_of(int number) {
  bool has_fibres = number == FEM_MATERIAL_LAW_COUNT;
  return (FemMaterial){.law = has_fibres ? FEM_MATERIAL_STVK : (FemMaterialLaw)number,
                       .young = 1e6,
                       .poisson = 0.45,
                       .density = 1000,
                       .mooney = 0.3,
                       .exponents = {1.3, 5, -2},
                       .shares = {0.9, 0.02, 0.08},
                       .fibre_stiffness = has_fibres ? 1e6 : 0,
                       .fibre_direction = {1, 2, 3}};
}

static void add(Bench *bench, int kind, int material, What what) {
  for (int in_lanes = 0; in_lanes < 2; in_lanes++)
    bench->contestants[bench->count++] = (Contestant){.block = &bench->blocks[kind],
                                                      .material = material_of(material),
                                                      .what = what,
                                                      .is_in_lanes = in_lanes,
                                                      .passes = bench->options->passes};
}

static Row row_of(const Bench *bench, int r) {
  const Contestant *single = &bench->contestants[2 * r], *lanes = single + 1;
  int rounds = bench->options->common.repeats;
  AppBenchTime alone = app_bench_timer_time(&single->timer, rounds),
               packed = app_bench_timer_time(&lanes->timer, rounds);
  return (Row){.element = kinds[single->block->packs.is_quadratic],
               .law = single->material.fibre_stiffness > 0 ? "stvk, fibres"
                                                           : fem_material_name(single->material.law),
               .what = whats[single->what],
               .single_s = alone.cpu,
               .lanes_s = packed.cpu,
               .ratio = app_bench_timer_cpu_ratio(&lanes->timer, &single->timer, rounds).median,
               .spread = (packed.wall_max - packed.wall_min) / packed.wall};
}

static Status measure(Bench *bench) {
  for (int kind = 0; kind < KINDS; kind++) {
    TRY(block_create(&bench->blocks[kind], kind));
    for (int m = 0; m < MATERIALS; m++)
      for (int what = FORCE; what <= MATRIX; what++) add(bench, kind, m, (What)what);
    add(bench, kind, FEM_MATERIAL_STVK, DAMPING_FORCE);
    add(bench, kind, FEM_MATERIAL_STVK, DAMPING_MATRIX);
  }
  TRY(app_bench_timer_take_turns(bench->contestants, sizeof *bench->contestants, bench->count,
                                 bench->options->common.repeats, take_turn));
  Row rows[MAX_ROWS];
  for (int r = 0; 2 * r < bench->count; r++) rows[r] = row_of(bench, r);
  return app_bench_report_print(&report, &bench->options->common, rows, bench->count / 2);
}

static Status run(const Options *options) {
  Bench *bench = memory_zeroed(1, sizeof *bench);
  if (!bench) return status_no_memory("the bench");
  bench->options = options;
  Status status = measure(bench);
  for (int kind = 0; kind < KINDS; kind++) block_destroy(&bench->blocks[kind]);
  memory_free(bench);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = app_bench_options_default(5), .passes = 20};
  app_cli_parse(&lab_elements, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_elements = {.name = "elements",
                                 .help = "forces and matrices of elements in vector lanes",
                                 .options = option_table,
                                 .doc = "Measure forces and matrices of elements in vector lanes.",
                                 .run = run_command,
                                 .rows = &report,
                                 .describe_rows = app_bench_report_describe};
