// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of the potential `field` for tests: two irregular blocks pressed into each other, or one into an
// obstacle, with differences of energies and forces.
#ifndef TETLAP_TESTS_PRESSING_H
#define TETLAP_TESTS_PRESSING_H

#include "blocks.h"
#include "evaluated.h"
#include "product.h"

#include "base/vec3.h"
#include "contact/pressure/law.h"
#include "contact/shape/convex.h"
#include "overlap/models.h"

static const double STIFFNESS = 1000;

typedef struct Scene {
  Blocks blocks;
  double *rest, *still;
  OverlapModel model;
  ContactShape shape; // its kind's point of view; only where shape_count is 1
  ContactConvex solid;
  int shape_count;
  const unsigned char *inner; // borrowed
  const ContactLaw *law;      // of all; borrowed, NULL: linear
  ContactSystem *system;
} Scene;

static inline void start(Scene *scene, const char *model) {
  scene->rest = scene->rest ? scene->rest : blocks_copy(&scene->blocks);
  scene->still = calloc(3 * (size_t)scene->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(scene->still);
  ck_assert_ok(overlap_models_create(&scene->model, model));
  ContactSystemDef def = blocks_def(&scene->blocks, scene->rest, &scene->model);
  def.potential = CONTACT_POTENTIAL_FIELD;
  def.stiffness = STIFFNESS;
  def.shapes = &scene->shape, def.shape_count = scene->shape_count;
  def.inner = scene->inner;
  const ContactLaw *laws[BLOCKS_MAX * (BLOCKS_MAX + 1)];
  for (int k = 0; k < BLOCKS_MAX * (BLOCKS_MAX + 1); k++) laws[k] = scene->law;
  def.pair_laws = laws;
  ck_assert_ok(contact_system_create(&scene->system, &def));
  ck_assert_ok(contact_system_update(scene->system, 0, scene->blocks.x, scene->still, 0.01));
}

static inline void destroy(Scene *scene) {
  contact_system_destroy(scene->system);
  overlap_model_destroy(&scene->model);
  blocks_destroy(&scene->blocks);
  free(scene->rest), free(scene->still);
  *scene = (Scene){.system = NULL};
}

static inline double energy_at(const Scene *scene, const double *x) {
  return evaluated_at(scene->system, 0, x)->energy;
}

static inline void move(const Scene *scene) {
  ck_assert_ok(contact_system_update(scene->system, 0, scene->blocks.x, scene->still, 0.01));
}

// Owned by the caller (free).
static inline double *forces_at(const Scene *scene, const double *x) {
  double *force = calloc(3 * (size_t)scene->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(force);
  evaluated_with_force(scene->system, x, force);
  return force;
}

// Two irregular blocks, one pressed into the other, both stretched and sheared from where they rest; the
// lower one is one cell thick.
static inline void press_blocks(Scene *scene, bool is_obstacle_below) {
  blocks_add(
      &scene->blocks,
      &(BlockDef){.cell = {1, 1, 1.6}, .cells = {3, 3, 1}, .jitter = 0.12, .is_obstacle = is_obstacle_below});
  blocks_add(
      &scene->blocks,
      &(BlockDef){.corner = {0.63, 0.41, 1.3}, .cell = {0.83, 0.9, 0.8}, .cells = {2, 2, 3}, .jitter = 0.15});
  scene->rest = blocks_copy(&scene->blocks);
  for (int v = scene->blocks.bodies[1].vertex_begin; v < scene->blocks.bodies[1].vertex_end; v++) {
    double *x = scene->blocks.x + 3 * v;
    x[0] += 0.08 * sin(x[1]), x[1] += 0.1 * x[2] - 0.13, x[2] += 0.05 * x[0];
  }
}

enum { ON_BODY, ON_MESH, ON_PLANE, ON_BALL, ON_BOX, ON_PRISM, KINDS };

static inline void press_on(Scene *scene, int kind) {
  *scene = (Scene){.system = NULL};
  if (kind <= ON_MESH) {
    press_blocks(scene, kind == ON_MESH);
    return;
  }
  blocks_add(&scene->blocks, &(BlockDef){.corner = {-0.7, -0.8, -0.22},
                                         .cell = {0.5, 0.6, 0.55},
                                         .cells = {3, 3, 2},
                                         .jitter = 0.15});
  scene->shape_count = 1;
  scene->shape = (ContactShape){.name = "obstacle",
                                .normal = {0, 0, 1},
                                .point = {0.1, 0.2, 0.01},
                                .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (kind == ON_BALL)
    scene->shape.kind = CONTACT_SHAPE_BALL, scene->shape.radius = 0.83, scene->shape.point[2] = -0.6;
  if (kind == ON_BOX || kind == ON_PRISM) {
    scene->shape.kind = CONTACT_SHAPE_CONVEX, scene->shape.convex = &scene->solid;
    scene->shape.point[2] = -0.45;
    if (kind == ON_BOX) contact_convex_make_box(&scene->solid, (double[]){0.4, 0.33, 0.47});
    if (kind == ON_PRISM) contact_convex_make_prism(&scene->solid, 0.5, 0.48, 16);
  }
}

// Vertices of the upper block are pushed through what lies above them, so that elements are
// inverted there; returns how many pairs have a side that is.
static inline int fold(Scene *scene) {
  const ContactLayout *layout = contact_system_layout(scene->system);
  const ContactBody *upper = &scene->blocks.bodies[scene->blocks.body_count - 1];
  int folded = 0;
  for (int v = upper->vertex_begin; v < upper->vertex_end; v++)
    if (layout->mesh.depths[v] > 0) scene->blocks.x[3 * v + 2] -= 1.1, scene->blocks.x[3 * v] += 0.2;
  move(scene);
  const ContactEvaluation *evaluation = evaluated_at(scene->system, 0, scene->blocks.x);
  for (int k = 0; k < evaluation->pair_count; k++)
    folded += evaluation->fields[k].signs[0] < 0 || evaluation->fields[k].signs[1] < 0;
  return folded;
}

static inline double *random_motion(const Scene *scene, uint64_t stream, bool obstacles_move) {
  Random random = random_seeded(21, stream);
  double *d = calloc(3 * (size_t)scene->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(d);
  for (int b = 0; b < scene->blocks.body_count; b++)
    for (int k = 3 * scene->blocks.bodies[b].vertex_begin; k < 3 * scene->blocks.bodies[b].vertex_end; k++)
      d[k] = scene->blocks.bodies[b].is_obstacle && !obstacles_move ? 0 : random_between(&random, -1, 1);
  return d;
}

static inline void step_to(const Scene *scene, double h, const double *d, double *x) {
  for (int k = 0; k < 3 * scene->blocks.vertex_count; k++) x[k] = scene->blocks.x[k] + h * d[k];
}

// Differences over ± h and ± 2 h, such that the error is of fourth order.
static inline double slope_along(const Scene *scene, const double *d, double h, double *x) {
  double energy[4], steps[4] = {-2, -1, 1, 2};
  for (int k = 0; k < 4; k++) {
    step_to(scene, steps[k] * h, d, x);
    energy[k] = energy_at(scene, x);
  }
  return (8 * (energy[2] - energy[1]) - (energy[3] - energy[0])) / (12 * h);
}

// −∂f/∂x along d, by differences over ± h. Owned by the caller (free).
static inline double *stiffness_along(const Scene *scene, const double *d, double h, double *x) {
  step_to(scene, h, d, x);
  double *above = forces_at(scene, x);
  step_to(scene, -h, d, x);
  double *below = forces_at(scene, x);
  for (int i = 0; i < 3 * scene->blocks.vertex_count; i++) above[i] = (below[i] - above[i]) / (2 * h);
  free(below);
  return above;
}

#endif
