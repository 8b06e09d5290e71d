// SPDX-License-Identifier: GPL-3.0-or-later
// The matrix of the potential `field`. A tetrahedron that contact has cut meets another with several cells,
// and the cells of a quadratic element move with the same ten nodes: the pairs' matrices are summed over the
// cells of two elements before they are handed on.
#ifndef TETLAP_CONTACT_FIELD_STIFFNESS_H
#define TETLAP_CONTACT_FIELD_STIFFNESS_H

#include "contact/evaluation.h"

// A pair's place in the order in which elements stand together.
typedef struct ContactFieldKey {
  int interface;
  int elements[2]; // [1] −1: a shape
  int pair;
} ContactFieldKey;

typedef struct ContactFieldStiffness {
  ContactFieldKey *order; // of the pairs
  size_t order_capacity;
  double *matrices; // of a portion of the pairs                     (PORTION, 24, 24)
  // Two elements being summed.
  int most; // vertices that two elements have at most
  int count;
  int *vertices; // of the contact mesh                              (count)
  int *place;    // 1 + place among them, 0: none                    (vertex_count)
  double *sum;   // in rows of a fixed length                        (3 count, 3 count)
  double *dense; // the same without gaps
} ContactFieldStiffness;

// Takes S += matrix, (3 count, 3 count), symmetric, of vertices of the contact mesh.
typedef void (*ContactFieldTake)(void *self, int count, const int *vertices, const double *matrix);

Status contact_field_stiffness_create(ContactFieldStiffness *stiffness, const ContactLayout *layout);
void contact_field_stiffness_destroy(ContactFieldStiffness *stiffness);
size_t contact_field_stiffness_bytes(const ContactFieldStiffness *stiffness); // on the heap

// ∂²U/∂x² of an evaluation, as contact_field_bend gives it.
Status contact_field_stiffness_add(ContactFieldStiffness *stiffness, const ContactLayout *layout,
                                   const ContactEvaluation *evaluation, void *self, ContactFieldTake take);

// Calls `visit` with the vertices of the contact mesh that any two elements with a pair among these couple.
Status contact_field_stiffness_couple(ContactFieldStiffness *stiffness, const ContactLayout *layout,
                                      int count, const ContactPair *pairs, void *visitor,
                                      Status (*visit)(void *visitor, int count, const int *vertices));

#endif
