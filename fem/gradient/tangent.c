// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/tangent.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/element/quadratic_face.h"

// How far a coordinate may move before the pattern is looked at again, over the distance at which contact
// lays pairs out. Where obstacles move by themselves it is looked at always.
static const double SHARE_OF_REACH = 1.0 / 8;

static Status find_remainder(FemTangent *tangent) {
  const ContactEvaluation *evaluation;
  if (!fem_remainder_is_there(tangent->system->model)) return STATUS_OK;
  TRY(fem_effect_contact_evaluate(tangent->system, tangent->state, &evaluation));
  return fem_remainder_find(&tangent->remainder, tangent->contact, evaluation);
}

Status fem_tangent_create(FemTangent *tangent, FemSystem *system) {
  *tangent = (FemTangent){.system = system};
  size_t count = 3 * (size_t)system->model->vertex_count;
  void *contact = fem_system_effect(system, &fem_effect_contact);
  tangent->stick = fem_system_effect(system, &fem_effect_stick);
  if (contact) {
    tangent->contact = fem_effect_contact_system(contact);
    tangent->interface_count = contact_system_layout(tangent->contact)->interface_count;
    if (system->model->scene->obstacle_count == 0)
      tangent->reach = SHARE_OF_REACH * fem_effect_contact_reach(contact);
  }
  tangent->every_dof = memory_zeroed(count, sizeof *tangent->every_dof);
  tangent->still = memory_zeroed(count, sizeof *tangent->still);
  tangent->coupled = memory_zeroed(count, sizeof *tangent->coupled);
  if (!tangent->every_dof || !tangent->still || !tangent->coupled)
    return status_no_memory("the stiffness of all coordinates");
  for (size_t dof = 0; dof < count; dof++) tangent->every_dof[dof] = (int)dof;
  return STATUS_OK;
}

void fem_tangent_destroy(FemTangent *tangent) {
  fem_matrix_destroy(&tangent->stiffness);
  fem_remainder_destroy(&tangent->remainder);
  memory_free(tangent->every_dof);
  memory_free(tangent->still);
  memory_free(tangent->coupled);
  *tangent = (FemTangent){0};
}

// Whether no pair can have come near that the pattern lacks. Two boxes approach along three axes by less than
// four times the way of a coordinate; twice that, as nodes of curved edges outrun the vertices.
static bool is_coupled(const FemTangent *tangent) {
  const FemModel *model = tangent->system->model;
  if (tangent->layout == 0 || tangent->layout != tangent->system->pattern_version) return false;
  for (int i = 0; i < 3 * model->vertex_count; i++)
    if (!(fabs(tangent->state->positions[i] - tangent->coupled[i]) < tangent->reach)) return false;
  return true;
}

static Status lay_out(FemTangent *tangent) {
  FemSystem *system = tangent->system;
  if (is_coupled(tangent)) return STATUS_OK;
  TRY(fem_system_couple(system, tangent->state));
  memcpy(tangent->coupled, tangent->state->positions,
         3 * (size_t)system->model->vertex_count * sizeof *tangent->coupled);
  if (tangent->layout == system->pattern_version) return STATUS_OK;
  fem_matrix_destroy(&tangent->stiffness);
  TRY(fem_matrix_create(&tangent->stiffness, system->pattern, tangent->every_dof));
  tangent->layout = system->pattern_version;
  return STATUS_OK;
}

// At rest damping has no stiffness.
Status fem_tangent_find(FemTangent *tangent, const FemState *state) {
  FemState still = *state;
  tangent->state = state;
  still.velocities = tangent->still;
  TRY(lay_out(tangent));
  TRY(fem_system_assemble_without(tangent->system, &fem_effect_stick, &still, 1, 0, 0, &tangent->stiffness));
  return find_remainder(tangent);
}

// A matrix that is never formed: y += share S x.
typedef struct Product {
  const double *x;
  double *y, share;
  bool back; // y += share Sᵀ x
} Product;

