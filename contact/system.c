// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/system.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "contact/audit.h"
#include "contact/footprint.h"
#include "contact/pressure/field_pull.h"
#include "contact/pressure/patch/area.h"
#include "contact/pressure/star_sink.h"
#include "contact/rest.h"
#include "contact/search/gap.h"
#include "contact/search/near.h"
#include "contact/shape/shape.h"
#include "contact/status.h"
#include "contact/stiffness.h"
#include "contact/surface/stars.h"
#include "overlap/slopes.h"

struct ContactSystem {
  ContactStars stars; // what all below works on
  ContactStarSink star_sink;
  ContactLayout layout;
  double *positions; // of the contact mesh, scratch; with virtual vertices or stars only  (position_count, 3)
  double *velocities; // of its vertices, scratch; with stars only                        (vertex_count, 3)
  // By the vertices and tetrahedra as they were given, of the evaluation; with stars only.
  double *given_forces, *given_covered, *given_volumes;
  ContactCandidates candidates;
  ContactNear near;
  ContactRest rest; // made by the first contact_system_hold
  bool has_rest;
  ContactEvaluation evaluation;
  ContactStiffness stiffness;
  ContactEvaluation audits[2]; // candidate, reference; made by the first audit
  bool has_audits;
  // Made when they are first asked for: of the evaluation, and of what rests.
  ContactTrace *traces, *rings, *resting_traces; //                 (given vertex_count)
  ContactStatus status;                          // made when it is first asked for
  bool has_status;
  ContactCounters counters;
};

static void measure_given(const ContactSystemDef *def, double *volumes) {
  for (int i = 0; i < def->tet_count; i++) {
    Vec3 x[4];
    for (int v = 0; v < 4; v++) x[v] = vec3_at(def->rest + 3 * (size_t)def->tets[i][v]);
    volumes[i] = fabs(vec3_det4(x[0], x[1], x[2], x[3])) / 6;
  }
}

// Room for what stands between the contact mesh and the definition as it was given.
static Status reserve(ContactSystem *system, const ContactSystemDef *def) {
  size_t vector = 3 * sizeof(double);
  if (system->layout.mesh.position_count > def->vertex_count) {
    system->positions = memory_zeroed((size_t)system->layout.mesh.position_count, vector);
    if (!system->positions) return status_no_memory("a contact system");
  }
  if (!system->stars.is_needed) return STATUS_OK;
  system->velocities = memory_zeroed((size_t)system->stars.def.vertex_count, vector);
  system->given_forces = memory_zeroed((size_t)def->vertex_count, vector);
  system->given_covered = memory_zeroed((size_t)def->tet_count, sizeof(double));
  system->given_volumes = memory_zeroed((size_t)def->tet_count, sizeof(double));
  if (!system->velocities || !system->given_forces || !system->given_covered || !system->given_volumes)
    return status_no_memory("a contact system");
  measure_given(def, system->given_volumes);
  return contact_star_sink_create(&system->star_sink, &system->stars);
}

static bool is_smooth(const ContactSystemDef *def) {
  for (int b = 0; b < def->body_count; b++)
    if (def->bodies[b].smooth > 0) return true;
  return false;
}

static void begin_counters(ContactSystem *system) {
  system->counters = (ContactCounters){.resting = system->layout.self.left_out.count};
}

// What depends on where the bodies are.
static Status create_lists(ContactSystem *system) {
  TRY(contact_evaluation_create(&system->evaluation, &system->layout));
  if (system->stars.is_needed) {
    system->evaluation.given_forces = system->given_forces;
    system->evaluation.given_covered = system->given_covered;
  }
  TRY(contact_candidates_create(&system->candidates, &system->layout));
  TRY(contact_near_create(&system->near, &system->layout));
  begin_counters(system);
  return STATUS_OK;
}

