// SPDX-License-Identifier: GPL-3.0-or-later
// Energies, forces and matrices of one element, linear and quadratic, by the formulas of fem/element and
// fem/material: what vector lanes are compared with.
#ifndef TETLAP_TESTS_REFERENCE_ELEMENT_H
#define TETLAP_TESTS_REFERENCE_ELEMENT_H

#include "fem/element/element.h"
#include "fem/element/quadratic.h"

double reference_element_energy(const FemElement *element, const FemMaterial *material,
                                const double x[12]); // U [J]
void reference_element_force(const FemElement *element, const FemMaterial *material, const double x[12],
                             double force[12]); // −∂U/∂x [N]
void reference_element_stiffness(const FemElement *element, const FemMaterial *material, const double x[12],
                                 double stiffness[144]); // ∂²U/∂x² [N/m]

// Stiffness-proportional damping and viscosity (fem/lanes/viscous.inc): R = ½ β V Ė:C:Ė; at rest the matrix
// is β K. Force −∂R/∂v, matrix ∂²R/∂v² (≥ 0).
void reference_element_damping_force(const FemElement *element, const FemMaterial *material, double beta,
                                     const double x[12], const double v[12], double force[12]); // [N]
void reference_element_damping_matrix(const FemElement *element, const FemMaterial *material, double beta,
                                      const double x[12], double matrix[144]); // [N s/m]
// The geometric part of −∂(damping force)/∂x (fem/lanes/viscous.inc). May be indefinite.
void reference_element_damping_stiffness(const FemElement *element, const FemMaterial *material, double beta,
                                         const double x[12], const double v[12], double matrix[144]); // [N/m]

// A straight quadratic one. `corners` (4, 3) at rest, positively oriented and of positive volume.
void reference_quadratic_create(FemQuadratic *element, const double corners[12]);
double reference_quadratic_energy(const FemQuadratic *element, FemQuadraticLaw law,
                                  const double x[30]); // U [J]
void reference_quadratic_force(const FemQuadratic *element, FemQuadraticLaw law, const double x[30],
                               double force[30]); // −∂U/∂x [N]
void reference_quadratic_stiffness(const FemQuadratic *element, FemQuadraticLaw law, const double x[30],
                                   double stiffness[900]); // ∂²U/∂x² [N/m]

void reference_quadratic_damping_force(const FemQuadratic *element, const FemMaterial *material, double beta,
                                       const double x[30], const double v[30], double force[30]);
// damping_scale ∂²R/∂v² + stiffness_scale · the symmetric part of −∂(damping force)/∂x.
void reference_quadratic_damping_matrix(const FemQuadratic *element, const FemMaterial *material, double beta,
                                        const double x[30], const double v[30], double stiffness_scale,
                                        double damping_scale, double matrix[900]);

#endif
