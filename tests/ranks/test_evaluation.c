// SPDX-License-Identifier: GPL-3.0-or-later
// One evaluation over ranks is that of one process to rounding: forces, energies, matrix times vector,
// and solutions, for every effect, element and potential, however the vertices are divided.
#include <stdio.h>
#include <string.h>

#include "app/scene/read.h"
#include "base/memory.h"
#include "base/random.h"
#include "case.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/system.h"
#include "fem/effect/system_energy.h"
#include "fem/model/build.h"

static const double SAME = 1e-12; // of the largest entry: sums of some hundred terms in another order
// Solutions: conjugate gradients to 1e-11 of the first residual, and as much again for the matrix's
// condition.
static const double SOLVED = 1e-11, SAME_SOLUTION = 1e-7;

typedef struct Variant {
  const char *name;
  const char *overrides[5]; // ended by NULL
  bool is_folded;           // the lower block's right half lies on its left one
} Variant;

static const Variant variants[] = {
    {.name = "field, stick"},
    {.name = "exact", .overrides = {"contact.overlap=exact"}},
    {.name = "learned, with its own centroid", .overrides = {"contact.overlap=geo"}},
    {.name = "nodal", .overrides = {"contact={potential: nodal}"}},
    {.name = "viscosity", .overrides = {"contact={viscosity: 1e-4}"}},
    {.name = "learned", .overrides = {"contact.overlap=tpn"}},
    {.name = "nodal elements", .overrides = {"bodies.lower.element=nodal", "bodies.upper.element=nodal"}},
    {.name = "quadratic elements",
     .overrides = {"bodies.lower.element=quadratic", "bodies.upper.element=nodal"}},
    {.name = "self-contact", .overrides = {"bodies.lower.self_contact=true"}, .is_folded = true},
    {.name = "without contact", .overrides = {"contact={}"}},
};
enum { VARIANTS = sizeof variants / sizeof *variants };

typedef struct Answer {
  int unknowns, values;
  double *forces, *product, *solution; // (values), (unknowns), (unknowns)
  FemEnergy energy;
  int pairs;
} Answer;

static void free_answer(Answer *answer) {
  memory_free(answer->forces), memory_free(answer->product), memory_free(answer->solution);
}

// A state some percent off rest, the same for whoever asks.
static void displace(const FemSystem *system, const Variant *variant, double size, double *u, double *v) {
  const FemModel *model = system->model;
  Random random = random_seeded(7, 0);
  for (int i = 0; i < model->free_count; i++) {
    u[i] = random_between(&random, -size, size) * model->edge;
    v[i] = random_between(&random, -0.05, 0.05);
  }
  for (int i = 0; i < model->free_count && variant->is_folded; i++) {
    int dof = system->numbering.dof_of_unknown[i], vertex = dof / 3;
    const double *x = model->rest + 3 * (size_t)vertex;
    double beyond = x[0] - 0.1;
    if (vertex >= model->bodies[0].vertex_end || !(beyond > 0)) continue;
    if (dof % 3 == 0) u[i] -= 2 * beyond;
    if (dof % 3 == 2) u[i] += fmin(beyond, 0.05) / 0.05 * 0.098;
  }
}

// 2-norm-free: x of the product, without structure.
static double probe_of(int i) {
  return sin(1.7 * i) + 0.3 * cos(0.31 * i * i);
}

static Status multiply(FemSystem *system, const FemState *state, Answer *answer) {
  double *x = memory_zeroed((size_t)answer->unknowns, sizeof *x);
  if (!x) return status_no_memory("a vector");
  for (int i = 0; i < answer->unknowns; i++) x[i] = probe_of(i);
  Status status = fem_system_couple(system, state);
  if (!status) status = fem_system_assemble(system, state, 1, 30, 1e4, &system->matrix);
  if (!status) fem_matrix_multiply(&system->matrix, x, answer->product);
  if (!status) ranks()->sum(answer->product, (size_t)answer->unknowns);
  memory_free(x);
  return status;
}

// S x = b of the matrix that was multiplied, twice: what is kept of the first time must serve the second.
static Status solve(const FemSystem *system, FemSolverKind kind, Answer *answer) {
  const FemSolverOps *ops = fem_solver_ops(kind);
  void *solver;
  TRY(ops->create(&solver, 1, ops->tolerance > 0 ? SOLVED : 0));
  Status status = ops->analyse(solver, &system->matrix);
  for (int time = 0; time < 2 && !status; time++) {
    status = ops->factorise(solver, &system->matrix, NULL, NULL, 1);
    if (!status) status = ops->solve(solver, answer->product, answer->solution);
  }
  ops->destroy(solver);
  return status;
}

static Status find_answer(FemSystem *system, FemState *state, const Variant *variant, FemSolverKind kind,
                          double *u, double *v, Answer *answer) {
  const double TIME = 1e-3;
  displace(system, variant, 0.002, u, v);
  TRY(fem_system_create_state(system, state));
  fem_system_scatter(system, 0, u, v, state);
  TRY(fem_system_begin(system, state, TIME));
  displace(system, variant, 0.0025, u, v);
  fem_system_scatter(system, TIME, u, v, state);
  TRY(fem_system_forces(system, state));
  memcpy(answer->forces, system->forces, (size_t)answer->values * sizeof(double));
  TRY(fem_system_energy(system, state, &answer->energy));
  const ContactEvaluation *contact;
  TRY(fem_effect_contact_evaluate(system, state, &contact));
  answer->pairs = contact ? contact_evaluation_active_count(contact) : 0;
  TRY(multiply(system, state, answer));
  return kind == FEM_SOLVER_AUTO ? STATUS_OK : solve(system, kind, answer);
}