// A step may be as long as without the points of smooth surfaces, so the margin is that of the bodies' own
// edges.
static Status create_parts(ContactSystem *system, const ContactSystemDef *def) {
  TRY(contact_stars_create(&system->stars, def));
  if (is_smooth(def) && !(def->margin > 0)) system->stars.def.margin = contact_layout_margin(def);
  TRY(contact_layout_create(&system->layout, &system->stars.def));
  TRY(reserve(system, def));
  TRY(contact_stiffness_create(&system->stiffness, &system->layout));
  return create_lists(system);
}

Status contact_system_create(ContactSystem **system, const ContactSystemDef *def) {
  *system = memory_zeroed(1, sizeof **system);
  if (!*system) return status_no_memory("a contact system");
  Status status = create_parts(*system, def);
  if (status) {
    contact_system_destroy(*system);
    *system = NULL;
  }
  return status;
}

void contact_system_destroy(ContactSystem *system) {
  if (!system) return;
  contact_layout_destroy(&system->layout);
  contact_stars_destroy(&system->stars);
  contact_star_sink_destroy(&system->star_sink);
  memory_free(system->positions);
  memory_free(system->velocities);
  memory_free(system->given_forces);
  memory_free(system->given_covered);
  memory_free(system->given_volumes);
  contact_candidates_destroy(&system->candidates);
  contact_near_destroy(&system->near);
  contact_rest_destroy(&system->rest);
  contact_evaluation_destroy(&system->evaluation);
  contact_stiffness_destroy(&system->stiffness);
  for (int k = 0; k < 2; k++) contact_evaluation_destroy(&system->audits[k]);
  contact_status_destroy(&system->status);
  memory_free(system->traces);
  memory_free(system->rings);
  memory_free(system->resting_traces);
  memory_free(system);
}

// Where the contact mesh is; what the inner modules are given.
static const double *place(ContactSystem *system, const double *positions) {
  if (!system->positions) return positions;
  if (system->stars.is_needed)
    contact_stars_place(&system->stars, positions, system->positions);
  else
    memcpy(system->positions, positions, 3 * (size_t)system->layout.def.vertex_count * sizeof(double));
  contact_mesh_place(&system->layout.mesh, &system->layout.def, system->positions);
  return system->positions;
}

const double *contact_system_place(ContactSystem *system, const double *positions) {
  return place(system, positions);
}

const double *contact_system_spread(ContactSystem *system, const double *velocities) {
  if (!system->stars.is_needed) return velocities;
  contact_stars_place(&system->stars, velocities, system->velocities);
  return system->velocities;
}

const ContactStars *contact_system_stars(const ContactSystem *system) {
  return &system->stars;
}

const ContactStiffnessSink *contact_system_sink(ContactSystem *system, const ContactStiffnessSink *sink) {
  return system->stars.is_needed ? contact_star_sink_to(&system->star_sink, sink) : sink;
}

void contact_system_carriers(ContactSystem *system, int *count, const int **vertices) {
  if (!system->stars.is_needed) return;
  contact_star_sink_gather(&system->star_sink, *count, *vertices);
  *count = system->star_sink.count, *vertices = system->star_sink.vertices;
}

// What the evaluation found, by the vertices and tetrahedra as they were given.
static void fold_result(ContactSystem *system) {
  const ContactEvaluation *evaluation = &system->evaluation;
  if (!system->stars.is_needed) return;
  memset(system->given_forces, 0, 3 * (size_t)system->stars.given_vertex_count * sizeof(double));
  for (int v = 0; v < system->stars.def.vertex_count; v++)
    contact_stars_push(&system->stars, v, vec3_at(evaluation->forces + 3 * (size_t)v), system->given_forces);
  contact_stars_cover(&system->stars, evaluation->covered, system->given_volumes, system->given_covered);
}

void contact_system_forget(ContactSystem *system) {
  contact_near_forget(&system->near);
  system->candidates.is_made = false;
}

