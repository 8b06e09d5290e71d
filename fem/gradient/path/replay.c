// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/replay.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/stick.h"
#include "fem/effect/elements/plasticity.h"
#include "fem/gradient/gradient.h"

enum { MAX_ITERATIONS = 30, STICKS = 1, SLIPS = 2 };
// A step is balanced once Newton's method with the matrix there, which is near J or corrected by GMRES, does
// not halve what is left, which is then at most this share of the largest force.
static const double LEAST_FALL = 0.5, BALANCE = 1e-9;
// The matrix's factor serves on while two steps by it leave at most the square of this, since mixing needs
// one step to make the next one swift; below that share of the largest force nothing more is asked for.
static const double SWIFT = 0.25, ROUNDED = 1e-12;
// Of a system that GMRES solves, the share of the right side that may be left; and how far coordinates move
// for a difference of forces, as a share of the mean edge.
static const double INEXACT = 1e-4, WAY = 1e-7;

FemReplayFormula fem_replay_formula(const FemReplay *replay, int k) {
  const FemReplaySteps *steps = replay->steps;
  if (k < 1 || k >= steps->count || replay->system.model->scene->is_static)
    return (FemReplayFormula){0, 0, 0};
  const double *t = steps->times + k;
  double h = t[0] - t[-1];
  if (k == 1) return (FemReplayFormula){1 / h, -1 / h, 0};
  double ratio = h / (t[-1] - t[-2]);
  return (FemReplayFormula){(1 + 2 * ratio) / (1 + ratio) / h, -(1 + ratio) / h,
                            ratio * ratio / (1 + ratio) / h};
}

// The step of the first row that is in memory with a segment.
static int first_of(const FemReplay *replay, int segment) {
  return segment > 0 ? segment * replay->plan.length + 1 - FEM_REPLAY_LEAD : 0;
}

static size_t place_of(const FemReplay *replay, int k) {
  return (size_t)replay->n * (size_t)(k - first_of(replay, replay->segment));
}

// u and v of step k, which is in memory.
static double *u_of(const FemReplay *replay, int k) {
  return replay->u + place_of(replay, k);
}

static double *v_of(const FemReplay *replay, int k) {
  return replay->v + place_of(replay, k);
}

const double *fem_replay_v(const FemReplay *replay, int k) {
  return v_of(replay, k);
}

FemEffectHistory *fem_replay_histories(const FemReplay *replay, int k) {
  int segment = k / replay->plan.length, place = k % replay->plan.length;
  int row = place == 0 ? segment : replay->plan.segment_count + place;
  return replay->histories + (size_t)row * (size_t)replay->system.effect_count;
}

double fem_replay_mass(const FemReplay *replay, int unknown) {
  return replay->system.model->mass[replay->system.numbering.dof_of_unknown[unknown] / 3];
}

Status fem_replay_end(const FemReplay *replay, int k, Status status) {
  if (status == STATUS_INTERRUPTED)
    return status_fail(status, "interrupted at t = %.9g s of the replay: no gradient",
                       replay->steps->times[k]);
  if (status != STATUS_RETRY) return status;
  char why[512];
  snprintf(why, sizeof why, "%s", status_message());
  return status_fail(STATUS_SOLVER, "the replay's step to t = %.9g s: %s", replay->steps->times[k], why);
}

// ---- Room.

static Status multiply(void *self, const double *x, double *y);

static Status precondition(void *self, const double *x, double *y) {
  FemReplay *replay = self;
  return fem_inverse_solve(&replay->inverse, replay->c, INEXACT * INEXACT, x, y);
}

static Status create_slips(FemReplay *replay) {
  FemSystem *system = &replay->system;
  replay->stick = fem_system_effect(system, &fem_effect_stick);
  if (!replay->stick) return STATUS_OK;
  const ContactSystem *contact = fem_effect_contact_system(fem_system_effect(system, &fem_effect_contact));
  const ContactLayout *layout = contact_system_layout(contact);
  size_t marks = (size_t)layout->interface_count * (size_t)layout->def.vertex_count;
  replay->slips = memory_zeroed(marks, 1);
  return replay->slips ? STATUS_OK : status_no_memory("the replay of a run");
}

