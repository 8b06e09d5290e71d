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
// that. A quadratic form is flat in a direction in which it has less than this share of its largest value.
// Coordinates in files of meshes have six digits.
// Held by test_smooth_scenes.
#define CONTACT_FLAT 1e-5

// A volume that is less than this share of its cell's or element's is a sliver: its middle and its slopes are
// quotients of roundings. Where an obstacle's surface cuts a face, less than this share of the face counts
// whole or not at all.
// Held by no test: 0.03 changes none of what tests of balls and of smooth surfaces compare.
#define CONTACT_SLIVER 1e-4

// ---- Contact: lists of pairs that are near. No result depends on which list found a pair.

// A list is made for so many steps at the speeds of now.
// Held by no test: with twice as many 02, 05, 10, 11 and 12 among the examples give the same bits.
#define CONTACT_STEPS_AHEAD 2

// The share of a margin that a step may use up, since it may be faster than expected.
// Held by no test: with 0.3 02_two_blocks takes 801 steps instead of 803, 13_dead_bounce 346 instead of 341.
#define CONTACT_MARGIN_USED 0.8

#endif
