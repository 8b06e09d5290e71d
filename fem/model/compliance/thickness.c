// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/thickness.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/surface/surface.h"
#include "fem/model/compliance/extent.h"

enum { MOST_SAMPLES = 400 };
static const double SLENDER = 5, MOSTLY = 0.5;

// At one triangle.
typedef struct Sample {
  double area, thickness, layers;
} Sample;

static Vec3 place(const FemModel *model, int vertex) {
  return vec3_at(model->rest + 3 * (size_t)vertex);
}

// Where the ray x + t d meets the triangle: t, INFINITY: nowhere (Möller and Trumbore 1997).
static double meet(const FemModel *model, const int vertices[3], Vec3 x, Vec3 d) {
  Vec3 a = place(model, vertices[0]), ab = vec3_sub(place(model, vertices[1]), a),
       ac = vec3_sub(place(model, vertices[2]), a), p = vec3_cross(d, ac), arm = vec3_sub(x, a);
  double det = vec3_dot(ab, p);
  if (det == 0) return INFINITY;
  Vec3 q = vec3_cross(arm, ab);
  double u = vec3_dot(arm, p) / det, v = vec3_dot(d, q) / det, t = vec3_dot(ac, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : INFINITY;
}

static Sample measure_sample(const FemModel *model, const ContactSurface *surface, int f) {
  const ContactSurfaceFace *face = &surface->faces[f];
  Vec3 a = place(model, face->vertices[0]), b = place(model, face->vertices[1]),
       c = place(model, face->vertices[2]), apex = place(model, model->tets[face->tet][face->corner]);
  Vec3 cross = vec3_cross(vec3_sub(b, a), vec3_sub(c, a)),
       middle = vec3_scale(1.0 / 3, vec3_add(a, vec3_add(b, c)));
  Vec3 inwards = vec3_scale(1 / vec3_length(cross), cross);
  double height = vec3_dot(inwards, vec3_sub(apex, a));
  if (height < 0) inwards = vec3_scale(-1, inwards), height = -height;
  Sample sample = {.area = 0.5 * vec3_length(cross), .thickness = INFINITY};
  for (int g = 0; g < surface->count; g++)
    if (g != f)
      sample.thickness = fmin(sample.thickness, meet(model, surface->faces[g].vertices, middle, inwards));
  sample.layers = sample.thickness / height;
  return sample;
}

static int by_thickness(const void *a, const void *b) {
  double p = ((const Sample *)a)->thickness, q = ((const Sample *)b)->thickness;
  return (p > q) - (p < q);
}

static int by_layers(const void *a, const void *b) {
  double p = ((const Sample *)a)->layers, q = ((const Sample *)b)->layers;
  return (p > q) - (p < q);
}

// The first at which half of the area is passed.
static const Sample *median(const Sample *samples, int count) {
  double all = 0, passed = 0;
  for (int i = 0; i < count; i++) all += samples[i].area;
  for (int i = 0; i < count; i++)
    if ((passed += samples[i].area) >= 0.5 * all) return &samples[i];
  return &samples[count - 1];
}

static void find_medians(Sample *samples, int count, double length, FemThickness *thickness) {
  double all = 0, thin = 0;
  int kept = 0;
  for (int i = 0; i < count; i++) {
    all += samples[i].area;
    if (!(samples[i].thickness <= length / SLENDER)) continue;
    thin += samples[i].area;
    samples[kept++] = samples[i];
  }
  thickness->is_slender = kept > 0 && thin >= MOSTLY * all;
  if (!thickness->is_slender) return;
  qsort(samples, (size_t)kept, sizeof *samples, by_thickness);
  thickness->thickness = median(samples, kept)->thickness;
  qsort(samples, (size_t)kept, sizeof *samples, by_layers);
  thickness->layers = median(samples, kept)->layers;
}

Status fem_thickness_find(const FemModel *model, int body, FemThickness *thickness) {
  const FemModelBody *range = &model->bodies[body];
  ContactSurface surface;
  FemExtent extent;
  *thickness = (FemThickness){0};
  TRY(fem_extent_measure(model, body, &extent));
  TRY(contact_surface_find(&surface, (const int(*)[4])model->tets, range->tet_begin, range->tet_end));
  int count = surface.count < MOST_SAMPLES ? surface.count : MOST_SAMPLES;
  Sample *samples = memory_zeroed((size_t)count, sizeof *samples);
  for (int i = 0; samples && i < count; i++)
    samples[i] = measure_sample(model, &surface, (int)((long long)i * surface.count / count));
  if (samples) find_medians(samples, count, extent.length, thickness);
  memory_free(samples);
  contact_surface_destroy(&surface);
  return samples ? STATUS_OK : status_no_memory("the thickness of a body");
}
