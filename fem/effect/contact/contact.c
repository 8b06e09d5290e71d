// SPDX-License-Identifier: GPL-3.0-or-later
// Contact by overlap volumes, as an effect: hands positions to contact/system.h, and its stiffness to the
// matrix.
#include "fem/effect/contact/contact.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/sink.h"
#include "fem/effect/effect.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/compliance/laws.h"
#include "fem/model/limits.h"
#include "fem/scene/drive.h"
#include "fem/scene/obstacle.h"
#include "overlap/models.h"
#include "overlap/source.h"

typedef struct Contact {
  const FemModel *model; // borrowed
  OverlapModel overlap;
  ContactBody *bodies;   // (model->body_count)
  ContactShape *shapes;  // (shape_count)
  ContactConvex *solids; // of shapes                              (shape_count)
  int shape_count;
  bool has_self; // a body meets itself
  ContactSystem *system;
  double reach;           // pairs closer than this are laid out in the matrix ahead [m]
  ContactCoupled coupled; // what the matrix pattern has
} Contact;

// A pair this close, as a share of the mean edge, is expected to touch soon.
static const double COUPLING_REACH = 0.1;
static const double RADIANS = M_PI / 180; // of a degree

static bool is_wanted(const FemSceneDef *scene) {
  return scene->contact.is_on;
}

static void destroy(void *self) {
  Contact *contact = self;
  contact_system_destroy(contact->system);
  contact_coupled_destroy(&contact->coupled);
  overlap_model_destroy(&contact->overlap);
  memory_free(contact->bodies);
  memory_free(contact->shapes);
  memory_free(contact->solids);
  memory_free(contact);
}

// Obstacles with elements are among the model's drivers.
static double horizon(const void *self, const FemForesight *foresight, double time, double farthest) {
  const FemModel *model = ((const Contact *)self)->model;
  const FemSceneDef *scene = model->scene;
  for (int o = 0; o < scene->obstacle_count; o++)
    if (scene->obstacles[o].kind != FEM_OBSTACLE_MESH)
      farthest = fem_drive_horizon(&scene->obstacles[o].motion, model->length, foresight, time, farthest);
  return farthest;
}

static void list_sides(Contact *contact, const FemCompliance *choice) {
  const FemModel *model = contact->model;
  for (int b = 0; b < model->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    contact->bodies[b] =
        (ContactBody){.name = body->name,
                      .vertex_begin = body->vertex_begin,
                      .vertex_end = body->vertex_end,
                      .tet_begin = body->tet_begin,
                      .tet_end = body->tet_end,
                      .quadratic_begin = body->quadratic_begin,
                      .quadratic_end = body->quadratic_end,
                      .is_obstacle = body->is_obstacle,
                      .smooth = choice->levels[b],
                      .meets_itself = b < model->scene->body_count && model->scene->bodies[b].self_contact};
  }
  for (int b = 0; b < model->body_count; b++)
    contact->has_self = contact->has_self || contact->bodies[b].meets_itself;
  for (int o = 0; o < model->scene->obstacle_count; o++) {
    const FemObstacleDef *def = &model->scene->obstacles[o];
    if (def->kind == FEM_OBSTACLE_MESH) continue;
    fem_obstacle_shape(def, &contact->shapes[contact->shape_count], &contact->solids[contact->shape_count]);
    contact->shape_count++;
  }
}

// The scene's word with its file as seen from here.
static Status locate(const FemSceneDef *scene, char word[PATH_MAX]) {
  char *folder = file_directory_of(scene->path ? scene->path : ".");
  if (!folder) return status_no_memory("a file name");
  bool fits = overlap_source_from(scene->contact.overlap, folder, word, PATH_MAX);
  memory_free(folder);
  return fits ? STATUS_OK : status_fail(STATUS_INPUT, "contact.overlap: the path is too long");
}

// Where the model is named.
static FemSceneWhere find_word(const FemSceneDef *scene) {
  FemSceneWhere where = fem_scene_where(scene, &scene->contact.overlap_place);
  if (scene->path && scene->contact.overlap_place.line == 0)
    snprintf(where.text, sizeof where.text, "%s with --overlap or --set", scene->path);
  return where;
}

Status fem_effect_contact_create_overlap(const FemSceneDef *scene, const char *name, OverlapModel *overlap) {
  char word[PATH_MAX];
  *overlap = (OverlapModel){0};
  if (name) return overlap_models_create(overlap, name);
  TRY(locate(scene, word));
  Status status = overlap_models_create(overlap, word);
  if (!status) return status;
  return status_prefix(status, "%s: contact.overlap", find_word(scene).text);
}

