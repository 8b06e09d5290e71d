// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/leaf.h"

#include <math.h>

#include "fem/model/compliance/patch.h"
#include "fem/model/parts.h"

// The least length over thickness of a leaf; λ³/(L h²); the most depth under the loads over the thickness;
// the most length of what holds a leaf, over its own.
static const double SLENDER = 10, SPREAD = 1.5, LOAD_DEPTH = 0.05, HELD = 0.5;

static bool is_held_by(const FemModelBody *body, const FemModelDriver *driver) {
  int vertex = driver->dof_count > 0 ? driver->dofs[0] / 3 : -1;
  return vertex >= body->vertex_begin && vertex < body->vertex_end;
}

// How far along the axis the vertices reach that are held across it.
static double held_length(const FemModel *model, const FemModelDriver *driver, const FemExtent *extent) {
  const double axis[3] = {extent->axis.x, extent->axis.y, extent->axis.z};
  double low = INFINITY, high = -INFINITY;
  for (int i = 0; i < driver->dof_count; i++) {
    double at = vec3_dot(vec3_at(model->rest + 3 * (size_t)(driver->dofs[i] / 3)), extent->axis);
    if (fabs(axis[driver->dofs[i] % 3]) > 0.99) continue;
    low = fmin(low, at);
    high = fmax(high, at);
  }
  return fmax(high - low, 0);
}

static bool is_leaf(const FemModel *model, int body, const FemExtent *extent) {
  if (body >= model->scene->body_count || !(extent->length >= SLENDER * extent->height)) return false;
  for (int d = 0; d < model->driver_count; d++)
    if (is_held_by(&model->bodies[body], &model->drivers[d]) &&
        held_length(model, &model->drivers[d], extent) > HELD * extent->length)
      return false;
  return true;
}

static bool others_move(const FemModel *model, const int bodies[2]) {
  int parties = model->body_count + fem_scene_shape_count(model->scene);
  for (int p = 0; p < parties; p++)
    if (p != bodies[0] && p != bodies[1] && fem_patch_travel(model, p) > 0) return true;
  return false;
}

static double plate_modulus(const FemMaterial *material) {
  return material->young / (1 - material->poisson * material->poisson);
}

// Of several materials as if all were the softest: no more than the true one.
static double bending_of(const FemModel *model, int body, double height) {
  return fem_model_parts_least(model, body, plate_modulus) * height * height * height / 12;
}

// The c at which the sum of the loads, on a patch as long as λ, presses two leaves LOAD_DEPTH of the thinner
// one's thickness into each other.
static double stiffness_of_loads(const FemModel *model, const int bodies[2], const FemExtent extents[2],
                                 double spread) {
  double force = 0, width = INFINITY, height = fmin(extents[0].height, extents[1].height);
  for (int b = 0; b < model->scene->body_count; b++) force += fem_patch_load(model, b);
  for (int k = 0; k < 2; k++) {
    double volume = fem_model_parts_volume(model, bodies[k]);
    width = fmin(width, volume / (extents[k].length * extents[k].height));
  }
  return force / (spread * width) / (2 * LOAD_DEPTH * height);
}

double fem_leaf_stiffness(const FemModel *model, const int bodies[2], const FemExtent extents[2]) {
  if (!model->scene->is_static || bodies[0] == bodies[1]) return INFINITY;
  for (int k = 0; k < 2; k++)
    if (!is_leaf(model, bodies[k], &extents[k])) return INFINITY;
  if (others_move(model, bodies)) return INFINITY;
  double length = fmin(extents[0].length, extents[1].length), edge = fmax(extents[0].edge, extents[1].edge);
  double bending = 1 / (1 / bending_of(model, bodies[0], extents[0].height) +
                        1 / bending_of(model, bodies[1], extents[1].height));
  double spread = cbrt(SPREAD * length * edge * edge);
  double stiffness = 2 * bending / (spread * spread * spread * spread);
  return stiffness > stiffness_of_loads(model, bodies, extents, spread) ? stiffness : INFINITY;
}
