// SPDX-License-Identifier: Apache-2.0
// A model of the user's as an overlap model: what every model owes the program, round what a port gives.
//
// - V below 0 becomes 0, its gradient too, and is flagged OVERLAP_UNSOUND; so is V above the smaller
//   tetrahedron, which stays. OverlapUnsound makes them errors.
// - A number that is not finite is an error that names the pair, unless OverlapUnsound has it counted; one
//   written beyond the end of an array always is.
// - It gets copies: what it does to the pairs it was given changes nothing of the caller's. One that answers
//   for disjoint pairs itself gets the caller's own, which are const.
#ifndef TETLAP_OVERLAP_FOREIGN_FOREIGN_H
#define TETLAP_OVERLAP_FOREIGN_FOREIGN_H

#include "overlap/ops.h"

// Opens the model that a word names (overlap/source.h). `*ops` belongs to `*self` and ends with it, by its
// `destroy`. STATUS_INPUT, STATUS_IO: as library.h and process.h have it, with the word.
Status overlap_foreign_create(void **self, const OverlapOps **ops, const char *word, OverlapUnsound unsound);

// Programs that this one starts may open the `channel:` word, too, one after the other. STATUS_INPUT: the
// descriptors are not there.
Status overlap_foreign_hand_on(const char *word);

#endif