static Status create_yields(FemReplay *replay) {
  replay->plastic = fem_system_effect(&replay->system, &fem_effect_plasticity);
  if (!replay->plastic) return STATUS_OK;
  replay->yielded = memory_zeroed((size_t)fem_effect_plasticity_count(replay->plastic), 1);
  return replay->yielded ? STATUS_OK : status_no_memory("the replay of a run");
}

static Status create_krylov(FemReplay *replay) {
  replay->is_near = !replay->stick && !fem_system_effect(&replay->system, &fem_effect_damping) &&
                    !fem_gradient_has_following(replay->system.model);
  if (replay->is_near) return STATUS_OK;
  double **arrays[] = {&replay->ahead, &replay->aside, &replay->rate};
  bool fits = true;
  for (int i = 0; i < 3; i++) fits = (*arrays[i] = memory_zeroed((size_t)replay->n, sizeof(double))) && fits;
  if (!fits) return status_no_memory("the replay of a run");
  replay->krylov = (FemKrylov){.self = replay, .multiply = multiply, .precondition = precondition};
  return fem_krylov_create(&replay->krylov, replay->n);
}

static size_t history_count(const FemReplay *replay) {
  size_t rows = (size_t)replay->plan.segment_count + (size_t)replay->plan.length;
  return rows * (size_t)replay->system.effect_count;
}

// Of which solutions serve as a preconditioner only.
static Status create_solver(FemReplay *replay, FemEquilibrium *equilibrium) {
  TRY(fem_equilibrium_create(equilibrium, &replay->system, &replay->state, &fem_solver_cholmod));
  fem_solver_cholmod.be_rough(equilibrium->solver);
  return STATUS_OK;
}

Status fem_replay_create(FemReplay *replay, const FemModel *model, const FemReplaySteps *steps) {
  *replay = (FemReplay){.steps = steps};
  TRY(fem_system_create(&replay->system, model));
  replay->n = replay->system.numbering.count;
  replay->plan = fem_replay_steps_plan(steps);
  if (replay->plan.bytes == 0)
    return status_fail(STATUS_MEMORY, "the replay of a run needs %zu bytes at least", replay->plan.least);
  size_t n = (size_t)replay->n, segments = (size_t)replay->plan.segment_count;
  size_t rows = (size_t)replay->plan.length + (segments > 1 ? FEM_REPLAY_LEAD : 1);
  replay->u = memory_zeroed(rows * n, sizeof(double));
  replay->v = memory_zeroed(rows * n, sizeof(double));
  replay->saved = memory_zeroed(segments > 1 ? segments * 2 * FEM_REPLAY_LEAD * n : 1, sizeof(double));
  replay->force = memory_zeroed(n, sizeof(double));
  replay->step = memory_zeroed(n, sizeof(double));
  replay->weights = memory_zeroed(n, sizeof(double));
  replay->histories = memory_zeroed(history_count(replay), sizeof *replay->histories);
  if (!replay->u || !replay->v || !replay->saved || !replay->force || !replay->step || !replay->weights ||
      !replay->histories)
    return status_no_memory("the replay of a run");
  for (size_t i = 0; i < n; i++) replay->weights[i] = 1;
  if (steps->u && steps->unknown_count != replay->n)
    return status_fail(STATUS_INPUT, "the steps are of a run with %d unknowns, the replay has %d",
                       steps->unknown_count, replay->n);
  TRY(fem_system_create_state(&replay->system, &replay->before));
  TRY(fem_system_create_state(&replay->system, &replay->state));
  TRY(create_slips(replay));
  TRY(create_yields(replay));
  TRY(create_krylov(replay));
  TRY(fem_inverse_create(&replay->inverse, &replay->system, &replay->state));
  TRY(create_solver(replay, &replay->adjoint));
  return fem_mixing_create(&replay->mixing, replay->n);
}

