// SPDX-License-Identifier: GPL-3.0-or-later
// One evaluation of contact: which candidates overlap, by how much, and what follows. The
// result is a pure function of positions, time and overlap model, as long as the candidates cover the
// positions; sums run in the order of the candidates, so it is the same for any number of threads.
#ifndef TETLAP_CONTACT_EVALUATION_H
#define TETLAP_CONTACT_EVALUATION_H

#include "contact/pressure/field.h"
#include "contact/pressure/patch/patches.h"
#include "contact/rest.h"
#include "contact/search/candidates.h"

// Pairs of meshes by how they were answered.
typedef struct ContactPairCounts {
  long long tried;     // given to the overlap model
  long long enclosed;  // flagged OVERLAP_ENCLOSED
  long long fallbacks; // flagged FALLBACK
  long long by_net;    // flagged NET
  long long blended;   // flagged BLENDED
  long long beyond;    // flagged BEYOND
  long long unsound;   // flagged UNSOUND
} ContactPairCounts;

typedef struct ContactEvaluation {
  const ContactRest *rest; // stands in the result beside the candidates (contact/rest.h); NULL: nothing
  long long version; // of the time and positions (contact_evaluate); 0: none that may be asked for again
  double time;       // of this result [s]
  double *positions; // of this result [m]; then the virtual vertices    (position_count, 3)
  double energy;     // U [J]
  // Pairs with V > 0 in the candidates' order, so those with shapes last.
  int pair_count, mesh_pair_count;
  ContactPair *pairs;       //                                       (pair_count)
  double *coordinates;      // as given to the model [m]             (mesh_pair_count, 2, 4, 3)
  double *volumes;          // V_ij [m³]                             (pair_count)
  ContactFieldPair *fields; //                                       (pair_count)
  double *pair_forces; // on the vertices of the pairs' tetrahedra, a shape's zeros [N]  (pair_count, 2, 4, 3)
  ContactPatches patches; // with W_i and forces per node
  double *forces;         // −∂U/∂x [N]                            (vertex_count, 3)
  double *covered;        // Σ over interfaces of W_i [m³]            (tet_count)
  // The same by the vertices and tetrahedra as they were given; borrowed.
  const double *given_forces;   //                                  (given vertex_count, 3)
  const double *given_covered;  //                                  (given tet_count)
  ContactInterface *interfaces; //                                       (interface_count)
  ContactPairCounts counts;     // of the pairs given to the model
  int blamed;                   // the pair of `coordinates` that the model failed at; −1: none
  double overlap_s, force_s;    // wall time [s]
  // ∂V/∂x [m²] and ∂x̄/∂x by the coordinates, where they were asked for           (mesh_pair_count, 4, 24)
  double *slopes;
  bool has_slopes;
  // Scratch memory.
  double *gradients;      // ∇V_ij where it is asked for [m²]          (pair_count, 2, 4, 3)
  double *centroids;      // x̄ of mesh pairs where it is asked for [m] (mesh_pair_count, 3)
  double *nodes;          // of the patches                            (node_count)
  unsigned char *is_kept; // of each candidate
  double (*boxes)[6];     // of the candidates' cells                 (cell_count)
  unsigned *flags;
  int32_t *elements, *bodies; // of mesh pairs, where the model asks whence they are (mesh_pair_count, 2)
  double *rest_volumes;       // likewise: the cells' volumes at rest [m³]           (mesh_pair_count, 2)
  size_t element_capacity, body_capacity, rest_capacity;
  size_t kept_capacity, pair_capacity, coordinate_capacity, volume_capacity, gradient_capacity;
  size_t slope_capacity, force_capacity, flag_capacity, centroid_capacity, field_capacity, node_capacity;
} ContactEvaluation;

Status contact_evaluation_create(ContactEvaluation *evaluation, const ContactLayout *layout);
void contact_evaluation_destroy(ContactEvaluation *evaluation);

// The last result is forgotten; `rest` has changed.
void contact_evaluation_start_over(ContactEvaluation *evaluation, const ContactLayout *layout);

// `with_shapes`: pairs with shapes, too, in which no overlap model takes part. STATUS_SOLVER: the model gave
// a volume that is not a number ≥ 0.
Status contact_evaluation_run(ContactEvaluation *evaluation, const ContactLayout *layout,
                              const ContactCandidateList *candidates, const OverlapModel *model,
                              bool with_shapes, double time, const double *positions);

// The slopes of the last result, by the model that gave it if it has them (overlap/slopes.h), or by clipping,
// with the potential `field`; found once.
Status contact_evaluation_find_slopes(ContactEvaluation *evaluation, const ContactLayout *layout,
                                      const OverlapModel *model);

// Forgets the last result and lists instead, without asking a model, the pairs of meshes whose boxes meet:
// pairs, coordinates and mesh_pair_count. A model that gives disjoint pairs a volume is asked these.
Status contact_evaluation_list(ContactEvaluation *evaluation, const ContactLayout *layout,
                               const ContactCandidateList *candidates, const double *positions);

// Pairs with V > 0, those at rest included.
int contact_evaluation_active_count(const ContactEvaluation *evaluation);

#endif
