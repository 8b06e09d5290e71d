// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/slabs.h"

#include <math.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/effect/contact/contact.h"

// Elements through a slab's thickness; positions a tenth of the lower slab's element apart.
enum { LAYERS = 2, SLIDES = 10 };
static const double STEP = 0.1;
// In elements of the lower slab.
static const double DEPTHS[] = {0.05, 0.3, 0.6};
enum { DEPTH_COUNT = sizeof DEPTHS / sizeof *DEPTHS };

// run->extra: the worst of all positions. Inside of the patch, three elements from its border, so that no
// vertex that a force depends on reaches the border; lower and upper slab:
enum {
  EVALUATIONS,
  LEAST_PAIRS,
  UNEVEN,                  // standard deviation of the normal force over surface vertices, by its mean
  TANGENTIAL = UNEVEN + 2, // Σ |f_t| / Σ f_n
  PRESSURE_ERROR = TANGENTIAL + 2, // |p / (2 c depth) − 1| of the lower slab
  // The whole lower slab, with the border, where the upper slab's sides are pressed as well:
  NET,     // sideways force on all of it by the normal one
  BALANCE, // force on the lower plus that on the upper slab, by the normal one
};

typedef struct Slabs {
  AppStressRun *run;
  ContactSystem *contact;
  const ContactEvaluation *evaluation; // at these positions
  double *positions;
  double depth, slid; // [m]
} Slabs;

static double edge_of(const AppStressRun *run, int body) {
  const FemModelBody *b = &run->model.bodies[body];
  double low = INFINITY, high = -INFINITY;
  for (int a = b->vertex_begin; a < b->vertex_end; a++) {
    low = fmin(low, run->model.rest[3 * a + 2]);
    high = fmax(high, run->model.rest[3 * a + 2]);
  }
  return (high - low) / LAYERS;
}

// Half the upper slab's width less three elements, and its middle, at rest.
static double reach_of(const AppStressRun *run, double middle[2]) {
  const FemModelBody *b = &run->model.bodies[1];
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int a = b->vertex_begin; a < b->vertex_end; a++)
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], run->model.rest[3 * a + c]);
      high[c] = fmax(high[c], run->model.rest[3 * a + c]);
    }
  for (int c = 0; c < 2; c++) middle[c] = (low[c] + high[c]) / 2;
  return (high[0] - low[0]) / 2 - 3 * edge_of(run, 0);
}

static void keep_worst(double *worst, double value) {
  if (!(value <= *worst)) *worst = value;
}

// The forces on one slab inside of the patch.
static void inspect(const Slabs *slabs, int body) {
  const FemModel *model = &slabs->run->model;
  const double *force = slabs->evaluation->given_forces;
  double middle[2], reach = reach_of(slabs->run, middle), edge = edge_of(slabs->run, body);
  double outwards = body == 0 ? -1 : 1, sum = 0, first = 0, squares = 0, tangential = 0, inner = 0;
  int count = 0;
  middle[0] += slabs->slid;
  for (int v = model->bodies[body].vertex_begin; v < model->bodies[body].vertex_end; v++) {
    const double *x = slabs->positions + 3 * v, *f = force + 3 * v;
    if (fabs(x[0] - middle[0]) > reach || fabs(x[1] - middle[1]) > reach) continue;
    double normal = outwards * f[2];
    tangential += hypot(f[0], f[1]);
    if (fabs(model->rest[3 * v + 2]) > edge / 2)
      inner += fabs(normal);
    else {
      first = count ? first : normal;
      sum += normal, squares += (normal - first) * (normal - first), count++;
    }
  }
  double mean = sum / count, variance = fmax(0, squares / count - (mean - first) * (mean - first));
  double pressure = (sum + inner) / count / (edge * edge), *extra = slabs->run->extra;
  keep_worst(&extra[UNEVEN + body], sqrt(variance) / mean);
  keep_worst(&extra[TANGENTIAL + body], tangential / (sum + inner));
  double stiffness = contact_system_layout(slabs->contact)->interfaces[0].stiffness;
  if (body == 0) keep_worst(&extra[PRESSURE_ERROR], fabs(pressure / (2 * stiffness * slabs->depth) - 1));
}