void fem_replay_destroy(FemReplay *replay) {
  for (size_t i = 0; replay->histories && i < history_count(replay); i++)
    fem_effect_history_destroy(&replay->histories[i]);
  fem_krylov_destroy(&replay->krylov);
  fem_mixing_destroy(&replay->mixing);
  fem_inverse_destroy(&replay->inverse);
  fem_equilibrium_destroy(&replay->adjoint);
  for (int i = 0; i < FEM_MAX_EFFECTS; i++) replay->before.histories[i] = (FemEffectHistory){0}; // borrowed
  fem_state_destroy(&replay->before);
  fem_state_destroy(&replay->state);
  fem_system_destroy(&replay->system);
  void *arrays[] = {replay->u,     replay->saved, replay->v,       replay->force,
                    replay->step,  replay->ahead, replay->aside,   replay->histories,
                    replay->slips, replay->rate,  replay->weights, replay->yielded};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  *replay = (FemReplay){0};
}

// ---- A step.

// Forces at u, where lists follow if the way was long.
static Status find_forces(FemReplay *replay, double time, const double *u, const double *v, double *force) {
  Status status = fem_equilibrium_forces_moving(&replay->inverse.equilibrium, time, u, v, force);
  if (status != STATUS_RETRY) return status;
  TRY(fem_equilibrium_renew(&replay->inverse.equilibrium, time, u));
  return fem_equilibrium_forces_moving(&replay->inverse.equilibrium, time, u, v, force);
}

// f − M v̇ at u of step k into `force`; the largest value.
static Status find_residual(FemReplay *replay, int k, double *left) {
  FemReplayFormula formula = fem_replay_formula(replay, k);
  size_t n = (size_t)replay->n;
  double *u = u_of(replay, k), *v = v_of(replay, k);
  for (size_t i = 0; i < n; i++)
    v[i] = formula.c * u[i] + formula.near * u[i - n] + (k > 1 ? formula.far * u[i - 2 * n] : 0);
  TRY(find_forces(replay, replay->steps->times[k], u, v, replay->force));
  for (size_t i = 0; i < n; i++) {
    double far = k > 1 ? formula.far * v[i - 2 * n] : 0;
    replay->force[i] -= fem_replay_mass(replay, (int)i) * (formula.c * v[i] + formula.near * v[i - n] + far);
  }
  *left = fem_equilibrium_largest(replay->force, replay->n);
  return STATUS_OK;
}

// What forces and changes of momentum within a step are measured by [N].
static double scale_of(const FemReplay *replay, int k, double c) {
  const double *v = v_of(replay, k);
  double scale = fem_equilibrium_largest(replay->system.forces, 3 * replay->system.model->vertex_count);
  for (int i = 0; i < replay->n; i++) scale = fmax(scale, fem_replay_mass(replay, i) * c * fabs(v[i]));
  return scale;
}

// (−∂f/∂u − c ∂f/∂v + c² M) x by a difference of forces.
static Status multiply(void *self, const double *x, double *y) {
  FemReplay *replay = self;
  int n = replay->n;
  double largest = fem_equilibrium_largest(x, n), time = replay->state.time;
  double share = WAY * replay->system.model->edge / largest;
  memset(y, 0, (size_t)n * sizeof *y);
  if (!(largest > 0)) return STATUS_OK;
  for (int side = 1; side >= -1; side -= 2) {
    for (int i = 0; i < n; i++) {
      replay->ahead[i] = replay->middle[i] + side * share * x[i];
      replay->rate[i] = replay->speed[i] + side * share * replay->c * x[i];
    }
    TRY(find_forces(replay, time, replay->ahead, replay->rate, replay->aside));
    for (int i = 0; i < n; i++) y[i] -= side * replay->aside[i] / (2 * share);
  }
  for (int i = 0; i < n; i++) y[i] += replay->c * replay->c * fem_replay_mass(replay, i) * x[i];
  return STATUS_OK;
}

// Of a step d = P⁻¹ r by a factor P of another c, the share after which least is left: with
// J d = r + (c² − c_P²) M d it is r·J d / |J d|².
static double find_share(const FemReplay *replay, double c) {
  double top = 0, bottom = 0, more = c * c - replay->inverse.c * replay->inverse.c;
  for (int i = 0; i < replay->n; i++) {
    double along = replay->force[i] + more * fem_replay_mass(replay, i) * replay->step[i];
    top += replay->force[i] * along;
    bottom += along * along;
  }
  return top > 0 ? top / bottom : 1;
}

