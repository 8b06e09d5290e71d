// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/compliance.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/surface/roundness.h"
#include "contact/surface/smooth/smooth_points.h"
#include "fem/model/compliance/blow.h"
#include "fem/model/compliance/leaf.h"
#include "fem/model/compliance/patch.h"
#include "fem/model/compliance/thickness.h"
#include "fem/model/compliance/tip.h"
#include "fem/model/limits.h"
#include "fem/model/parts.h"

// The deformation of the interface over that of the bodies, and its depth over the height in an impact, at
// most.
static const double GIVE = 0.02, BLOW_DEPTH = 0.01;
// Pressed between faces that hold it, a body is stiffer than E by 1/(1 − HELD ν⁴): a fit, not above what
// cubes have (1.048 at ν = .3, 1.169 at .45), that keeps the give below 2 % at any ν.
static const double HELD = 3.5;
// Where a surface curves: the deformation of the interface over that of the elements at the surface, at
// least, of what touches in a small patch and of what lies in a hollow, where the pressure varies less; the
// depth of the overlap over the sagittas, at least; and by what share radii in a hollow differ, at most.
static const double LAYER_GIVE = 0.34, HOLLOW_GIVE = 0.25, SAGITTAS = 2.5, SNUG = 0.25;
// Edges in the radius of a patch from which on they resolve it; a radius over that of the curvature from
// which on bodies are squeezed as a whole.
static const double RESOLVED = 2.2, WIDE = 0.6;
// The depth at which a tip gives way over the reach of its elements, at most.
static const double TIP_DEPTH = 0.2;

// Of every body; an obstacle is rigid and has none, nor has a body that is held as a whole.
typedef struct Give {
  FemExtent extent; // its height is L
  double wall;      // L of an impact (thickness.h) [m]
  double inverse;   // 1/E [1/Pa]
  double give;      // (1 − HELD ν⁴)/E: of what is pressed between faces that hold it [1/Pa]; of several
                    // materials the mean over the volume, and no more than the skin's
  double skin;      // the mean of it over the surface
  double volume;    // V [m³]
  ContactRoundness roundness;
  FemTip tip;
  double low[3], high[3]; // the box around it at rest; of a shape without elements that of its radius [m]
} Give;

// What the whole scene says of how hard its bodies meet.
typedef struct Course {
  double blow;   // the hardest [J]
  double travel; // of what is driven in a static scene, the farthest [m]
} Course;

// Whether the body has vertices that cannot move, and others; `held` by vertices.
static bool find_held(const FemModel *model, const FemModelBody *body, bool *held) {
  int count = 0;
  for (int v = body->vertex_begin; v < body->vertex_end; v++) {
    const bool *is_prescribed = model->is_prescribed + 3 * (size_t)v;
    held[v] = is_prescribed[0] && is_prescribed[1] && is_prescribed[2];
    count += held[v];
  }
  return count > 0 && count < body->vertex_end - body->vertex_begin;
}

static Status measure_roundness(const FemModel *model, int b, bool *held, ContactRoundness *roundness) {
  const FemModelBody *body = &model->bodies[b];
  ContactBody side = {.vertex_begin = body->vertex_begin,
                      .vertex_end = body->vertex_end,
                      .tet_begin = body->tet_begin,
                      .tet_end = body->tet_end};
  ContactSystemDef def = {.vertex_count = model->vertex_count,
                          .rest = model->rest,
                          .tets = (const int(*)[4])model->tets,
                          .tet_count = model->tet_count,
                          .inner = model->inner};
  return contact_roundness_measure(roundness, &def, &side, model->scene->contact.crease * M_PI / 180,
                                   find_held(model, body, held) ? held : NULL);
}

