// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/star_sink.h"

#include <string.h>

#include "base/memory.h"

// The most that carry two tetrahedra.
static int most_carriers(const ContactStars *stars) {
  int most = 0;
  for (int i = 0; i < stars->def.tet_count; i++) {
    int count = 0;
    for (int v = 0; v < 4; v++)
      count += stars->begin[stars->def.tets[i][v] + 1] - stars->begin[stars->def.tets[i][v]];
    most = count > most ? count : most;
  }
  return 2 * most < stars->given_vertex_count ? 2 * most : stars->given_vertex_count;
}

Status contact_star_sink_create(ContactStarSink *sink, const ContactStars *stars) {
  *sink = (ContactStarSink){.stars = stars};
  size_t count = (size_t)stars->given_vertex_count;
  sink->place = memory_zeroed(count, sizeof *sink->place);
  sink->vertices = memory_zeroed(count, sizeof *sink->vertices);
  sink->outer = memory_zeroed(3 * count, sizeof *sink->outer);
  size_t width = 3 * (size_t)most_carriers(stars);
  sink->dense = memory_zeroed(width * width, sizeof *sink->dense);
  return sink->place && sink->vertices && sink->outer && sink->dense ? STATUS_OK
                                                                     : status_no_memory("contact stiffness");
}

void contact_star_sink_destroy(ContactStarSink *sink) {
  memory_free(sink->vertices);
  memory_free(sink->place);
  memory_free(sink->outer);
  memory_free(sink->dense);
  *sink = (ContactStarSink){0};
}

size_t contact_star_sink_bytes(const ContactStarSink *sink) {
  const void *const arrays[] = {sink->vertices, sink->place, sink->outer, sink->dense};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
}

// Lists the carriers; place[] of them is set and has to be cleared.
static void list_carriers(ContactStarSink *sink, int count, const int *vertices) {
  const ContactStars *stars = sink->stars;
  sink->count = 0;
  for (int v = 0; v < count; v++)
    for (int r = stars->begin[vertices[v]]; r < stars->begin[vertices[v] + 1]; r++) {
      int *place = &sink->place[stars->nodes[r]];
      if (*place) continue;
      sink->vertices[sink->count] = stars->nodes[r];
      *place = ++sink->count;
    }
}

static void clear_places(ContactStarSink *sink) {
  for (int k = 0; k < sink->count; k++) sink->place[sink->vertices[k]] = 0;
}

void contact_star_sink_gather(ContactStarSink *sink, int count, const int *vertices) {
  list_carriers(sink, count, vertices);
  clear_places(sink);
}

static void add_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  ContactStarSink *sink = self;
  const ContactStars *stars = sink->stars;
  list_carriers(sink, count, vertices);
  memset(sink->outer, 0, 3 * (size_t)sink->count * sizeof(double));
  for (int v = 0; v < count; v++)
    for (int r = stars->begin[vertices[v]]; r < stars->begin[vertices[v] + 1]; r++)
      vec3_accumulate(sink->outer + 3 * (sink->place[stars->nodes[r]] - 1),
                      vec3_scale(stars->weights[r], vec3_at(w + 3 * v)));
  sink->to->add_outer(sink->to->self, sink->count, sink->vertices, sink->outer, scale);
  clear_places(sink);
}

// dense += Tᵀ block T of the vertices v, w.
static void add_block(ContactStarSink *sink, const int pair[2], const double *block, size_t stride) {
  const ContactStars *stars = sink->stars;
  size_t width = 3 * (size_t)sink->count;
  for (int r = stars->begin[pair[0]]; r < stars->begin[pair[0] + 1]; r++)
    for (int q = stars->begin[pair[1]]; q < stars->begin[pair[1] + 1]; q++) {
      double weight = stars->weights[r] * stars->weights[q];
      double *to = sink->dense + 3 * (size_t)(sink->place[stars->nodes[r]] - 1) * width +
                   3 * (size_t)(sink->place[stars->nodes[q]] - 1);
      for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++) to[i * width + j] += weight * block[i * stride + j];
    }
}

static void add_dense(void *self, int count, const int *vertices, const double *matrix) {
  ContactStarSink *sink = self;
  size_t stride = 3 * (size_t)count;
  list_carriers(sink, count, vertices);
  memset(sink->dense, 0, 9 * (size_t)sink->count * (size_t)sink->count * sizeof(double));
  for (int v = 0; v < count; v++)
    for (int w = 0; w < count; w++)
      add_block(sink, (int[]){vertices[v], vertices[w]}, matrix + 3 * (size_t)v * stride + 3 * w, stride);
  sink->to->add_dense(sink->to->self, sink->count, sink->vertices, sink->dense);
  clear_places(sink);
}

const ContactStiffnessSink *contact_star_sink_to(ContactStarSink *sink, const ContactStiffnessSink *to) {
  sink->to = to;
  sink->from = (ContactStiffnessSink){.self = sink, .add_outer = add_outer, .add_dense = add_dense};
  return &sink->from;
}
