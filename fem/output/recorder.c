// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/recorder.h"

#include <math.h>
#include <string.h>

#include "base/files/file.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/system_energy.h"
#include "fem/measure/stress.h"
#include "fem/output/columns.h"
#include "fem/output/lines.h"
#include "fem/output/moments.h"
#include "fem/output/reactions.h"
#include "fem/output/vtk/vtu.h"

static bool has_column(const FemRecorder *recorder, int column) {
  return fem_columns_is_wanted(column, recorder->system, recorder->has_status);
}

static ContactSystem *contact_of(const FemSystem *system) {
  void *effect = fem_system_effect(system, &fem_effect_contact);
  return effect ? fem_effect_contact_system(effect) : NULL;
}

static const ContactInterfaceDef *interfaces_of(const FemSystem *system, int *count) {
  ContactSystem *contact = contact_of(system);
  *count = contact ? contact_system_layout(contact)->interface_count : 0;
  return contact ? contact_system_layout(contact)->interfaces : NULL;
}

// The most columns that spreadsheets read. Interfaces that make more have none of their own: then there is
// the force on each body.
enum { MOST_COLUMNS = 16384, OF_INTERFACE = 10, OF_FRICTION = 5 };

static void choose_columns(FemRecorder *recorder) {
  int count, each = OF_INTERFACE + (fem_forces_has_friction(recorder->system) ? OF_FRICTION : 0);
  interfaces_of(recorder->system, &count);
  recorder->told = count;
  if (count <= MOST_COLUMNS / each) return;
  recorder->told = 0;
  log_info("history: the %d pairs of bodies would have more than %d columns: it has the force on each body",
           count, MOST_COLUMNS);
}

// Whether bodies have columns in the place of interfaces.
static bool tells_bodies(const FemRecorder *recorder) {
  return recorder->told < recorder->forces.interface_count;
}

static Status add_friction_columns(FemRecorder *recorder) {
  int count;
  FemHistory *history = &recorder->history;
  const ContactInterfaceDef *interfaces = interfaces_of(recorder->system, &count);
  const void *effect = fem_system_effect(recorder->system, &fem_effect_contact);
  for (int i = 0; i < recorder->told && fem_forces_has_friction(recorder->system); i++) {
    const char *a = fem_effect_contact_name(effect, interfaces[i].a),
               *b = fem_effect_contact_name(effect, interfaces[i].b);
    for (int c = 0; c < 3; c++) TRY(fem_history_add_column(history, "friction_%s_%s_%c_N", a, b, "xyz"[c]));
    TRY(fem_history_add_column(history, "stuck_%s_%s_m2", a, b));
    TRY(fem_history_add_column(history, "slides_%s_%s_m2", a, b));
  }
  return STATUS_OK;
}

static Status add_columns(FemRecorder *recorder) {
  const FemModel *model = recorder->system->model;
  choose_columns(recorder);
  FemHistory *history = &recorder->history;
  for (int i = 0; i < fem_columns_count(); i++)
    if (has_column(recorder, i)) TRY(fem_history_add_column(history, "%s", fem_columns_title(i)));
  for (int b = 0; b < model->scene->body_count; b++)
    for (int c = 0; c < 3; c++)
      TRY(fem_history_add_column(history, "centre_%s_%c_m", model->bodies[b].name, "xyz"[c]));
  int count;
  const ContactInterfaceDef *interfaces = interfaces_of(recorder->system, &count);
  const void *effect = fem_system_effect(recorder->system, &fem_effect_contact);
  for (int i = 0; i < recorder->told; i++)
    for (int c = 0; c < 3; c++)
      TRY(fem_history_add_column(history, "force_%s_%s_%c_N",
                                 fem_effect_contact_name(effect, interfaces[i].a),
                                 fem_effect_contact_name(effect, interfaces[i].b), "xyz"[c]));
  for (int b = 0; b < model->scene->body_count && tells_bodies(recorder); b++)
    for (int c = 0; c < 3; c++)
      TRY(fem_history_add_column(history, "force_%s_%c_N", model->bodies[b].name, "xyz"[c]));
  TRY(fem_reactions_add_columns(history, model));
  for (int b = 0; b < model->scene->body_count && !model->scene->is_static; b++)
    for (int c = 0; c < 3; c++)
      TRY(fem_history_add_column(history, "unbalanced_%s_%c_Ns", model->bodies[b].name, "xyz"[c]));
  for (int i = 0; i < recorder->told; i++) {
    const char *a = fem_effect_contact_name(effect, interfaces[i].a),
               *b = fem_effect_contact_name(effect, interfaces[i].b);
    TRY(fem_history_add_column(history, "contact_area_%s_%s_m2", a, b));
    for (int c = 0; c < 3; c++)
      TRY(fem_history_add_column(history, "contact_centre_%s_%s_%c_m", a, b, "xyz"[c]));
  }
  for (int i = 0; i < recorder->told; i++)
    for (int c = 0; c < 3; c++)
      TRY(fem_history_add_column(history, "moment_%s_%s_%c_Nm",
                                 fem_effect_contact_name(effect, interfaces[i].a),
                                 fem_effect_contact_name(effect, interfaces[i].b), "xyz"[c]));
  recorder->moments = memory_zeroed((size_t)recorder->told, sizeof *recorder->moments);
  if (!recorder->moments) return status_no_memory("the history");
  TRY(add_friction_columns(recorder));
  TRY(fem_probes_add_columns(history, model));
  recorder->row = memory_zeroed((size_t)history->column_count, sizeof *recorder->row);
  return recorder->row ? STATUS_OK : status_no_memory("the history");
}

