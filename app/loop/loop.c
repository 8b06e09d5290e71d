// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/loop/loop.h"

#include <math.h>
#include <string.h>

#include "app/job/origin.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/measure/stress.h"
#include "fem/output/moments.h"

static const FemRunState *run_of(const AppLoop *loop) {
  return fem_run_session_state(loop->session);
}

double app_loop_time(const AppLoop *loop) {
  return run_of(loop)->time;
}

const FemState *app_loop_state(const AppLoop *loop) {
  return &run_of(loop)->trial;
}

static void *contact_of(const AppLoop *loop) {
  return fem_system_effect(&run_of(loop)->system, &fem_effect_contact);
}

// The mean of forces then and now, over the time between.
static void add_impulse(AppLoopContact *contact, const double force[3], double seconds) {
  vec3_accumulate(contact->impulse,
                  vec3_scale(0.5 * seconds, vec3_add(vec3_at(contact->force), vec3_at(force))));
}

static void read_contact(AppLoop *loop, const ContactInterface *interface, int i, double seconds) {
  AppLoopContact *contact = &loop->contacts[i];
  const FemForces *forces = &loop->forces;
  const FemRubbing *rubbing = forces->rubbing ? &forces->rubbing[i] : NULL;
  Vec3 normal = vec3_at(forces->interfaces[i]);
  add_impulse(contact, forces->interfaces[i], seconds);
  vec3_store(contact->force, normal);
  memcpy(contact->moment, loop->moments[i], sizeof contact->moment);
  memcpy(contact->centre, forces->centres[i], sizeof contact->centre);
  if (rubbing) normal = vec3_sub(normal, vec3_at(rubbing->force));
  contact->normal = vec3_length(normal);
  contact->slip = NAN;
  if (rubbing && rubbing->stuck + rubbing->slides > 0)
    contact->slip = rubbing->slides / (rubbing->stuck + rubbing->slides);
  contact->volume = interface->volume;
}

static Status take_contacts(AppLoop *loop, const FemState *state, double seconds) {
  const FemSystem *system = &run_of(loop)->system;
  const ContactEvaluation *evaluation;
  if (!contact_of(loop)) return STATUS_OK;
  TRY(fem_forces_take(&loop->forces, state));
  TRY(fem_moments_find(system, state, loop->moments));
  TRY(fem_effect_contact_evaluate(system, state, &evaluation));
  for (int i = 0; i < loop->contact_count; i++) read_contact(loop, &evaluation->interfaces[i], i, seconds);
  return STATUS_OK;
}

// Of the present state; `seconds`: since the last reading.
static Status read_contacts(AppLoop *loop, double seconds) {
  const FemState *state = app_loop_state(loop);
  loop->readings++;
  loop->version_read = 0;
  loop->forces_time = state->time;
  loop->has_vertex_forces = loop->has_areas = false;
  TRY(take_contacts(loop, state, seconds));
  loop->version_read = state->version;
  return STATUS_OK;
}

Status app_loop_read_areas(AppLoop *loop) {
  if (!contact_of(loop) || loop->has_areas) return STATUS_OK;
  TRY(fem_forces_take_areas(&loop->forces, app_loop_state(loop)));
  for (int i = 0; i < loop->contact_count; i++) {
    AppLoopContact *contact = &loop->contacts[i];
    contact->area = loop->forces.areas[i];
    contact->pressure = contact->area > 0 ? contact->normal / contact->area : 0;
  }
  loop->has_areas = true;
  return STATUS_OK;
}

Status app_loop_read(AppLoop *loop) {
  TRY(read_contacts(loop, 0));
  return app_loop_read_areas(loop);
}

static Status create_contacts(AppLoop *loop) {
  void *effect = contact_of(loop);
  TRY(fem_forces_create(&loop->forces, &run_of(loop)->system, false));
  const ContactLayout *layout = effect ? contact_system_layout(fem_effect_contact_system(effect)) : NULL;
  if (layout) loop->contact_count = layout->interface_count;
  size_t count = (size_t)loop->contact_count;
  loop->contacts = memory_zeroed(count, sizeof *loop->contacts);
  loop->moments = memory_zeroed(count, sizeof *loop->moments);
  if (!loop->contacts || !loop->moments) return status_no_memory("the contacts");
  for (int i = 0; i < loop->contact_count; i++) {
    loop->contacts[i].a = fem_effect_contact_name(effect, layout->interfaces[i].a);
    loop->contacts[i].b = fem_effect_contact_name(effect, layout->interfaces[i].b);
  }
  return app_loop_read(loop);
}

// Of the run, after every step.
static Status observe(void *self, const FemRunProgress *progress) {
  AppLoop *loop = self;
  if (!loop->contacts) return STATUS_OK; // it is being opened
  TRY(fem_run_session_look(loop->session));
  TRY(read_contacts(loop, progress->time - loop->forces_time));
  return loop->on_step ? loop->on_step(loop->on_step_self, loop) : STATUS_OK;
}

