// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness by the vertices of the contact mesh, handed on by those that carry them
// (contact/surface/stars.h): Tᵀ K T with T the weights.
#ifndef TETLAP_CONTACT_PRESSURE_STAR_SINK_H
#define TETLAP_CONTACT_PRESSURE_STAR_SINK_H

#include "contact/stiffness.h"
#include "contact/surface/stars.h"

typedef struct ContactStarSink {
  const ContactStars *stars;      // borrowed
  const ContactStiffnessSink *to; // borrowed
  ContactStiffnessSink from;      // what takes the stiffness of the contact mesh
  // A clique being handed on.
  int count;
  int *vertices; // as given                                (count ≤ given_vertex_count)
  int *place;    // 1 + place in the clique, 0: not in it   (given_vertex_count)
  double *outer; //                                         (count, 3)
  double *half;  // of two elements, by vertices and carriers  (3 vertices, 3 count)
  double *dense; //                                            (3 count, 3 count)
} ContactStarSink;

Status contact_star_sink_create(ContactStarSink *sink, const ContactStars *stars);
void contact_star_sink_destroy(ContactStarSink *sink);
size_t contact_star_sink_bytes(const ContactStarSink *sink); // on the heap

// The sink to give in place of `to`; valid until the next call.
const ContactStiffnessSink *contact_star_sink_to(ContactStarSink *sink, const ContactStiffnessSink *to);

// The given vertices that carry these, each once, to sink->vertices.
void contact_star_sink_gather(ContactStarSink *sink, int count, const int *vertices);

#endif