static Status create(FemRecorder *recorder, const char *directory) {
  const FemModel *model = recorder->system->model;
  size_t vertices = (size_t)model->vertex_count, tets = (size_t)model->tet_count;
  recorder->det_F = memory_zeroed(tets, sizeof *recorder->det_F);
  recorder->overlap = memory_zeroed(tets, sizeof *recorder->overlap);
  if (!recorder->det_F || !recorder->overlap) return status_no_memory("the measures");
  TRY(fem_trouble_watch_create(&recorder->watch, model));
  TRY(fem_ledger_create(&recorder->ledger, recorder->system));
  TRY(fem_probes_create(&recorder->probes, recorder->system));
  TRY(fem_forces_create(&recorder->forces, recorder->system,
                        (directory && (model->scene->write_vtu || model->line_count > 0)) ||
                            model->probe_count > 0));
  if (!directory) return STATUS_OK;
  recorder->writes_vtu = model->scene->write_vtu;
  recorder->writes_history = model->scene->history;
  recorder->directory = memory_copy(directory, strlen(directory) + 1, 1);
  bool has_reactions = fem_reactions_any(model);
  if (has_reactions) recorder->reaction = memory_zeroed(3 * vertices, sizeof *recorder->reaction);
  if (!recorder->directory || (has_reactions && !recorder->reaction))
    return status_no_memory("the output arrays");
  if (recorder->writes_vtu) TRY(fem_frames_create(&recorder->frames, model, recorder->directory));
  TRY(file_make_directories(directory));
  if (!recorder->writes_history) return STATUS_OK;
  char *path = file_join(directory, "history.csv");
  if (!path) return status_no_memory("a file name");
  Status status = fem_history_create(&recorder->history, path);
  memory_free(path);
  return status ? status : add_columns(recorder);
}

// The model that the elements' status is held against.
static Status create_reference(FemRecorder *recorder) {
  const FemSceneDef *scene = recorder->system->model->scene;
  if (!scene->status_reference) return STATUS_OK;
  if (!contact_of(recorder->system))
    return status_fail(STATUS_INPUT,
                       "%s: output.status asks which elements overlap, but the scene has no contact; add a "
                       "'contact' section",
                       scene->path);
  TRY(fem_effect_contact_create_overlap(scene, scene->status_reference, &recorder->reference));
  recorder->has_status = true;
  return STATUS_OK;
}

Status fem_recorder_create(FemRecorder *recorder, FemSystem *system, const char *directory) {
  *recorder = (FemRecorder){.system = system};
  Status status = create_reference(recorder);
  if (!status) status = create(recorder, directory);
  if (status) fem_recorder_destroy(recorder);
  return status;
}

void fem_recorder_destroy(FemRecorder *recorder) {
  fem_frames_destroy(&recorder->frames); // first: one may be being written
  fem_history_destroy(&recorder->history);
  memory_free(recorder->directory);
  memory_free(recorder->row);
  fem_forces_destroy(&recorder->forces);
  fem_ledger_destroy(&recorder->ledger);
  fem_probes_destroy(&recorder->probes);
  memory_free(recorder->moments);
  memory_free(recorder->reaction);
  memory_free(recorder->det_F);
  memory_free(recorder->overlap);
  fem_trouble_watch_destroy(&recorder->watch);
  overlap_model_destroy(&recorder->reference);
  *recorder = (FemRecorder){0};
}