static Status open_opened(AppLoop *loop, const AppLoopOptions *options) {
  TRY(app_origin_make(&loop->job, &options->job, options->overlap, &loop->origin));
  TRY(app_loop_diary_create(&loop->diary, loop->job.model.vertex_count));
  TRY(app_loop_groups_create(&loop->groups, &loop->job.scene, &loop->job.model));
  loop->options = (FemRunOptions){.stop = options->stop, .observe = observe, .observer = loop};
  TRY(fem_run_session_open(&loop->session, &loop->job.model, &loop->options, &loop->result));
  return create_contacts(loop);
}

Status app_loop_open(AppLoop *loop, const AppLoopOptions *options) {
  *loop = (AppLoop){0};
  TRY(app_job_open(&loop->job, &options->job, options->overlap, NULL));
  Status status = open_opened(loop, options);
  if (status) app_loop_close(loop);
  return status;
}

void app_loop_close(AppLoop *loop) {
  loop->options.observe = NULL;
  fem_forces_destroy(&loop->forces);
  memory_free(loop->contacts);
  memory_free(loop->moments);
  fem_run_session_close(loop->session, STATUS_OK);
  fem_run_result_destroy(&loop->result);
  app_loop_groups_destroy(&loop->groups);
  app_loop_diary_destroy(&loop->diary);
  record_destroy(loop->origin);
  app_job_close(&loop->job);
  *loop = (AppLoop){0};
}

// What differs from the scene's end by no more than the rounding of a million steps' sum is the end.
static double snap(const AppLoop *loop, double until) {
  static const double ROUNDING = 1e-9;
  const double end = loop->job.scene.end;
  return fabs(until - end) <= ROUNDING * end ? end : until;
}

static Status change(AppLoop *loop, bool jumps) {
  TRY(fem_run_session_change(loop->session, jumps));
  return app_loop_read(loop);
}

Status app_loop_advance(AppLoop *loop, double wanted) {
  const double until = snap(loop, wanted);
  bool has_changed = false;
  TRY(fem_run_session_check(loop->session, until));
  if (until > app_loop_time(loop))
    TRY(app_loop_groups_begin(&loop->groups, app_loop_time(loop), until, &has_changed));
  if (has_changed) TRY(change(loop, false));
  TRY(fem_run_session_advance(loop->session, until));
  if (app_loop_state(loop)->version != loop->version_read) TRY(read_contacts(loop, 0));
  TRY(app_loop_read_areas(loop));
  const bool is_stopped = fem_run_session_is_stopped(loop->session);
  return app_loop_diary_advance(&loop->diary, until, is_stopped ? app_loop_time(loop) : until);
}

void app_loop_stop(AppLoop *loop) {
  fem_run_session_stop(loop->session);
}

Status app_loop_set(AppLoop *loop, AppLoopKind kind, const char *name, double ramp, const double *values,
                    int count) {
  AppLoopGroup *group;
  bool jumps;
  const FemState *state = app_loop_state(loop);
  TRY(app_loop_groups_find(&loop->groups, kind, name, &group));
  TRY(app_loop_group_set(&loop->groups, group, state->time, ramp, values, count, state->positions, &jumps));
  TRY(app_loop_diary_set(&loop->diary, kind, name, ramp, values, count));
  return group->is_pending ? STATUS_OK : change(loop, jumps);
}

Status app_loop_contact(const AppLoop *loop, const char *a, const char *b, int *contact) {
  char known[1024] = "";
  for (int i = 0; i < loop->contact_count; i++) {
    const AppLoopContact *it = &loop->contacts[i];
    *contact = i;
    if ((strcmp(it->a, a) == 0 && strcmp(it->b, b) == 0) || (strcmp(it->a, b) == 0 && strcmp(it->b, a) == 0))
      return STATUS_OK;
    size_t length = strlen(known);
    snprintf(known + length, sizeof known - length, "%s%s, %s", length > 0 ? "; " : "", it->a, it->b);
  }
  return status_fail(STATUS_INPUT, "'%s' and '%s' are no two that can touch; %s%s", a, b,
                     known[0] ? "there are: " : "the scene has no contact", known);
}

Status app_loop_vertex_forces(AppLoop *loop, const double **forces, const double **pressure) {
  const FemRunState *run = run_of(loop);
  *forces = *pressure = NULL;
  if (!contact_of(loop)) return STATUS_OK;
  if (!loop->forces.contact) {
    fem_forces_destroy(&loop->forces);
    TRY(fem_forces_create(&loop->forces, &run->system, true));
  }
  if (!loop->has_vertex_forces) {
    TRY(fem_forces_take(&loop->forces, &run->trial));
    TRY(fem_forces_take_surface(&loop->forces, &run->trial));
    for (int i = 0; i < 3 * run->model->vertex_count && loop->forces.friction; i++)
      loop->forces.contact[i] += loop->forces.friction[i];
  }
  loop->has_vertex_forces = true;
  *forces = loop->forces.contact;
  *pressure = loop->forces.pressure;
  return STATUS_OK;
}

void app_loop_stress(const AppLoop *loop, double *stress) {
  const FemRunState *run = run_of(loop);
  for (int e = 0; e < run->model->tet_count; e++)
    fem_stress_find(&run->system, &run->trial, e, stress + 6 * (size_t)e);
}
