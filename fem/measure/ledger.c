// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/measure/ledger.h"

#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "contact/evaluation.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/compliance/compliance.h"
#include "fem/model/limits.h"

// The system's own: it has another one once it began anew from a checkpoint.
static ContactSystem *contact_of(const FemLedger *ledger) {
  void *effect = fem_system_effect(ledger->system, &fem_effect_contact);
  return effect ? fem_effect_contact_system(effect) : NULL;
}

static int probe_count(const FemLedger *ledger) {
  return ledger->system->model->probe_count;
}

static bool is_static(const FemLedger *ledger) {
  return ledger->system->model->scene->is_static;
}

Status fem_ledger_create(FemLedger *ledger, FemSystem *system) {
  *ledger = (FemLedger){.system = system};
  ledger->contact = contact_of(ledger);
  size_t probes = (size_t)probe_count(ledger);
  ledger->readings = memory_zeroed(probes, sizeof *ledger->readings);
  ledger->next_readings = memory_zeroed(probes, sizeof *ledger->next_readings);
  if (!ledger->readings || !ledger->next_readings) return status_no_memory("the probes");
  TRY(fem_accuracy_create(&ledger->accuracy, system->model, ledger->contact));
  return fem_momentum_create(&ledger->momentum, system);
}

void fem_ledger_destroy(FemLedger *ledger) {
  fem_momentum_destroy(&ledger->momentum);
  contact_passage_destroy(&ledger->passage);
  fem_accuracy_destroy(&ledger->accuracy);
  memory_free(ledger->readings);
  memory_free(ledger->next_readings);
  *ledger = (FemLedger){0};
}

static Status look(FemLedger *ledger, const FemState *state, const FemLedgerEntry *entry) {
  for (int p = 0; p < probe_count(ledger); p++) {
    ledger->next_readings[p] = ledger->readings[p];
    fem_readings_add(&ledger->next_readings[p], &entry->readings[p], state->time);
  }
  if (!ledger->contact) return STATUS_OK;
  const ContactLayout *layout = contact_system_layout(ledger->contact);
  const ContactEvaluation *contact;
  TRY(fem_effect_contact_evaluate(ledger->system, state, &contact));
  TRY(contact_passage_look(&ledger->passage, ledger->contact, contact));
  return fem_accuracy_look(&ledger->accuracy, ledger->system, layout, contact, state, entry->elastic);
}

static void accept(FemLedger *ledger) {
  FemReadings *readings = ledger->readings;
  ledger->readings = ledger->next_readings;
  ledger->next_readings = readings;
  if (!ledger->contact) return;
  contact_passage_accept(&ledger->passage);
  fem_accuracy_accept(&ledger->accuracy);
}

// The effects are made anew at a checkpoint, so contact is looked up whenever a part begins. The
// accepted state is evaluated once more, which changes nothing.
Status fem_ledger_begin(FemLedger *ledger, const FemState *state, const FemLedgerEntry *entry) {
  ledger->contact = contact_of(ledger);
  if (!is_static(ledger)) TRY(fem_momentum_begin(&ledger->momentum, state, &entry->contact));
  TRY(look(ledger, state, entry));
  accept(ledger);
  return STATUS_OK;
}

Status fem_ledger_end(FemLedger *ledger, const FemState *state, const FemLedgerEntry *entry) {
  TRY(look(ledger, state, entry));
  return is_static(ledger) ? STATUS_OK : fem_momentum_end(&ledger->momentum, state, &entry->contact);
}

void fem_ledger_accept(FemLedger *ledger) {
  if (!is_static(ledger)) fem_momentum_accept(&ledger->momentum);
  accept(ledger);
}

// ---- Telling.

// A smaller share is not mentioned.
static const double NOTHING = FEM_DOUBT * FEM_DOUBT;
// With fewer elements across a patch its pressure has the mesh's shape, whatever the stiffness
// (docs/contact_error.md).
static const double RESOLVED = 5;
// Above this share of pressure times area the resultant alone is reported.
static const double ONE_WAY = 0.5;

static void record_estimate(const FemEstimate *estimate, Record *record) {
  record_number(record, "give", estimate->give);
  record_number(record, "give_time", estimate->give_time);
  record_number(record, "rim", estimate->rim);
  record_number(record, "depth_over_edge", estimate->depth_over_edge);
  record_number(record, "tolerance_over_depth", estimate->tolerance_over_depth);
  record_number(record, "elements_across", estimate->elements_across);
  record_number(record, "stiffness", estimate->stiffness);
  record_number(record, "stiffness_for_1_percent", estimate->stiffness_for);
  record_number(record, "tolerance_for_1_percent", estimate->tolerance_for);
}