Status fem_recorder_clear(const FemRecorder *recorder) {
  static const char *const names[] = {"frames.pvd", "obstacles.vtu", "history.csv", "summary.json"};
  if (!recorder->directory) return STATUS_OK;
  int frames = file_remove_numbered(recorder->directory, "frame_", ".vtu") +
               file_remove_numbered(recorder->directory, "frame_", ".pvtu");
  int count = frames + file_remove_numbered(recorder->directory, "obstacles_", ".vtu") +
              file_remove_numbered(recorder->directory, "lines_", ".csv");
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    char *path = file_join(recorder->directory, names[k]);
    if (!path) return status_no_memory("a file name");
    count += file_remove(path);
    memory_free(path);
  }
  if (count > 0)
    log_info("%s held an earlier run: it and its %d frames were removed", recorder->directory, frames);
  return STATUS_OK;
}

enum { FEW_ELEMENTS = 4000 }; // for one thread

// `covered`: the covered volume of each element [m³]; NULL: nothing is covered.
static void measure_elements(FemRecorder *recorder, const double *positions, const double *covered,
                             FemMeasures *measures) {
  const FemModel *model = recorder->system->model;
  double least = INFINITY, deepest = 0;
#pragma omp parallel for schedule(static) reduction(min                                                      \
                                                    : least)                                                 \
    reduction(max                                                                                            \
              : deepest) if (model->tet_count > FEW_ELEMENTS)
  for (int e = 0; e < model->tet_count; e++) {
    recorder->det_F[e] = fem_model_det(model, e, positions);
    recorder->overlap[e] = covered ? covered[e] / model->volumes[e] : 0;
    if (model->bodies[model->tet_body[e]].is_obstacle) continue;
    least = fmin(least, recorder->det_F[e]);
    deepest = fmax(deepest, recorder->overlap[e]);
  }
  measures->min_det_F = least;
  measures->deepest_overlap = deepest;
}

static void measure_motion(const FemModel *model, const FemState *state, FemMeasures *measures) {
  Vec3 momentum = {0, 0, 0}, angular = {0, 0, 0};
  for (int a = 0; a < model->vertex_count; a++) {
    Vec3 p = vec3_scale(model->mass[a], vec3_at(state->velocities + 3 * a));
    momentum = vec3_add(momentum, p);
    angular = vec3_add(angular, vec3_cross(vec3_at(state->positions + 3 * a), p));
  }
  vec3_store(measures->momentum, momentum);
  vec3_store(measures->angular_momentum, angular);
}

static void measure_contact(const FemRecorder *recorder, const ContactEvaluation *evaluation,
                            FemMeasures *measures) {
  for (int i = 0; i < recorder->forces.interface_count; i++) {
    measures->overlap_volume += evaluation->interfaces[i].volume;
    double force[3];
    vec3_store(force, vec3_at(recorder->forces.interfaces[i]));
    measures->contact_force = fmax(measures->contact_force, vec3_length(vec3_at(force)));
  }
  measures->active_pairs = contact_evaluation_active_count(evaluation);
}

static void measure_steps(const FemRecorder *recorder, double time, FemMeasures *measures) {
  const FemMomentum *momentum = &recorder->ledger.momentum;
  measures->momentum_gap = fem_momentum_largest_gap(momentum, time, &measures->momentum_body);
}

Status fem_recorder_measure(FemRecorder *recorder, const FemState *state, FemMeasures *measures) {
  const ContactEvaluation *contact;
  *measures = (FemMeasures){0};
  TRY(fem_system_energy(recorder->system, state, &measures->energy));
  TRY(fem_forces_take(&recorder->forces, state));
  TRY(fem_effect_contact_evaluate(recorder->system, state, &contact));
  measure_elements(recorder, state->positions, contact ? contact->given_covered : NULL, measures);
  measure_motion(recorder->system->model, state, measures);
  if (contact) measure_contact(recorder, contact, measures);
  measure_steps(recorder, state->time, measures);
  fem_trouble_find(&recorder->watch, state->positions, contact ? contact->given_forces : NULL,
                   recorder->det_F, recorder->overlap, &measures->trouble);
  return STATUS_OK;
}

