// SPDX-License-Identifier: GPL-3.0-or-later
// What a parameter changes while free coordinates stay where they are: forces, prescribed coordinates, the
// contact between two, an obstacle's place, energies. Each is a derivative by the parameter.
//
// An obstacle that moves by v(x) = shift + spin × x changes the contact of one interface as bodies that moved
// the other way would, but for the turn of its forces: ∂f/∂p = spin × f + K v, K that interface's stiffness.
#ifndef TETLAP_FEM_GRADIENT_CHANGE_H
#define TETLAP_FEM_GRADIENT_CHANGE_H

#include "fem/gradient/parameter.h"
#include "fem/gradient/shape.h"
#include "fem/gradient/tangent.h"
#include "fem/gradient/varied.h"

typedef struct FemChange {
  double *force;             // ∂f/∂p on all vertices, contact included               (vertex_count, 3)
  double *motion;            // ∂x_c/∂p of prescribed coordinates, else 0             (vertex_count, 3)
  double *speed;             // ∂v_c/∂p of their velocities, else 0                   (vertex_count, 3)
  double *rates;             // ∂ ln κ/∂p of each interface                           (interface_count)
  double *slips;             // ∂μ/∂p of each interface                               (interface_count)
  FemVariedLaw law;          // contact by the derivative of a pressure law; zeroed: by none
  double *masses;            // ∂m/∂p                                                 (vertex_count)
  int party;                 // the obstacle that moves; −1: none
  double shift[3], spin[3];  // by v(x) = shift + spin × x
  double *rests;             // ∂X/∂p of rest positions                               (vertex_count, 3)
  FemShape shape;            // what follows from that where it is no shift of a body; zeroed: nothing
  bool wants_elastic;        // set by the caller: whether `elastic` is found; true at first
  double elastic, gravity;   // ∂/∂p of these energies
  double *product, *contact; // scratch                                    (vertex_count, 3)
} FemChange;

Status fem_change_create(FemChange *change, const FemTangent *tangent);
void fem_change_destroy(FemChange *change); // also of a zeroed one

// By a parameter that was checked, at the state of the tangent. `follows`: a contact stiffness that is chosen
// from E and ν changes with them; else it stays.
Status fem_change_find(FemChange *change, FemVaried *varied, const FemTangent *tangent,
                       const FemParameter *parameter, bool follows);

// The party of the scene's obstacle of that number (FemCompliance: bodies, obstacles with a mesh among them,
// then shapes).
int fem_change_party(const FemModel *model, int obstacle);
// v(x) on the vertices of the body that meets the obstacle, elsewhere 0 (vertex_count, 3).
void fem_change_field(const FemChange *change, const FemTangent *tangent, int interface, double *field);
// Whether the obstacle that moves is a side of the interface.
bool fem_change_moves(const FemChange *change, const FemTangent *tangent, int interface);
// Adds ∂f/∂p of the contact forces of an interface (vertex_count, 3).
Status fem_change_add_contact(FemChange *change, const FemTangent *tangent, int interface, double *force);

#endif
