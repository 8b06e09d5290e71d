// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's matrix of contact, ∂²U/∂x², and which vertices it couples. A tetrahedron that contact has cut
// meets another with several cells, and the cells of one element move with the same nodes. The pairs'
// matrices are summed over the cells of two elements before they are handed on.
#ifndef TETLAP_CONTACT_STIFFNESS_H
#define TETLAP_CONTACT_STIFFNESS_H

#include "contact/evaluation.h"

// Where the stiffness ∂²U/∂x² goes. Each call adds a dense symmetric part over a short list of distinct
// vertices; those of obstacles carry no unknowns and are left out.
typedef struct ContactStiffnessSink {
  void *self;
  // S += scale · w wᵀ, w (count, 3).
  void (*add_outer)(void *self, int count, const int *vertices, const double *w, double scale);
  // S += matrix, (3 count, 3 count), symmetric unless told otherwise.
  void (*add_dense)(void *self, int count, const int *vertices, const double *matrix);
} ContactStiffnessSink;

// A pair's place in the order in which elements stand together.
typedef struct ContactStiffnessKey {
  int interface;
  int elements[2]; // [1] −1: a shape
  int pair;
} ContactStiffnessKey;

// Which elements have been coupled with which: their cliques need not be visited again.
typedef struct ContactCoupled {
  ContactStiffnessKey *keys; // one of each two, ascending by their elements          (count)
  int count;
  size_t capacity;
} ContactCoupled;

// Scratch memory.
typedef struct ContactStiffness {
  ContactPair *near_pairs; // that may couple
  size_t near_capacity;
  ContactStiffnessKey *order; // of the pairs
  size_t order_capacity;
  // Two elements being summed.
  int most; // vertices that two elements have at most
  int count;
  int *vertices; // of the contact mesh                              (count)
  int *place;    // 1 + place among them, 0: none                    (vertex_count)
  double *sum;   // in rows of a fixed length                        (3 count, 3 count)
  double *dense; // the same without gaps
} ContactStiffness;

Status contact_stiffness_create(ContactStiffness *stiffness, const ContactLayout *layout);
void contact_stiffness_destroy(ContactStiffness *stiffness);
size_t contact_stiffness_bytes(const ContactStiffness *stiffness); // on the heap

enum { CONTACT_ALL_INTERFACES = -1 };

// What is handed on: ∂²U/∂x², or −∂f/∂x, which is not symmetric.
typedef struct ContactStiffnessWay {
  bool is_turned;       // −∂f/∂x of pairs with a law, by contact_field_turn_law
  const double *slopes; // of the model (mesh_pair_count, 4, 24): −∂f/∂x of pairs of meshes by
                        // contact_field_turn; NULL: clipping's polyhedra serve. Borrowed
} ContactStiffnessWay;

// Hands ∂²U/∂x² of an evaluation to the sink, that of one interface or of all, as contact_field_bend or
// contact_volume_bend gives it, or −∂f/∂x, by vertices of the contact mesh. STATUS_MEMORY possible.
Status contact_stiffness_add(ContactStiffness *stiffness, const ContactLayout *layout,
                             const ContactEvaluation *evaluation, int interface,
                             const ContactStiffnessWay *way, const ContactStiffnessSink *sink);

// Visits cliques that contain every list the sink would be given if all candidates whose boxes are within
// `reach` of each other (of a shape: that are within `reach` of it) overlapped, but for those of elements
// that are `coupled`, which takes the new ones. Begin with a zeroed one.
Status contact_stiffness_couple(ContactStiffness *stiffness, const ContactLayout *layout,
                                const ContactCandidateList *candidates, double time, const double *positions,
                                double reach, ContactCoupled *coupled, void *visitor,
                                Status (*visit)(void *visitor, int count, const int *vertices));

void contact_coupled_destroy(ContactCoupled *coupled); // it can be used again

#endif
