// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/run_stage.h"

#include <float.h>
#include <math.h>

#include "contact/pressure/law.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/limits.h"
#include "fem/model/tolerance.h"
#include "fem/run/check/choice.h"
#include "fem/run/rest/hold.h"
#include "fem/run/run_frames.h"

double fem_run_stage_resolved(const FemModel *model) {
  return FEM_SHORTEST_RETRY * model->edge / fem_model_fastest_wave(model);
}

// p′ of a law where it presses with that pressure, or at the depth `deepest` if it never does.
static double slope_at(const ContactLaw *law, double pressure, double deepest) {
  double low = 0, high = deepest;
  for (int i = 0; i < DBL_MANT_DIG; i++) {
    double middle = 0.5 * (low + high);
    if (contact_law_at(law, middle).pressure < pressure)
      low = middle;
    else
      high = middle;
  }
  return contact_law_at(law, high).slope;
}

// The slope found last: of many interfaces nearly all have one law and one material.
typedef struct {
  const ContactLaw *law;
  double young, slope;
} Slope;

// Of a contact as that of an element: its pressure over the strain of an edge [Pa].
static double modulus_of(const FemModel *model, const ContactInterfaceDef *interface, double young,
                         Slope *last) {
  if (model->scene->contact.potential == CONTACT_POTENTIAL_NODAL) return interface->stiffness;
  if (interface->law) {
    if (interface->law != last->law || young != last->young)
      *last = (Slope){interface->law, young, slope_at(interface->law, young, model->edge)};
    return model->edge * last->slope;
  }
  return (interface->shape < 0 ? 2 : 1) * model->edge * interface->stiffness;
}

// The fastest speed with which such a contact throws an element of a party back [m/s].
static double speed_of(const FemModel *model, const ContactInterfaceDef *interface, int party, Slope *last) {
  double fastest = 0;
  if (party >= model->body_count) return fastest;
  const FemModelBody *body = &model->bodies[party];
  for (int p = body->part_begin; p < body->part_end; p++) {
    const FemMaterial *material = &model->parts[p].material;
    fastest = fmax(fastest, sqrt(modulus_of(model, interface, material->young, last) / material->density));
  }
  return fastest;
}

double fem_run_stage_rebound(const FemModel *model, const ContactLayout *contact) {
  double fastest = fem_model_fastest_wave(model);
  Slope last = {NULL, 0, 0};
  for (int i = 0; i < contact->interface_count; i++) {
    const ContactInterfaceDef *interface = &contact->interfaces[i];
    fastest = fmax(fastest, speed_of(model, interface, interface->a, &last));
    fastest = fmax(fastest, speed_of(model, interface, interface->b, &last));
  }
  return FEM_SHORTEST_RETRY * model->edge / fastest;
}

void fem_run_stage_scatter(FemRunState *run) {
  fem_system_scatter(&run->system, run->time, run->u, run->v, &run->trial);
}

Status fem_run_stage_begin(FemRunState *run, double step) {
  const FemModel *model = run->model;
  const FemSceneDef *scene = model->scene;
  double next = fem_rest_next_change(run->rest);
  run->stage_end = fmin(fmin(scene->end, next), fem_numbering_next_release(model, run->time));
  if (run->system.numbering.count == 0) return STATUS_OK; // all sleep
  void *contact = fem_system_effect(&run->system, &fem_effect_contact);
  run->rebound = contact
                     ? fem_run_stage_rebound(model, contact_system_layout(fem_effect_contact_system(contact)))
                     : fem_run_stage_resolved(model);
  FemIntegratorDef def = {.displacement_tolerance = fem_model_position_tolerance(model),
                          .velocity_tolerance = fem_model_velocity_tolerance(model),
                          .speed_share = fem_model_speed_share(model),
                          .initial_step = step,
                          .min_step = scene->min_step,
                          .max_step = scene->max_step,
                          .least_start = FEM_CUT * fem_run_stage_resolved(model),
                          .max_order = scene->max_order,
                          .end = run->stage_end,
                          .stall = &run->stall};
  const FemSolverOps *solver = fem_solver_ops(fem_run_choice(model, &run->system.numbering).kind);
  TRY(fem_integrator_create(&run->integrator, &run->system, &run->trial, solver, &def));
  fem_integrator_aim(run->integrator, run->target);
  return fem_integrator_restart(run->integrator, run->time, run->u, run->v, step);
}

static void add_stability(FemStability *total, const FemStability *part) {
  if (part->unstable == 0) return;
  if (total->unstable == 0) *total = (FemStability){0, part->most, part->stable_until, part->unstable_from};
  total->unstable += part->unstable;
  if (part->most > total->most) total->most = part->most;
}

void fem_run_stage_end(FemRunState *run) {
  FemRunResult *result = run->result;
  const FemStatics *statics = &run->statics;
  result->integrator = fem_run_state_stats(run);
  if (run->integrator) {
    fem_run_result_add_solver(&result->matrix.solver, fem_integrator_solver_stats(run->integrator));
    result->cost.phases.products += fem_integrator_product_s(run->integrator);
  }
  if (statics->equilibrium.solver) {
    fem_run_result_add_solver(&result->matrix.solver,
                              statics->equilibrium.ops->stats(statics->equilibrium.solver));
    result->equilibrium.residual = statics->residual;
    result->equilibrium.residual_allowed = statics->tolerance * statics->force_scale;
    result->equilibrium.relaxation_steps += statics->relaxation_steps;
    result->equilibrium.halvings += statics->halvings;
    result->equilibrium.loose += statics->loose;
    add_stability(&result->equilibrium.stability, &statics->stability);
  }
  fem_integrator_destroy(run->integrator);
  run->integrator = NULL;
  fem_statics_destroy(&run->statics);
}

// With the coordinates that are free from here on.
static Status begin_account(FemRunState *run) {
  FemMeasures measures;
  fem_run_stage_scatter(run);
  TRY(fem_run_frames_measure(run, &measures));
  return fem_recorder_begin_step(&run->recorder, &run->trial, &measures);
}

Status fem_run_stage_change(FemRunState *run) {
  fem_run_stage_end(run);
  fem_run_stage_scatter(run);
  TRY(fem_hold_renumber(&run->system, run->rest, &run->trial, &run->audit, run->u, run->v));
  TRY(begin_account(run));
  return fem_run_stage_begin(run, 0);
}

Status fem_run_stage_accept(FemRunState *run, double next_step) {
  fem_run_stage_scatter(run); // a frame has been shown since, perhaps
  TRY(fem_system_accept(&run->system, &run->trial, next_step));
  return fem_rest_decide(run->rest, next_step);
}
