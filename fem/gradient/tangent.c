// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/tangent.h"

#include "base/memory.h"
#include "fem/effect/contact/contact.h"

// As if nothing moved, where damping has no stiffness.
static Status assemble(FemTangent *tangent, size_t count) {
  FemState still = *tangent->state;
  still.velocities = memory_zeroed(count, sizeof *still.velocities);
  if (!still.velocities) return status_no_memory("the stiffness of all coordinates");
  Status status = fem_system_assemble(tangent->system, &still, 1, 0, 0, &tangent->stiffness);
  memory_free(still.velocities);
  return status;
}

Status fem_tangent_create(FemTangent *tangent, FemSystem *system, const FemState *state) {
  *tangent = (FemTangent){.system = system, .state = state};
  int count = 3 * system->model->vertex_count;
  void *contact = fem_system_effect(system, &fem_effect_contact);
  tangent->stick = fem_system_effect(system, &fem_effect_stick);
  if (contact) {
    tangent->contact = fem_effect_contact_system(contact);
    tangent->interface_count = contact_system_layout(tangent->contact)->interface_count;
  }
  tangent->every_dof = memory_zeroed((size_t)count, sizeof *tangent->every_dof);
  if (!tangent->every_dof) return status_no_memory("the stiffness of all coordinates");
  for (int dof = 0; dof < count; dof++) tangent->every_dof[dof] = dof;
  TRY(fem_matrix_create(&tangent->stiffness, system->pattern, tangent->every_dof));
  return assemble(tangent, (size_t)count);
}

void fem_tangent_destroy(FemTangent *tangent) {
  fem_matrix_destroy(&tangent->stiffness);
  memory_free(tangent->every_dof);
  *tangent = (FemTangent){0};
}

// A matrix that is never formed: y += share S x.
typedef struct Product {
  const double *x;
  double *y, share;
} Product;

static void add_dense(void *self, int count, const int *vertices, const double *matrix) {
  const Product *product = self;
  int width = 3 * count;
  for (int r = 0; r < width; r++) {
    double sum = 0;
    for (int c = 0; c < width; c++)
      sum += matrix[r * width + c] * product->x[3 * (size_t)vertices[c / 3] + (size_t)(c % 3)];
    product->y[3 * (size_t)vertices[r / 3] + (size_t)(r % 3)] += product->share * sum;
  }
}

static void add_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  const Product *product = self;
  double sum = 0;
  for (int c = 0; c < 3 * count; c++) sum += w[c] * product->x[3 * (size_t)vertices[c / 3] + (size_t)(c % 3)];
  for (int r = 0; r < 3 * count; r++)
    product->y[3 * (size_t)vertices[r / 3] + (size_t)(r % 3)] += product->share * scale * sum * w[r];
}

Status fem_tangent_multiply(const FemTangent *tangent, const double *x, double *y) {
  fem_matrix_multiply(&tangent->stiffness, x, y);
  if (!tangent->stick) return STATUS_OK;
  Product product = {x, y, -1};
  return fem_effect_stick_add_stiffness(tangent->stick, tangent->state,
                                        &(ContactStiffnessSink){&product, add_outer, add_dense});
}

const ContactInterfaceDef *fem_tangent_interface(const FemTangent *tangent, int interface) {
  return &contact_system_layout(tangent->contact)->interfaces[interface];
}

static Status evaluate(const FemTangent *tangent, const ContactEvaluation **evaluation) {
  return fem_effect_contact_evaluate(tangent->system, tangent->state, evaluation);
}

Status fem_tangent_add_contact(const FemTangent *tangent, int interface, double *force) {
  const ContactEvaluation *evaluation;
  TRY(evaluate(tangent, &evaluation));
  contact_system_add_force_of(tangent->contact, evaluation, interface, force);
  return STATUS_OK;
}

Status fem_tangent_contact_energy(const FemTangent *tangent, int interface, double *energy) {
  const ContactEvaluation *evaluation;
  TRY(evaluate(tangent, &evaluation));
  *energy = contact_system_energy_of(evaluation, interface);
  return STATUS_OK;
}

Status fem_tangent_add_contact_product(const FemTangent *tangent, int interface, const double *x, double *y) {
  const ContactEvaluation *evaluation;
  TRY(evaluate(tangent, &evaluation));
  Product product = {x, y, 1};
  const ContactStiffnessSink sink = {&product, add_outer, add_dense};
  return contact_system_stiffness_of(tangent->contact, evaluation, interface, &sink);
}
