// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/star_sink.h"

#include <string.h>

#include "base/memory.h"

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

// Of what the contact mesh has in place of one element, at most: the corners of its cells, and what carries
// them.
static void find_most(ContactStarSink *sink, int *corners, int *carriers) {
  const ContactStars *stars = sink->stars;
  *corners = *carriers = 0;
  for (int begin = 0, end; begin < stars->def.tet_count; begin = end) {
    for (end = begin; end < stars->def.tet_count && stars->origin[end] == stars->origin[begin];) end++;
    list_carriers(sink, 4 * (end - begin), stars->def.tets[begin]);
    clear_places(sink);
    if (4 * (end - begin) > *corners) *corners = 4 * (end - begin);
    if (sink->count > *carriers) *carriers = sink->count;
  }
}

Status contact_star_sink_create(ContactStarSink *sink, const ContactStars *stars) {
  *sink = (ContactStarSink){.stars = stars};
  int corners, carriers;
  size_t count = (size_t)stars->given_vertex_count;
  sink->place = memory_zeroed(count, sizeof *sink->place);
  sink->vertices = memory_zeroed(count, sizeof *sink->vertices);
  sink->outer = memory_zeroed(3 * count, sizeof *sink->outer);
  if (!sink->place || !sink->vertices || !sink->outer) return status_no_memory("contact stiffness");
  find_most(sink, &corners, &carriers);
  size_t width = 2 * 3 * (size_t)carriers;
  sink->half = memory_zeroed(2 * 3 * (size_t)corners * width, sizeof *sink->half);
  sink->dense = memory_zeroed(width * width, sizeof *sink->dense);
  return sink->half && sink->dense ? STATUS_OK : status_no_memory("contact stiffness");
}

void contact_star_sink_destroy(ContactStarSink *sink) {
  memory_free(sink->vertices);
  memory_free(sink->place);
  memory_free(sink->outer);
  memory_free(sink->half);
  memory_free(sink->dense);
  *sink = (ContactStarSink){0};
}

size_t contact_star_sink_bytes(const ContactStarSink *sink) {
  const void *const arrays[] = {sink->vertices, sink->place, sink->outer, sink->half, sink->dense};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
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

// half = matrix T, (3 count, 3 carriers).
static void spread_columns(ContactStarSink *sink, int count, const int *vertices, const double *matrix) {
  const ContactStars *stars = sink->stars;
  size_t rows = 3 * (size_t)count, width = 3 * (size_t)sink->count;
  memset(sink->half, 0, rows * width * sizeof(double));
  for (int w = 0; w < count; w++)
    for (int r = stars->begin[vertices[w]]; r < stars->begin[vertices[w] + 1]; r++) {
      double *to = sink->half + 3 * (size_t)(sink->place[stars->nodes[r]] - 1);
      for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < 3; j++)
          to[i * width + j] += stars->weights[r] * matrix[i * rows + 3 * (size_t)w + j];
    }
}

// dense = Tᵀ half, (3 carriers, 3 carriers).
static void spread_rows(ContactStarSink *sink, int count, const int *vertices) {
  const ContactStars *stars = sink->stars;
  size_t block = 3 * 3 * (size_t)sink->count; // three rows
  memset(sink->dense, 0, block * (size_t)sink->count * sizeof(double));
  for (int v = 0; v < count; v++)
    for (int r = stars->begin[vertices[v]]; r < stars->begin[vertices[v] + 1]; r++) {
      double *to = sink->dense + block * (size_t)(sink->place[stars->nodes[r]] - 1);
      const double *from = sink->half + block * (size_t)v, weight = stars->weights[r];
      for (size_t k = 0; k < block; k++) to[k] += weight * from[k];
    }
}

static void add_dense(void *self, int count, const int *vertices, const double *matrix) {
  ContactStarSink *sink = self;
  list_carriers(sink, count, vertices);
  spread_columns(sink, count, vertices, matrix);
  spread_rows(sink, count, vertices);
  sink->to->add_dense(sink->to->self, sink->count, sink->vertices, sink->dense);
  clear_places(sink);
}

const ContactStiffnessSink *contact_star_sink_to(ContactStarSink *sink, const ContactStiffnessSink *to) {
  sink->to = to;
  sink->from = (ContactStiffnessSink){.self = sink, .add_outer = add_outer, .add_dense = add_dense};
  return &sink->from;
}
