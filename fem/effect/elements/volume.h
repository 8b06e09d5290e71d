// SPDX-License-Identifier: GPL-3.0-or-later
// Nodal volume change: linear tetrahedra that do not lock as ν → ½. Every law has a term λ/2 θ² in its
// measure of volume change θ (fem/material/material.h). Of λ an element keeps λ_e = min(λ, μ) for itself; the
// rest resists the mean over the elements around a vertex, of which there are a fifth as many:
//
//   U = Σ_e V_e Ψ(F_e; λ_e) + Σ_a V_a ½ (λ − λ_e) θ_a²
//
//   θ_a = Σ_{e∋a} ¼ V_e θ_e / V_a,   V_a = Σ_{e∋a} ¼ V_e
//
// It is the average nodal pressure tetrahedron (Bonet and Burton 1998, Comm. Num. Meth. Eng. 14), stabilised
// by what the elements keep (as Puso and Solberg 2006 do), for any law. Its vertices are those of the mesh,
// so contact, loads and constraints are as for linear tetrahedra. The cost: a vertex couples with its
// neighbours' neighbours. Where materials meet, θ may jump: a vertex there is one for each, with the elements
// of that material around it.
#ifndef TETLAP_FEM_EFFECT_ELEMENTS_VOLUME_H
#define TETLAP_FEM_EFFECT_ELEMENTS_VOLUME_H

#include "fem/model/model.h"
#include "fem/sparse/matrix.h"

typedef struct FemVolume {
  const FemModel *model; // borrowed
  int *tets;             // of nodal bodies                                      (tet_count)
  int tet_count;
  FemElement *elements;          // what is constant in those                           (tet_count)
  int *index;                    // of a tetrahedron of the model in `tets`             (model->tet_count)
  int *parts;                    // of the model, by those vertices                     (vertex_count)
  int vertex_count;              // of nodal bodies, once for each material
  int (*corners)[4];             // of each tetrahedron among those vertices            (tet_count)
  int *tet_begin, *tet_list;     // positions in `tets` around each vertex       (vertex_count + 1)
  int *patch_begin, *patch_list; // the model's vertices of those                (vertex_count + 1)
  double *vertex_volume;         // V_a [m³]                                     (vertex_count)
  double *tet_theta;             // θ_e                                          (tet_count)
  double *vertex_theta;          // θ_a                                          (vertex_count)
  double *tet_gradient;          // V_e/4 ∂θ_e/∂x                                (tet_count, 12)
  double *row;                   // ∂θ_a/∂x over one patch                       (largest patch, 3)
  int *place;                    // of a vertex in the patch at hand             (model->vertex_count)
} FemVolume;

Status fem_volume_create(FemVolume *volume, const FemModel *model);
void fem_volume_destroy(FemVolume *volume);       // also of a zeroed one
size_t fem_volume_bytes(const FemVolume *volume); // on the heap

Status fem_volume_couple(const FemVolume *volume, FemPattern *pattern, int *has_grown);
// θ_e, θ_a and gradients at these positions (model->vertex_count, 3); what follows uses them.
void fem_volume_evaluate(FemVolume *volume, const double *positions);
double fem_volume_energy(const FemVolume *volume); // [J]
void fem_volume_add_force(const FemVolume *volume, double *force);
void fem_volume_add_stiffness(FemVolume *volume, const double *positions, double scale, FemMatrix *matrix);

// (λ − λ_e) times the mean of θ_a over the vertices of a tetrahedron of a body: what pushes in it [Pa].
double fem_volume_pressure(const FemVolume *volume, int tet);

#endif
