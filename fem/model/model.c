// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/model.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/lanes/lanes.h"
#include "fem/material/cofactor.h"

const char *fem_model_body_name(const FemModel *model, int vertex) {
  for (int b = 0; b < model->body_count; b++)
    if (vertex < model->bodies[b].vertex_end) return model->bodies[b].name ? model->bodies[b].name : "?";
  return "?";
}

double fem_model_contact_stiffness(const FemModel *model) {
  const FemContactDef *contact = &model->scene->contact;
  if (contact->stiffness > 0) return contact->stiffness;
  double softest = INFINITY;
  for (int p = 0; p < model->part_count; p++) softest = fmin(softest, model->parts[p].material.young);
  return softest;
}

double fem_model_largest_ratio(const FemModelBody *body) {
  if (body->element == FEM_ELEMENT_NODAL) return FEM_MATERIAL_LARGEST_LOCAL_RATIO;
  return body->element == FEM_ELEMENT_QUADRATIC ? FEM_QUADRATIC_LARGEST_RATIO : INFINITY;
}

bool fem_model_has_linear_materials(const FemModel *model) {
  for (int p = 0; p < model->part_count; p++)
    if (!fem_material_is_linear(&model->parts[p].material)) return false;
  return true;
}

double fem_model_wave(const FemMaterial *material) {
  return sqrt(material->young / material->density);
}

double fem_model_slowest_wave(const FemModel *model) {
  double slowest = INFINITY;
  for (int p = 0; p < model->part_count; p++)
    slowest = fmin(slowest, fem_model_wave(&model->parts[p].material));
  return slowest;
}

double fem_model_fastest_wave(const FemModel *model) {
  double fastest = 0;
  for (int p = 0; p < model->part_count; p++)
    fastest = fmax(fastest, fem_model_wave(&model->parts[p].material));
  return fastest;
}

double fem_model_strain_energy(const FemModel *model, double strain) {
  double energy = 0;
  for (int p = 0; p < model->part_count; p++) {
    const FemModelPart *part = &model->parts[p];
    energy += strain * strain * part->material.young * part->mass / part->material.density;
  }
  return energy;
}

static const FemModelBody *body_of(const FemModel *model, int tet) {
  return &model->bodies[model->tet_body[tet]];
}

static void gather(const int *nodes, int count, const double *positions, double *x) {
  for (int k = 0; k < count; k++) memcpy(x + 3 * k, positions + 3 * (size_t)nodes[k], 3 * sizeof *x);
}

// The quadratic tetrahedron of which `tet` is a part.
static int quadratic_of(const FemModel *model, int tet) {
  const FemModelBody *body = body_of(model, tet);
  return body->quadratic_begin + (tet - body->tet_begin) / FEM_QUADRATIC_PARTS;
}

FemElement fem_model_element(const FemModel *model, int tet) {
  double rest[12];
  FemElement element;
  gather(model->tets[tet], 4, model->rest, rest);
  fem_element_create(&element, rest);
  return element;
}

double fem_model_det(const FemModel *model, int tet, const double *positions) {
  const FemModelBody *body = body_of(model, tet);
  int part = (tet - body->tet_begin) % FEM_QUADRATIC_PARTS;
  double x[30];
  const int *nodes = model->tets[tet];
  double own =
      vec3_det4(vec3_at(positions + 3 * (size_t)nodes[0]), vec3_at(positions + 3 * (size_t)nodes[1]),
                vec3_at(positions + 3 * (size_t)nodes[2]), vec3_at(positions + 3 * (size_t)nodes[3])) /
      (6 * model->volumes[tet]);
  if (body->element != FEM_ELEMENT_QUADRATIC || part >= FEM_QUADRATIC_POINTS) return own;
  int quadratic = quadratic_of(model, tet);
  gather(model->quadratic_nodes[quadratic], FEM_QUADRATIC_NODES, positions, x);
  double at_point = fem_quadratic_det(&model->quadratics[quadratic], part, x);
  return at_point < own ? at_point : own;
}

void fem_model_stress(const FemModel *model, int tet, const double *positions, double stress[6]) {
  const FemModelBody *body = body_of(model, tet);
  const FemModelPart *part = &model->parts[model->tet_part[tet]];
  double x[30];
  if (body->element != FEM_ELEMENT_QUADRATIC) {
    gather(model->tets[tet], 4, positions, x);
    const FemElement element = fem_model_element(model, tet);
    fem_element_cauchy(&element, &part->local, x, stress);
    return;
  }
  int quadratic = quadratic_of(model, tet);
  FemQuadraticLaw law = {&part->local, part->bulk};
  gather(model->quadratic_nodes[quadratic], FEM_QUADRATIC_NODES, positions, x);
  fem_quadratic_cauchy(&model->quadratics[quadratic], law, x, (tet - body->tet_begin) % FEM_QUADRATIC_PARTS,
                       stress);
}

bool fem_model_is_rigid(const FemModel *model, int body) {
  const int begin = 3 * model->bodies[body].vertex_begin, end = 3 * model->bodies[body].vertex_end;
  for (int dof = begin; dof < end; dof++)
    if (!model->is_prescribed[dof]) return false;
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    bool is_theirs = driver->dof_count > 0 && driver->dofs[0] >= begin && driver->dofs[0] < end;
    if (is_theirs && driver->def->release > 0) return false;
  }
  return true;
}

// The memory of contact is proportional to the surfaces: six faces of a cube of n vertices have 6 n^(2/3).
// Measured on cubes that touch with one face.
static double contact_bytes(const FemModel *model) {
  double surface = 0;
  for (int b = 0; b < model->body_count; b++)
    surface += pow(model->bodies[b].vertex_end - model->bodies[b].vertex_begin, 2.0 / 3.0);
  return model->scene->contact.is_on ? 1.2e5 * surface : 0;
}

// The constants are of the resident set, measured with `pcg`, which keeps nothing.
double fem_model_memory_estimate(const FemModel *model) {
  double vertices = model->vertex_count, tets = model->tet_count, unknowns = model->free_count;
  double arrays = vertices * 30 * sizeof(double) + tets * 400;
  arrays += model->quadratic_count * (double)(sizeof(FemQuadratic) + sizeof(FemLanesQuadratics) / FEM_LANES +
                                              FEM_LANES_HALF * sizeof(int));
  double matrix = unknowns * 23 * (sizeof(double) + sizeof(int));
  return 2e7 + arrays + matrix + contact_bytes(model);
}