void contact_system_start_over(ContactSystem *system) {
  contact_rest_destroy(&system->rest);
  system->has_rest = false;
  system->evaluation.rest = NULL;
  contact_candidates_leave_out(&system->candidates, &system->layout, NULL);
  system->candidates.searches = 0;
  system->candidates.search_s = 0;
  contact_system_forget(system);
  contact_evaluation_start_over(&system->evaluation, &system->layout);
  fold_result(system);
  begin_counters(system);
}

// Whether pairs that are known to stay apart need not be asked for.
static bool evaluates_near(const ContactSystem *system) {
  return !overlap_model_has_ghosts(system->layout.def.model);
}

static Status update(ContactSystem *system, double time, const double *positions, const double *velocities,
                     double step) {
  positions = place(system, positions);
  TRY(contact_candidates_update(&system->candidates, &system->layout, time, positions,
                                contact_system_spread(system, velocities), step));
  system->counters.searches = system->candidates.searches;
  if (evaluates_near(system))
    TRY(contact_near_update(&system->near, &system->layout, &system->candidates, time, positions));
  return STATUS_OK;
}

Status contact_system_update(ContactSystem *system, double time, const double *positions,
                             const double *velocities, double step) {
  ContactCounters *counters = &system->counters;
  double began = clock_wall_s(), searched_s = system->candidates.search_s;
  Status status = update(system, time, positions, velocities, step);
  searched_s = system->candidates.search_s - searched_s;
  counters->broad_s += searched_s;
  counters->update_s += clock_wall_s() - began - searched_s;
  return status;
}

Status contact_system_keep(ContactSystem *system) {
  return contact_candidates_keep(&system->candidates, &system->layout);
}

double contact_system_least_reach(const ContactSystem *system) {
  return contact_candidates_least_reach(&system->layout);
}

double contact_system_longest_step(const ContactSystem *system) {
  return system->candidates.time_left;
}

static Status check_margin(ContactSystem *system, double time, const double *positions) {
  if (contact_candidates_cover(&system->candidates, &system->layout, time, positions)) return STATUS_OK;
  system->counters.beyond_margin++;
  return status_fail(
      STATUS_RETRY,
      "contact: at t = %g s bodies have moved farther than the last search allows; use a smaller step", time);
}

static void count(ContactCounters *counters, const ContactEvaluation *evaluation) {
  counters->evaluations++;
  const ContactPairCounts *counts = &evaluation->counts;
  counters->pairs.tried += counts->tried;
  counters->pairs.enclosed += counts->enclosed;
  counters->pairs.fallbacks += counts->fallbacks;
  counters->pairs.by_net += counts->by_net;
  counters->pairs.blended += counts->blended;
  counters->pairs.beyond += counts->beyond;
  counters->pairs.unsound += counts->unsound;
  counters->overlap_s += evaluation->overlap_s;
  counters->force_s += evaluation->force_s;
}

// Where the contact mesh is.
static Status evaluate(ContactSystem *system, double time, const double *positions) {
  ContactEvaluation *evaluation = &system->evaluation;
  TRY(check_margin(system, time, positions));
  const ContactCandidateList *list =
      contact_near_choose(&system->near, &system->layout, &system->candidates, time, positions);
  TRY(contact_evaluation_run(evaluation, &system->layout, list, system->layout.def.model, true, time,
                             positions));
  count(&system->counters, evaluation);
  if (system->has_rest) system->counters.left_at_rest += system->rest.candidate_count;
  fold_result(system);
  return STATUS_OK;
}

Status contact_evaluate(ContactSystem *system, long long version, double time, const double *positions,
                        const ContactEvaluation **evaluation) {
  ContactEvaluation *own = &system->evaluation;
  *evaluation = own;
  if (version != 0 && own->version == version) return STATUS_OK;
  TRY(evaluate(system, time, place(system, positions)));
  own->version = version;
  return STATUS_OK;
}

static Status make_rest(ContactSystem *system) {
  if (system->has_rest) return STATUS_OK;
  contact_rest_destroy(&system->rest);
  TRY(contact_rest_create(&system->rest, &system->layout));
  system->evaluation.rest = &system->rest;
  system->has_rest = true;
  return STATUS_OK;
}