// The entry of the ledger for a state that has been measured.
static Status describe(FemRecorder *recorder, const FemState *state, const FemMeasures *measures,
                       FemLedgerEntry *entry) {
  const ContactEvaluation *contact;
  TRY(fem_probes_measure(&recorder->probes, state, &recorder->forces));
  TRY(fem_effect_contact_evaluate(recorder->system, state, &contact));
  *entry = (FemLedgerEntry){.contact = {.count = recorder->forces.interface_count,
                                        .interfaces = contact ? contact->interfaces : NULL,
                                        .forces = (const double(*)[3])recorder->forces.interfaces},
                            .elastic = measures->energy.elastic,
                            .readings = recorder->probes.readings};
  return STATUS_OK;
}

Status fem_recorder_begin_step(FemRecorder *recorder, const FemState *state, const FemMeasures *measures) {
  FemLedgerEntry entry;
  TRY(describe(recorder, state, measures, &entry));
  return fem_ledger_begin(&recorder->ledger, state, &entry);
}

static void fill_passages(const FemRecorder *recorder, const ContactPassageCount *passages,
                          FemTroubleState *state) {
  const ContactPassageEntry *first = &passages->first;
  int interface_count;
  state->count[FEM_TROUBLE_PASSED] = passages->elements;
  if (passages->elements == 0) return;
  const ContactInterfaceDef *interface = &interfaces_of(recorder->system, &interface_count)[first->interface];
  state->first[FEM_TROUBLE_PASSED] = contact_system_origin(contact_of(recorder->system), first->tet);
  state->passed[0] = interface->a;
  state->passed[1] = interface->b;
}

Status fem_recorder_end_step(FemRecorder *recorder, const FemState *state, FemMeasures *measures) {
  FemLedgerEntry entry;
  TRY(describe(recorder, state, measures, &entry));
  TRY(fem_ledger_end(&recorder->ledger, state, &entry));
  measure_steps(recorder, state->time, measures);
  fill_passages(recorder, &recorder->ledger.passage.passed, &measures->trouble);
  return STATUS_OK;
}

void fem_recorder_find_turned(const FemRecorder *recorder, FemTroubleState *state) {
  ContactPassageCount turned = contact_passage_turned(&recorder->ledger.passage);
  fill_passages(recorder, &turned, state);
}

void fem_recorder_accept_step(FemRecorder *recorder) {
  fem_ledger_accept(&recorder->ledger);
}

static void fill_displacement(void *self, size_t first, size_t count, double *values) {
  const FemRecorder *recorder = self;
  for (size_t i = 3 * first; i < 3 * (first + count); i++)
    *values++ = recorder->state->positions[i] - recorder->system->model->rest[i];
}

static void fill_stress(void *self, size_t first, size_t count, double *values) {
  const FemRecorder *recorder = self;
  for (size_t i = 0; i < count; i++)
    fem_stress_find(recorder->system, recorder->state, (int)(first + i), values + 6 * i);
}

static void fill_von_mises(void *self, size_t first, size_t count, double *values) {
  const FemRecorder *recorder = self;
  for (size_t i = 0; i < count; i++) {
    double stress[6];
    fem_stress_find(recorder->system, recorder->state, (int)(first + i), stress);
    values[i] = fem_stress_von_mises(stress);
  }
}

// Moves the arrays that have values to the front; how many.
static int keep_given(FemVtuArray *arrays, size_t count) {
  int kept = 0;
  for (size_t k = 0; k < count; k++)
    if (arrays[k].reals || arrays[k].integers || arrays[k].fill) arrays[kept++] = arrays[k];
  return kept;
}

// Whether forces depend on more than positions and velocities: on what the last accepted state has left.
static bool has_history(const FemSystem *system) {
  return fem_forces_has_friction(system) || fem_system_effect(system, &fem_effect_plasticity);
}

