// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run_frames.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/limits.h"

static void keep_frame(FemRunState *run, double time) {
  FemRunResult *result = run->result;
  if (!result->trajectory.positions) return;
  int frame = result->trajectory.frame_count++;
  size_t values = 3 * (size_t)result->trajectory.vertex_count;
  result->trajectory.times[frame] = time;
  memcpy(result->trajectory.positions + (size_t)frame * values, run->trial.positions,
         values * sizeof(double));
  int count = run->recorder.forces.interface_count;
  for (int i = 0; i < count; i++)
    vec3_store(result->trajectory.interface_forces + 3 * ((size_t)frame * (size_t)count + (size_t)i),
               vec3_at(run->recorder.forces.interfaces[i]));
}

void fem_run_frames_keep_extremes(FemRunResult *result, const FemMeasures *measures) {
  result->contact.pairs_max =
      measures->active_pairs > result->contact.pairs_max ? measures->active_pairs : result->contact.pairs_max;
  result->contact.overlap_volume_max = fmax(result->contact.overlap_volume_max, measures->overlap_volume);
  result->contact.force_max = fmax(result->contact.force_max, measures->contact_force);
  result->contact.force_since_row = fmax(result->contact.force_since_row, measures->contact_force);
  result->contact.deepest_overlap_max = fmax(result->contact.deepest_overlap_max, measures->deepest_overlap);
  result->min_det_F = fmin(result->min_det_F, measures->min_det_F);
  result->momentum.gap = measures->momentum_gap;
  result->momentum.body = measures->momentum_body;
}

static void keep_status(FemRunState *run) {
  FemRunResult *result = run->result;
  result->status.is_asked = run->recorder.has_status;
  if (!result->status.is_asked) return;
  const ContactStatusCounts *pairs = &run->recorder.status->pairs;
  result->status.pairs.asked += pairs->asked;
  result->status.pairs.overlapping += pairs->overlapping;
  result->status.pairs.false_positives += pairs->false_positives;
  result->status.pairs.false_negatives += pairs->false_negatives;
}

static FemColumnSource source_of(const FemRunState *run, const FemState *state, const FemMeasures *measures,
                                 const FemAudit *audit, const FemIntegratorStats *stats) {
  return (FemColumnSource){.state = state,
                           .measures = measures,
                           .audit = audit,
                           .step = stats->last_step,
                           .step_count = stats->steps,
                           .energy_events = run->result->trouble.of[FEM_TROUBLE_ENERGY].events};
}

Status fem_run_frames_write(FemRunState *run, double time, const FemMeasures *measures) {
  FemIntegratorStats stats = fem_run_state_stats(run);
  FemAudit audit = run->audit;
  if (time > audit.time) audit = fem_audit_next_within(&audit, time, &measures->energy, run->least_power);
  FemMeasures shown = *measures;
  shown.peak_force = run->result->contact.force_since_row;
  run->result->contact.force_since_row = 0;
  const FemState state = fem_state_beside(&run->trial, time);
  const FemColumnSource source = source_of(run, &state, &shown, &audit, &stats);
  TRY(fem_recorder_write(&run->recorder, &source));
  run->result->contact.force_last = measures->contact_force;
  keep_status(run);
  keep_frame(run, time);
  run->next_frame++;
  return STATUS_OK;
}

Status fem_run_frames_measure(FemRunState *run, FemMeasures *measures) {
  TRY(fem_system_check_state(&run->system, &run->trial));
  TRY(fem_recorder_measure(&run->recorder, &run->trial, measures));
  const char *faulty = fem_energy_faulty_term(&measures->energy);
  return faulty ? status_fail(STATUS_RETRY, "the %s is not a number", faulty) : STATUS_OK;
}

// Measures at a frame within the last step; the contact lists are renewed there if it lies beyond their
// margin.
static Status measure_within_step(FemRunState *run, double time, FemMeasures *measures) {
  const double *u = run->u, *v = run->v;
  if (run->integrator) TRY(fem_integrator_at(run->integrator, time, &u, &v));
  fem_system_scatter(&run->system, time, u, v, &run->trial);
  Status status = fem_run_frames_measure(run, measures);
  if (status != STATUS_RETRY) return status;
  TRY(fem_system_check_state(&run->system, &run->trial)); // no wider list makes a number of NaN
  TRY(fem_system_renew(&run->system, &run->trial));
  return fem_run_frames_measure(run, measures);
}

Status fem_run_frames_write_until(FemRunState *run, double time) {
  const FemSceneDef *scene = run->model->scene;
  double slack = FEM_TIME_RESOLUTION * scene->end;
  while (run->next_frame <= scene->frames) {
    double frame = fem_scene_frame_time(scene, run->next_frame);
    if (frame > time + slack) break;
    FemMeasures measures;
    TRY(measure_within_step(run, fmin(frame, time), &measures));
    TRY(fem_run_frames_write(run, frame, &measures));
  }
  return STATUS_OK;
}

// "a, b" for each interface.
static Status keep_names(FemRunResult *result, void *effect) {
  enum { NAME_SIZE = 256 };
  const ContactLayout *layout = contact_system_layout(fem_effect_contact_system(effect));
  const ContactInterfaceDef *interfaces = layout->interfaces;
  int count = layout->interface_count;
  result->trajectory.interface_names =
      memory_zeroed((size_t)count, sizeof *result->trajectory.interface_names);
  if (!result->trajectory.interface_names) return status_no_memory("the names of interfaces");
  result->trajectory.interface_count = count;
  for (int i = 0; i < count; i++) {
    result->trajectory.interface_names[i] = memory_zeroed(NAME_SIZE, 1);
    if (!result->trajectory.interface_names[i]) return status_no_memory("the names of interfaces");
    snprintf(result->trajectory.interface_names[i], NAME_SIZE, "%s, %s",
             fem_effect_contact_name(effect, interfaces[i].a),
             fem_effect_contact_name(effect, interfaces[i].b));
  }
  return STATUS_OK;
}

static Status keep_trajectory(FemRunState *run) {
  FemRunResult *result = run->result;
  void *effect = fem_system_effect(&run->system, &fem_effect_contact);
  if (effect) TRY(keep_names(result, effect));
  size_t frames = (size_t)run->model->scene->frames + 1;
  result->trajectory.vertex_count = run->model->vertex_count;
  result->trajectory.times = memory_zeroed(frames, sizeof(double));
  result->trajectory.positions =
      memory_zeroed(frames * 3 * (size_t)result->trajectory.vertex_count, sizeof(double));
  result->trajectory.interface_forces =
      memory_zeroed(frames * 3 * (size_t)result->trajectory.interface_count, sizeof(double));
  bool ok = result->trajectory.times && result->trajectory.positions && result->trajectory.interface_forces;
  return ok ? STATUS_OK : status_no_memory("the kept trajectory");
}

Status fem_run_frames_open(FemRunState *run) {
  const FemCheckpoint *from = &run->checkpoint;
  TRY(fem_recorder_create(&run->recorder, &run->system, run->options->directory));
  if (run->options->keep_trajectory) TRY(keep_trajectory(run));
  if (from->next_frame > 0) TRY(fem_ledger_load(&run->recorder.ledger, from->ledger, from->ledger_count));
  return fem_recorder_continue(&run->recorder, from->history, from->next_frame);
}

Status fem_run_frames_take_row(FemRunState *run, const FemMeasures *measures, const FemAudit *audit) {
  FemIntegratorStats stats = fem_run_state_stats(run);
  const FemColumnSource source = source_of(run, &run->trial, measures, audit, &stats);
  return fem_recorder_take_step(&run->recorder, &source);
}
