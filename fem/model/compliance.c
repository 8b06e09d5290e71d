// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/surface/surface.h"
#include "fem/material/svd3.h"
#include "fem/model/blow.h"

// The deformation of the interface over that of the bodies, and its depth over the height in an impact, at
// most.
static const double GIVE = 0.02, BLOW_DEPTH = 0.01;
// Pressed between faces that hold it, a body is stiffer than E by 1/(1 − HELD ν⁴): a fit, not above what
// cubes have (1.048 at ν = .3, 1.169 at .45), that keeps the give below 2 % at any ν.
static const double HELD = 3.5;

static Vec3 corner_of(const FemModel *model, int tet, int v) {
  return vec3_at(model->rest + 3 * (size_t)model->tets[tet][v]);
}

// Volume, and ∫ x and ∫ x xᵀ about the body's first vertex.
typedef struct Moments {
  double volume;
  Vec3 first;
  double second[9];
} Moments;

static void add_tet(const FemModel *model, int tet, Vec3 origin, Moments *moments) {
  Vec3 x[4], sum = {0, 0, 0};
  for (int v = 0; v < 4; v++) x[v] = vec3_sub(corner_of(model, tet, v), origin), sum = vec3_add(sum, x[v]);
  double volume = fabs(vec3_det4(x[0], x[1], x[2], x[3])) / 6;
  moments->volume += volume;
  moments->first = vec3_add(moments->first, vec3_scale(volume / 4, sum));
  for (int v = 0; v < 5; v++) {
    Vec3 y = v < 4 ? x[v] : sum;
    const double p[3] = {y.x, y.y, y.z};
    for (int e = 0; e < 9; e++) moments->second[e] += volume / 20 * p[e / 3] * p[e % 3];
  }
}

// The least radius of inertia about the centroid: the root of the least principal value of the covariance.
static double least_radius(const FemModel *model, const FemModelBody *body, double *volume) {
  Moments moments = {0};
  FemSvd3 principal;
  Vec3 origin = corner_of(model, body->tet_begin, 0);
  for (int i = body->tet_begin; i < body->tet_end; i++) add_tet(model, i, origin, &moments);
  const double mean[3] = {moments.first.x / moments.volume, moments.first.y / moments.volume,
                          moments.first.z / moments.volume};
  for (int e = 0; e < 9; e++)
    moments.second[e] = moments.second[e] / moments.volume - mean[e / 3] * mean[e % 3];
  fem_svd3_factor(&principal, moments.second);
  *volume = moments.volume;
  return sqrt(fabs(principal.sigma[2]));
}

static Status measure_area(const FemModel *model, const FemModelBody *body, double *area) {
  ContactSurface surface;
  TRY(contact_surface_find(&surface, (const int(*)[4])model->tets, body->tet_begin, body->tet_end));
  *area = 0;
  for (int f = 0; f < surface.count; f++) {
    Vec3 x[3];
    for (int v = 0; v < 3; v++) x[v] = vec3_at(model->rest + 3 * (size_t)surface.faces[f].vertices[v]);
    *area += 0.5 * vec3_length(vec3_cross(vec3_sub(x[1], x[0]), vec3_sub(x[2], x[0])));
  }
  contact_surface_destroy(&surface);
  return STATUS_OK;
}

// L of a body [m].
static Status measure_height(const FemModel *model, int body, double *height) {
  double volume, area, radius = least_radius(model, &model->bodies[body], &volume);
  TRY(measure_area(model, &model->bodies[body], &area));
  *height = fmin(sqrt(12) * radius, 6 * volume / area);
  return STATUS_OK;
}

// Of every body; an obstacle is rigid and has none.
typedef struct Give {
  double height;  // L [m]
  double inverse; // 1/E [1/Pa]
  double give;    // (1 − HELD ν⁴)/E: of what is pressed between faces that hold it [1/Pa]
  double volume;  // V [m³]
} Give;

static Status measure_bodies(const FemModel *model, Give *gives) {
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    const double square = body->material.poisson * body->material.poisson;
    TRY(measure_height(model, b, &gives[b].height));
    gives[b].inverse = 1 / body->material.young;
    gives[b].give = (1 - HELD * square * square) / body->material.young;
    gives[b].volume = body->mass / body->material.density;
  }
  return STATUS_OK;
}

// By how much two bodies yield for each Pa between them [m/Pa]: no patch of contact is larger than the
// smaller one, and material farther away than its height deforms little.
static double give_of(const Give *a, const Give *b) {
  if (!(a->give > 0) || !(b->give > 0)) return a->height * a->give + b->height * b->give;
  return fmin(a->height, b->height) * (a->give + b->give);
}

// What the interface must hold in an impact: the pressure p between two bodies that store its energy, evenly
// strained; beyond E, where they store no more, p²/E, so that their edges hold it.
static double pressure_of(const Give *a, const Give *b, double blow) {
  double stored = a->volume * a->inverse + b->volume * b->inverse;
  double pressure = sqrt(2 * blow / stored), compliance = fmax(a->inverse, b->inverse);
  return pressure * fmax(1, pressure * compliance);
}