Status fem_effect_contact_check_overlap(const FemSceneDef *scene, const char *name,
                                        const OverlapModel *model) {
  bool has_gradient = overlap_model_has_gradient(model);
  bool is_field = scene->contact.potential == CONTACT_POTENTIAL_FIELD;
  if (has_gradient || (is_field && overlap_model_has_own_centroid(model))) return STATUS_OK;
  return status_fail(
      STATUS_INPUT, "'%s' gives %s: forces need its %s%s. `tetlap eval` grades it on pairs", model->ops->name,
      overlap_model_has_own_centroid(model) ? "V and the centroid" : "V alone",
      is_field ? "centroid or its gradient" : "gradient",
      overlap_source_of(name ? name : scene->contact.overlap) == OVERLAP_SOURCE_PYTHON
          ? " (which PyTorch has where V follows from the pairs, without detach() and no_grad())"
          : "");
}

static Status build(Contact *contact, const FemCompliance *choice) {
  const FemModel *model = contact->model;
  const FemContactDef *def = &model->scene->contact;
  TRY(fem_effect_contact_create_overlap(model->scene, NULL, &contact->overlap));
  if (fem_effect_contact_check_overlap(model->scene, NULL, &contact->overlap))
    return status_prefix(STATUS_INPUT, "%s: contact.overlap", find_word(model->scene).text);
  contact->bodies = memory_zeroed((size_t)model->body_count, sizeof *contact->bodies);
  contact->shapes = memory_zeroed((size_t)model->scene->obstacle_count, sizeof *contact->shapes);
  contact->solids = memory_zeroed((size_t)model->scene->obstacle_count, sizeof *contact->solids);
  if (!contact->bodies || !contact->shapes || !contact->solids) return status_no_memory("the contact bodies");
  const ContactLaw **laws;
  TRY(fem_laws_create(model, &laws));
  list_sides(contact, choice);
  ContactSystemDef system = {.vertex_count = model->vertex_count,
                             .rest = model->rest,
                             .tets = (const int(*)[4])model->tets,
                             .tet_count = model->tet_count,
                             .quadratics = (const int(*)[10])model->quadratic_nodes,
                             .bodies = contact->bodies,
                             .body_count = model->body_count,
                             .shapes = contact->shapes,
                             .shape_count = contact->shape_count,
                             .inner = model->inner,
                             .crease = def->crease * RADIANS,
                             .potential = def->potential,
                             .stiffness = fem_model_contact_stiffness(model),
                             .pair_stiffness = choice->stiffness,
                             .pair_laws = laws,
                             .margin = def->margin,
                             .model = &contact->overlap};
  Status status = contact_system_create(&contact->system, &system);
  memory_free(laws);
  return status;
}

static Status create_with(void **self, const FemModel *model, const FemCompliance *choice) {
  Contact *contact = memory_zeroed(1, sizeof *contact);
  if (!contact) return status_no_memory("contact");
  contact->model = model;
  contact->reach = COUPLING_REACH * model->edge;
  Status status = build(contact, choice);
  if (status)
    destroy(contact);
  else
    *self = contact;
  return status;
}

static Status create(void **self, const FemModel *model) {
  FemCompliance choice;
  TRY(fem_compliance_choose(model, &choice));
  Status status = create_with(self, model, &choice);
  fem_compliance_destroy(&choice);
  return status;
}

Status fem_effect_contact_create_like(void **self, const FemModel *model, const void *of) {
  const Contact *contact = of;
  const ContactLayout *layout = contact_system_layout(contact->system);
  size_t bodies = (size_t)model->body_count, parties = bodies + (size_t)contact->shape_count;
  FemCompliance choice = {.party_count = (int)parties,
                          .stiffness = memory_zeroed(bodies * parties, sizeof *choice.stiffness),
                          .levels = memory_zeroed(bodies, sizeof *choice.levels)};
  Status status = choice.stiffness && choice.levels ? STATUS_OK : status_no_memory("contact");
  for (int i = 0; i < layout->interface_count && !status; i++) {
    const ContactInterfaceDef *interface = &layout->interfaces[i];
    choice.stiffness[(size_t)interface->a * parties + (size_t)interface->b] = interface->stiffness;
  }
  for (size_t b = 0; b < bodies && !status; b++) choice.levels[b] = contact->bodies[b].smooth;
  if (!status) status = create_with(self, model, &choice);
  fem_compliance_destroy(&choice);
  return status;
}

// The overlap model, whose weights may have been replaced on the disk, stays; so do surfaces and laws.
static Status create_again(void **self, void **old) {
  Contact *contact = *old;
  contact_system_start_over(contact->system);
  *self = contact;
  *old = NULL;
  return STATUS_OK;
}

static Status renew(void *self, const FemState *state, double step) {
  Contact *contact = self;
  return contact_system_update(contact->system, state->time, state->positions, state->velocities, step);
}

