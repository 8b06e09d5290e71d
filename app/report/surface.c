// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/surface.h"

#include <string.h>

#include "base/memory.h"
#include "base/tet.h"
#include "fem/mesh/faces.h"

// A face with one entry in the list is on the surface.
static void take_face(AppReportSurface *surface, const FemMeshFace *face, const int *tets) {
  int *triangle = surface->triangles + 4 * (size_t)surface->triangle_count++;
  const int *corners = tet_faces[face->local];
  for (int k = 0; k < 3; k++) triangle[k] = tets[4 * (size_t)face->tet + (size_t)corners[k]];
  triangle[3] = face->tet;
}

Status app_report_surface_find(AppReportSurface *surface, const AppReportRun *run) {
  *surface = (AppReportSurface){0};
  FemMeshFace *faces;
  TRY(fem_mesh_faces_list(&faces, run->vertex_count, run->tet_count, (const int(*)[4])run->tets));
  const int face_count = 4 * run->tet_count;
  surface->triangles = memory_zeroed((size_t)face_count, 4 * sizeof *surface->triangles);
  if (surface->triangles)
    for (int begin = 0, end; begin < face_count; begin = end) {
      end = fem_mesh_faces_end(faces, face_count, begin);
      if (end - begin == 1) take_face(surface, &faces[begin], run->tets);
    }
  memory_free(faces);
  return surface->triangles ? STATUS_OK : status_no_memory("the surface of a run's mesh");
}

void app_report_surface_destroy(AppReportSurface *surface) {
  memory_free(surface->triangles);
  *surface = (AppReportSurface){0};
}

// Things that stay, in their order.
typedef struct Kept {
  int *places; // of each thing among those that stay, −1: it goes
  int count;
} Kept;

// Keeps what the triangles name in their corners `first` … `last`.
static bool keep_corners(Kept *kept, int thing_count, const AppReportSurface *surface, int first, int last) {
  kept->count = 0;
  kept->places = memory_zeroed((size_t)thing_count, sizeof *kept->places);
  if (!kept->places) return false;
  for (int t = 0; t < surface->triangle_count; t++)
    for (int k = first; k <= last; k++) kept->places[surface->triangles[4 * t + k]] = 1;
  for (int i = 0; i < thing_count; i++) kept->places[i] = kept->places[i] ? kept->count++ : -1;
  return true;
}

// Moves the rows of what stays to the front, frame by frame.
static void compact(double *values, int frame_count, int thing_count, const Kept *kept, size_t components) {
  double *target = values;
  for (int frame = 0; frame < frame_count; frame++)
    for (int i = 0; i < thing_count; i++) {
      if (kept->places[i] < 0) continue;
      const double *row = values + ((size_t)frame * (size_t)thing_count + (size_t)i) * components;
      memmove(target, row, components * sizeof *row);
      target += components;
    }
}

static void renumber(AppReportSurface *surface, const Kept *vertices, const Kept *tets) {
  for (int t = 0; t < surface->triangle_count; t++) {
    int *triangle = surface->triangles + 4 * (size_t)t;
    for (int k = 0; k < 3; k++) triangle[k] = vertices->places[triangle[k]];
    triangle[3] = tets->places[triangle[3]];
  }
}

Status app_report_surface_strip(AppReportSurface *surface, AppReportRun *run) {
  Kept vertices = {0}, tets = {0};
  bool ok = keep_corners(&vertices, run->vertex_count, surface, 0, 2) &&
            keep_corners(&tets, run->tet_count, surface, 3, 3);
  if (ok) {
    compact(run->positions, run->frame_count, run->vertex_count, &vertices, 3);
    for (int k = 0; k < run->field_count; k++) {
      AppReportField *field = &run->fields[k];
      compact(field->values, run->frame_count, field->is_cell ? run->tet_count : run->vertex_count,
              field->is_cell ? &tets : &vertices, 1);
    }
    renumber(surface, &vertices, &tets);
    run->vertex_count = vertices.count;
    run->tet_count = tets.count;
    memory_free(run->tets);
    run->tets = NULL;
  }
  memory_free(vertices.places);
  memory_free(tets.places);
  return ok ? STATUS_OK : status_no_memory("the surface of a run's mesh");
}
