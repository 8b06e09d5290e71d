// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run_watch.h"

#include "base/ranks.h"

static Status refuse_passage(const FemRunState *run) {
  char text[512];
  fem_trouble_describe(&run->result->trouble, run->model, FEM_TROUBLE_PASSED, text, sizeof text);
  return status_fail(STATUS_SOLVER, "%s (--strict)", text);
}

Status fem_run_watch_refuse(FemRunState *run, double time, const FemTroubleState *found) {
  if (found->count[FEM_TROUBLE_PASSED] == 0) return STATUS_OK;
  FemTrouble *trouble = &run->result->trouble;
  FemTroubleState passage = *found;
  for (int kind = 0; kind < FEM_TROUBLE_KIND_COUNT; kind++) // the rest was in a state that is not accepted
    if (kind != FEM_TROUBLE_PASSED) passage.count[kind] = 0;
  fem_trouble_add(trouble, time, &passage);
  const FemLedger *ledger = &run->recorder.ledger;
  const ContactInterfaceDef *interface =
      &contact_system_layout(ledger->contact)->interfaces[ledger->passage.passed.first.interface];
  char text[1024];
  fem_trouble_describe_refusal(trouble, run->model, found, interface->law ? 0 : interface->stiffness, text,
                               sizeof text);
  return status_fail(STATUS_SOLVER, "%s", text);
}

// Counts the trouble of the accepted state; `*has_begun`: some of it was not there in the state before.
static Status watch_trouble(FemRunState *run, FemMeasures *measures, bool *has_begun) {
  FemTrouble *trouble = &run->result->trouble;
  const double rise = fem_audit_rise(&run->result->energy.bounds, &run->audit);
  const double bound = run->result->energy.bounds.run;
  measures->trouble.count[FEM_TROUBLE_ENERGY] = !(rise <= bound);
  *has_begun = fem_trouble_add(trouble, run->time, &measures->trouble);
  if (run->options->is_strict && measures->trouble.count[FEM_TROUBLE_PASSED] > 0) return refuse_passage(run);
  if (!run->options->is_strict || !measures->trouble.count[FEM_TROUBLE_ENERGY]) return STATUS_OK;
  return status_fail(
      STATUS_SOLVER,
      "at t = %.9g s: the energy has risen by %.3g of the scene's so far, the bound is %g (--strict). Try "
      "a smaller time.tolerance or time.max_step, or a smaller contact.stiffness",
      run->time, rise, bound);
}

Status fem_run_watch_stop(const FemRunState *run) {
  if (!run->options->stop || !*run->options->stop) return STATUS_OK;
  return status_fail(STATUS_INTERRUPTED, "interrupted at t = %g s; everything written so far is complete",
                     run->time);
}

Status fem_run_watch(FemRunState *run, FemMeasures *measures) {
  bool has_begun;
  TRY(watch_trouble(run, measures, &has_begun));
  TRY(ranks()->worst(fem_run_watch_stop(run)));
  if (!run->options->observe) return STATUS_OK;
  FemIntegratorStats stats = fem_run_state_stats(run);
  FemRunProgress progress = {.system = &run->system,
                             .time = run->time,
                             .end = run->model->scene->end,
                             .step = stats.last_step,
                             .step_count = stats.steps,
                             .measures = measures,
                             .audit = &run->audit,
                             .energy_rise = fem_audit_rise(&run->result->energy.bounds, &run->audit),
                             .energy_bound = run->result->energy.bounds.run,
                             .trouble = &run->result->trouble,
                             .has_trouble_begun = has_begun};
  return run->options->observe(run->options->observer, &progress);
}

// At the end of the run, where none passed through another.
static Status watch_inside(FemRunState *run) {
  ContactPassageCount inside = contact_passage_inside(&run->recorder.ledger.passage);
  if (inside.elements == 0) return STATUS_OK;
  const ContactLayout *layout = contact_system_layout(run->recorder.ledger.contact);
  const ContactInterfaceDef *interface = &layout->interfaces[inside.first.interface];
  run->result->inside =
      (FemRunInside){.count = inside.elements,
                     .element = contact_system_origin(run->recorder.ledger.contact, inside.first.tet),
                     .parties = {interface->a, interface->b}};
  if (!run->options->is_strict) return STATUS_OK;
  char text[512];
  fem_run_describe_inside(&run->result->inside, run->model, text, sizeof text);
  return status_fail(STATUS_SOLVER, "bodies lie inside each other at the end: %s (--strict)", text);
}

Status fem_run_watch_passages(FemRunState *run) {
  FemTrouble *trouble = &run->result->trouble;
  FemTroubleState state = trouble->last;
  fem_recorder_find_turned(&run->recorder, &state);
  if (trouble->of[FEM_TROUBLE_PASSED].steps > 0) return STATUS_OK;
  if (state.count[FEM_TROUBLE_PASSED] == 0) return watch_inside(run);
  for (int kind = 0; kind < FEM_TROUBLE_KIND_COUNT; kind++) // the rest of the last step has been added
    if (kind != FEM_TROUBLE_PASSED) state.count[kind] = 0;
  fem_trouble_add(trouble, run->time, &state);
  return run->options->is_strict ? refuse_passage(run) : STATUS_OK;
}
