// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that several files of contact share. docs/limits.md is made from this page and fem/model/limits.h
// by tools/limits; each entry ends with what holds its number.
#ifndef TETLAP_CONTACT_LIMITS_H
#define TETLAP_CONTACT_LIMITS_H

// ---- Contact: what counts as nothing.

// A difference of this share of what it is compared with is rounding: of lengths, volumes, sines, a margin.
// Held by test_contact, test_field.
#define CONTACT_ROUNDING 1e-9

// A surface is flat where it bulges by less than this share of an edge, or turns by a cosine that is less by
// that. A cell is flat whose volume is less than this share of its element's, and what of a face is less than
// this share of it is none. A quadratic form is flat in a direction in which it has less than this share of
// its largest value. Coordinates in files of meshes have six digits.
// Held by test_smooth_scenes.
#define CONTACT_FLAT 1e-5

// ---- Contact: lists of pairs that are near. No result depends on which list found a pair.

// A list is made for so many steps at the speeds of now, and renewed when one of them is used up.
// Held by test_contact_lists.
#define CONTACT_STEPS_AHEAD 2

#endif
