// SPDX-License-Identifier: GPL-3.0-or-later
// Second derivatives of the contact potential, handed out term by term, and which vertices they couple.
//
//   ∂²U/∂x² = Σ c ∇w ∇wᵀ  (curvature of contact/pressure/potential.h)  +  Σ p_ij ∇²V_ij  (geometric,
//   indefinite)
//
// A model without second derivatives borrows those of clipping: exact for `exact` and `cgal`, near for
// learned ones. Vertices of obstacles carry no unknowns and are left out of every list.
#ifndef TETLAP_CONTACT_STIFFNESS_H
#define TETLAP_CONTACT_STIFFNESS_H

#include "contact/evaluation.h"
#include "contact/pressure/field_stiffness.h"

// Where the stiffness ∂²U/∂x² goes. Each call adds a dense symmetric part over a short list of distinct
// vertices; those of obstacles carry no unknowns and are left out.
typedef struct ContactStiffnessSink {
  void *self;
  // S += scale · w wᵀ, w (count, 3).
  void (*add_outer)(void *self, int count, const int *vertices, const double *w, double scale);
  // S += matrix, (3 count, 3 count), symmetric.
  void (*add_dense)(void *self, int count, const int *vertices, const double *matrix);
} ContactStiffnessSink;

// Scratch memory.
typedef struct ContactStiffness {
  ContactPatches near; // of the pairs that may couple
  ContactPair *near_pairs;
  size_t near_capacity;
  // A clique being collected: its nodes and the gradient of w by them.
  int count;
  int *nodes;       //                                             (count)
  int *vertices;    //                                             (count)
  double *gradient; //                                             (count, 3)
  int *place;       // 1 + place in the clique, 0: not in it       (nodes of the patches)
  size_t node_capacity, vertex_capacity, gradient_capacity, place_capacity;
  double *hessians; //                                             (PAIRS_AT_ONCE, 24, 24)
  double *volumes;  //                                             (PAIRS_AT_ONCE)
  ContactFieldStiffness field;
} ContactStiffness;

Status contact_stiffness_create(ContactStiffness *stiffness, const ContactLayout *layout);
void contact_stiffness_destroy(ContactStiffness *stiffness);

// Hands ∂²U/∂x² of the evaluation to the sink. The geometric part is included if the layout's definition asks
// for it and the model has second derivatives.
Status contact_stiffness_add(ContactStiffness *stiffness, const ContactLayout *layout,
                             ContactEvaluation *evaluation, const OverlapModel *model,
                             const ContactStiffnessSink *sink);

// S += Σ_a coefficient_a ∇W_a ∇W_aᵀ over the nodes of the evaluation's patches whose sides carry unknowns;
// `coefficients` (node_count).
Status contact_stiffness_add_nodes(ContactStiffness *stiffness, const ContactLayout *layout,
                                   ContactEvaluation *evaluation, const double *coefficients,
                                   const ContactStiffnessSink *sink);

// Visits cliques that contain every list the sink would be given if all candidates whose boxes are within
// `reach` of each other (a half-space: that are within `reach` of it) overlapped.
Status contact_stiffness_couple(ContactStiffness *stiffness, const ContactLayout *layout,
                                const ContactCandidateList *candidates, double time, const double *positions,
                                double reach, void *visitor,
                                Status (*visit)(void *visitor, int count, const int *vertices));

#endif
