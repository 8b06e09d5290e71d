// SPDX-License-Identifier: GPL-3.0-or-later
// The same model with bodies of another shape: how forces and energies at fixed positions depend on where
// vertices rest. Selections keep their vertices, contact its stiffness.
//
// Elements, masses and loads are smooth in X: a difference of sixth order gives their derivative. The depth
// below a surface (contact/surface/mesh.h) is the least of several distances. Where two of them are equal and
// change differently it has a kink; a difference of second order with a shorter step finds it.
#ifndef TETLAP_FEM_GRADIENT_SHAPE_H
#define TETLAP_FEM_GRADIENT_SHAPE_H

#include "fem/gradient/parameter.h"
#include "fem/gradient/tangent.h"

typedef struct FemShape {
  double *force;  // ∂f/∂p without contact, owned                        (vertex_count, 3)
  double *masses; // ∂m/∂p, owned                                        (vertex_count)
  double *contact; // ∂f/∂p of each interface, owned; NULL: no contact    (interface_count, vertex_count, 3)
  double *energies;       // ∂/∂p of its energy, owned; NULL: no contact         (interface_count)
  double (*stretches)[3]; // ∂q/∂p of the entries of the history that friction leaves
                          // (contact/friction/stick_pull.h), owned; NULL: no friction   (entry_count)
  int entry_count;
  double elastic, gravity; // ∂/∂p of these energies
} FemShape;

// ∂X/∂p of a body's place or of a parameter of its shape (fem_parameter_moves_rest), of others 0, into
// `rests` (vertex_count, 3).
void fem_shape_rest(const FemModel *model, const FemParameter *parameter, double *rests);
// Fills a zeroed one of that body, at the tangent's state. STATUS_INPUT: contact has a kink there. Destroy it
// also after a failure.
Status fem_shape_derive(FemShape *shape, const FemTangent *tangent, int body, const double *rests);
void fem_shape_destroy(FemShape *shape); // also of a zeroed one
// Adds ∂m/∂p of all vertices (vertex_count).
Status fem_shape_add_masses(const FemModel *model, const double *rests, double *masses);

#endif