static void record_contact(const FemLedger *ledger, int i, Record *record) {
  const FemModel *model = ledger->system->model;
  const FemAccuracyPair *pair = &ledger->accuracy.pairs[i];
  const ContactInterfaceDef *interface = &contact_system_layout(contact_of(ledger))->interfaces[i];
  FemEstimate estimate = fem_accuracy_estimate(pair, model, interface->law ? NAN : interface->stiffness);
  record_text(record, "a", fem_compliance_party_name(model, interface->a));
  record_text(record, "b", fem_compliance_party_name(model, interface->b));
  record_number(record, "force_max_N", pair->force);
  record_number(record, "force_max_time", pair->force_time);
  record_number(record, "pressed_max_N", pair->pressed);
  record_number(record, "pressed_max_time", pair->time);
  record_number(record, "pressed_held_N", pair->held);
  record_bool(record, "is_brief", estimate.is_brief);
  record_number(record, "area_m2", pair->area);
  record_numbers(record, "centre_m", pair->centre, 3);
  record_estimate(&estimate, record_child(record, "estimate"));
}

static void record_readings(const FemLedger *ledger, int p, Record *record) {
  const FemReadings *readings = &ledger->readings[p];
  record_text(record, "name", ledger->system->model->probes[p].def->name);
  record_text(record, "body", ledger->system->model->bodies[ledger->system->model->probes[p].body].name);
  record_number(record, "force_max_N", readings->largest_force);
  record_number(record, "force_max_time", readings->largest_force_time);
  record_number(record, "displacement_max_m", readings->largest_displacement);
  record_number(record, "displacement_max_time", readings->largest_displacement_time);
  double last[FEM_READING_COUNT];
  memcpy(last, &readings->last, sizeof last);
  Record *end = record_child(record, "last");
  for (int k = 0; k < FEM_READING_COUNT; k++) record_number(end, fem_reading_title(k), last[k]);
}

void fem_ledger_record(const FemLedger *ledger, Record *record) {
  if (contact_of(ledger)) {
    RecordList *contacts = record_list(record, "contacts");
    for (int i = 0; i < ledger->accuracy.count; i++)
      if (ledger->accuracy.pairs[i].pressed > 0) record_contact(ledger, i, record_append(contacts));
  }
  if (probe_count(ledger) == 0) return;
  RecordList *probes = record_list(record, "probes");
  for (int p = 0; p < probe_count(ledger); p++) record_readings(ledger, p, record_append(probes));
}

// Whether a presses more than b, or as much and comes first.
static bool is_before(const FemAccuracy *accuracy, int a, int b) {
  double of_a = accuracy->pairs[a].pressed, of_b = accuracy->pairs[b].pressed;
  return of_a > of_b || (of_a == of_b && a < b);
}

// The interface of that rank by what it presses; −1: none.
static int find_rank(const FemAccuracy *accuracy, int rank) {
  int found = -1;
  for (int r = 0; r <= rank; r++) {
    int next = -1;
    for (int i = 0; i < accuracy->count; i++)
      if (accuracy->pairs[i].pressed > 0 && (found < 0 || is_before(accuracy, found, i)) &&
          (next < 0 || is_before(accuracy, i, next)))
        next = i;
    if (next < 0) return -1;
    found = next;
  }
  return found;
}

// What presses: the resultant, and pressure times area where that is another number.
static void describe_force(const FemAccuracyPair *pair, const FemEstimate *estimate, char *text, size_t size,
                           size_t *used) {
  if (pair->resultant > ONE_WAY * pair->pressed)
    text_append(text, size, used, "largest force %.4g N, at t = %.4g s", pair->resultant, pair->time);
  else
    text_append(text, size, used,
                "pressure times area %.4g N at most, at t = %.4g s\n"
                "of which %.4g N are left as a resultant force: they press in many directions",
                pair->pressed, pair->time, pair->resultant);
  if (estimate->is_brief)
    text_append(text, size, used,
                "\nthat peak lasts one step, and two steps in a row hold %.4g N at most: a smaller "
                "time.tolerance tells whether it is real",
                pair->held);
}

