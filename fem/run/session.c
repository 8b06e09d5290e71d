// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/session.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/limits.h"
#include "fem/run/checkpoint/restart.h"
#include "fem/run/run_frames.h"
#include "fem/run/run_loop.h"
#include "fem/run/run_stage.h"

struct FemRunSession {
  FemRunState run;
  bool is_stopped; // by the observer, in this advance
  Status failure;  // of an advance; OK: none
  char message[2048];
};

// Back to the accepted state: a frame within the last step may have been looked at since. Contact is
// evaluated again only then.
static Status look(FemRunState *run) {
  const ContactEvaluation *contact;
  fem_run_stage_scatter(run);
  return fem_effect_contact_evaluate(&run->system, &run->trial, &contact);
}

Status fem_run_session_open(FemRunSession **session, const FemModel *model, const FemRunOptions *options,
                            FemRunResult *result) {
  FemRunSession *made = *session = memory_zeroed(1, sizeof *made);
  if (!made) return status_no_memory("a run");
  FemRunState *run = &made->run;
  Status status = fem_run_loop_begin(run, model, options, result);
  if (!status) status = look(run);
  if (!status) return STATUS_OK;
  status = fem_run_loop_end(run, fem_run_loop_explain(run, status));
  memory_free(made);
  *session = NULL;
  return status;
}

static Status fail(FemRunSession *session, Status status) {
  session->failure = fem_run_loop_explain(&session->run, status);
  strncpy(session->message, status_message(), sizeof session->message - 1);
  return session->failure;
}

Status fem_run_session_check(const FemRunSession *session, double time) {
  const FemRunState *run = &session->run;
  if (session->failure) return status_fail(session->failure, "%s", session->message);
  if (!(time >= run->time))
    return status_fail(STATUS_INPUT,
                       "the run is at t = %.9g s and cannot go back to %.9g s; to go back, restore a state "
                       "that was kept",
                       run->time, time);
  if (time <= run->model->scene->end * (1 + FEM_TIME_RESOLUTION)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "the scene ends at t = %.9g s, before %.9g s: give it a later time.end",
                     run->model->scene->end, time);
}

static void aim(FemRunState *run, double target) {
  const FemSceneDef *scene = run->model->scene;
  run->target = target < scene->end * (1 - FEM_TIME_RESOLUTION) ? target : INFINITY;
  if (run->integrator) fem_integrator_aim(run->integrator, run->target);
  run->stall = fem_stall_begin(run->time, scene->end, scene->end / scene->frames);
}

Status fem_run_session_advance(FemRunSession *session, double time) {
  FemRunState *run = &session->run;
  TRY(fem_run_session_check(session, time));
  const double reached = time - FEM_TIME_RESOLUTION * run->model->scene->end;
  session->is_stopped = false;
  aim(run, time);
  Status status = STATUS_OK;
  while (!status && !session->is_stopped && run->time < reached && !fem_run_state_has_ended(run))
    status = fem_run_loop_turn(run);
  if (!status && run->time >= reached)
    run->time = fmax(run->time, time); // the same time, so a loop to it ends
  if (!status) status = fem_recorder_wait(&run->recorder);
  if (!status) status = look(run);
  return status ? fail(session, status) : STATUS_OK;
}

Status fem_run_session_look(FemRunSession *session) {
  return look(&session->run);
}

void fem_run_session_stop(FemRunSession *session) {
  session->is_stopped = true;
}

// Who sleeps is decided again: what acts on a sleeper may change.
static Status decide_rest(FemRunState *run) {
  TRY(fem_rest_decide(run->rest, fem_run_state_stats(run).current_step));
  return fem_rest_has_changed(run->rest) ? fem_run_stage_change(run) : STATUS_OK;
}

// The account goes on with the forces and powers from here on.
static Status renew_account(FemRunState *run) {
  FemMeasures measures;
  fem_system_scatter(&run->system, fem_signal_past(run->time), run->u, run->v, &run->trial);
  TRY(fem_run_frames_measure(run, &measures));
  TRY(fem_recorder_begin_step(&run->recorder, &run->trial, &measures));
  run->audit.dissipated_power = measures.energy.dissipated_power;
  run->audit.driven_power = measures.energy.driven_power;
  return STATUS_OK;
}

static Status change(FemRunState *run, bool jumps) {
  if (run->model->scene->is_static || fem_run_state_has_ended(run)) return look(run);
  TRY(decide_rest(run));
  TRY(renew_account(run));
  if (jumps && run->integrator) TRY(fem_integrator_restart(run->integrator, run->time, run->u, run->v, 0));
  return look(run);
}

bool fem_run_session_is_stopped(const FemRunSession *session) {
  return session->is_stopped;
}

Status fem_run_session_change(FemRunSession *session, bool jumps) {
  if (session->failure) return status_fail(session->failure, "%s", session->message);
  Status status = change(&session->run, jumps);
  return status ? fail(session, status) : STATUS_OK;
}

// A run that is taken back to here need not search for contact.
static Status keep_lists(FemRunState *run) {
  void *contact = fem_system_effect(&run->system, &fem_effect_contact);
  return contact ? contact_system_keep(fem_effect_contact_system(contact)) : STATUS_OK;
}

Status fem_run_session_keep(FemRunSession *session, FemCheckpoint *copy) {
  FemRunState *run = &session->run;
  if (session->failure) return status_fail(session->failure, "%s", session->message);
  if (fem_run_state_has_ended(run))
    return status_fail(STATUS_INPUT, "the run has reached its end, t = %.9g s: no state after it is kept",
                       run->time);
  Status status = fem_run_loop_begin_anew(run);
  if (!status) status = keep_lists(run);
  if (!status) status = look(run);
  return status ? fail(session, status) : fem_checkpoint_copy(copy, &run->checkpoint);
}

Status fem_run_session_restore(FemRunSession *session, const FemCheckpoint *from) {
  FemRunState *run = &session->run;
  TRY(fem_restart_check(from, run->model));
  session->failure = STATUS_OK;
  Status status = fem_run_loop_restore(run, from);
  if (!status) status = look(run);
  return status ? fail(session, status) : STATUS_OK;
}

const FemRunState *fem_run_session_state(const FemRunSession *session) {
  return &session->run;
}

Status fem_run_session_close(FemRunSession *session, Status status) {
  if (!session) return STATUS_OK;
  status = fem_run_loop_end(&session->run, status);
  memory_free(session);
  return status;
}