// Obstacles without elements have no edges.
static void measure_shapes(const FemModel *model, Give *gives) {
  int party = model->body_count;
  for (int o = 0; o < model->scene->obstacle_count; o++) {
    const FemObstacleDef *def = &model->scene->obstacles[o];
    if (def->kind == FEM_OBSTACLE_MESH) continue;
    if (def->kind == FEM_OBSTACLE_BALL || def->kind == FEM_OBSTACLE_CYLINDER)
      gives[party].roundness.round = 1 / def->radius;
    for (int c = 0; c < 3; c++) {
      gives[party].low[c] = def->point[c] - def->radius;
      gives[party].high[c] = def->point[c] + def->radius;
    }
    party++;
  }
}

static void measure_box(const FemModel *model, const FemModelBody *body, Give *give) {
  for (int c = 0; c < 3; c++) give->low[c] = INFINITY, give->high[c] = -INFINITY;
  for (int v = body->vertex_begin; v < body->vertex_end; v++)
    for (int c = 0; c < 3; c++) {
      give->low[c] = fmin(give->low[c], model->rest[3 * (size_t)v + (size_t)c]);
      give->high[c] = fmax(give->high[c], model->rest[3 * (size_t)v + (size_t)c]);
    }
}

static double inverse_of(const FemMaterial *material) {
  return 1 / material->young;
}

static double give_of_material(const FemMaterial *material) {
  double square = material->poisson * material->poisson;
  return (1 - HELD * square * square) / material->young;
}

// Rays through all faces: not where nothing strikes, or c is given.
static Status measure_wall(const FemModel *model, int body, double blow, Give *give) {
  FemThickness found = {.wall = give->extent.height};
  if (blow > 0) TRY(fem_thickness_find(model, body, &found));
  give->wall = found.wall;
  return STATUS_OK;
}

static Status measure_bodies(const FemModel *model, double blow, Give *gives) {
  bool *held = memory_zeroed((size_t)model->vertex_count, sizeof *held);
  Status status = held ? STATUS_OK : status_no_memory("the curvature of a body");
  for (int b = 0; b < model->body_count && !status; b++)
    status = measure_roundness(model, b, held, &gives[b].roundness),
    measure_box(model, &model->bodies[b], &gives[b]);
  memory_free(held);
  TRY(status);
  for (int b = 0; b < model->body_count; b++) TRY(fem_tip_find(model, b, &gives[b].tip));
  measure_shapes(model, gives);
  for (int b = 0; b < model->scene->body_count; b++) {
    if (fem_model_is_rigid(model, b)) continue;
    TRY(fem_extent_measure(model, b, &gives[b].extent));
    TRY(measure_wall(model, b, blow, &gives[b]));
    gives[b].inverse = fem_model_parts_mean(model, b, inverse_of);
    gives[b].skin = fem_model_parts_surface_mean(model, b, give_of_material);
    gives[b].give = fmin(fem_model_parts_mean(model, b, give_of_material), gives[b].skin);
    gives[b].volume = fem_model_parts_volume(model, b);
  }
  return STATUS_OK;
}

// By how much two bodies yield for each Pa between them [m/Pa]: no patch of contact is larger than the
// smaller one, and material farther away than its height deforms little.
static double give_of(const Give *a, const Give *b) {
  if (!(a->give > 0) || !(b->give > 0)) return a->extent.height * a->give + b->extent.height * b->give;
  return fmin(a->extent.height, b->extent.height) * (a->give + b->give);
}

// How two meet of which one curves at least.
typedef struct Meeting {
  bool is_curved, is_hollow; // one lies in the other's hollow
  double curvature;          // [1/m]
  double radius;             // of their contact; 0: not known [m]
  double layer;              // what the interface must yield for each Pa [m/Pa]
  double leaf;               // the most that two bent leaves bear; INFINITY: they are none [Pa/m]
} Meeting;

// A small patch yields by δ = π/2 a Σ 1/E' times the pressure in its middle.
static double give_at(const Give *a, const Give *b, const Meeting *meeting) {
  double give = give_of(a, b);
  if (!(meeting->radius > 0) || meeting->is_hollow) return give;
  return fmin(give, M_PI / 2 * meeting->radius * (a->give + b->give));
}

