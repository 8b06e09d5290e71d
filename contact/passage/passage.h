// SPDX-License-Identifier: GPL-3.0-or-later
// Elements that have passed through another body: they entered it on one side and leave it on the opposite
// one. A deep overlap that is pushed back out is no passage.
//
// An element i meets another body or shape B with the direction
//
//   h_i = Σ_j w_ij g_j / Σ_j w_ij |g_j|,   g the slope of the depth in B, w the volume at rest of i in it
//
// (contact/pressure/field.h). It points inwards from the surface of B that is nearest to what of i is inside.
// |h| is 1 where that is one side of B only, and about 0 where it reaches as far into either half. With the
// potential `nodal`, g is the direction of ∂V_ij/∂x and w is V_ij (contact/volume/volume.h).
//
// Kept direction. The element keeps the direction in which it came in. From one accepted state to the next
// the kept direction becomes h where |h| > ½, unless the element is turned, if either
//
//   h turns by less than a right angle: the element slides round a drum or over an edge, or turns with B;
//   the element is near the surface, however far h turns, as over a sharp ridge. Only an element that has
//   been deep inside can come to the other side by passing through.
//
// Turned. h is opposed where its component along the kept direction is below −½. An element is turned once h
// is opposed while the element is deep inside. It is turned, too, if it was deep before h became opposed and
// the middle of B is within its reach: the margin of contact's lists, by which it moves at most while they
// hold. It has gone beyond the middle of B then, and is pushed out on the other side. It is no longer turned
// once that component is above ½. An element that leaves B while it is turned has passed through.
//
// Parts of B. Where B has several layers, or a slot, the element meets parts of B
// (contact/passage/meetings.h) that press it from opposite sides, and their shares change. So h is that of
// one part, and the element keeps one direction for each part. At the next accepted state a part is followed
// by its cell, the one that the element met most of. It goes on in the part that has this cell, else in the
// one whose cells have the most vertices in common with it. After a fast slide there is neither: then it goes
// on in one that lies at rest no farther from it than the margin of contact's lists.
// Where two parts go on in one, one entry stays: the one that is turned, else has a direction, else has been
// deep inside, else has the direction that fits best.
//
// Deep inside. Two shares decide, so the unit of length does not matter:
//
//   reach    the largest depth, over the depth of B's middle at that place (contact/surface/middle.h). It
//            must be a tenth, since cells along an edge of B's mesh can have any slope;
//   covered  the volume that the two share, over that of the element or of the cells that it meets, whichever
//            is less. It must be a thousandth; without a depth (`nodal`) a tenth, and reach is not asked.
//
// An interface is followed while an element reaches half of that, may come to the middle in the next step, or
// is deep inside or turned. The way of a step is one and a half times the margin at most: half of it may be
// used up, in any direction, where the step begins. Where all touch more lightly the kept directions would be
// those of the present state.
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
  bool is_deep; // deep inside, or was, h has been opposed to the kept direction since, and the middle is near
  double direction[3];   // in which it came in; 0: not known yet
  double reach, covered; // scratch: the shares, now
} ContactPassageEntry;

typedef struct ContactPassageList {
  ContactPassageEntry *entries; // by interface, then tet                     (count)
  int count;
  size_t capacity;
} ContactPassageList;

// How many elements of a list have some property. An element counts once for each body that it meets, in
// however many parts.
typedef struct ContactPassageCount {
  int elements;
  ContactPassageEntry first, last; // of the first and of the last of them; not set where there are none
} ContactPassageCount;

typedef struct ContactPassage {
  ContactPassageList now, next; // at the last accepted state, and at the one that is evaluated
  ContactPassageCount passed;   // what has left turned, from `now` to `next`
  ContactMeetings meetings;     // of `next`
  double *middles;              // of each cell: the depth of the middle there [m]; `field` only
  bool *is_followed;            // scratch: of each interface
  size_t followed_capacity;
} ContactPassage;

void contact_passage_destroy(ContactPassage *passage); // also of a zeroed one, which is a beginning

// Fills `next` and `passed` at an evaluation of the system. At the state that was accepted last it finds what
// `now` has. STATUS_MEMORY.
Status contact_passage_look(ContactPassage *passage, const ContactSystem *system,
                            const ContactEvaluation *evaluation);
// The evaluated state is accepted.
void contact_passage_accept(ContactPassage *passage);

// What is turned at the accepted state.
ContactPassageCount contact_passage_turned(const ContactPassage *passage);

// What lies inside another body at the accepted state: the element is covered, or covers what it meets, and
// reaches more than half way to the middle. With the potential `field` only.
ContactPassageCount contact_passage_inside(const ContactPassage *passage);

// What a checkpoint keeps of `now`: a row of so many numbers for each entry.
enum { CONTACT_PASSAGE_KEPT = 8 };
void contact_passage_save(const ContactPassage *passage, double *values);
Status contact_passage_load(ContactPassage *passage, int count, const double *values); // STATUS_MEMORY

#endif