static Status evaluate(const FemModel *model, const Variant *variant, FemSolverKind kind, Answer *answer) {
  size_t n = (size_t)model->free_count, values = 3 * (size_t)model->vertex_count;
  FemSystem system;
  FemState state = {0};
  TRY(fem_system_create(&system, model));
  double *u = memory_zeroed(n, sizeof *u), *v = memory_zeroed(n, sizeof *v);
  *answer = (Answer){.unknowns = (int)n, .values = (int)values};
  answer->forces = memory_zeroed(values, sizeof(double));
  answer->product = memory_zeroed(n, sizeof(double));
  answer->solution = memory_zeroed(n, sizeof(double));
  bool is_ok = u && v && answer->forces && answer->product && answer->solution;
  Status status =
      is_ok ? find_answer(&system, &state, variant, kind, u, v, answer) : status_no_memory("an answer");
  memory_free(u), memory_free(v);
  fem_state_destroy(&state);
  fem_system_destroy(&system);
  return status;
}

// Reads the scene and evaluates it with the table of ranks that is set.
// The solution by that solver, FEM_SOLVER_AUTO: none.
static Status answer_variant(const Variant *variant, FemSolverKind kind, Answer *answer) {
  FemSceneDef scene = {0};
  FemModel model = {0};
  int count = 0;
  while (variant->overrides[count]) count++;
  Status status =
      app_scene_read(TETLAP_SOURCE_DIR "/tests/ranks/press.yaml", variant->overrides, count, &scene);
  if (!status) status = fem_model_create(&model, &scene);
  if (!status) status = evaluate(&model, variant, kind, answer);
  fem_model_destroy(&model);
  fem_scene_destroy(&scene);
  return status;
}

static double difference(const double *a, const double *b, int count) {
  double most = 0, largest = 0;
  for (int i = 0; i < count; i++) {
    most = fmax(most, fabs(a[i]));
    double off = fabs(a[i] - b[i]);
    if (!(off <= largest)) largest = off;
  }
  return largest / most;
}

START_TEST(one_evaluation_is_that_of_one_process) {
  const Variant *variant = &variants[_i / CASE_DIVISIONS];
  CaseDivision division = (CaseDivision)(_i % CASE_DIVISIONS);
  Answer whole = {0}, shared = {0};
  case_alone();
  Status status = answer_variant(variant, FEM_SOLVER_AUTO, &whole);
  case_share(division);
  ck_assert_ok(status);
  ck_assert_ok(answer_variant(variant, FEM_SOLVER_AUTO, &shared));
  ck_assert_int_gt(ranks()->count, 1);
  ck_assert_int_eq(shared.unknowns, whole.unknowns);
  double forces = case_most(difference(whole.forces, shared.forces, whole.values)),
         product = case_most(difference(whole.product, shared.product, whole.unknowns)),
         energy = case_most(difference(&whole.energy.kinetic, &shared.energy.kinetic,
                                       (int)(sizeof whole.energy / sizeof(double)))),
         pairs = case_most(abs(whole.pairs - shared.pairs));
  bool has_contact = strcmp(variant->name, "without contact") != 0;
  ck_assert_msg(whole.pairs > 0 || !has_contact, "%s: nothing touches", variant->name);
  ck_assert_msg(forces <= SAME, "%s, division %d: forces differ by %g", variant->name, division, forces);
  ck_assert_msg(product <= SAME, "%s, division %d: matrices differ by %g", variant->name, division, product);
  ck_assert_msg(energy <= SAME, "%s, division %d: energies differ by %g", variant->name, division, energy);
  ck_assert_msg(pairs <= 0, "%s, division %d: %g pairs more or less", variant->name, division, pairs);
  free_answer(&whole), free_answer(&shared);
}
END_TEST

START_TEST(solutions_are_those_of_a_factor) {
  static const FemSolverKind kinds[] = {FEM_SOLVER_CHOLMOD, FEM_SOLVER_PCG, FEM_SOLVER_AMG, FEM_SOLVER_GAMG};
  const Variant *variant = &variants[_i / 4 ? VARIANTS - 3 : 0];
  FemSolverKind kind = kinds[_i % 4];
  Answer whole = {0}, shared = {0};
  case_alone();
  Status status = answer_variant(variant, FEM_SOLVER_CHOLMOD, &whole);
  case_share((CaseDivision)(_i % CASE_DIVISIONS));
  ck_assert_ok(status);
  ck_assert_ok(answer_variant(variant, kind, &shared));
  double solution = case_most(difference(whole.solution, shared.solution, whole.unknowns));
  ck_assert_msg(solution <= SAME_SOLUTION, "%s, %s: solutions differ by %g", variant->name,
                fem_solver_name(kind), solution);
  free_answer(&whole), free_answer(&shared);
}
END_TEST

int main(int argument_count, char **arguments) {
  TCase *test_case = tcase_create("evaluation");
  tcase_add_loop_test(test_case, one_evaluation_is_that_of_one_process, 0, VARIANTS * CASE_DIVISIONS);
  tcase_add_loop_test(test_case, solutions_are_those_of_a_factor, 0, 8);
  return case_main(argument_count, arguments, "ranks_evaluation", test_case);
}