static Status reserve_traces(ContactSystem *system, ContactTrace **traces) {
  size_t count = (size_t)system->stars.given_vertex_count;
  if (!*traces) *traces = memory_zeroed(count, sizeof **traces);
  return *traces ? STATUS_OK : status_no_memory("pressures at the surface");
}

// Of what is put to rest by an evaluation.
static Status keep_traces(ContactSystem *system) {
  const ContactLayout *layout = &system->layout;
  if (!contact_layout_has_field(layout)) return STATUS_OK;
  TRY(reserve_traces(system, &system->resting_traces));
  memset(system->resting_traces, 0, (size_t)system->stars.given_vertex_count * sizeof(ContactTrace));
  contact_trace_add(layout, &system->stars, &system->evaluation, system->rest.is_resting, NULL,
                    system->resting_traces);
  return STATUS_OK;
}

Status contact_system_trace(ContactSystem *system, const ContactEvaluation *evaluation,
                            const double (*pulls)[3], const ContactTraceResult *result) {
  const ContactLayout *layout = &system->layout;
  int count = system->stars.given_vertex_count;
  TRY(reserve_traces(system, &system->traces));
  TRY(reserve_traces(system, &system->rings));
  memset(system->rings, 0, (size_t)count * sizeof *system->rings);
  if (system->resting_traces && system->has_rest && system->rest.resting_count > 0)
    memcpy(system->traces, system->resting_traces, (size_t)count * sizeof *system->traces);
  else
    memset(system->traces, 0, (size_t)count * sizeof *system->traces);
  if (contact_layout_has_field(layout)) {
    contact_trace_add(layout, &system->stars, evaluation, NULL, pulls, system->traces);
    contact_trace_ring(layout, &system->stars, evaluation->positions, system->traces, system->rings);
  }
  contact_trace_find(count, system->traces, system->rings, result);
  return STATUS_OK;
}

void contact_system_gaps(ContactSystem *system, const ContactEvaluation *evaluation, double *gaps) {
  for (int v = 0; v < system->stars.given_vertex_count; v++) gaps[v] = INFINITY;
  if (contact_layout_has_field(&system->layout))
    contact_gap_find(&system->candidates, &system->layout, &system->stars, evaluation->time,
                     evaluation->positions, gaps);
}

static void find_areas(const ContactSystem *system, const ContactEvaluation *evaluation, double *areas) {
  for (int p = 0; p < evaluation->patches.patch_count; p++) {
    const ContactPatch *patch = &evaluation->patches.patches[p];
    areas[patch->interface] = contact_area_find(&system->layout, evaluation, patch);
  }
}

void contact_system_areas(const ContactSystem *system, const ContactEvaluation *evaluation, double *areas) {
  for (int f = 0; f < system->layout.interface_count; f++)
    areas[f] = contact_system_is_resting(system, f) ? system->rest.areas[f] : 0;
  find_areas(system, evaluation, areas);
}

int contact_system_origin(const ContactSystem *system, int tet) {
  return system->stars.is_needed ? system->stars.origin[tet] : tet;
}

Status contact_system_hold(ContactSystem *system, double time, const double *positions,
                           const double *velocities, double step, const bool *is_held) {
  const ContactLayout *layout = &system->layout;
  TRY(make_rest(system));
  contact_rest_clear(&system->rest, layout);
  contact_candidates_leave_out(&system->candidates, layout, NULL);
  contact_near_forget(&system->near);
  contact_evaluation_start_over(&system->evaluation, layout);
  contact_system_forget(system);
  TRY(update(system, time, positions, velocities, step));
  if (!is_held) return STATUS_OK;
  positions = place(system, positions);
  TRY(evaluate(system, time, positions));
  contact_rest_keep(&system->rest, layout, &system->candidates.list, &system->evaluation.patches,
                    system->evaluation.interfaces, is_held);
  find_areas(system, &system->evaluation, system->rest.areas);
  TRY(keep_traces(system));
  contact_candidates_leave_out(&system->candidates, layout, system->rest.is_resting);
  contact_near_forget(&system->near);
  contact_evaluation_start_over(&system->evaluation, layout);
  fold_result(system);
  return STATUS_OK;
}

