// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives dg/dp at an equilibrium f(x, p) = 0 of a static scene without friction and plasticity, for any
// number of parameters by one solve for each g (the adjoint method):
//
//   Jᵀ λ = ∂g/∂x,   dg/dp = ∂g/∂p + λ · ∂f/∂p + (∂g/∂x_c − J_cᵀ λ) · ∂x_c/∂p,   J = −∂f/∂x
//
// with x the free coordinates, x_c the prescribed ones and J_c their columns. J is the matrix, which is
// symmetric. With overlap models that do not clip and with pressure laws it is not; then the adjoint is
// solved by GMRES with the matrix's factor. Where contact begins or ends exactly at the state, g has no
// derivative; the values are one-sided there.
#ifndef TETLAP_FEM_GRADIENT_GRADIENT_H
#define TETLAP_FEM_GRADIENT_GRADIENT_H

#include "fem/gradient/parameter.h"
#include "fem/gradient/quantity.h"

typedef struct FemGradientDef {
  const FemGoal *goals;           // borrowed                                 (goal_count)
  const FemParameter *parameters; // borrowed                            (parameter_count)
  int goal_count, parameter_count;
  bool follows_choice; // a contact stiffness that is chosen changes with E and ν; else it is kept
  bool by_weights;     // derivatives by the weights of the overlap model's network, too
} FemGradientDef;

typedef struct FemGradient {
  double time;        // of the latest state that it was found at [s]
  double unbalanced;  // largest force on an unknown, as a share of the largest on a vertex
  long long switches; // of a path, of vertices between sticking and slipping from step to step
  long long yields;   // the same of points that begin or cease to yield
  double replay_s;    // of a path, processor time of its replay, with segments that are done again [s]
  double *values;     // g, owned                                            (goal_count)
  double *residuals;  // |∂g/∂x − Jᵀ λ| / |∂g/∂x|, owned                      (goal_count)
  double *mismatches; // |J λ + ∂f/∂x λ| / |J λ|, ∂f/∂x λ by differences of forces; NaN of a path; owned
                      // (goal_count)
  size_t weight_count; // of the overlap model's network; 0: not asked for
  double *weights;     // dg/dw, owned                          (goal_count, weight_count)
  double *derivatives; // dg/dp, owned                       (goal_count, parameter_count)
  // Why a parameter of shape has none, which are NaN then; NULL: it has. Owned            (parameter_count)
  char **kinks;
  int parameter_count, kink_count;
} FemGradient;

bool fem_gradient_has_friction(const FemModel *model);
bool fem_gradient_yields(const FemModel *model);        // plasticity remembers
bool fem_gradient_has_following(const FemModel *model); // pressures that turn with their surface
// Whether its derivatives are those of a path (fem/gradient/path/path.h): of a motion, with friction or
// plasticity, and with following pressures.
bool fem_gradient_is_path(const FemModel *model);

// STATUS_INPUT: what cannot be differentiated in this scene; the message says what and why.
Status fem_gradient_check(const FemModel *model, const FemGradientDef *def);
// Adds to a zeroed gradient, or to what earlier states gave, the goals that are due at the system's accepted
// state. The equilibrium there is first found more exactly; the accepted state stays as it is. STATUS_SOLVER:
// K is not positive definite, so the equilibrium is not stable. Destroy the gradient also after a failure.
Status fem_gradient_find(FemGradient *gradient, FemSystem *system, const FemGradientDef *def);
// Room for the results, all 0.
Status fem_gradient_create(FemGradient *gradient, const FemGradientDef *def);
// The status of finding what parameter p changes. A kink by a body's shape (fem_shape_derive) is noted and
// passes while another parameter has no kink, or derivatives by weights are asked for.
Status fem_gradient_pass(FemGradient *gradient, const FemGradientDef *def, int p, Status status);
// Room for those by weights, if they are asked for.
Status fem_gradient_make_weights(FemGradient *gradient, const FemModel *model, const FemGradientDef *def);
void fem_gradient_destroy(FemGradient *gradient); // also of a zeroed one

// Whether an adjoint serves for derivatives to 1e-6 of which the share `residual` is left unsolved.
// STATUS_SOLVER: it does not, or the share is NaN; the message says the time.
Status fem_gradient_judge(double residual, double time);

#endif
