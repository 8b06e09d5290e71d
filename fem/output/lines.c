// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/lines.h"

#include <math.h>
#include <stdio.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "fem/measure/stress.h"

static const char titles[] =
    "line,time_s,way_m,x_m,y_m,z_m,displacement_x_m,displacement_y_m,displacement_z_m,"
    "stress_xx_Pa,stress_yy_Pa,stress_zz_Pa,stress_xy_Pa,stress_yz_Pa,stress_xz_Pa,von_mises_Pa,"
    "contact_pressure_Pa\n";

static void print_numbers(FILE *stream, const double *values, int count) {
  for (int k = 0; k < count; k++)
    if (isnan(values[k]))
      fputs(",nan", stream);
    else
      fprintf(stream, ",%.10g", values[k]);
}

static void print_point(FILE *stream, const FemSystem *system, const FemState *state, const double *pressures,
                        const FemLinePoint *point) {
  const FemModel *model = system->model;
  double stress[6], place[3] = {0}, moved[3] = {0}, pressure = pressures && point->is_surface ? 0 : NAN;
  for (int k = 0; k < 4; k++) {
    size_t v = (size_t)model->tets[point->tet][k];
    for (int c = 0; c < 3; c++) {
      place[c] += point->shares[k] * state->positions[3 * v + (size_t)c];
      moved[c] += point->shares[k] * (state->positions[3 * v + (size_t)c] - model->rest[3 * v + (size_t)c]);
    }
    if (!isnan(pressure)) pressure += point->shares[k] * pressures[v];
  }
  fem_stress_find(system, state, point->tet, stress);
  const double mises = fem_stress_von_mises(stress);
  print_numbers(stream, &state->time, 1);
  print_numbers(stream, &point->way, 1);
  print_numbers(stream, place, 3);
  print_numbers(stream, moved, 3);
  print_numbers(stream, stress, 6);
  print_numbers(stream, &mises, 1);
  print_numbers(stream, &pressure, 1);
  fputc('\n', stream);
}

Status fem_lines_write(const FemSystem *system, const FemState *state, const double *pressures,
                       const char *directory, int frame) {
  const FemModel *model = system->model;
  FileWriter file;
  char name[32];
  if (model->line_count == 0) return STATUS_OK;
  snprintf(name, sizeof name, "lines_%05d.csv", frame);
  char *path = file_join(directory, name);
  if (!path) return status_no_memory("a file name");
  Status status = file_begin(&file, path);
  memory_free(path);
  TRY(status);
  fputs(titles, file.stream);
  for (int l = 0; l < model->line_count; l++)
    for (int k = 0; k < model->lines[l].count; k++) {
      fputs(model->lines[l].def->name, file.stream);
      print_point(file.stream, system, state, pressures, &model->lines[l].points[k]);
    }
  return file_commit(&file);
}