bool contact_system_is_resting(const ContactSystem *system, int interface) {
  return system->has_rest && system->rest.is_resting[interface];
}

bool contact_system_is_near(const ContactSystem *system, int interface) {
  if (system->has_rest && system->rest.is_resting[interface]) return system->rest.is_near[interface];
  const int *begin = system->candidates.list.begin;
  return begin[interface + 1] > begin[interface];
}

void contact_system_add_force(const ContactSystem *system, const ContactEvaluation *evaluation,
                              double *force) {
  for (int n = 0; n < evaluation->patches.node_count; n++) {
    const ContactNode *node = &evaluation->patches.nodes[n];
    contact_stars_push(&system->stars, node->vertex, vec3_at(node->force), force);
  }
}

void contact_system_add_resting(const ContactSystem *system, double *force) {
  if (!system->has_rest || system->rest.resting_count == 0) return;
  for (int v = 0; v < system->layout.def.vertex_count; v++)
    contact_stars_push(&system->stars, v, vec3_at(system->rest.forces + 3 * (size_t)v), force);
}

Status contact_system_stiffness(ContactSystem *system, const ContactEvaluation *evaluation,
                                const ContactStiffnessSink *sink) {
  return contact_stiffness_add(&system->stiffness, &system->layout, evaluation, CONTACT_ALL_INTERFACES,
                               &(ContactStiffnessWay){false, NULL}, contact_system_sink(system, sink));
}

void contact_system_add_force_of(const ContactSystem *system, const ContactEvaluation *evaluation,
                                 int interface, double *force) {
  const ContactPatches *patches = &evaluation->patches;
  for (int p = 0; p < patches->patch_count; p++) {
    const ContactPatch *patch = &patches->patches[p];
    for (int n = patch->node_begin; n < patch->node_end && patch->interface == interface; n++)
      contact_stars_push(&system->stars, patches->nodes[n].vertex, vec3_at(patches->nodes[n].force), force);
  }
}

double contact_system_energy_of(const ContactEvaluation *evaluation, int interface) {
  double energy = 0;
  for (int k = 0; k < evaluation->pair_count; k++)
    if (evaluation->pairs[k].interface == interface) energy += evaluation->fields[k].energy;
  return energy;
}

Status contact_system_turn(ContactSystem *system, const ContactEvaluation *evaluation, int interface,
                           const ContactStiffnessSink *sink) {
  ContactStiffnessWay way = {.is_turned = true};
  if (overlap_slopes_are_there(system->layout.def.model))
    TRY(contact_system_slopes(system, evaluation, &way.slopes));
  return contact_stiffness_add(&system->stiffness, &system->layout, evaluation, interface, &way,
                               contact_system_sink(system, sink));
}

Status contact_system_slopes(ContactSystem *system, const ContactEvaluation *evaluation,
                             const double **slopes) {
  *slopes = NULL;
  assert(evaluation == &system->evaluation);
  TRY(contact_evaluation_find_slopes(&system->evaluation, &system->layout, system->layout.def.model));
  *slopes = evaluation->slopes;
  return STATUS_OK;
}

// By the pair's F and λ(x̄), whose forces on the vertices are λ F and its opposite.
static ContactFieldSlopes slopes_of_forces(const ContactLayout *layout, const ContactPair *pair,
                                           const ContactFieldPair *field, const double *forces,
                                           double weight) {
  ContactFieldSlopes by = {{0, 0, 0}, 0, {{0}}};
  for (int t = 0; t < 2; t++)
    for (int v = 0; v < 4; v++) {
      int vertex = contact_layout_vertices(layout, pair->cells[t])[v];
      Vec3 own = vec3_scale(t == 0 ? weight : -weight, vec3_at(forces + 3 * (size_t)vertex));
      by.weights[t][v] = vec3_dot(own, vec3_at(field->force));
      vec3_accumulate(by.force, vec3_scale(field->weights[t][v], own));
    }
  return by;
}