bool fem_ledger_describe(const FemLedger *ledger, int rank, char *text, size_t size) {
  const FemModel *model = ledger->system->model;
  int i = contact_of(ledger) ? find_rank(&ledger->accuracy, rank) : -1;
  if (i < 0) return false;
  const FemAccuracyPair *pair = &ledger->accuracy.pairs[i];
  const ContactInterfaceDef *interface = &contact_system_layout(contact_of(ledger))->interfaces[i];
  FemEstimate estimate = fem_accuracy_estimate(pair, model, interface->law ? NAN : interface->stiffness);
  size_t used = 0;
  text_append(text, size, &used, "'%s' and '%s'\n", fem_compliance_party_name(model, interface->a),
              fem_compliance_party_name(model, interface->b));
  describe_force(pair, &estimate, text, size, &used);
  text_append(text, size, &used,
              "\nmean overlap %.2g m then\n"
              "%.3g %% of the total deformation is overlap, at t = %.4g s",
              estimate.depth, 100 * estimate.give, estimate.give_time);
  if (estimate.tolerance_over_depth > 1)
    text_append(text, size, &used, "\nthe overlap is below the resolution of time.tolerance");
  if (estimate.rim > NOTHING)
    text_append(text, size, &used, "\n%.2g %% of the force is lost along edges of the bodies",
                100 * estimate.rim);
  text_append(text, size, &used, "\n%.1f elements across the contact%s", estimate.elements_across,
              estimate.elements_across < RESOLVED ? " (too few: first refine the meshes to 5 or more)" : "");
  if (estimate.stiffness_for > estimate.stiffness)
    text_append(text, size, &used, "\ncontact.stiffness %.2g %s instead of %.2g brings %s to 1 %%",
                estimate.stiffness_for, contact_def_potential_unit(model->scene->contact.potential),
                estimate.stiffness, estimate.rim > NOTHING ? "overlap and loss" : "the overlap");
  return true;
}

// ---- Checkpoints.

// How many numbers there are before the passages.
static size_t fixed_count(const FemLedger *ledger) {
  return (size_t)ledger->momentum.body_count * FEM_MOMENTUM_KEPT +
         (size_t)ledger->accuracy.count * FEM_ACCURACY_KEPT + (size_t)probe_count(ledger) * FEM_READINGS_KEPT;
}

Status fem_ledger_save(const FemLedger *ledger, double **values, size_t *count) {
  *count = fixed_count(ledger) + (size_t)ledger->passage.now.count * CONTACT_PASSAGE_KEPT;
  double *to = *values = memory_zeroed(*count, sizeof **values);
  if (!to) return status_no_memory("a checkpoint");
  fem_momentum_save(&ledger->momentum, to);
  to += ledger->momentum.body_count * FEM_MOMENTUM_KEPT;
  for (int i = 0; i < ledger->accuracy.count; i++, to += FEM_ACCURACY_KEPT)
    memcpy(to, &ledger->accuracy.pairs[i], sizeof ledger->accuracy.pairs[i]);
  for (int p = 0; p < probe_count(ledger); p++, to += FEM_READINGS_KEPT)
    memcpy(to, &ledger->readings[p], sizeof ledger->readings[p]);
  contact_passage_save(&ledger->passage, to);
  return STATUS_OK;
}

// Whether so many numbers, from `passages` on, can be entries of passages.
static bool are_passages(const FemLedger *ledger, const double *passages, size_t count) {
  bool fits = count % CONTACT_PASSAGE_KEPT == 0;
  const ContactLayout *layout = count > 0 ? contact_system_layout(contact_of(ledger)) : NULL;
  for (size_t k = 0; k < count && fits; k += CONTACT_PASSAGE_KEPT)
    fits = passages[k] >= 0 && passages[k] < ledger->accuracy.count && passages[k + 1] >= 0 &&
           passages[k + 1] < layout->def.tet_count && passages[k + 6] >= -1 &&
           passages[k + 6] < layout->mesh.cell_count;
  return fits;
}

Status fem_ledger_load(FemLedger *ledger, const double *values, size_t count) {
  const size_t fixed = fixed_count(ledger);
  if (count < fixed || !fem_momentum_fits(&ledger->momentum, values) ||
      !are_passages(ledger, values + fixed, count - fixed))
    return status_fail(
        STATUS_INPUT,
        "the checkpoint holds %zu numbers of momentum, contacts and probes that do not fit this "
        "scene, which has %zu and eights of contacts",
        count, fixed);
  fem_momentum_load(&ledger->momentum, values);
  values += ledger->momentum.body_count * FEM_MOMENTUM_KEPT;
  for (int i = 0; i < ledger->accuracy.count; i++, values += FEM_ACCURACY_KEPT)
    memcpy(&ledger->accuracy.pairs[i], values, sizeof ledger->accuracy.pairs[i]);
  for (int p = 0; p < probe_count(ledger); p++, values += FEM_READINGS_KEPT)
    memcpy(&ledger->readings[p], values, sizeof ledger->readings[p]);
  return contact_passage_load(&ledger->passage, (int)((count - fixed) / CONTACT_PASSAGE_KEPT), values);
}
