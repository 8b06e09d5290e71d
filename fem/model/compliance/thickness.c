// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/thickness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/surface/surface.h"
#include "fem/model/compliance/extent.h"
#include "fem/model/limits.h"

enum { MOST_SAMPLES = 400 };
static const double SLENDER = 5, THICK = 3, MOSTLY = 0.5;
// To either side of the median, of what makes a wall: without a jump where the half of an area becomes thin.
static const double BAND = 0.1;

// At one triangle.
typedef struct Sample {
  double area, thickness, layers;
} Sample;

static Vec3 place(const FemModel *model, int vertex) {
  return vec3_at(model->rest + 3 * (size_t)vertex);
}

static Sample measure_sample(const FemModel *model, const ContactSurface *surface,
                             const ContactSurfaceFace *face) {
  Vec3 a = place(model, face->vertices[0]), b = place(model, face->vertices[1]),
       c = place(model, face->vertices[2]), apex = place(model, model->tets[face->tet][face->corner]);
  Vec3 cross = vec3_cross(vec3_sub(b, a), vec3_sub(c, a)),
       middle = vec3_scale(1.0 / 3, vec3_add(a, vec3_add(b, c)));
  Vec3 inwards = vec3_scale(1 / vec3_length(cross), cross);
  double height = vec3_dot(inwards, vec3_sub(apex, a));
  if (height < 0) inwards = vec3_scale(-1, inwards), height = -height;
  Sample sample = {.area = 0.5 * vec3_length(cross),
                   .thickness = contact_surface_meet(surface, face, middle, inwards)};
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

// Of samples in order: the mean over the middle of the area. What differs from the median by rounding is the
// median.
static double typical(const Sample *samples, int count) {
  const double middle = median(samples, count)->thickness;
  double all = 0, passed = 0, sum = 0;
  for (int i = 0; i < count; i++) all += samples[i].area;
  for (int i = 0; i < count; i++) {
    double from = fmax(passed, (0.5 - BAND) * all), to = fmin(passed += samples[i].area, (0.5 + BAND) * all);
    double more = samples[i].thickness - middle;
    if (to > from && fabs(more) > FEM_ROUNDING * middle) sum += (to - from) * more;
  }
  return middle + sum / (2 * BAND * all);
}

// Between a fifth and a third of the length the wall of what is hollow goes over into the height.
static double wall_of(Sample *samples, int count, const FemExtent *extent) {
  qsort(samples, (size_t)count, sizeof *samples, by_thickness);
  double thickness = typical(samples, count), least = extent->length / SLENDER;
  double share = fmin(fmax((thickness - least) / (extent->length / THICK - least), 0), 1);
  if (!(thickness < (1 - FEM_ROUNDING) * extent->height) || share == 1) return extent->height;
  return thickness + share * (extent->height - thickness);
}

// At every so manieth face, in the order in which they were found.
static Status measure_samples(const FemModel *model, ContactSurface *surface, int count, Sample *samples) {
  ContactSurfaceFace *faces = memory_zeroed((size_t)count, sizeof *faces);
  if (!faces) return status_no_memory("the thickness of a body");
  for (int i = 0; i < count; i++) faces[i] = surface->faces[(long long)i * surface->count / count];
  Status status = contact_surface_index(surface, model->rest);
  for (int i = 0; i < count && !status; i++) samples[i] = measure_sample(model, surface, &faces[i]);
  memory_free(faces);
  return status;
}

Status fem_thickness_find(const FemModel *model, int body, FemThickness *thickness) {
  const FemModelBody *range = &model->bodies[body];
  ContactSurface surface;
  FemExtent extent;
  *thickness = (FemThickness){0};
  TRY(fem_extent_measure(model, body, &extent));
  TRY(contact_surface_find(&surface, (const int(*)[4])model->tets, range->tet_begin, range->tet_end));
  int count = surface.count < MOST_SAMPLES ? surface.count : MOST_SAMPLES;
  Sample *samples = memory_zeroed(2 * (size_t)count, sizeof *samples);
  Status status = samples ? measure_samples(model, &surface, count, samples)
                          : status_no_memory("the thickness of a body");
  if (!status) {
    memcpy(samples + count, samples, (size_t)count * sizeof *samples);
    find_medians(samples, count, extent.length, thickness);
    thickness->wall = wall_of(samples + count, count, &extent);
  }
  memory_free(samples);
  contact_surface_destroy(&surface);
  return status;
}