// What the interface must hold in an impact: the pressure p between two bodies that store its energy, evenly
// strained; beyond E, where they store no more, p²/E, so that their edges hold it.
static double pressure_of(const Give *a, const Give *b, double blow) {
  double stored = a->volume * a->inverse + b->volume * b->inverse;
  double pressure = sqrt(2 * blow / stored), compliance = fmax(a->inverse, b->inverse);
  return pressure * fmax(1, pressure * compliance);
}

// At which the tip of one gives way in time. Coarser elements than its own are as much stiffer as they are
// larger, by their area.
static double sharp_of(const Give *tip, const Give *other) {
  if (!(tip->tip.slope > 0)) return 0;
  double coarser = fmax(1, other->roundness.edge / tip->tip.reach);
  double give = tip->give + other->give / (coarser * coarser);
  return give > 0 ? 1.5 * tip->tip.slope / (TIP_DEPTH * tip->tip.reach * give) : 0;
}

// Between two bodies: stiff enough for a press and for an impact [J], and where a surface curves no stiffer
// than its elements resolve. `terms`: of p = terms · c d.
static double stiffness_between(const Give *a, const Give *b, double blow, int terms, const Meeting *meeting,
                                FemComplianceBound *bound) {
  double sum = give_at(a, b, meeting), wall = a->wall, sharp = fmax(sharp_of(a, b), sharp_of(b, a));
  *bound = FEM_COMPLIANCE_BODIES;
  if (!(sum > 0)) return 0;
  if (b->wall > 0) wall = wall > 0 ? fmin(wall, b->wall) : b->wall;
  double stiffness = 1 / (terms * GIVE * sum), struck = pressure_of(a, b, blow) / (terms * BLOW_DEPTH * wall);
  if (meeting->layer > GIVE * sum) stiffness = 1 / (terms * meeting->layer), *bound = FEM_COMPLIANCE_ELEMENTS;
  if (meeting->leaf < stiffness) stiffness = meeting->leaf, *bound = FEM_COMPLIANCE_LEAVES;
  if (struck > stiffness) stiffness = struck, *bound = FEM_COMPLIANCE_BLOW;
  if (sharp > stiffness) stiffness = sharp, *bound = FEM_COMPLIANCE_TIP;
  return stiffness;
}

static double curvature_of(const Give *give) {
  return fmax(give->roundness.round, give->roundness.hollow);
}

// Whether one lies in the other's hollow.
static bool fits(double round, double hollow) {
  return round > 0 && hollow > 0 && fabs(round - hollow) <= SNUG * fmax(round, hollow);
}

// Whether the boxes share half of the lesser one in every direction: two tubes that cross do not.
static bool share_room(const Give *a, const Give *b) {
  for (int c = 0; c < 3; c++) {
    double shared = fmin(a->high[c], b->high[c]) - fmax(a->low[c], b->low[c]);
    if (!(shared >= 0.5 * fmin(a->high[c] - a->low[c], b->high[c] - b->low[c]))) return false;
  }
  return true;
}

static bool lies_in_hollow(const Give *a, const Give *b) {
  return (fits(a->roundness.round, b->roundness.hollow) || fits(b->roundness.round, a->roundness.hollow)) &&
         share_room(a, b);
}

// What is driven may press others by those between.
static double farthest_travel(const FemModel *model) {
  int parties = model->body_count + fem_scene_shape_count(model->scene);
  double farthest = 0;
  for (int p = 0; p < parties && model->scene->is_static; p++)
    farthest = fmax(farthest, fem_patch_travel(model, p));
  return farthest;
}

static double radius_between(const FemModel *model, const Give *gives, const Course *course, int a, int b,
                             double curvature) {
  double force = fmax(fem_patch_load(model, a), fem_patch_load(model, b));
  double give = gives[a].give + gives[b].give;
  if (!(give > 0)) return 0;
  return fem_patch_radius(curvature, 1 / give, course->travel, force, course->blow);
}

// By how much less than LAYER_GIVE the interface yields where more elements resolve the patch.
static double resolved_by(double radius, double edge) {
  return edge > 0 ? fmax(1, radius / (RESOLVED * edge)) : 1;
}

