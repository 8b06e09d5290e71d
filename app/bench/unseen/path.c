// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/unseen/path.h"

#include <math.h>
#include <string.h>

#include "app/evaluation/evaluation.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "contact/system.h"

static const double TURN = 6.283185307179586;
// The path's smallest depth, and how far it goes across, as shares of its middle depth and of its slide.
static const double SHALLOWEST = 0.3, ACROSS = 0.4;

// One of the two models on its way.
typedef struct Walker {
  const OverlapModel *model;
  ContactSystem *system;
  const ContactEvaluation *evaluation; // of this place
  double *force;                       // on vertices                                        (vertex_count, 3)
  double total[3];                     // on the upper body
  double normal_sum;
  double net, turned_over; // Σ F·dx, Σ |F·dx|
  double seconds;
} Walker;

typedef struct Walk {
  const AppUnseenCase *what;
  const AppUnseenMesh *mesh;
  double *x, *velocity; // of this place                                  (vertex_count, 3)
  Walker told, truth;
  int capacity;                    // of the pairs' answers
  double *volume[2], *centroid[2]; // of the pairs of clipping, by the model and true
  // Sums: differences and the truth's.
  double volumes[2], moments[2], nodal[2], totals[2], normals[2];
  double tangential, largest_normal;
  long long pairs;
} Walk;

static Status start(Walker *walker, const Walk *walk, const OverlapModel *model) {
  const AppUnseenMesh *mesh = walk->mesh;
  ContactSystemDef def = {.vertex_count = mesh->vertex_count,
                          .rest = mesh->rest,
                          .tets = (const int(*)[4])mesh->tets,
                          .tet_count = mesh->tet_count,
                          .bodies = mesh->bodies,
                          .body_count = 2,
                          .potential = CONTACT_POTENTIAL_FIELD,
                          .stiffness = 1,
                          .model = model};
  walker->model = model;
  walker->force = memory_zeroed(3 * (size_t)mesh->vertex_count, sizeof(double));
  if (!walker->force) return status_no_memory("a path");
  return contact_system_create(&walker->system, &def);
}

// An ellipse in x and z that also goes across: x = slide · sin, y = ACROSS slide · sin 2t, z = −depth ± …
static void place_at(const Walk *walk, double t, double at[3], double along[3]) {
  const AppUnseenCase *what = walk->what;
  double swing = (1 - SHALLOWEST) * what->depth;
  at[0] = what->slide * sin(t), along[0] = what->slide * cos(t);
  at[1] = ACROSS * what->slide * sin(2 * t), along[1] = 2 * ACROSS * what->slide * cos(2 * t);
  at[2] = -what->depth + swing * cos(t), along[2] = -swing * sin(t);
}

static void move_to(Walk *walk, const double at[3]) {
  const ContactBody *upper = &walk->mesh->bodies[1];
  memcpy(walk->x, walk->mesh->x, 3 * (size_t)walk->mesh->vertex_count * sizeof(double));
  for (int v = upper->vertex_begin; v < upper->vertex_end; v++)
    for (int c = 0; c < 3; c++) walk->x[3 * v + c] += at[c];
}

static Status evaluate(Walker *walker, const Walk *walk, const double along[3], double step) {
  const AppUnseenMesh *mesh = walk->mesh;
  memset(walker->force, 0, 3 * (size_t)mesh->vertex_count * sizeof(double));
  TRY(contact_system_update(walker->system, 0, walk->x, walk->velocity, 1));
  TRY(contact_evaluate(walker->system, 0, 0, walk->x, &walker->evaluation));
  const ContactEvaluation *evaluation = walker->evaluation;
  contact_system_add_force(walker->system, evaluation, walker->force);
  walker->normal_sum = 0;
  for (int i = 0; i < evaluation->mesh_pair_count; i++)
    walker->normal_sum += vec3_length(vec3_at(evaluation->fields[i].force));
  Vec3 total = {0, 0, 0};
  for (int v = mesh->bodies[1].vertex_begin; v < mesh->bodies[1].vertex_end; v++)
    total = vec3_add(total, vec3_at(walker->force + 3 * v));
  vec3_store(walker->total, total);
  double work = step * vec3_dot(total, vec3_at(along));
  walker->net += work, walker->turned_over += fabs(work);
  return STATUS_OK;
}

static Status answer(Walker *walker, int count, const double *pairs, double *volume, double *centroid) {
  double began = clock_cpu_s();
  TRY(overlap_model_eval(
      walker->model,
      &(OverlapBatch){.pair_count = count, .pairs = pairs, .volume = volume, .centroid = centroid}));
  walker->seconds += clock_cpu_s() - began;
  return STATUS_OK;
}

static void add_pair(Walk *walk, const double pair[24], int i) {
  double truth[8], told[8], volume = walk->volume[1][i], other = walk->volume[0][i];
  walk->volumes[0] += fabs(other - volume), walk->volumes[1] += volume;
  if (!app_evaluation_coordinates(pair, walk->centroid[1] + 3 * i, truth) ||
      !app_evaluation_coordinates(pair, walk->centroid[0] + 3 * i, told))
    return;
  for (int z = 0; z < 8; z++) {
    walk->moments[0] += fabs((other > 0 ? other * told[z] : 0) - volume * truth[z]);
    walk->moments[1] += fabs(volume * truth[z]);
  }
}

