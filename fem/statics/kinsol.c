// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/statics/kinsol.h"

#include <kinsol/kinsol.h>
#include <stdio.h>

#include "base/memory.h"
#include "fem/time/newton/direct.h"
#include "fem/time/nvector.h"
#include "fem/time/sundials.h"

enum { FULL_STEPS = 12, LINE_SEARCH_STEPS = 40, MESSAGE_SIZE = 512 };

// One call of KINSOL and what it needs.
typedef struct Newton {
  FemEquilibrium *equilibrium;
  double time;
  int n;
  SUNContext context;
  void *kinsol;
  N_Vector u, u_scale, f_scale;
  FemDirect direct;
  Status fatal;               // of a callback; STATUS_OK: none
  char message[MESSAGE_SIZE]; // of the last failure of a callback, "" if none
} Newton;

static int answer(Newton *newton, Status status) {
  if (status == STATUS_OK) return 0;
  snprintf(newton->message, sizeof newton->message, "%s", status_message());
  if (status < 0) newton->fatal = status;
  return status > 0 ? 1 : -1;
}

// F = −f, so that its Jacobian is K.
static int residual(N_Vector u, N_Vector r, void *self) {
  Newton *newton = self;
  double *force = N_VGetArrayPointer(r);
  int flag =
      answer(newton, fem_equilibrium_forces(newton->equilibrium, newton->time, N_VGetArrayPointer(u), force));
  for (int i = 0; i < newton->n && flag == 0; i++) force[i] = -force[i];
  return flag;
}

static int jacobian(N_Vector u, N_Vector r, SUNMatrix matrix, void *self, N_Vector scratch1,
                    N_Vector scratch2) {
  (void)r, (void)matrix, (void)scratch1, (void)scratch2;
  Newton *newton = self;
  return answer(newton,
                fem_equilibrium_factorise(newton->equilibrium, newton->time, N_VGetArrayPointer(u), 0));
}

// Factorised when the Jacobian was asked for.
static int set_up(SUNLinearSolver linear, SUNMatrix matrix) {
  (void)linear, (void)matrix;
  return SUN_SUCCESS;
}
static int solve(SUNLinearSolver linear, SUNMatrix matrix, N_Vector x, N_Vector b, sunrealtype tolerance) {
  (void)matrix, (void)tolerance;
  Newton *newton = linear->content;
  int flag = answer(newton,
                    fem_equilibrium_solve(newton->equilibrium, N_VGetArrayPointer(b), N_VGetArrayPointer(x)));
  return fem_direct_flag(flag);
}

static Status create(Newton *newton, double tolerance, double length) {
  if (!fem_sundials_create(&newton->context)) return status_no_memory("KINSOL");
  N_Vector *vectors[] = {&newton->u, &newton->u_scale, &newton->f_scale};
  for (int i = 0; i < 3; i++)
    if (!(*vectors[i] = fem_nvector_create(newton->n, newton->context))) return status_no_memory("KINSOL");
  N_VConst(1 / length, newton->u_scale);
  N_VConst(1 / tolerance, newton->f_scale);
  TRY(fem_direct_create(&newton->direct, newton->context, newton, set_up, solve));
  newton->kinsol = KINCreate(newton->context);
  if (!newton->kinsol) return status_no_memory("KINSOL");
  void *kinsol = newton->kinsol;
  bool is_ok = FEM_SUNDIALS_SILENCE(KIN, kinsol) && KINInit(kinsol, residual, newton->u) == KIN_SUCCESS &&
               KINSetUserData(kinsol, newton) == KIN_SUCCESS &&
               KINSetLinearSolver(kinsol, newton->direct.linear, newton->direct.matrix) == KIN_SUCCESS &&
               KINSetJacFn(kinsol, jacobian) == KIN_SUCCESS &&
               KINSetMaxSetupCalls(kinsol, 1) == KIN_SUCCESS &&
               KINSetFuncNormTol(kinsol, 1) == KIN_SUCCESS && // of the force over `tolerance`
               KINSetScaledStepTol(kinsol, 1e-14) == KIN_SUCCESS;
  return is_ok ? STATUS_OK : status_fail(STATUS_SOLVER, "KINSOL could not be set up");
}

static void destroy(Newton *newton) {
  if (newton->kinsol) KINFree(&newton->kinsol);
  fem_direct_destroy(&newton->direct);
  N_Vector vectors[] = {newton->u, newton->u_scale, newton->f_scale};
  for (int i = 0; i < 3; i++)
    if (vectors[i]) N_VDestroy(vectors[i]);
  if (newton->context) SUNContext_Free(&newton->context);
}

// From the start u by one strategy of KINSOL; u is what it ended in, also of a failure.
static Status run(Newton *newton, int strategy, int most, const double *start, double *u,
                  long long *iterations) {
  double *own = N_VGetArrayPointer(newton->u), norm = 0;
  for (int i = 0; i < newton->n; i++) own[i] = start[i];
  newton->message[0] = 0;
  KINSetNumMaxIters(newton->kinsol, most);
  int flag = KINSol(newton->kinsol, newton->u, strategy, newton->u_scale, newton->f_scale);
  long taken = 0;
  KINGetNumNonlinSolvIters(newton->kinsol, &taken);
  KINGetFuncNorm(newton->kinsol, &norm);
  *iterations += taken;
  if (newton->fatal != STATUS_OK) return status_fail(newton->fatal, "%s", newton->message);
  for (int i = 0; i < newton->n; i++) u[i] = own[i];
  if (flag == KIN_SUCCESS || flag == KIN_INITIAL_GUESS_OK) return STATUS_OK;
  const char *name = flag == KIN_MAXITER_REACHED ? "too many iterations" : newton->message;
  return status_fail(STATUS_RETRY,
                     "Newton's method left a force of %.3g times the tolerance after %ld iterations%s%s",
                     norm, taken, name[0] ? ": " : "", name);
}

Status fem_kinsol_solve(FemEquilibrium *equilibrium, double time, double tolerance, double length, double *u,
                        long long *iterations) {
  Newton newton = {.equilibrium = equilibrium, .time = time, .n = equilibrium->system->numbering.count};
  double *start = memory_copy(u, (size_t)newton.n, sizeof *u);
  Status status = start ? create(&newton, tolerance, length) : status_no_memory("KINSOL");
  if (!status) status = run(&newton, KIN_NONE, FULL_STEPS, start, u, iterations);
  if (status == STATUS_RETRY) status = run(&newton, KIN_LINESEARCH, LINE_SEARCH_STEPS, start, u, iterations);
  memory_free(start);
  destroy(&newton);
  return status;
}
