// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/model.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/lanes/lanes.h"
#include "fem/material/cofactor.h"

const char *fem_model_body_name(const FemModel *model, int vertex) {
  for (int b = 0; b < model->body_count; b++)
    if (vertex < model->bodies[b].vertex_end) return model->bodies[b].name ? model->bodies[b].name : "?";
  return "?";
}

double fem_model_contact_stiffness(const FemModel *model) {
  const FemContactDef *contact = &model->scene->contact;
  if (contact->stiffness > 0) return contact->stiffness;
  double softest = INFINITY, smallest_element = INFINITY;
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    softest = fmin(softest, body->material.young);
    double volume = body->mass / body->material.density;
    smallest_element = fmin(smallest_element, volume / (body->tet_end - body->tet_begin));
  }
  return contact->potential == CONTACT_POTENTIAL_BODY ? softest / smallest_element : softest;
}

bool fem_model_has_linear_materials(const FemModel *model) {
  for (int b = 0; b < model->scene->body_count; b++)
    if (!fem_material_is_linear(&model->bodies[b].material)) return false;
  return true;
}

// What sticks moves by less than ε, which an integrator that tolerates more than a few ε does not see.
// Measured on a block that slides on a block: at 1, 2 and 7 ε as good, at 23 ε four times the steps.
static const double FRICTION_RESOLUTION = 5;

// Of the slowest wave's speed. An impact's waves carry the speed of the impact, hundredths of that: at 1 a
// ball at 0.5 m/s loses 13 % of its energy in a contact, at 0.1 0.3 %, at 0.03 0.1 % (docs/time.md).
static const double VELOCITY_SHARE = 0.03;
// Where a body rubs on itself normals jump from step to step, and a fine tolerance follows every jump: a fold
// of 180 tetrahedra stalls at 0.3 and below.
static const double VELOCITY_SHARE_OF_SELF_FRICTION = 1;

// How far what sticks may creep in a whole run, as a share of the smallest body.
static const double CREEP = 1e-3;

double fem_model_slip_speed(const FemModel *model) {
  double given = model->scene->contact.slip_speed;
  return given > 0 ? given : CREEP * model->length / model->scene->end;
}

// Of time.tolerance.
static const double SPEED_SHARE = 5;

static bool creeps(const FemSceneDef *scene) {
  return fem_scene_most_friction(&scene->contact) > 0 &&
         fem_scene_friction_law(&scene->contact) == FEM_FRICTION_VELOCITY;
}

static double wave_of(const FemMaterial *material) {
  return sqrt(material->young / material->density);
}

double fem_model_slowest_wave(const FemModel *model) {
  double slowest = INFINITY;
  for (int b = 0; b < model->scene->body_count; b++)
    slowest = fmin(slowest, wave_of(&model->scene->bodies[b].material));
  return slowest;
}

double fem_model_fastest_wave(const FemModel *model) {
  double fastest = 0;
  for (int b = 0; b < model->scene->body_count; b++)
    fastest = fmax(fastest, wave_of(&model->scene->bodies[b].material));
  return fastest;
}

double fem_model_speed_share(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->velocity_tolerance > 0 || !scene->contact.is_on || creeps(scene)) return 0;
  return SPEED_SHARE * scene->tolerance;
}

// Of the speed that a scene's motion is expected to have: in stiff bodies that move slowly waves carry far
// less than a hundredth of √(E/ρ).
static const double MOTION_SHARE = 0.3;

// The fastest at t = 0, or after falling the smallest body's length; infinite where neither is given.
static double expected_speed(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  double fastest = scene->has_gravity ? sqrt(vec3_length(vec3_at(scene->gravity)) * model->length) : 0;
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *body = &scene->bodies[b];
    fastest = fmax(fastest, vec3_length(vec3_at(body->velocity)) +
                                0.5 * model->length * vec3_length(vec3_at(body->spin)));
  }
  return fastest > 0 ? fastest : INFINITY;
}

// Without contact nothing strikes, and what shakes a body are waves that need not be followed: bending needs
// fine positions, not fine velocities (docs/time.md).
static const double POSITION_SHARE_WITHOUT_CONTACT = 0.03;

static bool is_free(const FemSceneDef *scene) {
  return !scene->contact.is_on && !scene->is_static;
}

double fem_model_position_tolerance(const FemModel *model) {
  return (is_free(model->scene) ? POSITION_SHARE_WITHOUT_CONTACT : 1) * model->scene->tolerance *
         model->length;
}

double fem_model_velocity_tolerance(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->velocity_tolerance > 0) return scene->velocity_tolerance;
  double slowest = fem_model_slowest_wave(model);
  double share = fem_scene_has_self_friction(scene) ? VELOCITY_SHARE_OF_SELF_FRICTION : VELOCITY_SHARE;
  double chosen = scene->tolerance * fmin(share * slowest, MOTION_SHARE * expected_speed(model));
  if (is_free(scene)) return chosen / VELOCITY_SHARE;
  return creeps(scene) ? fmin(chosen, FRICTION_RESOLUTION * fem_model_slip_speed(model)) : chosen;
}