static Status write_frame(FemRecorder *recorder) {
  const FemSystem *system = recorder->system;
  const FemModel *model = system->model;
  const FemState *state = recorder->state;
  if (recorder->reaction) TRY(fem_reactions_measure(recorder->system, state, NULL, recorder->reaction));
  const ContactStatus *status = recorder->status;
  const int *verdicts[] = {status ? status->predicted : NULL, status ? status->exact : NULL,
                           status ? status->error : NULL, status ? status->wrong_pairs : NULL};
  bool has_contact = contact_of(system) != NULL;
  // Those without values are left out.
  FemVtuArray arrays[] = {
      {.name = "displacement", .components = 3, .fill = fill_displacement, .self = recorder},
      {.name = "velocity", .components = 3, .reals = state->velocities},
      {.name = "body", .is_cell = true, .components = 1, .integers = model->tet_body},
      {.name = "material",
       .is_cell = true,
       .components = 1,
       .integers = model->part_count > model->scene->body_count ? model->tet_part : NULL},
      {.name = "det_F", .is_cell = true, .components = 1, .reals = recorder->det_F},
      {.name = "stress", .is_cell = true, .components = 6, .fill = fill_stress, .self = recorder},
      {.name = "von_mises", .is_cell = true, .components = 1, .fill = fill_von_mises, .self = recorder},
      {.name = "trouble", .is_cell = true, .components = 1, .integers = recorder->watch.marks},
      {.name = "contact_force", .components = 3, .reals = recorder->forces.contact},
      {.name = "contact_pressure", .components = 1, .reals = recorder->forces.pressure},
      {.name = "contact_depth", .components = 1, .reals = recorder->forces.depth},
      {.name = "contact_traction", .components = 3, .reals = recorder->forces.traction},
      {.name = "contact_gap", .components = 1, .reals = recorder->forces.gap},
      {.name = "contact_status", .components = 1, .integers = recorder->forces.status},
      {.name = "slip", .components = 3, .reals = recorder->forces.slip},
      {.name = "slip_way", .components = 1, .reals = recorder->forces.way},
      {.name = "friction_work", .components = 1, .reals = recorder->forces.work},
      {.name = "overlap_fraction",
       .is_cell = true,
       .components = 1,
       .reals = has_contact ? recorder->overlap : NULL},
      {.name = "wrong_way", .components = 1, .integers = has_contact ? recorder->watch.is_wrongway : NULL},
      {.name = "reaction", .components = 3, .reals = recorder->reaction},
      {.name = "friction_force", .components = 3, .reals = recorder->forces.friction},
      {.name = "status_predicted", .is_cell = true, .components = 1, .integers = verdicts[0]},
      {.name = "status_exact", .is_cell = true, .components = 1, .integers = verdicts[1]},
      {.name = "status_error", .is_cell = true, .components = 1, .integers = verdicts[2]},
      {.name = "status_wrong_pairs", .is_cell = true, .components = 1, .integers = verdicts[3]},
  };
  const FemVtuFrame frame = {.time = state->time,
                             .history_time = has_history(system) ? &state->last->time : NULL,
                             .vertex_count = model->vertex_count,
                             .positions = state->positions,
                             .cell_count = model->tet_count,
                             .cells = model->tets[0],
                             .arrays = arrays,
                             .array_count = keep_given(arrays, sizeof arrays / sizeof *arrays)};
  return fem_frames_write(&recorder->frames, &frame);
}

Status fem_recorder_continue(FemRecorder *recorder, JournalMark history, int frame_count) {
  if (!recorder->directory) return STATUS_OK;
  if (recorder->writes_history) TRY(fem_history_continue(&recorder->history, history));
  if (recorder->writes_vtu) fem_frames_continue(&recorder->frames, frame_count);
  recorder->frame_count = frame_count;
  return STATUS_OK;
}

static double *append_centres(const FemModel *model, const double *positions, double *row) {
  for (int b = 0; b < model->scene->body_count; b++) {
    Vec3 centre = {0, 0, 0};
    for (int a = model->bodies[b].vertex_begin; a < model->bodies[b].vertex_end; a++)
      centre =
          vec3_add(centre, vec3_scale(model->mass[a] / model->bodies[b].mass, vec3_at(positions + 3 * a)));
    vec3_store(row, centre);
    row += 3;
  }
  return row;
}

static double *append_forces_on_bodies(const FemRecorder *recorder, double *row) {
  int count, bodies = recorder->system->model->scene->body_count;
  const ContactInterfaceDef *interfaces = interfaces_of(recorder->system, &count);
  if (!tells_bodies(recorder)) return row;
  memset(row, 0, 3 * (size_t)bodies * sizeof *row);
  for (int i = 0; i < count; i++) {
    const int a = interfaces[i].a, b = interfaces[i].b;
    Vec3 force = vec3_at(recorder->forces.interfaces[i]);
    if (a == b) continue;
    if (a < bodies) vec3_accumulate(row + 3 * (size_t)a, force);
    if (b < bodies) vec3_accumulate(row + 3 * (size_t)b, vec3_scale(-1, force));
  }
  return row + 3 * (size_t)bodies;
}

