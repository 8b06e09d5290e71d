// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/signal.h"

#include <float.h>
#include <math.h>

// Looks at a piece between two knots at so many places, if it is straight and if it is curved.
enum { SAMPLES = 4, SAMPLES_OF_CURVE = 8 };
// Between knots a step is not shortened below this share.
static const double SHORTEST_SHARE = 1.0 / 1024;

// Formulas' knots are known to a few roundings.
static const double MARGIN = 32 * DBL_EPSILON;

double fem_signal_before(double knot) {
  return knot - MARGIN * fabs(knot);
}

double fem_signal_past(double before) {
  return before + 2 * MARGIN * fabs(before);
}

// The cubic through values and rates at both ends of a step; in statics the chord.
typedef struct Span {
  double begin, end;
  double from[3], from_rate[3], to[3], to_rate[3];
} Span;

static Span span_of(const FemSignal *signal, const FemForesight *foresight, double begin, double end) {
  Span span = {.begin = begin, .end = end};
  signal->eval(signal->def, begin, span.from, span.from_rate);
  signal->eval(signal->def, fem_signal_before(end), span.to, span.to_rate); // of what comes before
  for (int c = 0; c < 3 && foresight->static_share > 0; c++)
    span.from_rate[c] = span.to_rate[c] = (span.to[c] - span.from[c]) / (end - begin);
  return span;
}

// Hermite's interpolation.
static double cubic_at(const Span *span, int c, double time) {
  double h = span->end - span->begin, s = (time - span->begin) / h, rise = s * s * (3 - 2 * s);
  return span->from[c] + rise * (span->to[c] - span->from[c]) +
         h * s * (1 - s) * ((1 - s) * span->from_rate[c] - s * span->to_rate[c]);
}

// Whether what happens between the ends can be found from them.
static bool is_followed(const FemSignal *signal, const FemForesight *foresight, double begin, double end) {
  Span span = span_of(signal, foresight, begin, end);
  int samples = signal->is_curved && foresight->static_share == 0 ? SAMPLES_OF_CURVE : SAMPLES;
  double deviation = 0, change = 0, next;
  for (double knot = begin; knot < end; knot = next) {
    next = fmin(signal->next_knot(signal->def, knot + foresight->resolution), end);
    for (int k = 1; k <= samples; k++) {
      double time = k < samples ? knot + (next - knot) * k / samples : next, value[3], rate[3];
      if (time >= end) break;
      signal->eval(signal->def, time, value, rate);
      for (int c = 0; c < 3; c++) {
        deviation = fmax(deviation, fabs(value[c] - cubic_at(&span, c, time)));
        change = fmax(change, fabs(value[c] - span.from[c]));
      }
    }
  }
  double allowed = fmin(signal->deviation, signal->impulse / (end - begin));
  return deviation <= allowed + foresight->static_share * change;
}

// A knot between two times, near their middle; INFINITY: there is none.
static double find_knot(const FemSignal *signal, const FemForesight *foresight, double low, double high) {
  double middle = low + 0.5 * (high - low), knot = INFINITY;
  double next = signal->next_knot(signal->def, low + foresight->resolution);
  while (next < high && (next <= middle || isinf(knot))) {
    knot = next;
    next = signal->next_knot(signal->def, knot + foresight->resolution);
  }
  return knot;
}

// The last knot before `end` up to which the function is followed; `begin`: there is none. A pulse is too
// much whether it is passed by half or whole: bisection.
static double last_knot(const FemSignal *signal, const FemForesight *foresight, double begin, double *end) {
  double low = begin, knot;
  while ((knot = find_knot(signal, foresight, low, *end)) < *end) {
    if (is_followed(signal, foresight, begin, knot))
      low = knot;
    else
      *end = knot;
  }
  return low;
}

double fem_signal_horizon(const FemSignal *signal, const FemForesight *foresight, double time,
                          double farthest) {
  double begin = time + foresight->resolution, end = farthest;
  if (!(end - begin > foresight->resolution) || is_followed(signal, foresight, begin, end)) return farthest;
  double knot = last_knot(signal, foresight, begin, &end);
  if (knot == begin) {
    // All that is left is one piece. A straight one is always followed, statics follows all.
    double shortest = SHORTEST_SHARE * (end - begin);
    bool may_halve = signal->is_curved && foresight->static_share == 0;
    while (may_halve && end - begin > shortest && !is_followed(signal, foresight, begin, end))
      end = begin + 0.5 * (end - begin);
    knot = end;
  }
  return farthest - knot > foresight->resolution ? knot : farthest;
}
