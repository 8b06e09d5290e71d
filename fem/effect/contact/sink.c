// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/contact/sink.h"

static void add_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  FemContactSink *sink = self;
  fem_matrix_add_outer(sink->matrix, count, vertices, w, sink->scale * scale);
}

static void add_dense(void *self, int count, const int *vertices, const double *matrix) {
  FemContactSink *sink = self;
  fem_matrix_add(sink->matrix, count, vertices, matrix, sink->scale);
}

ContactStiffnessSink fem_contact_sink_of(FemContactSink *sink) {
  return (ContactStiffnessSink){.self = sink, .add_outer = add_outer, .add_dense = add_dense};
}