double fem_model_strain_energy(const FemModel *model, double strain) {
  double energy = 0;
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    energy += strain * strain * body->material.young * body->mass / body->material.density;
  }
  return energy;
}

static const FemModelBody *body_of(const FemModel *model, int tet) {
  return &model->bodies[model->tet_body[tet]];
}

static void gather(const int *nodes, int count, const double *positions, double *x) {
  for (int k = 0; k < count; k++) memcpy(x + 3 * k, positions + 3 * (size_t)nodes[k], 3 * sizeof *x);
}

// The quadratic tetrahedron of which `tet` is a part.
static int quadratic_of(const FemModel *model, int tet) {
  const FemModelBody *body = body_of(model, tet);
  return body->quadratic_begin + (tet - body->tet_begin) / FEM_QUADRATIC_PARTS;
}

FemElement fem_model_element(const FemModel *model, int tet) {
  double rest[12];
  FemElement element;
  gather(model->tets[tet], 4, model->rest, rest);
  fem_element_create(&element, rest);
  return element;
}

double fem_model_det(const FemModel *model, int tet, const double *positions) {
  const FemModelBody *body = body_of(model, tet);
  int part = (tet - body->tet_begin) % FEM_QUADRATIC_PARTS;
  double x[30], F[9];
  gather(model->tets[tet], 4, positions, x);
  const FemElement element = fem_model_element(model, tet);
  fem_element_deformation(&element, x, F);
  double own = fem_cofactor_det(F);
  if (body->element != FEM_ELEMENT_QUADRATIC || part >= FEM_QUADRATIC_POINTS) return own;
  int quadratic = quadratic_of(model, tet);
  gather(model->quadratic_nodes[quadratic], FEM_QUADRATIC_NODES, positions, x);
  double at_point = fem_quadratic_det(&model->quadratics[quadratic], part, x);
  return at_point < own ? at_point : own;
}

void fem_model_stress(const FemModel *model, int tet, const double *positions, double stress[6]) {
  const FemModelBody *body = body_of(model, tet);
  double x[30];
  if (body->element != FEM_ELEMENT_QUADRATIC) {
    gather(model->tets[tet], 4, positions, x);
    const FemElement element = fem_model_element(model, tet);
    fem_element_cauchy(&element, &body->local, x, stress);
    return;
  }
  int quadratic = quadratic_of(model, tet);
  FemQuadraticLaw law = {&body->local, body->bulk};
  gather(model->quadratic_nodes[quadratic], FEM_QUADRATIC_NODES, positions, x);
  fem_quadratic_cauchy(&model->quadratics[quadratic], law, x, (tet - body->tet_begin) % FEM_QUADRATIC_PARTS,
                       stress);
}

// A body rings with periods of the time that a wave takes through it and back; some periods, and calm is no
// turning point.
static const double REST_CROSSINGS = 20;

double fem_model_rest_time(const FemModel *model) {
  double given = model->scene->contact.rest_time, longest = 0;
  if (given > 0) return given;
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    double diagonal = sqrt(3) * cbrt(body->mass / body->material.density);
    longest = fmax(longest, diagonal / wave_of(&body->material));
  }
  return REST_CROSSINGS * longest;
}

// A body that is wrong by the tolerance after a wave has run through it.
double fem_model_rest_speed(const FemModel *model) {
  double given = model->scene->contact.rest_speed;
  return given > 0 ? given : model->scene->tolerance * fem_model_slowest_wave(model);
}

// Less would be asked in vain: the integrator's own errors accelerate a body that lies still by some
// hundredths of a tolerance's speed in the time of a crossing.
static const double REST_ACCELERATION = 5; // speeds in the time it is watched

double fem_model_rest_acceleration(const FemModel *model) {
  double given = model->scene->contact.rest_acceleration;
  return given > 0 ? given : REST_ACCELERATION * fem_model_rest_speed(model) / fem_model_rest_time(model);
}

// What contact keeps goes by the surfaces: six faces of a cube of n vertices have 6 n^(2/3). Measured on
// cubes that touch with one of them.
static double contact_bytes(const FemModel *model) {
  double surface = 0;
  for (int b = 0; b < model->body_count; b++)
    surface += pow(model->bodies[b].vertex_end - model->bodies[b].vertex_begin, 2.0 / 3.0);
  return model->scene->contact.is_on ? 1.2e5 * surface : 0;
}

// The constants are of the resident set, measured with `pcg`, which keeps nothing.
double fem_model_memory_estimate(const FemModel *model) {
  double vertices = model->vertex_count, tets = model->tet_count, unknowns = model->unknown_count;
  double arrays = vertices * 30 * sizeof(double) + tets * 400;
  arrays += model->quadratic_count * (double)(sizeof(FemQuadratic) + sizeof(FemLanesQuadratics) / FEM_LANES +
                                              FEM_LANES_HALF * sizeof(int));
  double matrix = unknowns * 23 * (sizeof(double) + sizeof(int));
  return 2e7 + arrays + matrix + contact_bytes(model);
}
