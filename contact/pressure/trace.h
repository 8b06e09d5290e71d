// SPDX-License-Identifier: GPL-3.0-or-later
// Pressure, depth and traction at the vertices of a surface, right up to the rim. Potential `field` only.
//
// Every pair of cells is a sample: at the centroid x̄ of its overlap the depth is exactly D = V/A and the
// pressure p = |F|/A (A: contact_field_area) wherever D is linear within the pair, also where a rim cuts it.
// Round a vertex a, with w = λ_a A, the samples are fitted by a linear function in the tangent plane, whose
// value at a is taken (a recovery as by Zienkiewicz and Zhu 1992):
//
//   r = x̄ − x_a,   m = Σ w r / Σ w,   C = Σ w r rᵀ / Σ w − m mᵀ,   p_a = p̄ − g·m,   C g = Σ w p r / Σ w − p̄ m
//
// Of three samples, counted by their weights as (Σ w)² / Σ w², or fewer a fit would follow their scatter.
// There the samples of the vertices round a, on faces of the surface, are added with the same weight in all,
// as far as they are pressed the same way; and no more is told than p̄, or p̄ (1 − z/D̄) where a is outside of
// the other body by a gap z, D̄ the mean depth of its own samples. Where the vertices round it have few as
// well, that is told. Along a direction in which the samples hardly spread, against their distance, g is
// taken back to 0. So p is exact up to the edge of a punch, where the mean would be, and up to a rim where it
// falls to 0, where the mean is far too large. A vertex that no cell of its pairs lies before or behind,
// along their forces, is beyond the edge of the other body, and one with z ≥ D̄ is beyond the rim: 0.
#ifndef TETLAP_CONTACT_PRESSURE_TRACE_H
#define TETLAP_CONTACT_PRESSURE_TRACE_H

#include "contact/evaluation.h"
#include "contact/surface/stars.h"

enum { CONTACT_TRACE_PRESSURE, CONTACT_TRACE_DEPTH, CONTACT_TRACE_VALUES };

// Sums over the samples round a vertex as it was given, on its own body.
typedef struct ContactTrace {
  double weight;                           // Σ w [m²]
  double squares;                          // Σ w² [m⁴]
  double pressed;                          // Σ λ |F| [N]
  double force[3];                         // Σ λ F [N]
  double rub[3];                           // Σ λ T, T the friction of a pair [N]
  double arm[3];                           // Σ w r [m³]
  double spread[6];                        // Σ w r rᵀ: xx, yy, zz, xy, yz, xz [m⁴]
  double values[CONTACT_TRACE_VALUES];     // Σ w p [N], Σ w D [m³]
  double moments[CONTACT_TRACE_VALUES][3]; // Σ w p r, Σ w D r
  bool is_faced;                           // another body lies before or behind the vertex, along the force
  double gap;                              // how far before it at least, if so; 0: touched or passed [m]
} ContactTrace;

// What follows for the given vertices; 0 where nothing presses and inside of bodies.
typedef struct ContactTraceResult {
  double *pressures;      // [Pa]                                     (given vertex_count)
  double *depths;         // of the overlap [m]                       (given vertex_count)
  double (*tractions)[3]; // on the surface, friction included [Pa]; NULL: not wanted   (given vertex_count)
} ContactTraceResult;

// Adds the evaluation's pairs to the traces (given vertex_count). `is_wanted` by interfaces; NULL: all.
// `pulls`: friction on side 0 of each pair [N]; NULL: none.
void contact_trace_add(const ContactLayout *layout, const ContactStars *stars,
                       const ContactEvaluation *evaluation, const bool *is_wanted, const double (*pulls)[3],
                       ContactTrace *traces);

// Adds to the rings, zeroed (given vertex_count), the sums of the vertices round each one that has few
// samples.
void contact_trace_ring(const ContactLayout *layout, const ContactStars *stars, const double *positions,
                        const ContactTrace *traces, ContactTrace *rings);

void contact_trace_find(int count, const ContactTrace *traces, const ContactTrace *rings,
                        const ContactTraceResult *result);

#endif
