// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/measure/ledger.h"

#include <limits.h>

#include "base/memory.h"
#include "fem/effect/contact.h"

static void find_contact(FemLedger *ledger) {
  void *effect = fem_system_effect(ledger->system, &fem_effect_contact);
  ledger->contact = effect ? fem_effect_contact_system(effect) : NULL;
}

Status fem_ledger_create(FemLedger *ledger, FemSystem *system) {
  *ledger = (FemLedger){.system = system};
  return fem_momentum_create(&ledger->momentum, system);
}

void fem_ledger_destroy(FemLedger *ledger) {
  fem_momentum_destroy(&ledger->momentum);
  contact_passage_destroy(&ledger->passage);
  *ledger = (FemLedger){0};
}

// The effects are made anew at a checkpoint, so contact is looked up whenever a part begins.
Status fem_ledger_begin(FemLedger *ledger, double time, const FemMomentumContact *contact) {
  find_contact(ledger);
  if (!ledger->system->model->scene->is_static) TRY(fem_momentum_begin(&ledger->momentum, time, contact));
  if (!ledger->contact || ledger->passage.now.count > 0) return STATUS_OK;
  TRY(contact_passage_look(&ledger->passage, ledger->contact));
  contact_passage_accept(&ledger->passage);
  return STATUS_OK;
}

Status fem_ledger_end(FemLedger *ledger, double time, const FemMomentumContact *contact) {
  if (ledger->contact) TRY(contact_passage_look(&ledger->passage, ledger->contact));
  if (ledger->system->model->scene->is_static) return STATUS_OK;
  return fem_momentum_end(&ledger->momentum, time, contact);
}

void fem_ledger_accept(FemLedger *ledger) {
  if (!ledger->system->model->scene->is_static) fem_momentum_accept(&ledger->momentum);
  if (ledger->contact) contact_passage_accept(&ledger->passage);
}

Status fem_ledger_save(const FemLedger *ledger, double **values, size_t *count) {
  const int bodies = ledger->momentum.body_count, entries = ledger->passage.now.count;
  *count = (size_t)bodies * FEM_MOMENTUM_KEPT + (size_t)entries * CONTACT_PASSAGE_KEPT;
  *values = memory_zeroed(*count, sizeof **values);
  if (!*values) return status_no_memory("a checkpoint");
  fem_momentum_save(&ledger->momentum, *values);
  contact_passage_save(&ledger->passage, *values + bodies * FEM_MOMENTUM_KEPT);
  return STATUS_OK;
}

Status fem_ledger_load(FemLedger *ledger, const double *values, size_t count) {
  const size_t moved = (size_t)ledger->momentum.body_count * FEM_MOMENTUM_KEPT;
  if (count < moved || (count - moved) % CONTACT_PASSAGE_KEPT != 0)
    return status_fail(STATUS_INPUT,
                       "the checkpoint has %zu numbers of momentum and passages, this scene has %zu "
                       "or more, by sixes",
                       count, moved);
  fem_momentum_load(&ledger->momentum, values);
  find_contact(ledger);
  int facings = 0;
  if (ledger->contact) contact_system_interfaces(ledger->contact, &facings);
  for (size_t k = moved; k < count; k += CONTACT_PASSAGE_KEPT)
    if (!(values[k] >= 0 && values[k] < facings && values[k + 1] >= 0 && values[k + 1] <= INT_MAX))
      return status_fail(STATUS_INPUT,
                         "the checkpoint tells of contact between two that this scene does not have");
  return contact_passage_load(&ledger->passage, (int)((count - moved) / CONTACT_PASSAGE_KEPT),
                              values + moved);
}