// How Newton's method goes on.
typedef struct FemReplayWay {
  bool is_fresh;     // with the matrix there, not an earlier one
  bool is_corrected; // by GMRES
  bool is_mixed;
} FemReplayWay;

// Newton's step from u and v, whose residual is in `force`.
static Status find_step(FemReplay *replay, double time, const double *u, const double *v, double c,
                        FemReplayWay way) {
  if (way.is_fresh) {
    TRY(fem_inverse_make(&replay->inverse, time, u, v, c));
    fem_mixing_forget(&replay->mixing);
  }
  if (!way.is_corrected) {
    TRY(fem_inverse_solve(&replay->inverse, c, INEXACT, replay->force, replay->step));
    if (!replay->mixing.has_last) replay->share = find_share(replay, c);
    for (int i = 0; i < replay->n; i++) replay->step[i] *= replay->share;
    if (!way.is_mixed) return STATUS_OK;
    fem_mixing_mix(&replay->mixing, replay->weights, replay->step);
    fem_mixing_take(&replay->mixing, 1, replay->step);
    return STATUS_OK;
  }
  replay->c = c;
  replay->middle = u;
  replay->speed = v;
  return fem_krylov_solve(&replay->krylov, replay->force, INEXACT, replay->step, NULL);
}

static Status balance(FemReplay *replay, int k, FemReplayWay way) {
  double c = fem_replay_formula(replay, k).c, time = replay->steps->times[k], left;
  size_t n = (size_t)replay->n;
  double *u = u_of(replay, k), *v = v_of(replay, k);
  fem_mixing_forget(&replay->mixing);
  TRY(find_residual(replay, k, &left));
  double last = left / (SWIFT * SWIFT * SWIFT); // the first step may leave more than there was
  for (int i = 0; i < MAX_ITERATIONS && left > 0; i++) {
    double earlier = last;
    last = left;
    bool is_newton = way.is_fresh && (replay->is_near || way.is_corrected), was_fresh = way.is_fresh;
    TRY(find_step(replay, time, u, v, c, way));
    for (size_t j = 0; j < n; j++) u[j] += replay->step[j];
    TRY(find_residual(replay, k, &left));
    double scale = scale_of(replay, k, c);
    way.is_fresh = !(left <= SWIFT * (way.is_mixed ? SWIFT * earlier : last));
    way.is_corrected = way.is_corrected || (way.is_fresh && was_fresh && !replay->is_near);
    if (!(left <= BALANCE * scale)) continue;
    if (left > ROUNDED * scale && (left <= LEAST_FALL * last || !is_newton)) continue;
    replay->worst = fmax(replay->worst, left / scale);
    return STATUS_OK;
  }
  if (!(left > 0)) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "the replay's step to t = %.9g s cannot be balanced", time);
}

// ---- All steps.

// Counts vertices that slip and stuck in the step before, and the other way round.
static Status count_switches(FemReplay *replay) {
  const ContactStick *law;
  if (!replay->stick) return STATUS_OK;
  TRY(fem_effect_stick_evaluate(replay->stick, &replay->state, &law));
  size_t vertices = (size_t)law->vertex_count, marks = vertices * (size_t)law->interface_count;
  for (size_t i = 0; i < marks; i++) replay->slips[i] <<= 4; // what was, above what is
  for (int k = 0; k < law->node_count; k++) {
    const ContactStickNode *node = &law->nodes[k];
    replay->slips[vertices * (size_t)node->interface + (size_t)node->vertex] |= node->slips ? SLIPS : STICKS;
  }
  for (size_t i = 0; i < marks; i++) {
    int was = replay->slips[i] >> 4, is = replay->slips[i] & 15;
    replay->switches += was && is && was != is;
    replay->slips[i] = (unsigned char)is;
  }
  return STATUS_OK;
}

// The same of points that yield and did not in the step before.
static void count_yields(FemReplay *replay, int k) {
  if (!replay->plastic) return;
  int place = fem_effect_plasticity_place(replay->plastic);
  const FemPlastic *was = (const FemPlastic *)fem_replay_histories(replay, k - 1)[place].values;
  const FemPlastic *is = (const FemPlastic *)fem_replay_histories(replay, k)[place].values;
  for (int i = 0; i < fem_effect_plasticity_count(replay->plastic); i++) {
    bool yields = is[i].alpha > was[i].alpha;
    replay->yields += k > 1 && yields != replay->yielded[i];
    replay->yielded[i] = yields;
  }
}