// The pairs that share volume, as the bodies of clipping see them, by both models.
static Status compare_pairs(Walk *walk) {
  int count, *tets;
  double *pairs;
  TRY(contact_system_active_pairs(walk->truth.system, walk->truth.evaluation, &count, &pairs, &tets));
  Status status = STATUS_OK;
  for (int first = 0; first < count && !status; first += walk->capacity) {
    int some = count - first < walk->capacity ? count - first : walk->capacity;
    const double *block = pairs + 24 * (size_t)first;
    status = answer(&walk->told, some, block, walk->volume[0], walk->centroid[0]);
    if (!status) status = answer(&walk->truth, some, block, walk->volume[1], walk->centroid[1]);
    for (int i = 0; i < some && !status; i++) add_pair(walk, block + 24 * (size_t)i, i);
  }
  walk->pairs += count;
  memory_free(pairs), memory_free(tets);
  return status;
}

static void compare_forces(Walk *walk) {
  for (int k = 0; k < 3 * walk->mesh->vertex_count; k++) {
    double truth = walk->truth.force[k], difference = walk->told.force[k] - truth;
    walk->nodal[0] += difference * difference, walk->nodal[1] += truth * truth;
  }
  double difference[3];
  for (int c = 0; c < 3; c++) {
    difference[c] = walk->told.total[c] - walk->truth.total[c];
    walk->totals[0] += difference[c] * difference[c];
    walk->totals[1] += walk->truth.total[c] * walk->truth.total[c];
  }
  walk->tangential = fmax(walk->tangential, hypot(difference[0], difference[1]));
  walk->largest_normal = fmax(walk->largest_normal, fabs(walk->truth.total[2]));
  double sum = walk->told.normal_sum - walk->truth.normal_sum;
  walk->normals[0] += sum * sum, walk->normals[1] += walk->truth.normal_sum * walk->truth.normal_sum;
}

static Status go(Walk *walk, const OverlapModel *model, const OverlapModel *clip, int places) {
  TRY(start(&walk->told, walk, model));
  TRY(start(&walk->truth, walk, clip));
  for (int n = 0; n < places; n++) {
    double at[3], along[3], step = TURN / places;
    place_at(walk, n * step, at, along);
    move_to(walk, at);
    TRY(evaluate(&walk->told, walk, along, step));
    TRY(evaluate(&walk->truth, walk, along, step));
    compare_forces(walk);
    TRY(compare_pairs(walk));
  }
  return STATUS_OK;
}

static Status create(Walk *walk) {
  size_t vertices = 3 * (size_t)walk->mesh->vertex_count, capacity = (size_t)walk->capacity;
  walk->x = memory_zeroed(vertices, sizeof(double)), walk->velocity = memory_zeroed(vertices, sizeof(double));
  bool fits = walk->x && walk->velocity;
  for (int m = 0; m < 2; m++) {
    walk->volume[m] = memory_zeroed(capacity, sizeof(double));
    walk->centroid[m] = memory_zeroed(3 * capacity, sizeof(double));
    fits = fits && walk->volume[m] && walk->centroid[m];
  }
  return fits ? STATUS_OK : status_no_memory("a path");
}

static void destroy(Walk *walk) {
  Walker *walkers[] = {&walk->told, &walk->truth};
  for (int m = 0; m < 2; m++) {
    contact_system_destroy(walkers[m]->system);
    memory_free(walkers[m]->force), memory_free(walk->volume[m]), memory_free(walk->centroid[m]);
  }
  memory_free(walk->x), memory_free(walk->velocity);
}

static double ratio(const double sums[2]) {
  return sums[1] > 0 ? sums[0] / sums[1] : NAN;
}

static void finish(const Walk *walk, AppUnseenErrors *errors) {
  const Walker *told = &walk->told, *truth = &walk->truth;
  *errors = (AppUnseenErrors){.pairs = walk->pairs,
                              .volume = ratio(walk->volumes),
                              .moment = ratio(walk->moments),
                              .nodal_force = sqrt(ratio(walk->nodal)),
                              .total_force = sqrt(ratio(walk->totals)),
                              .tangential = walk->tangential / walk->largest_normal,
                              .normal_sum = sqrt(ratio(walk->normals)),
                              .path_work = fabs(told->net) / told->turned_over,
                              .path_work_clip = fabs(truth->net) / truth->turned_over,
                              .seconds = told->seconds,
                              .seconds_clip = truth->seconds};
}

Status app_unseen_path_measure(const AppUnseenCase *what, const AppUnseenMesh *mesh,
                               const OverlapModel *model, const OverlapModel *clip, int places,
                               AppUnseenErrors *errors) {
  Walk walk = {.what = what, .mesh = mesh, .capacity = 4096};
  Status status = create(&walk);
  if (!status) status = go(&walk, model, clip, places);
  if (!status) finish(&walk, errors);
  destroy(&walk);
  return status;
}