static double leaf_between(const FemModel *model, const Give *gives, int a, int b) {
  const FemExtent extents[2] = {gives[a].extent, gives[b].extent};
  return fem_leaf_stiffness(model, (const int[2]){a, b}, extents);
}

// Only what bulges meets first: a hole in a face that nothing fills does not curve it.
static Meeting meeting_of(const FemModel *model, const Give *gives, const Course *course, int a, int b) {
  const Give *one = &gives[a], *other = &gives[b];
  Meeting meeting = {.curvature = one->roundness.round + other->roundness.round,
                     .is_hollow = lies_in_hollow(one, other),
                     .leaf = INFINITY};
  meeting.is_curved = a != b && meeting.curvature > 0 && !(one->tip.slope > 0) && !(other->tip.slope > 0);
  if (!meeting.is_curved) {
    if (!(curvature_of(one) > 0) && !(curvature_of(other) > 0))
      meeting.leaf = leaf_between(model, gives, a, b);
    return meeting;
  }
  meeting.radius = radius_between(model, gives, course, a, b, meeting.curvature);
  if (!meeting.is_hollow && meeting.radius * meeting.curvature > WIDE) return (Meeting){.leaf = INFINITY};
  if (!meeting.is_hollow && !(meeting.radius > 0)) return meeting; // 2 % hold, whatever the elements are
  double edge = fmax(one->roundness.edge, other->roundness.edge);
  meeting.layer = (meeting.is_hollow ? HOLLOW_GIVE : LAYER_GIVE / resolved_by(meeting.radius, edge)) *
                  (one->roundness.edge * one->skin + other->roundness.edge * other->skin);
  return meeting;
}

static int terms_of(const FemModel *model, int b) {
  return b < model->body_count ? 2 : 1;
}

// Two that do not yield are as stiff as the least of the others.
static void replace_zeros(double *stiffness, size_t count) {
  double least = INFINITY;
  for (size_t k = 0; k < count; k++)
    if (stiffness[k] > 0) least = fmin(least, stiffness[k]);
  for (size_t k = 0; k < count; k++)
    if (!(stiffness[k] > 0)) stiffness[k] = isfinite(least) ? least : 1;
}

static void choose_for_field(const FemModel *model, const Give *gives, const Course *course,
                             FemCompliance *choice) {
  int parties = choice->party_count;
  for (int a = 0; a < model->body_count; a++)
    for (int b = 0; b < parties; b++) {
      Meeting meeting = meeting_of(model, gives, course, a, b);
      choice->stiffness[a * parties + b] =
          stiffness_between(&gives[a], &gives[b], a == b ? 0 : course->blow, terms_of(model, b), &meeting,
                            &choice->bounds[a * parties + b]);
    }
  replace_zeros(choice->stiffness, (size_t)model->body_count * (size_t)parties);
}

// ---- What they may be pressed by.

static double section_of(const Give *give) {
  return give->extent.height > 0 ? give->volume / give->extent.height : INFINITY;
}

static double pressure_between(const FemModel *model, const Give *gives, const Course *course, int a, int b) {
  const Give *one = &gives[a], *other = &gives[b];
  double give = one->give + other->give, curvature = one->roundness.round + other->roundness.round;
  double force = fmax(fem_patch_load(model, a), fem_patch_load(model, b));
  double stored = one->volume * one->inverse + other->volume * other->inverse;
  if (a == b || !(give > 0)) return 0;
  double flat = fmax(force / fmin(section_of(one), section_of(other)), sqrt(2 * course->blow / stored));
  if (!(curvature > 0) || lies_in_hollow(one, other)) return flat;
  double radius = fem_patch_radius(curvature, 1 / give, 0, force, course->blow);
  return fmax(flat, 2 / M_PI * curvature * radius / give);
}

static void estimate_pressures(const FemModel *model, const Give *gives, const Course *course,
                               FemCompliance *choice) {
  for (int a = 0; a < model->body_count; a++)
    for (int b = 0; b < choice->party_count; b++)
      choice->pressures[a * choice->party_count + b] = pressure_between(model, gives, course, a, b);
}

