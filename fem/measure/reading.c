// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/measure/reading.h"

#include <assert.h>
#include <math.h>

#include "base/vec3.h"

static_assert(sizeof(FemReading) == FEM_READING_COUNT * sizeof(double), "titles[] names every value");
static_assert(sizeof(FemReadings) == FEM_READINGS_KEPT * sizeof(double), "numbers only");

const char *fem_reading_title(int value) {
  static const char *const titles[FEM_READING_COUNT] = {
      "force_x_N",   "force_y_N", "force_z_N",        "moment_x_Nm",      "moment_y_Nm",     "moment_z_Nm",
      "pressure_Pa", "area_m2",   "displacement_x_m", "displacement_y_m", "displacement_z_m"};
  return titles[value];
}

static Vec3 place(const double *positions, int vertex) {
  return vec3_at(positions + 3 * (size_t)vertex);
}

// Σ area vectors; `*area`: Σ areas.
static Vec3 add_areas(const FemProbe *probe, const double *positions, double *area) {
  Vec3 sum = {0, 0, 0};
  *area = 0;
  for (int t = 0; t < probe->triangle_count; t++) {
    const int *v = probe->triangles[t];
    Vec3 a = place(positions, v[0]), ab = vec3_sub(place(positions, v[1]), a),
         ac = vec3_sub(place(positions, v[2]), a);
    Vec3 one = vec3_scale(0.5, vec3_cross(ab, ac));
    sum = vec3_add(sum, one);
    *area += vec3_length(one);
  }
  return sum;
}

FemReading fem_reading_take(const FemProbe *probe, const double *rest, const double *positions,
                            const double *external) {
  FemReading reading = {0};
  Vec3 centre = {0, 0, 0}, start = {0, 0, 0}, force = {0, 0, 0}, moment = {0, 0, 0};
  double share = 1.0 / probe->vertex_count;
  for (int i = 0; i < probe->vertex_count; i++) {
    centre = vec3_add(centre, vec3_scale(share, place(positions, probe->vertices[i])));
    start = vec3_add(start, vec3_scale(share, place(rest, probe->vertices[i])));
  }
  for (int i = 0; i < probe->vertex_count; i++) {
    Vec3 one = place(external, probe->vertices[i]),
         arm = vec3_sub(place(positions, probe->vertices[i]), centre);
    force = vec3_add(force, one);
    moment = vec3_add(moment, vec3_cross(arm, one));
  }
  Vec3 normal = add_areas(probe, positions, &reading.area);
  vec3_store(reading.force, force);
  vec3_store(reading.moment, moment);
  vec3_store(reading.displacement, vec3_sub(centre, start));
  reading.pressure = -vec3_dot(force, normal) / (vec3_length(normal) * reading.area);
  return reading;
}

static void keep_largest(double value, double time, double *largest, double *when) {
  if (!(value > *largest)) return;
  *largest = value;
  *when = time;
}

void fem_readings_add(FemReadings *readings, const FemReading *reading, double time) {
  readings->last = *reading;
  keep_largest(vec3_length(vec3_at(reading->force)), time, &readings->largest_force,
               &readings->largest_force_time);
  keep_largest(vec3_length(vec3_at(reading->displacement)), time, &readings->largest_displacement,
               &readings->largest_displacement_time);
}