Status contact_system_pull(ContactSystem *system, const ContactEvaluation *evaluation, int interface,
                           const double *forces, double weight, double *answers) {
  const double *slopes, *spread = contact_system_spread(system, forces);
  TRY(contact_system_slopes(system, evaluation, &slopes));
  for (int k = 0; k < evaluation->mesh_pair_count; k++) {
    const ContactPair *pair = &evaluation->pairs[k];
    const ContactFieldPair *field = &evaluation->fields[k];
    double slope[24] = {0};
    if (interface != CONTACT_ALL_INTERFACES && pair->interface != interface) continue;
    const ContactFieldSlopes by = slopes_of_forces(&system->layout, pair, field, spread, weight);
    contact_field_pull(&system->layout, pair, evaluation->coordinates + 24 * (size_t)k, field,
                       slopes + 96 * (size_t)k, &by, slope, answers + 4 * (size_t)k);
  }
  return STATUS_OK;
}

// Hands on cliques by the vertices as they were given.
typedef struct Visit {
  ContactSystem *system;
  void *visitor;
  Status (*visit)(void *visitor, int count, const int *vertices);
} Visit;

static Status visit_given(void *visitor, int count, const int *vertices) {
  const Visit *visit = visitor;
  contact_system_carriers(visit->system, &count, &vertices);
  return visit->visit(visit->visitor, count, vertices);
}

Status contact_system_couple(ContactSystem *system, const ContactEvaluation *evaluation, double reach,
                             ContactCoupled *coupled, void *visitor,
                             Status (*visit)(void *visitor, int count, const int *vertices)) {
  Visit given = {system, visitor, visit};
  return contact_stiffness_couple(&system->stiffness, &system->layout, &system->candidates.list,
                                  evaluation->time, evaluation->positions, reach, coupled, &given,
                                  visit_given);
}

Status contact_system_active_pairs(const ContactSystem *system, const ContactEvaluation *evaluation,
                                   int *pair_count, double **pairs, int **tets) {
  size_t active = (size_t)evaluation->mesh_pair_count;
  *pair_count = evaluation->mesh_pair_count;
  *pairs = memory_copy(evaluation->coordinates, active, OVERLAP_PAIR_SIZE * sizeof(double));
  *tets = memory_zeroed(active, 2 * sizeof(int));
  if (!*pairs || !*tets) {
    memory_free(*pairs), memory_free(*tets);
    *pairs = NULL, *tets = NULL;
    return status_no_memory("overlapping pairs");
  }
  for (size_t k = 0; k < active; k++)
    for (int side = 0; side < 2; side++)
      (*tets)[2 * k + (size_t)side] =
          contact_layout_origin(&system->layout, evaluation->pairs[k].cells[side]);
  return STATUS_OK;
}

// A shape that moves by v(x) changes V as vertices that moved by −v would.
double contact_system_shape_power(const ContactSystem *system, const ContactEvaluation *evaluation) {
  const ContactLayout *layout = &system->layout;
  const ContactPatches *patches = &evaluation->patches;
  double power = 0;
  for (int p = 0; p < patches->patch_count; p++) {
    int s = layout->interfaces[patches->patches[p].interface].shape;
    if (s < 0) continue;
    for (int n = patches->patches[p].node_begin; n < patches->patches[p].node_end; n++) {
      const ContactNode *node = &patches->nodes[n];
      Vec3 x = vec3_at(evaluation->positions + 3 * (size_t)node->vertex);
      Vec3 velocity = contact_shape_velocity(&layout->def.shapes[s], evaluation->time, x);
      power += vec3_dot(vec3_at(node->force), velocity);
    }
  }
  return power;
}

