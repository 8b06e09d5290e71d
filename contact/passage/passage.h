// SPDX-License-Identifier: GPL-3.0-or-later
// Elements that have passed through another body: they entered it on one side and leave it on the opposite
// one. A deep overlap that is pushed back out is no passage.
//
// An element i meets another body or shape B with the direction
//
//   h_i = Σ_j w_ij g_j / Σ_j w_ij |g_j|,   g the slope of the depth in B, w the volume at rest of i in it
//
// (contact/pressure/field.h): inwards from the surface of B that is nearest to what of i is inside; |h| = 1
// where it sees one side of B only, about 0 where it reaches as far into either half. With the potential
// `nodal` g is the direction of ∂V_ij/∂x, and w V_ij (contact/volume/volume.h). The element keeps the
// direction in which it came in. The kept direction follows h from one accepted state to the next while |h| >
// ½ and h turns by less than a right angle: so it does where an element slides round a drum or over an edge,
// or turns together with B. Near the surface it follows however far h turns, as over a sharp ridge: only an
// element that has been deep inside can come to the other side by passing through, and that it has been is
// kept while h is opposed. Where h is opposed to the kept direction, by a component of more than ½, an
// element that has been deep inside has gone beyond the middle of B and is pushed out on the other side: it
// is called turned. An element that leaves B while it is turned has passed through; one that comes back is no
// longer turned.
//
// Where B has several layers, or a slot, the element meets parts of it (contact/passage/meetings.h) that
// press it from opposite sides, now one more and now the other. So h is that of a part, and the element keeps
// one direction for each. A part of the next accepted state is the one before where it has the cell that the
// element met most of, or neighbours of it, or, after a fast slide, lies at rest no farther from that than
// the margin of contact's lists, which bounds the step. Where parts become one, what is turned stays, then
// what has a direction, then what has been deep inside, then the direction that fits best.
//
// Whether an element is deep inside, as one must be to become turned, is judged by two shares, so the unit of
// length does not matter:
//
//   reach    the largest depth, over the depth of B's middle at that place (contact/surface/middle.h): at
//            least a tenth, since cells along an edge of B's mesh can have any slope;
//   covered  the volume that the two share, over that of the element or of the cells that it meets, whichever
//            is less: at least a thousandth; without a depth a tenth.
//
// Below a millionth the centroid and the depth of an overlap are those of rounding: such a pair counts for
// nothing, and such an element keeps no direction.
#ifndef TETLAP_CONTACT_PASSAGE_PASSAGE_H
#define TETLAP_CONTACT_PASSAGE_PASSAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "contact/passage/meetings.h"
#include "contact/system.h"

// An element in a part of another's body.
typedef struct ContactPassageEntry {
  int interface, tet;
  int cell; // of the part, the one that it meets most of; −1: a shape
  bool is_turned;
  bool is_deep;          // or has been, and h has not come back to the kept direction since
  double direction[3];   // in which it came in; 0: not known yet
  double reach, covered; // scratch: the shares, now
} ContactPassageEntry;

typedef struct ContactPassageList {
  ContactPassageEntry *entries; // by interface, then tet                     (count)
  int count;
  size_t capacity;
} ContactPassageList;

// Elements of a list for which something holds: each once, in however many parts, for each body that it
// meets.
typedef struct ContactPassageCount {
  int elements;
  ContactPassageEntry first, last; // of the first and of the last of them, where there are any
} ContactPassageCount;

typedef struct ContactPassage {
  ContactPassageList now, next; // at the last accepted state, and at the one that is evaluated
  ContactPassageCount passed;   // what has left turned, from `now` to `next`
  ContactMeetings meetings;     // of `next`
  double *middles;              // of each cell: the depth of the middle there [m]; `field` only
} ContactPassage;

void contact_passage_destroy(ContactPassage *passage); // also of a zeroed one, which is a beginning

// At an evaluation of the system: fills `next` and `passed`. What it finds at the state that was accepted
// last is what `now` has already.
Status contact_passage_look(ContactPassage *passage, const ContactSystem *system,
                            const ContactEvaluation *evaluation);
// The evaluated state is accepted.
void contact_passage_accept(ContactPassage *passage);

// What is turned at the accepted state.
ContactPassageCount contact_passage_turned(const ContactPassage *passage);

// What lies inside of another body at the accepted state: it is covered, or covers what it meets, and reaches
// more than half way to its middle. `field` only.
ContactPassageCount contact_passage_inside(const ContactPassage *passage);

// What a checkpoint keeps: so many numbers, a row an entry of `now`.
enum { CONTACT_PASSAGE_KEPT = 8 };
void contact_passage_save(const ContactPassage *passage, double *values);
Status contact_passage_load(ContactPassage *passage, int count, const double *values);

#endif
