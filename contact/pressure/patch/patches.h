// SPDX-License-Identifier: GPL-3.0-or-later
// The neighbourhoods of a list of pairs: per interface one patch with its elements (tetrahedra that take
// part) and nodes (their vertices), numbered in order of first appearance, and the pairs of elements that
// touch.
//
//     pair ──► 2 elements ──► 4 nodes each          after contact_patches_index also
//     node ──► elements   ──► pairs
//
// The cost is that of the list, whatever the size of the meshes.
#ifndef TETLAP_CONTACT_PRESSURE_PATCH_PATCHES_H
#define TETLAP_CONTACT_PRESSURE_PATCH_PATCHES_H

#include "contact/search/layout.h"

typedef struct ContactElement {
  int tet;
  int side;       // of the interface: 0 or 1; of a body and itself: in the first of its pairs
  int nodes[4];   // of its vertices
  double covered; // W_i [m³]; the user's
} ContactElement;

typedef struct ContactNode {
  int vertex;
  int side;
  double force[3]; // [N]; the user's
} ContactNode;

// An interface that has pairs.
typedef struct ContactPatch {
  int interface;
  int pair_begin, pair_end;
  int element_begin, element_end;
  int node_begin, node_end;
  double energy; // U of its pairs [J]; the user's
} ContactPatch;

typedef struct ContactPatches {
  int patch_count, element_count, node_count, pair_count;
  ContactPatch *patches;    //                                                (patch_count)
  ContactElement *elements; //                                                (element_count)
  ContactNode *nodes;       //                                                (node_count)
  int (*pair_elements)[2];  // elements of each pair, −1: a shape             (pair_count)
  size_t patch_capacity, element_capacity, node_capacity, pair_capacity;
  int *element_of_tet; // scratch: −1 between calls                            (tet_count)
  int *node_of_vertex; // scratch: −1 between calls                            (vertex_count)
} ContactPatches;

Status contact_patches_create(ContactPatches *patches, const ContactLayout *layout);
void contact_patches_destroy(ContactPatches *patches);

// Builds the patches of `pairs`, which come interface by interface. Elements' and nodes' own numbers are
// zeroed.
Status contact_patches_build(ContactPatches *patches, const ContactLayout *layout, int pair_count,
                             const ContactPair *pairs);

#endif