static void add_dense(void *self, int count, const int *vertices, const double *matrix) {
  const Product *product = self;
  int width = 3 * count;
  for (int r = 0; r < width; r++) {
    double sum = 0;
    for (int c = 0; c < width; c++)
      sum += matrix[product->back ? c * width + r : r * width + c] *
             product->x[3 * (size_t)vertices[c / 3] + (size_t)(c % 3)];
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

// ---- Following pressures. Their stiffness in the matrix is the symmetric part; what it leaves out is there
// at a rim that moves. Forces on a face are quadratic in its nodes' positions, so that differences are exact.

enum { MOST_NODES = FEM_QUADRATIC_FACE_NODES };

// A face, three nodes or six, under its pressure.
typedef struct Face {
  int count;
  const int *nodes;
  double pressure, x[3 * MOST_NODES];
} Face;

static Face face_at(const FemTangent *tangent, int count, const int *nodes, double pressure) {
  Face face = {count, nodes, pressure, {0}};
  for (int i = 0; i < 3 * count; i++)
    face.x[i] = tangent->state->positions[3 * (size_t)nodes[i / 3] + (size_t)(i % 3)];
  return face;
}

// Adds share · f where the nodes are x.
static void add_pressure(const Face *face, const double *x, double share, double force[3 * MOST_NODES]) {
  double area[3 * MOST_NODES] = {0};
  if (face->count == MOST_NODES) fem_quadratic_face_area(x, area);
  Vec3 a = vec3_at(x), whole = vec3_cross(vec3_sub(vec3_at(x + 3), a), vec3_sub(vec3_at(x + 6), a));
  for (int k = 0; k < 3 && face->count == 3; k++) vec3_store(area + 3 * k, vec3_scale(1.0 / 6, whole));
  for (int i = 0; i < 3 * face->count; i++) force[i] -= share * face->pressure * area[i];
}

// ∂f/∂x along a way.
static void derive(const Face *face, const double *way, double force[3 * MOST_NODES]) {
  double x[3 * MOST_NODES];
  memset(force, 0, 3 * MOST_NODES * sizeof *force);
  for (int side = 1; side >= -1; side -= 2) {
    for (int i = 0; i < 3 * face->count; i++) x[i] = face->x[i] + side * way[i];
    add_pressure(face, x, 0.5 * side, force);
  }
}

// Adds −½ ((∂f/∂x)ᵀ − ∂f/∂x) λ of a face. Ways are as long as the face.
static void turn_face(const FemTangent *tangent, const Face *face, const double *lambda, double *y) {
  double length = tangent->system->model->edge, largest = 0;
  double own[3 * MOST_NODES], along[3 * MOST_NODES], force[3 * MOST_NODES];
  for (int i = 0; i < 3 * face->count; i++) {
    own[i] = lambda[3 * (size_t)face->nodes[i / 3] + (size_t)(i % 3)];
    largest = fmax(largest, fabs(own[i]));
  }
  if (!(largest > 0)) return;
  for (int i = 0; i < 3 * face->count; i++) along[i] = own[i] * length / largest;
  derive(face, along, force);
  for (int i = 0; i < 3 * face->count; i++) along[i] = force[i] * largest / length;
  for (int j = 0; j < 3 * face->count; j++) {
    double way[3 * MOST_NODES] = {0}, across = 0;
    way[j] = length;
    derive(face, way, force);
    for (int i = 0; i < 3 * face->count; i++) across += own[i] * force[i] / length;
    y[3 * (size_t)face->nodes[j / 3] + (size_t)(j % 3)] -= 0.5 * (across - along[j]);
  }
}

static Status turn_pressures(const FemTangent *tangent, const double *lambda, double *y) {
  const FemModel *model = tangent->system->model;
  for (int l = 0; l < model->load_count; l++) {
    const FemLoad *load = &model->loads[l];
    double factor;
    if (load->triangle_count + load->face_count == 0) continue;
    TRY(fem_load_factor(load->def, tangent->state->time, &factor));
    for (int i = 0; i < load->triangle_count + load->face_count; i++) {
      int k = i - load->triangle_count;
      Face face = k < 0 ? face_at(tangent, 3, load->triangles[i], factor * load->def->pressure)
                        : face_at(tangent, MOST_NODES, load->faces[k], factor * load->def->pressure);
      turn_face(tangent, &face, lambda, y);
    }
  }
  return STATUS_OK;
}

Status fem_tangent_pull(const FemTangent *tangent, const double *x, double *y) {
  fem_matrix_multiply(&tangent->stiffness, x, y);
  TRY(turn_pressures(tangent, x, y));
  fem_remainder_add_product(&tangent->remainder, true, x, y);
  return STATUS_OK;
}

void fem_tangent_add_remainder(const FemTangent *tangent, const double *x, double *y) {
  fem_remainder_add_product(&tangent->remainder, false, x, y);
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

Status fem_tangent_add_contact_product(const FemTangent *tangent, int interface, bool back, const double *x,
                                       double *y) {
  const ContactEvaluation *evaluation;
  TRY(evaluate(tangent, &evaluation));
  Product product = {x, y, 1, back};
  const ContactStiffnessSink sink = {&product, add_outer, add_dense};
  return contact_system_turn(tangent->contact, evaluation, interface, &sink);
}

Status fem_tangent_begin_answers(const FemTangent *tangent, FemAnswers *answers) {
  const ContactEvaluation *evaluation;
  TRY(evaluate(tangent, &evaluation));
  return fem_answers_begin(answers, evaluation);
}

Status fem_tangent_pull_contact(const FemTangent *tangent, int interface, const double *forces,
                                double weight) {
  const ContactEvaluation *evaluation;
  if (!tangent->answers) return STATUS_OK;
  TRY(evaluate(tangent, &evaluation));
  return contact_system_pull(tangent->contact, evaluation, interface, forces, weight, tangent->answers->by);
}

Status fem_tangent_train(const FemTangent *tangent, double *slope) {
  const ContactEvaluation *evaluation;
  TRY(evaluate(tangent, &evaluation));
  return fem_answers_train(tangent->answers, tangent->contact, evaluation, slope);
}