static void inspect_all(const Slabs *slabs) {
  const FemModel *model = &slabs->run->model;
  const double *force = slabs->evaluation->given_forces;
  double total[2][3] = {{0}}, imbalance = 0, *extra = slabs->run->extra;
  for (int body = 0; body < 2; body++)
    for (int v = model->bodies[body].vertex_begin; v < model->bodies[body].vertex_end; v++)
      for (int c = 0; c < 3; c++) total[body][c] += force[3 * v + c];
  for (int c = 0; c < 3; c++) imbalance = fmax(imbalance, fabs(total[0][c] + total[1][c]));
  keep_worst(&extra[NET], hypot(total[0][0], total[0][1]) / fabs(total[0][2]));
  keep_worst(&extra[BALANCE], imbalance / fabs(total[0][2]));
}

static void place(Slabs *slabs) {
  const FemModel *model = &slabs->run->model;
  memcpy(slabs->positions, model->rest, 3 * (size_t)model->vertex_count * sizeof *slabs->positions);
  for (int v = model->bodies[1].vertex_begin; v < model->bodies[1].vertex_end; v++)
    slabs->positions[3 * v] += slabs->slid, slabs->positions[3 * v + 2] -= slabs->depth;
}

static Status slide(Slabs *slabs, const double *velocities) {
  AppStressRun *run = slabs->run;
  for (int k = 0; k < SLIDES && !run->is_cut; k++) {
    slabs->slid = k * STEP * edge_of(run, 0);
    place(slabs);
    TRY(contact_system_update(slabs->contact, 0, slabs->positions, velocities, 0.01));
    TRY(contact_evaluate(slabs->contact, 0, 0, slabs->positions, &slabs->evaluation));
    run->extra[LEAST_PAIRS] = fmin(run->extra[LEAST_PAIRS], slabs->evaluation->pair_count);
    run->extra[EVALUATIONS]++;
    for (int body = 0; body < 2; body++) inspect(slabs, body);
    inspect_all(slabs);
    run->is_cut = clock_cpu_s() - run->began_s > run->limit_s;
    if (run->asked_to_stop && *run->asked_to_stop) return status_fail(STATUS_INTERRUPTED, "interrupted");
  }
  return STATUS_OK;
}

static Status press(Slabs *slabs, FemSystem *system) {
  AppStressRun *run = slabs->run;
  size_t count = 3 * (size_t)run->model.vertex_count;
  double *velocities = memory_zeroed(count, sizeof *velocities);
  slabs->positions = memory_zeroed(count, sizeof *slabs->positions);
  slabs->contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  Status status = velocities && slabs->positions ? STATUS_OK : status_no_memory("positions of slabs");
  for (int d = 0; d < DEPTH_COUNT && !status; d++) {
    slabs->depth = DEPTHS[d] * edge_of(run, 0);
    status = slide(slabs, velocities);
  }
  run->result.contact.pairs = contact_system_counters(slabs->contact)->pairs;
  memory_free(slabs->positions);
  memory_free(velocities);
  return status;
}

Status app_stress_slabs_run(AppStressRun *run) {
  FemSystem system;
  Slabs slabs = {.run = run};
  run->began_s = clock_cpu_s();
  run->extra[LEAST_PAIRS] = INFINITY;
  run->status = fem_system_create(&system, &run->model);
  if (!run->status) run->status = press(&slabs, &system);
  fem_system_destroy(&system);
  run->cpu_s = clock_cpu_s() - run->began_s;
  if (run->status) snprintf(run->message, sizeof run->message, "%s", status_message());
  return run->status == STATUS_MEMORY || run->status == STATUS_INTERRUPTED ? run->status : STATUS_OK;
}

void app_stress_slabs_judge(const AppStressRun *run, AppStressRow *row) {
  const double *extra = run->extra;
  app_stress_ask_occurred(row, "positions", extra[EVALUATIONS], SLIDES * DEPTH_COUNT);
  app_stress_ask_occurred(row, "least overlapping pairs", extra[LEAST_PAIRS], 100);
  app_stress_ask_most(row, "force and counter-force", extra[BALANCE], 1e-12);
  app_stress_ask_most(row, "unevenness, lower", extra[UNEVEN], 0.01);
  app_stress_ask_most(row, "unevenness, upper", extra[UNEVEN + 1], 0.01);
  app_stress_ask_most(row, "false friction inside, lower", extra[TANGENTIAL], 1e-6);
  app_stress_ask_most(row, "false friction inside, upper", extra[TANGENTIAL + 1], 1e-6);
  app_stress_ask_most(row, "false friction, whole patch", extra[NET], 0.05);
  app_stress_ask_most(row, "pressure against 2 c depth", extra[PRESSURE_ERROR], 1e-3);
}