// Between two bodies: stiff enough for a press and for an impact [J]. `terms`: of p = terms · c d.
static double stiffness_between(const Give *a, const Give *b, double blow, int terms) {
  double sum = give_of(a, b), height = a->height;
  if (!(sum > 0)) return 1;
  if (b->height > 0) height = height > 0 ? fmin(height, b->height) : b->height;
  return fmax(1 / (terms * GIVE * sum), pressure_of(a, b, blow) / (terms * BLOW_DEPTH * height));
}

static Status choose_for_field(const FemModel *model, int party_count, double *stiffness) {
  Give *gives = memory_zeroed((size_t)party_count, sizeof *gives);
  Status status = gives ? measure_bodies(model, gives) : status_no_memory("contact stiffness");
  double blow = fem_blow_hardest(model);
  for (int a = 0; a < model->body_count && !status; a++)
    for (int b = 0; b < party_count; b++)
      stiffness[a * party_count + b] =
          stiffness_between(&gives[a], &gives[b], a == b ? 0 : blow, b < model->body_count ? 2 : 1);
  memory_free(gives);
  return status;
}

int fem_compliance_party(const FemModel *model, const char *name) {
  int party = model->body_count;
  for (int b = 0; b < model->body_count; b++)
    if (strcmp(model->bodies[b].name, name) == 0) return b;
  for (int o = 0; o < model->scene->obstacle_count; o++) {
    const FemObstacleDef *obstacle = &model->scene->obstacles[o];
    if (obstacle->kind == FEM_OBSTACLE_MESH) continue;
    if (strcmp(obstacle->name, name) == 0) return party;
    party++;
  }
  return -1;
}

const char *fem_compliance_party_name(const FemModel *model, int party) {
  if (party >= 0 && party < model->body_count) return model->bodies[party].name;
  int shape = model->body_count;
  for (int o = 0; o < model->scene->obstacle_count; o++)
    if (model->scene->obstacles[o].kind != FEM_OBSTACLE_MESH && shape++ == party)
      return model->scene->obstacles[o].name;
  return "?";
}

static Status check_pair(const FemModel *model, const FemContactPairDef *pair) {
  for (int k = 0; k < 2; k++)
    if (fem_compliance_party(model, pair->names[k]) < 0)
      return status_fail(STATUS_INPUT, "%s: contact.pairs: no body or obstacle has the name '%s'",
                         fem_scene_where(model->scene, &pair->place).text, pair->names[k]);
  return STATUS_OK;
}

static Status apply_pairs(const FemModel *model, int party_count, double *stiffness) {
  const FemContactDef *contact = &model->scene->contact;
  for (int i = 0; i < contact->pair_count; i++) {
    const FemContactPairDef *pair = &contact->pairs[i];
    TRY(check_pair(model, pair));
    if (!(pair->stiffness > 0)) continue;
    int a = fem_compliance_party(model, pair->names[0]), b = fem_compliance_party(model, pair->names[1]);
    if (a < model->body_count) stiffness[a * party_count + b] = pair->stiffness;
    if (b < model->body_count) stiffness[b * party_count + a] = pair->stiffness;
  }
  return STATUS_OK;
}

double fem_compliance_friction(const FemModel *model, int a, int b) {
  const FemContactDef *contact = &model->scene->contact;
  double friction = contact->friction;
  for (int i = 0; i < contact->pair_count; i++) {
    const FemContactPairDef *pair = &contact->pairs[i];
    int first = fem_compliance_party(model, pair->names[0]), second = fem_compliance_party(model, pair->names[1]);
    bool is_theirs = (first == a && second == b) || (first == b && second == a);
    if (is_theirs && pair->friction >= 0) friction = pair->friction;
  }
  return friction;
}

Status fem_compliance_stiffness(const FemModel *model, double **stiffness, int *party_count) {
  const FemContactDef *contact = &model->scene->contact;
  int parties = *party_count = model->body_count + fem_scene_shape_count(model->scene);
  size_t count = (size_t)model->body_count * (size_t)parties;
  double *table = *stiffness = memory_zeroed(count, sizeof *table);
  if (!table) return status_no_memory("contact stiffness");
  for (size_t k = 0; k < count; k++) table[k] = fem_model_contact_stiffness(model);
  Status status = STATUS_OK;
  if (contact->potential == CONTACT_POTENTIAL_FIELD && !(contact->stiffness > 0))
    status = choose_for_field(model, parties, table);
  if (!status) status = apply_pairs(model, parties, table);
  if (status) {
    memory_free(table);
    *stiffness = NULL;
  }
  return status;
}

Status fem_compliance_range(const FemModel *model, double range[2]) {
  double *stiffness;
  int parties, bodies = model->scene->body_count;
  TRY(fem_compliance_stiffness(model, &stiffness, &parties));
  range[0] = INFINITY, range[1] = 0;
  for (int a = 0; a < bodies; a++)
    for (int b = a; b < parties; b++) {
      if (a == b && !model->scene->bodies[a].self_contact) continue;
      range[0] = fmin(range[0], stiffness[a * parties + b]);
      range[1] = fmax(range[1], stiffness[a * parties + b]);
    }
  memory_free(stiffness);
  if (!(range[1] > 0)) range[0] = range[1] = fem_model_contact_stiffness(model);
  return STATUS_OK;
}