// The pattern is taken back then, too.
static void forget(void *self) {
  Contact *contact = self;
  contact_system_forget(contact->system);
  contact_coupled_destroy(&contact->coupled);
}

typedef struct Coupling {
  FemPattern *pattern;
  int *has_grown;
} Coupling;

static Status add_clique(void *visitor, int count, const int *vertices) {
  Coupling *coupling = visitor;
  return fem_pattern_add_clique(coupling->pattern, count, vertices, coupling->has_grown);
}

static Status evaluate(Contact *contact, const FemState *state, const ContactEvaluation **evaluation) {
  return contact_evaluate(contact->system, state->version, state->time, state->positions, evaluation);
}

static Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  Contact *contact = self;
  const ContactEvaluation *evaluation;
  TRY(evaluate(contact, state, &evaluation));
  Coupling coupling = {.pattern = pattern, .has_grown = has_grown};
  return contact_system_couple(contact->system, evaluation, contact->reach, &contact->coupled, &coupling,
                               add_clique);
}

static Status add_force(void *self, const FemState *state, double *force) {
  Contact *contact = self;
  const ContactEvaluation *evaluation;
  TRY(evaluate(contact, state, &evaluation));
  contact_system_add_force(contact->system, evaluation, force);
  if (!state->is_held) contact_system_add_resting(contact->system, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)damping_scale; // contact does not damp
  Contact *contact = self;
  if (stiffness_scale == 0) return STATUS_OK;
  const ContactEvaluation *evaluation;
  TRY(evaluate(contact, state, &evaluation));
  FemContactSink sink = {.matrix = matrix, .scale = stiffness_scale};
  const ContactStiffnessSink to = fem_contact_sink_of(&sink);
  return contact_system_stiffness(contact->system, evaluation, &to);
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  Contact *contact = self;
  const ContactEvaluation *evaluation;
  TRY(evaluate(contact, state, &evaluation));
  energy->contact += evaluation->energy;
  // Mesh obstacles are prescribed coordinates, which the system counts.
  energy->driven_power += contact_system_shape_power(contact->system, evaluation);
  return STATUS_OK;
}

// Less a reserve for what accelerates.
static double longest_step(const void *self) {
  return (1 - FEM_RESERVE) * contact_system_longest_step(((const Contact *)self)->system);
}

static void report(void *self, const FemState *state, Record *counters) {
  (void)state;
  Contact *contact = self;
  const ContactCounters *count = contact_system_counters(contact->system);
  record_add(counters, "contact_evaluations", count->evaluations);
  record_add(counters, "contact_pairs", count->pairs.tried);
  record_add(counters, "contact_searches", count->searches);
  record_add(counters, "enclosed_pairs", count->pairs.enclosed);
  record_add(counters, "overlap_fallbacks", count->pairs.fallbacks);
  record_add(counters, "net_pairs", count->pairs.by_net);
  record_add(counters, "overlap_blended", count->pairs.blended);
  record_add(counters, "beyond_range_pairs", count->pairs.beyond);
  record_add(counters, "unsound_pairs", count->pairs.unsound);
  record_add(counters, "beyond_margin", count->beyond_margin);
  if (contact->has_self) record_add(counters, "self_pairs_left_out", count->resting);
}

static size_t bytes(const void *self) {
  const Contact *contact = self;
  return memory_held(self) + memory_held(contact->bodies) + memory_held(contact->shapes) +
         memory_held(contact->solids) + memory_held(contact->coupled.keys) +
         contact_system_bytes(contact->system);
}

const FemEffectOps fem_effect_contact = {
    .name = "contact",
    .help = "bodies and obstacles that overlap are pushed apart by a penalty on the overlap volume",
    .couples_anew = true,
    .is_wanted = is_wanted,
    .create = create,
    .create_again = create_again,
    .couple = couple,
    .renew = renew,
    .forget = forget,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .horizon = horizon,
    .longest_step = longest_step,
    .report = report,
    .bytes = bytes,
    .destroy = destroy,
};

ContactSystem *fem_effect_contact_system(void *effect) {
  return ((Contact *)effect)->system;
}

double fem_effect_contact_reach(const void *effect) {
  const Contact *contact = effect;
  return fmin(contact->reach, contact_system_least_reach(contact->system));
}

Status fem_effect_contact_evaluate(const FemSystem *system, const FemState *state,
                                   const ContactEvaluation **evaluation) {
  Contact *contact = fem_system_effect(system, &fem_effect_contact);
  *evaluation = NULL;
  return contact ? evaluate(contact, state, evaluation) : STATUS_OK;
}

const char *fem_effect_contact_name(const void *effect, int number) {
  const Contact *contact = effect;
  int bodies = contact->model->body_count;
  return number < bodies ? contact->bodies[number].name : contact->shapes[number - bodies].name;
}