// ---- How often edges are halved.

// The least level at which the depth is as large as SAGITTAS of the facets of both, h²/(8 R · 4^level).
static int level_between(const FemModel *model, const Give *gives, const Course *course, int a, int b,
                         double stiffness) {
  const Meeting meeting = meeting_of(model, gives, course, a, b);
  double sagitta = 0, give = gives[a].give + gives[b].give;
  if (!meeting.is_curved || !(give > 0)) return 0;
  if (meeting.is_hollow) return CONTACT_SMOOTH_MOST_LEVEL;
  if (!(meeting.radius > 0)) return 1;
  for (int side = 0; side < 2; side++) {
    const Give *own = &gives[side ? b : a];
    sagitta += own->roundness.edge * own->roundness.edge * curvature_of(own) / 8;
  }
  double pressure = 2 / M_PI / give * meeting.curvature * meeting.radius;
  double depth = pressure / (terms_of(model, b) * stiffness);
  int level = 0;
  while (level < CONTACT_SMOOTH_MOST_LEVEL && depth * (1 << 2 * level) < SAGITTAS * sagitta) level++;
  return level;
}

static void raise_level(FemCompliance *choice, int body, int level) {
  if (level > choice->levels[body]) choice->levels[body] = level;
}

// Whether every node on an edge lies halfway, to rounding.
static bool has_straight_edges(const FemModel *model, int body) {
  static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  for (int e = model->bodies[body].quadratic_begin; e < model->bodies[body].quadratic_end; e++)
    for (int k = 0; k < 6; k++) {
      const int *nodes = model->quadratic_nodes[e];
      Vec3 a = vec3_at(model->rest + 3 * (size_t)nodes[ends[k][0]]),
           b = vec3_at(model->rest + 3 * (size_t)nodes[ends[k][1]]),
           way = vec3_sub(vec3_at(model->rest + 3 * (size_t)nodes[4 + k]), vec3_scale(0.5, vec3_add(a, b)));
      if (vec3_length(way) > FEM_ROUNDING * vec3_length(vec3_sub(b, a))) return false;
    }
  return true;
}