// In arrays that are not larger than what they hold.
static Status keep_histories(FemReplay *replay, int k) {
  FemEffectHistory *kept = fem_replay_histories(replay, k);
  for (int e = 0; e < replay->system.effect_count; e++) {
    const FemEffectHistory *history = &replay->system.accepted.histories[e];
    size_t count = history->count;
    fem_effect_history_destroy(&kept[e]);
    if (count == 0) continue;
    kept[e] = (FemEffectHistory){memory_copy(history->values, count, sizeof(double)), count, count};
    if (!kept[e].values) return status_no_memory("the replay of a run");
  }
  return STATUS_OK;
}

// u at step k extrapolated from the steps before it; from one step by the velocity there.
static double lead(const double *t, const double *u, size_t n, int k, const double *v) {
  if (k < FEM_REPLAY_LEAD) return u[-(ptrdiff_t)n] + (t[k] - t[k - 1]) * v[-(ptrdiff_t)n];
  double sum = 0;
  for (int i = 1; i <= FEM_REPLAY_LEAD; i++) {
    double share = 1;
    for (int j = 1; j <= FEM_REPLAY_LEAD; j++)
      if (j != i) share *= (t[k] - t[k - j]) / (t[k - i] - t[k - j]);
    sum += share * u[-(ptrdiff_t)(n * (size_t)i)];
  }
  return sum;
}

static void guess(FemReplay *replay, int k) {
  size_t n = (size_t)replay->n;
  const double *t = replay->steps->times, *found = replay->steps->u ? replay->steps->u[k] : NULL;
  double *u = u_of(replay, k), *v = v_of(replay, k);
  if (found) memcpy(u, found, n * sizeof *u);
  for (size_t i = 0; i < n && !found; i++) u[i] = lead(t, u + i, n, k, v + i);
}

// A step of a motion is short, so that an earlier factor serves; where it does not, nothing is spared.
static Status find(FemReplay *replay, int k) {
  double c = fem_replay_formula(replay, k).c;
  if (!replay->system.model->scene->is_static) {
    guess(replay, k);
    Status status = balance(
        replay, k, (FemReplayWay){.is_fresh = !fem_inverse_serves(&replay->inverse, c), .is_mixed = true});
    if (status != STATUS_SOLVER && status != STATUS_RETRY) return status;
  }
  guess(replay, k);
  return balance(replay, k, (FemReplayWay){.is_fresh = true, .is_corrected = !replay->is_near});
}

static Status step(FemReplay *replay, int k, bool is_again) {
  const double *t = replay->steps->times;
  TRY(find(replay, k));
  fem_system_scatter(&replay->system, t[k], u_of(replay, k), v_of(replay, k), &replay->state);
  if (!is_again) TRY(count_switches(replay));
  TRY(fem_system_accept(&replay->system, &replay->state, k + 1 < replay->steps->count ? t[k + 1] - t[k] : 0));
  TRY(keep_histories(replay, k));
  if (!is_again) count_yields(replay, k);
  return STATUS_OK;
}

// A run that goes on from another begins at that one's end.
static Status begin(FemReplay *replay) {
  const FemModel *model = replay->system.model;
  if (!model->start) return STATUS_OK;
  memcpy(replay->state.positions, model->start->positions, 3 * (size_t)model->vertex_count * sizeof(double));
  return fem_system_begin(&replay->system, &replay->state, 0);
}

// The accepted state of step k, its histories borrowed.
static void recall(FemReplay *replay, int k, FemState *state) {
  fem_system_scatter(&replay->system, replay->steps->times[k], u_of(replay, k), v_of(replay, k), state);
  memcpy(state->histories, fem_replay_histories(replay, k),
         (size_t)replay->system.effect_count * sizeof *state->histories);
  state->version = fem_state_new_version();
  state->last = state;
}

// Whether the replay begins anew at step k, forwards and backwards.
static bool is_anew(const FemReplay *replay, int k) {
  return k % FEM_REPLAY_BLOCK == 0 && k + 1 < replay->steps->count;
}

