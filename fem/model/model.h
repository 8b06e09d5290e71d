// SPDX-License-Identifier: GPL-3.0-or-later
// What stays constant in a run: all bodies' meshes one after another, masses, elements, materials,
// and constraints. fem/model/build.h makes it. Which coordinates are unknowns changes in a run:
// fem/effect/numbering.h.
#ifndef TETLAP_FEM_MODEL_MODEL_H
#define TETLAP_FEM_MODEL_MODEL_H

#include "contact/def.h"
#include "fem/element/element.h"
#include "fem/element/quadratic.h"
#include "fem/model/start.h"
#include "fem/scene/load.h"
#include "fem/scene/probe/line.h"
#include "fem/scene/probe/probe.h"
#include "fem/scene/scene.h"
#include "fem/sparse/share.h"

typedef struct FemModelBody {
  const char *name; // borrowed from the scene
  int vertex_begin, vertex_end;
  int tet_begin, tet_end;
  int part_begin, part_end; // obstacles: none
  int quadratic_begin, quadratic_end;
  FemElementKind element;
  double mass; // [kg]
  double cube; // vertices of the cube whose factor costs as much a vertex (fem/model/work.h)
  bool is_obstacle;
} FemModelBody;

// What of a body is made of one material: all of it, unless its scene says otherwise.
typedef struct FemModelPart {
  int body;
  int item; // of the body's materials in the scene; −1: its `material`
  FemMaterial material;
  FemMaterial local; // what an element resists with by itself; the rest of λ is the vertices'
                     // (the effect volume) or the mean's of a quadratic one (fem/element/quadratic.h)
  double bulk;       // that rest, of quadratic ones; else 0 [Pa]
  double damping;    // β [s]
  double mass;       // [kg]
  double skin;       // of the body's surface that may touch, at rest [m²]
} FemModelPart;

// Coordinates whose motion is prescribed by one constraint, until it is released.
typedef struct FemModelDriver {
  const FemConstraintDef *def; // borrowed from the scene
  bool is_fixed;               // no motion at all
  int *dofs;                   // 3·vertex + component   (dof_count)
  int dof_count;
} FemModelDriver;

typedef struct FemModel {
  const FemSceneDef *scene;                // borrowed
  int vertex_count, tet_count, body_count; // obstacles included, after the bodies
  double *rest;                            // [m]                                       (vertex_count, 3)
  int (*tets)[4];                          //                                           (tet_count)
  int *tet_body;                           //                                           (tet_count)
  int *tet_part;                           // −1: of an obstacle                        (tet_count)
  double *volumes;                         // at rest [m³]                              (tet_count)
  int quadratic_count;                     // a body's tets are the eighths of its quadratic ones
  FemQuadratic *quadratics;                //                                           (quadratic_count)
  int (*quadratic_nodes)[10];              //                                           (quadratic_count)
  int *quadratic_part;                     //                                           (quadratic_count)
  FemModelBody *bodies;                    //                                           (body_count)
  FemModelPart *parts;                     // by bodies                                 (part_count)
  int part_count;
  double *mass;             // lumped, obstacles 0 [kg]                  (vertex_count)
  unsigned char *inner;     // bit k: on the k-th part of the boundary that is no surface (vertex_count)
  double *initial_velocity; // [m/s]                                     (vertex_count, 3)
  FemStart *start;          // owned; NULL: the bodies start at rest, as placed
  int free_count;           // of coordinates that nothing prescribes
  bool *is_prescribed;      // by a driver                               (3·vertex_count)
  FemModelDriver *drivers;  //                                           (driver_count)
  int driver_count;
  FemLoad *loads; //                                                                    (load_count)
  int load_count;
  FemProbe *probes; //                                                                  (probe_count)
  int probe_count;
  FemLine *lines; //                                                                    (line_count)
  int line_count;
  FemShare *share; // which vertices this rank has; NULL: there is one process
  double length;   // the smallest body's bounding box diagonal [m]
  double edge;     // the smallest mean edge of a body [m]
} FemModel;

// Whether the driver has been released at a time.
static inline bool fem_model_is_released(const FemModelDriver *driver, double time) {
  return driver->def->release > 0 && driver->def->release <= time;
}

// Whether contact cannot deform the body: every coordinate of it is prescribed and never released.
bool fem_model_is_rigid(const FemModel *model, int body);

// Whether the driver moves anything, where those up to that time have been released.
static inline bool fem_model_is_moved(const FemModelDriver *driver, double released) {
  return !driver->is_fixed && !fem_model_is_released(driver, released);
}

// Of an element; of an obstacle the first law.
static inline FemMaterialLaw fem_model_law(const FemModel *model, int tet) {
  int part = model->tet_part[tet];
  return part < 0 ? (FemMaterialLaw)0 : model->parts[part].material.law;
}

// For messages: the name of the body that a vertex is of, "?" if it has none; borrowed.
const char *fem_model_body_name(const FemModel *model, int vertex);

// κ as the scene says, or as chosen for the potential `nodal`: the softest body's Young's modulus E.
double fem_model_contact_stiffness(const FemModel *model);

// √(E/ρ), the speed of a stretched bar's waves [m/s].
double fem_model_wave(const FemMaterial *material);

// Slowest and fastest √(E/ρ) of the scene's bodies [m/s].
double fem_model_slowest_wave(const FemModel *model);
double fem_model_fastest_wave(const FemModel *model);

// E V ε², the energy of a strain in all bodies, twice if it were uniaxial [J].
double fem_model_strain_energy(const FemModel *model, double strain);

// The largest λ/μ that the body's elements resist with by themselves (`local`); infinite: any.
double fem_model_largest_ratio(const FemModelBody *body);

// Every body's law is linear, without fibres.
bool fem_model_has_linear_materials(const FemModel *model);

// What is constant in a tetrahedron, from its corners at rest: cheaper to find than to keep.
FemElement fem_model_element(const FemModel *model, int tet);
// det F of a tetrahedron; of a part of a quadratic one the smaller of its own and that at the point near its
// corner.
double fem_model_det(const FemModel *model, int tet, const double *positions);
// Cauchy stress [Pa] of a tetrahedron of a body by its law alone.
void fem_model_stress(const FemModel *model, int tet, const double *positions, double stress[6]);

// The memory that a run of this model will take, roughly, without its linear solver [bytes].
double fem_model_memory_estimate(const FemModel *model);

#endif