static void choose_levels(const FemModel *model, const Give *gives, const Course *course,
                          FemCompliance *choice) {
  int wanted = model->scene->contact.smooth, parties = choice->party_count;
  for (int a = 0; a < model->body_count; a++) {
    if (wanted >= 0) choice->levels[a] = wanted;
    for (int b = a + 1; b < parties && wanted < 0; b++) {
      int level = level_between(model, gives, course, a, b, choice->stiffness[a * parties + b]);
      raise_level(choice, a, level);
      if (b < model->body_count) raise_level(choice, b, level);
    }
  }
  for (int a = 0; a < model->body_count; a++) {
    bool is_quadratic = model->bodies[a].quadratic_end > model->bodies[a].quadratic_begin;
    if (!(curvature_of(&gives[a]) > 0)) choice->levels[a] = 0;
    choice->is_faceted[a] = is_quadratic && choice->levels[a] > 0 && has_straight_edges(model, a);
    if (choice->is_faceted[a]) choice->levels[a] = 0;
  }
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

static void set_pair(const FemModel *model, FemCompliance *choice, int a, int b, double stiffness) {
  if (a >= model->body_count) return;
  choice->stiffness[a * choice->party_count + b] = stiffness;
  choice->bounds[a * choice->party_count + b] = FEM_COMPLIANCE_SCENE;
}

static Status apply_pairs(const FemModel *model, FemCompliance *choice) {
  const FemContactDef *contact = &model->scene->contact;
  for (int i = 0; i < contact->pair_count; i++) {
    const FemContactPairDef *pair = &contact->pairs[i];
    TRY(check_pair(model, pair));
    if (!(pair->stiffness > 0)) continue;
    int a = fem_compliance_party(model, pair->names[0]), b = fem_compliance_party(model, pair->names[1]);
    set_pair(model, choice, a, b, pair->stiffness);
    set_pair(model, choice, b, a, pair->stiffness);
  }
  return STATUS_OK;
}

FemFrictionDef fem_compliance_friction(const FemModel *model, int a, int b) {
  const FemContactDef *contact = &model->scene->contact;
  FemFrictionDef friction = contact->friction;
  for (int i = 0; i < contact->pair_count; i++) {
    const FemContactPairDef *pair = &contact->pairs[i];
    int first = fem_compliance_party(model, pair->names[0]),
        second = fem_compliance_party(model, pair->names[1]);
    bool is_theirs = (first == a && second == b) || (first == b && second == a);
    if (is_theirs && pair->friction.coefficient >= 0) friction = pair->friction;
  }
  return friction;
}

static Status choose(const FemModel *model, Give *gives, FemCompliance *choice) {
  const FemContactDef *contact = &model->scene->contact;
  bool is_field = contact->potential == CONTACT_POTENTIAL_FIELD;
  size_t count = (size_t)model->body_count * (size_t)choice->party_count;
  for (size_t k = 0; k < count; k++) choice->stiffness[k] = fem_model_contact_stiffness(model);
  Course course = {0};
  if (is_field) {
    course = (Course){.blow = fem_blow_hardest(model), .travel = farthest_travel(model)};
    TRY(measure_bodies(model, contact->stiffness > 0 ? 0 : course.blow, gives));
  }
  if (is_field && !(contact->stiffness > 0)) choose_for_field(model, gives, &course, choice);
  TRY(apply_pairs(model, choice));
  if (is_field) estimate_pressures(model, gives, &course, choice);
  if (is_field) choose_levels(model, gives, &course, choice);
  return STATUS_OK;
}

Status fem_compliance_choose(const FemModel *model, FemCompliance *choice) {
  int parties = model->body_count + fem_scene_shape_count(model->scene);
  size_t count = (size_t)model->body_count * (size_t)parties;
  *choice = (FemCompliance){.party_count = parties};
  Give *gives = memory_zeroed((size_t)parties, sizeof *gives);
  choice->stiffness = memory_zeroed(count, sizeof *choice->stiffness);
  choice->bounds = memory_zeroed(count, sizeof *choice->bounds);
  choice->pressures = memory_zeroed(count, sizeof *choice->pressures);
  choice->levels = memory_zeroed((size_t)model->body_count, sizeof *choice->levels);
  choice->is_faceted = memory_zeroed((size_t)model->body_count, sizeof *choice->is_faceted);
  bool fits = gives && choice->stiffness && choice->bounds && choice->pressures && choice->levels &&
              choice->is_faceted;
  Status status = fits ? choose(model, gives, choice) : status_no_memory("contact stiffness");
  memory_free(gives);
  if (status) fem_compliance_destroy(choice);
  return status;
}

void fem_compliance_destroy(FemCompliance *choice) {
  memory_free(choice->stiffness);
  memory_free(choice->bounds);
  memory_free(choice->levels);
  memory_free(choice->pressures);
  memory_free(choice->is_faceted);
  *choice = (FemCompliance){0};
}

bool fem_compliance_meets(const FemModel *model, int a, int b) {
  int bodies = model->scene->body_count;
  if (a == b) return a < bodies && model->scene->bodies[a].self_contact;
  return a < bodies || b < bodies;
}

void fem_compliance_range(const FemModel *model, const FemCompliance *choice, double range[2]) {
  int parties = choice->party_count;
  range[0] = INFINITY, range[1] = 0;
  for (int a = 0; a < model->scene->body_count; a++)
    for (int b = a; b < parties; b++) {
      if (!fem_compliance_meets(model, a, b)) continue;
      range[0] = fmin(range[0], choice->stiffness[a * parties + b]);
      range[1] = fmax(range[1], choice->stiffness[a * parties + b]);
    }
  if (!(range[1] > 0)) range[0] = range[1] = fem_model_contact_stiffness(model);
}
