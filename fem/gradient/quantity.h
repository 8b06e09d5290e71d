// SPDX-License-Identifier: GPL-3.0-or-later
// Quantities of an equilibrium that have derivatives, and sums and misfits of them.
#ifndef TETLAP_FEM_GRADIENT_QUANTITY_H
#define TETLAP_FEM_GRADIENT_QUANTITY_H

#include "fem/gradient/change.h"

typedef enum FemQuantityKind {
  FEM_QUANTITY_DISPLACEMENT, // mean over all vertices of a body [m]
  FEM_QUANTITY_PROBE,        // the same of a probe [m]
  FEM_QUANTITY_POSITION,     // of a vertex of a body [m]
  FEM_QUANTITY_FORCE,        // of contact on a body or an obstacle, by another or by all [N]
  FEM_QUANTITY_PATCH,        // the same on the vertices of a probe [N]
  FEM_QUANTITY_PRESSURE,     // on them, by fem/gradient/contact/pressure.h [Pa]
  FEM_QUANTITY_MOMENT,       // of those forces about the origin [N m]
  FEM_QUANTITY_REACTION,     // of what holds or drives a body, as in history.csv [N]
  FEM_QUANTITY_ENERGY,       // [J]
} FemQuantityKind;

enum { FEM_QUANTITY_ELASTIC = 1, FEM_QUANTITY_CONTACT = 2, FEM_QUANTITY_GRAVITY = 4 };

typedef struct FemQuantity {
  FemQuantityKind kind;
  int body;      // of displacement and position the body; of force and moment the party (FemCompliance); of a
                 // probe, a patch and a pressure the number of the probe
  int other;     // the party that presses; −1: all
  int vertex;    // of a position, in the body's mesh
  int component; // x, y, z
  int power;     // m of a pressure
  int energies;  // those that are summed
  const FemConstraintDef *held; // of a reaction, borrowed from the scene
} FemQuantity;

typedef struct FemTerm {
  FemQuantity quantity;
  double weight, data;
  double time; // when q is taken [s]; that of the run's end, or later: there
} FemTerm;

// g = Σ weight q, or as a misfit g = ½ Σ weight (q − data)².
typedef struct FemGoal {
  FemTerm *terms; // owned by the caller                                  (term_count)
  int term_count;
  bool is_misfit;
} FemGoal;

// STATUS_INPUT: nothing of the kind is in the model.
Status fem_quantity_check(const FemModel *model, const FemQuantity *quantity);
const char *fem_quantity_unit(const FemQuantity *quantity);

// Whether it is taken at that time, but for rounding; of a goal, one of its terms.
bool fem_term_is_due(const FemTerm *term, const FemModel *model, double time);
bool fem_goal_is_due(const FemGoal *goal, const FemModel *model, double time);
// Adds the terms that are due at the state's time to g, and ∂g/∂x by all positions, prescribed ones included,
// to `slope` (vertex_count, 3). `factors` gets ∂g/∂q of these terms (term_count). Derivatives through
// friction, damping and overlaps are added to the tangent's `friction`, `damping` and `answers`. The energy
// of contact is without that of friction's springs.
Status fem_goal_evaluate(const FemGoal *goal, const FemTangent *tangent, double *value, double *slope,
                         double *factors);
// ∂g/∂p of the terms that are due, at fixed positions, with `factors` as found above.
Status fem_goal_change(const FemGoal *goal, const FemTangent *tangent, const double *factors,
                       FemChange *change, double *derivative);

#endif