const ContactCounters *contact_system_counters(const ContactSystem *system) {
  return &system->counters;
}

const double *contact_system_blamed(const ContactSystem *system) {
  const ContactEvaluation *evaluation = &system->evaluation;
  return evaluation->blamed < 0 ? NULL : evaluation->coordinates + 24 * (size_t)evaluation->blamed;
}

size_t contact_system_bytes(const ContactSystem *system) {
  size_t sum = memory_held(system) + memory_held(system->positions) + memory_held(system->velocities) +
               memory_held(system->given_forces) + memory_held(system->given_covered) +
               memory_held(system->given_volumes) + memory_held(system->traces) + memory_held(system->rings) +
               memory_held(system->resting_traces) + contact_stars_bytes(&system->stars) +
               contact_star_sink_bytes(&system->star_sink) + contact_footprint_layout(&system->layout) +
               contact_footprint_candidates(&system->candidates) + contact_footprint_near(&system->near) +
               contact_stiffness_bytes(&system->stiffness) + contact_footprint_status(&system->status) +
               contact_footprint_rest(&system->rest);
  for (int k = 0; k < 2; k++) sum += contact_footprint_evaluation(&system->audits[k]);
  return sum + contact_footprint_evaluation(&system->evaluation);
}

const ContactLayout *contact_system_layout(const ContactSystem *system) {
  return &system->layout;
}

static Status create_audits(ContactSystem *system) {
  if (system->has_audits) return STATUS_OK;
  for (int k = 0; k < 2; k++) {
    contact_evaluation_destroy(&system->audits[k]);
    TRY(contact_evaluation_create(&system->audits[k], &system->layout));
  }
  system->has_audits = true;
  return STATUS_OK;
}

Status contact_system_near_pairs(ContactSystem *system, double time, const double *positions, int *count,
                                 const double **pairs) {
  positions = place(system, positions);
  TRY(check_margin(system, time, positions));
  TRY(create_audits(system));
  ContactEvaluation *listed = &system->audits[0];
  TRY(contact_evaluation_list(listed, &system->layout, &system->candidates.list, positions));
  *count = listed->mesh_pair_count, *pairs = listed->coordinates;
  return STATUS_OK;
}

bool contact_system_asks_model(const ContactSystem *system) {
  for (int f = 0; f < system->layout.interface_count; f++)
    if (system->layout.interfaces[f].shape < 0) return true;
  return false;
}

Status contact_system_audit(ContactSystem *system, double time, const double *positions,
                            const OverlapModel *candidate, const OverlapModel *reference,
                            ContactAudit *audit) {
  positions = place(system, positions);
  TRY(check_margin(system, time, positions));
  TRY(create_audits(system));
  const OverlapModel *models[2] = {candidate, reference};
  for (int k = 0; k < 2; k++)
    TRY(contact_evaluation_run(&system->audits[k], &system->layout, &system->candidates.list, models[k],
                               false, time, positions));
  *audit = contact_audit_compare(&system->layout, &system->audits[0], &system->audits[1]);
  return STATUS_OK;
}

Status contact_system_status(ContactSystem *system, double time, const double *positions,
                             const OverlapModel *reference, const ContactStatus **status) {
  positions = place(system, positions);
  TRY(check_margin(system, time, positions));
  if (!system->has_status) TRY(contact_status_create(&system->status, &system->layout));
  system->has_status = true;
  TRY(contact_status_run(&system->status, &system->layout, &system->candidates.list, system->layout.def.model,
                         reference, positions));
  contact_stars_spread(&system->stars, system->status.predicted);
  contact_stars_spread(&system->stars, system->status.exact);
  contact_stars_spread(&system->stars, system->status.error);
  contact_stars_spread(&system->stars, system->status.wrong_pairs);
  *status = &system->status;
  return STATUS_OK;
}
