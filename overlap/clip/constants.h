// SPDX-License-Identifier: Apache-2.0
// Constants of clipping that processors and devices share: its text is also part of what a device compiles,
// so it includes nothing.
#ifndef TETLAP_OVERLAP_CLIP_CONSTANTS_H
#define TETLAP_OVERLAP_CLIP_CONSTANTS_H

#ifndef CONSTANT
#define CONSTANT static const
#endif

// Where a barycentric coordinate has a larger error than this, ∇V is not computed here.
#define OVERLAP_CLIP_FLATTEST 1e-10

// The rounding error of det · λ, over the cube of the longest difference of coordinates. In the classes of
// the tests the errors of V correspond to at most 0.065 ε; this is 0.25.
#define OVERLAP_CLIP_NOISE (0.25 * DBL_EPSILON)

// L_A² of clip.h over A's squared edges from its first vertex, S. Rounding does about 5.3 ε |e||f| L at most
// to det_A · λ of the face with edges e and f. The fourth λ is one less the three others: Σ|e||f| ≤ S, so 5.3
// ε S L of these and 1.5 ε S L of the differences, 27 in units of OVERLAP_CLIP_NOISE. In a search among small
// elements on large cells some V were wrong with ½.
#define OVERLAP_CLIP_OWN 32.0

// How far λ of a flat tetrahedron may slide along its faces, as clip.h has it: times noise, over det. Six
// times the largest found in a search for bad pairs.
#define OVERLAP_CLIP_SLIDE (1 / (256 * OVERLAP_CLIP_NOISE))

// An overlap may be rounding alone if it is no thicker than so many times the displacement of its faces by
// rounding, or if its faces together are no larger than that, in units of whole faces.
#define OVERLAP_CLIP_THINNEST 64.0
#define OVERLAP_CLIP_SMALLEST (4096 * DBL_EPSILON)

// The planes u, v spanning the parameters of face f, such that the face, seen from outside and with positive
// det, runs counter-clockwise through (0, 0), (1, 0), (0, 1) of (λ_u, λ_v); t is the third vertex, at (0, 0).
// Indices 4–7 are those of B.
CONSTANT unsigned char overlap_clip_t[8] = {1, 0, 0, 0, 5, 4, 4, 4};
CONSTANT unsigned char overlap_clip_u[8] = {2, 3, 1, 2, 6, 7, 5, 6};
CONSTANT unsigned char overlap_clip_v[8] = {3, 2, 3, 1, 7, 6, 7, 5};

#endif