// From step k on nothing depends on what was before, but for the numbers that are kept.
static Status begin_anew(FemReplay *replay, int k) {
  FemSystem *system = &replay->system;
  const double *t = replay->steps->times + k;
  recall(replay, k, &replay->before);
  TRY(fem_system_begin(system, &replay->before, t[1] - t[0]));
  for (int e = 0; e < system->effect_count; e++) {
    const FemEffectHistory *history = &replay->before.histories[e];
    if (history->count > 0) TRY(fem_system_remember(system, e, history->values, history->count));
  }
  replay->state.last = &system->accepted;
  return fem_inverse_forget(&replay->inverse);
}

// ---- Segments.

// Keeps the last rows before a segment, or, `back`, puts them back.
static void save(FemReplay *replay, int segment, bool back) {
  int begin = segment * replay->plan.length, from = first_of(replay, segment);
  size_t n = (size_t)replay->n, count = n * (size_t)(begin + 1 - from);
  double *saved = replay->saved + 2 * FEM_REPLAY_LEAD * n * (size_t)segment;
  for (int i = 0; i < 2; i++) {
    double *kept = saved + (size_t)i * FEM_REPLAY_LEAD * n;
    double *row = i == 0 ? u_of(replay, from) : v_of(replay, from);
    memcpy(back ? row : kept, back ? kept : row, count * sizeof *row);
  }
}

// Takes a segment into memory in place of the other, of which only the beginnings of segments stay.
static void turn_to(FemReplay *replay, int segment) {
  size_t begins = (size_t)(replay->plan.segment_count + 1) * (size_t)replay->system.effect_count;
  for (size_t i = begins; i < history_count(replay); i++) fem_effect_history_destroy(&replay->histories[i]);
  replay->segment = segment;
  save(replay, segment, true);
}

// Does the steps of the segment in memory.
static Status go_through(FemReplay *replay, bool is_again) {
  int begin = replay->segment * replay->plan.length, last = replay->steps->count - 1;
  double began = clock_cpu_s();
  TRY(begin_anew(replay, begin));
  for (int k = begin + 1; k <= last && k <= begin + replay->plan.length; k++) {
    TRY(fem_replay_end(replay, k, step(replay, k, is_again)));
    if (k < begin + replay->plan.length && is_anew(replay, k)) TRY(begin_anew(replay, k));
  }
  replay->spent_s += clock_cpu_s() - began;
  return STATUS_OK;
}

Status fem_replay_go(FemReplay *replay) {
  TRY(begin(replay));
  fem_system_gather(&replay->system, &replay->system.accepted, replay->u, replay->v);
  TRY(keep_histories(replay, 0));
  if (replay->plan.segment_count > 1) save(replay, 0, false);
  TRY(go_through(replay, false));
  for (int segment = 1; segment < replay->plan.segment_count; segment++) {
    save(replay, segment, false);
    turn_to(replay, segment);
    TRY(go_through(replay, false));
  }
  return STATUS_OK;
}

// Sees to it that step k and the one before are in memory.
static Status fetch(FemReplay *replay, int k) {
  int segment = k > 0 ? (k - 1) / replay->plan.length : 0;
  if (segment == replay->segment) return STATUS_OK;
  turn_to(replay, segment);
  return go_through(replay, true);
}

Status fem_replay_return(FemReplay *replay, int k) {
  double time = replay->steps->times[k];
  TRY(fetch(replay, k));
  if (is_anew(replay, k)) TRY(begin_anew(replay, k));
  recall(replay, k > 0 ? k - 1 : 0, &replay->before);
  replay->state.last = &replay->before;
  TRY(fem_equilibrium_renew(&replay->inverse.equilibrium, time, u_of(replay, k)));
  fem_system_scatter(&replay->system, time, u_of(replay, k), v_of(replay, k), &replay->state);
  return STATUS_OK;
}

Status fem_replay_factorise(FemReplay *replay, int k) {
  double c = fem_replay_formula(replay, k).c;
  return fem_equilibrium_factorise_moving(&replay->adjoint, replay->steps->times[k], u_of(replay, k),
                                          v_of(replay, k), c, c * c);
}