static double *append_friction(const FemRecorder *recorder, double *row) {
  const FemRubbing *rubbing = recorder->forces.rubbing;
  for (int i = 0; rubbing && i < recorder->told; i++) {
    vec3_store(row, vec3_at(rubbing[i].force));
    row += 3;
    *row++ = rubbing[i].stuck;
    *row++ = rubbing[i].slides;
  }
  return row;
}

static Status fill_row(FemRecorder *recorder, FemColumnSource source) {
  double *row = recorder->row;
  source.status = recorder->status;
  for (int i = 0; i < fem_columns_count(); i++)
    if (has_column(recorder, i)) *row++ = fem_columns_value(i, &source);
  row = append_centres(recorder->system->model, source.state->positions, row);
  for (int i = 0; i < recorder->told; i++, row += 3) vec3_store(row, vec3_at(recorder->forces.interfaces[i]));
  row = append_forces_on_bodies(recorder, row);
  if (fem_reactions_any(recorder->system->model))
    TRY(fem_reactions_measure(recorder->system, source.state, &row, NULL));
  const FemSceneDef *scene = recorder->system->model->scene;
  for (int b = 0; b < scene->body_count && !scene->is_static; b++, row += 3)
    fem_momentum_missing(&recorder->ledger.momentum, source.state->time, b, row);
  TRY(fem_forces_take_areas(&recorder->forces, source.state));
  for (int i = 0; i < recorder->told; i++, row += 4) {
    row[0] = recorder->forces.areas[i];
    vec3_store(row + 1, vec3_at(recorder->forces.centres[i]));
  }
  if (recorder->told > 0) TRY(fem_moments_find(recorder->system, source.state, recorder->moments));
  for (int i = 0; i < recorder->told; i++, row += 3) vec3_store(row, vec3_at(recorder->moments[i]));
  row = append_friction(recorder, row);
  fem_probes_fill(&recorder->probes, row);
  return STATUS_OK;
}

Status fem_recorder_take_step(FemRecorder *recorder, const FemColumnSource *source) {
  return recorder->writes_history == FEM_HISTORY_STEPS ? fill_row(recorder, *source) : STATUS_OK;
}

Status fem_recorder_append_step(FemRecorder *recorder) {
  if (recorder->writes_history != FEM_HISTORY_STEPS) return STATUS_OK;
  return fem_history_add_row(&recorder->history, recorder->row);
}

static Status find_status(FemRecorder *recorder, const FemState *state) {
  if (!recorder->has_status) return STATUS_OK;
  return contact_system_status(contact_of(recorder->system), state->time, state->positions,
                               &recorder->reference, &recorder->status);
}

Status fem_recorder_write(FemRecorder *recorder, const FemColumnSource *source) {
  double began = clock_wall_s();
  TRY(find_status(recorder, source->state));
  if (!recorder->directory) return STATUS_OK;
  recorder->state = source->state;
  if (recorder->writes_vtu || recorder->system->model->line_count > 0)
    TRY(fem_forces_take_surface(&recorder->forces, source->state));
  if (recorder->writes_vtu) TRY(write_frame(recorder));
  TRY(fem_lines_write(recorder->system, source->state, recorder->forces.pressure, recorder->directory,
                      recorder->frame_count++));
  bool is_first = recorder->history.file.end.size == 0;
  if (recorder->writes_history == FEM_HISTORY_FRAMES || (recorder->writes_history && is_first)) {
    TRY(fem_probes_measure(&recorder->probes, source->state, &recorder->forces));
    TRY(fill_row(recorder, *source));
    TRY(fem_history_add_row(&recorder->history, recorder->row));
  }
  recorder->seconds += clock_wall_s() - began;
  return STATUS_OK;
}

static Status end_writing(FemRecorder *recorder, Status (*end)(FemFrames *frames)) {
  double began = clock_wall_s();
  Status status = end(&recorder->frames);
  recorder->seconds += clock_wall_s() - began;
  return status;
}

Status fem_recorder_wait(FemRecorder *recorder) {
  return end_writing(recorder, fem_frames_wait);
}

Status fem_recorder_finish(FemRecorder *recorder) {
  return end_writing(recorder, fem_frames_finish);
}
