// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/unseen/mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/files/file.h"
#include "base/files/temporary.h"
#include "base/memory.h"
#include "base/random.h"
#include "base/vec3.h"

#define BLOCK .grading = 1, .push = 1
const AppUnseenCase app_unseen_cases[] = {
    {"jittered",
     "six tetrahedra a cell, jittered by .15: as in training, other seeds",
     {.cells = {5, 5, 3}, .cell = {1, 1, 1}, .jitter = 0.15, BLOCK},
     {.cells = {4, 4, 3}, .cell = {0.83, 0.83, 0.83}, .jitter = 0.15, .turn = 0.7, .tilt = 0.05, BLOCK},
     0.35,
     0.9},
    {"aligned",
     "flat slabs whose inner faces coincide",
     {.cells = {6, 6, 3}, .cell = {1, 1, 1}, BLOCK},
     {.cells = {3, 3, 3}, .cell = {1, 1, 1}, BLOCK},
     0.3,
     1},
    {"five",
     "five tetrahedra a cell, mirrored from cell to cell",
     {.cells = {5, 5, 3}, .cell = {1, 1, 1}, .jitter = 0.1, .is_five = true, BLOCK},
     {.cells = {4, 4, 3}, .cell = {0.9, 0.9, 0.9}, .jitter = 0.2, .is_five = true, .turn = 0.3, BLOCK},
     0.35,
     0.9},
    {"graded",
     "cells that grow by 1.6 from one to the next",
     {.cells = {8, 8, 4}, .cell = {0.4, 0.4, 0.4}, .grading = 1.6, .jitter = 0.1, .push = 1},
     {.cells = {6, 6, 4}, .cell = {0.3, 0.3, 0.3}, .grading = 1.6, .jitter = 0.1, .turn = 0.5, .push = 1},
     0.2,
     0.6},
    {"slivers",
     "cells twelve times as wide as thick",
     {.cells = {5, 5, 6}, .cell = {1, 1, 0.08}, .jitter = 0.2, BLOCK},
     {.cells = {4, 4, 6}, .cell = {0.85, 0.85, 0.07}, .jitter = 0.2, .turn = 0.4, BLOCK},
     0.12,
     0.8},
    {"strained",
     "sheared by 45°, compressed to .5 and stretched to 1.5",
     {.cells = {5, 5, 3}, .cell = {1, 1, 1}, .jitter = 0.15, .grading = 1, .shear = 1, .push = 0.5},
     {.cells = {4, 4, 3},
      .cell = {0.8, 0.8, 0.8},
      .jitter = 0.15,
      .turn = 0.6,
      .grading = 1,
      .shear = -1,
      .push = 1.5},
     0.3,
     0.8},
    {"fine",
     "cells five times as small as the other's",
     {.cells = {4, 4, 2}, .cell = {1, 1, 1}, .jitter = 0.15, BLOCK},
     {.cells = {8, 8, 4}, .cell = {0.2, 0.2, 0.2}, .jitter = 0.15, .turn = 0.3, BLOCK},
     0.15,
     0.5},
    {"thin",
     "a sheet one cell thick on a block",
     {.cells = {5, 5, 3}, .cell = {1, 1, 1}, .jitter = 0.15, BLOCK},
     {.cells = {5, 5, 1}, .cell = {0.7, 0.7, 0.2}, .jitter = 0.1, .turn = 0.5, BLOCK},
     0.12,
     0.8},
    {"edge",
     "an edge on a block, the side faces at 45°",
     {.cells = {5, 5, 3}, .cell = {1, 1, 1}, .jitter = 0.15, BLOCK},
     {.cells = {4, 3, 3}, .cell = {0.8, 0.8, 0.8}, .jitter = 0.05, .turn = 0.2, .tilt = 0.785, BLOCK},
     0.35,
     0.8},
    {"made",
     "gmsh's Delaunay meshes",
     {.is_made = true, .growth = 1, .cells = {5, 5, 3}, .cell = {1, 1, 1}, BLOCK},
     {.is_made = true,
      .growth = 1,
      .cells = {4, 4, 3},
      .cell = {0.85, 0.85, 0.85},
      .turn = 0.3,
      .tilt = 0.03,
      BLOCK},
     0.35,
     0.9},
    {"adapted",
     "gmsh's with edges that grow threefold across the body, sheared and pressed",
     {.is_made = true, .growth = 3, .cells = {10, 10, 5}, .cell = {0.5, 0.5, 0.5}, BLOCK},
     {.is_made = true,
      .growth = 3,
      .cells = {8, 8, 5},
      .cell = {0.4, 0.4, 0.4},
      .turn = 0.6,
      .grading = 1,
      .shear = 0.4,
      .push = 0.8},
     0.2,
     0.6},
};
const int app_unseen_case_count = sizeof app_unseen_cases / sizeof *app_unseen_cases;

void app_unseen_mesh_destroy(AppUnseenMesh *mesh) {
  memory_free(mesh->rest), memory_free(mesh->x), memory_free(mesh->tets);
  *mesh = (AppUnseenMesh){0};
}

static int vertices_of(const AppUnseenBody *body, const FemMesh *made) {
  return body->is_made ? made->vertex_count
                       : (body->cells[0] + 1) * (body->cells[1] + 1) * (body->cells[2] + 1);
}

static int tets_of(const AppUnseenBody *body, const FemMesh *made) {
  return body->is_made ? made->tet_count
                       : (body->is_five ? 5 : 6) * body->cells[0] * body->cells[1] * body->cells[2];
}

// Where line i of an axis is, and how wide the cells beside it are: from the surface down, and from the
// middle to either side.
static double line_at(const AppUnseenBody *body, int axis, int i, double *width) {
  double middle = axis < 2 ? 0.5 * body->cells[axis] : 0, steps = fabs(i - middle), at = 0;
  *width = body->cell[axis];
  for (double s = 0; s < steps; s++) {
    double part = fmin(1, steps - s);
    at += part * *width;
    *width *= body->grading;
  }
  return i < middle ? -at : at;
}

static Vec3 place_vertex(const AppUnseenBody *body, const int index[3], Random *random) {
  double x[3], width;
  for (int c = 0; c < 3; c++) {
    x[c] = line_at(body, c, index[c], &width);
    x[c] += width / fmax(1, body->grading) * body->jitter * random_between(random, -1, 1);
  }
  return vec3_at(x);
}

static Vec3 turned(const AppUnseenBody *body, Vec3 x) {
  double ca = cos(body->turn), sa = sin(body->turn), cb = cos(body->tilt), sb = sin(body->tilt);
  Vec3 y = {ca * x.x - sa * x.y, sa * x.x + ca * x.y, x.z};
  return (Vec3){y.x, cb * y.y - sb * y.z, sb * y.y + cb * y.z};
}

// `down`: −1 for the lower body, whose layers go down from its surface.
static void add_vertex(AppUnseenMesh *mesh, const AppUnseenBody *body, double down, Vec3 x) {
  x.z *= down;
  Vec3 strained = {x.x + body->shear * x.z, x.y, body->push * x.z};
  vec3_store(mesh->rest + 3 * mesh->vertex_count, turned(body, x));
  vec3_store(mesh->x + 3 * mesh->vertex_count++, turned(body, strained));
}

static void add_vertices(AppUnseenMesh *mesh, const AppUnseenBody *body, double down, Random *random) {
  for (int k = 0; k <= body->cells[2]; k++)
    for (int j = 0; j <= body->cells[1]; j++)
      for (int i = 0; i <= body->cells[0]; i++)
        add_vertex(mesh, body, down, place_vertex(body, (int[]){i, j, k}, random));
}

static void add_tet(AppUnseenMesh *mesh, const int corners[8], const int which[4]) {
  int *tet = mesh->tets[mesh->tet_count++];
  for (int v = 0; v < 4; v++) tet[v] = corners[which[v]];
  Vec3 edge[3], origin = vec3_at(mesh->rest + 3 * tet[0]);
  for (int e = 0; e < 3; e++) edge[e] = vec3_sub(vec3_at(mesh->rest + 3 * tet[e + 1]), origin);
  if (vec3_dot(edge[0], vec3_cross(edge[1], edge[2])) > 0) return;
  int kept = tet[2];
  tet[2] = tet[3], tet[3] = kept;
}

// Corners of a cell by the bits of their number, x lowest.
static void add_cell(AppUnseenMesh *mesh, const AppUnseenBody *body, const int corners[8], bool is_odd) {
  static const int fives[2][5][4] = {{{0, 3, 5, 6}, {0, 3, 5, 1}, {0, 3, 6, 2}, {0, 5, 6, 4}, {3, 5, 6, 7}},
                                     {{1, 2, 4, 7}, {1, 2, 4, 0}, {1, 2, 7, 3}, {1, 4, 7, 5}, {2, 4, 7, 6}}};
  static const int sixes[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7},
                                  {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};
  if (body->is_five)
    for (int t = 0; t < 5; t++) add_tet(mesh, corners, fives[is_odd][t]);
  else
    for (int t = 0; t < 6; t++) add_tet(mesh, corners, sixes[t]);
}

static void add_cells(AppUnseenMesh *mesh, const AppUnseenBody *body, int first) {
  int stride[3] = {1, body->cells[0] + 1, (body->cells[0] + 1) * (body->cells[1] + 1)};
  for (int k = 0; k < body->cells[2]; k++)
    for (int j = 0; j < body->cells[1]; j++)
      for (int i = 0; i < body->cells[0]; i++) {
        int corners[8];
        for (int c = 0; c < 8; c++)
          corners[c] = first + (i + (c & 1)) + (j + (c >> 1 & 1)) * stride[1] + (k + (c >> 2)) * stride[2];
        add_cell(mesh, body, corners, (i + j + k) % 2);
      }
}

static void add_made(AppUnseenMesh *mesh, const AppUnseenBody *body, const FemMesh *made, double down,
                     int first) {
  for (int v = 0; v < made->vertex_count; v++) add_vertex(mesh, body, down, vec3_at(made->rest + 3 * v));
  for (int t = 0; t < made->tet_count; t++) {
    int corners[8] = {0};
    for (int v = 0; v < 4; v++) corners[v] = first + made->tets[t][v];
    add_tet(mesh, corners, (const int[]){0, 1, 2, 3});
  }
}

static void add_body(AppUnseenMesh *mesh, const AppUnseenBody *body, const FemMesh *made, int number,
                     Random *random) {
  static const char *const names[] = {"lower", "upper"};
  ContactBody *range = &mesh->bodies[number];
  *range =
      (ContactBody){.name = names[number], .vertex_begin = mesh->vertex_count, .tet_begin = mesh->tet_count};
  if (body->is_made) {
    add_made(mesh, body, made, number ? 1 : -1, range->vertex_begin);
  } else {
    add_vertices(mesh, body, number ? 1 : -1, random);
    add_cells(mesh, body, range->vertex_begin);
  }
  range->vertex_end = mesh->vertex_count, range->tet_end = mesh->tet_count;
}

static void lay_on_ground(const AppUnseenMesh *mesh) {
  const ContactBody *upper = &mesh->bodies[1];
  double lowest = INFINITY;
  for (int v = upper->vertex_begin; v < upper->vertex_end; v++) lowest = fmin(lowest, mesh->x[3 * v + 2]);
  for (int v = upper->vertex_begin; v < upper->vertex_end; v++)
    mesh->x[3 * v + 2] -= lowest, mesh->rest[3 * v + 2] -= lowest;
}

// The ground face, drawn up by extrusion.
static Status write_box(const char *path, const double size[3], double edge, double growth) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  fprintf(writer.stream, "Mesh.Algorithm3D = 1;\n"); // Delaunay; others are not the same at every call
  for (int p = 0; p < 4; p++)
    fprintf(writer.stream, "Point(%d) = {%.17g, %.17g, 0, %.17g};\n", p + 1, (p % 3 ? 0.5 : -0.5) * size[0],
            (p > 1 ? 0.5 : -0.5) * size[1], edge * (p % 3 ? growth : 1));
  for (int p = 0; p < 4; p++) fprintf(writer.stream, "Line(%d) = {%d, %d};\n", p + 1, p + 1, (p + 1) % 4 + 1);
  fprintf(writer.stream, "Curve Loop(1) = {1, 2, 3, 4};\nPlane Surface(1) = {1};\n");
  fprintf(writer.stream, "body[] = Extrude {0, 0, %.17g} { Surface{1}; };\n", size[2]);
  return file_commit(&writer);
}

// A box of that size, its middle over x = y = 0, from z = 0 up, filled by Delaunay tetrahedra with edges of
// about `edge` at one end and `growth` times that at the other, along x.
static Status make_box(FemMesh *mesh, const double size[3], double edge, double growth) {
  char *path;
  TRY(temporary_file("unseen", ".geo", &path));
  Status status = write_box(path, size, edge, growth);
  if (!status) status = fem_mesh_read(mesh, path, NULL, NULL);
  temporary_remove(path);
  return status;
}

static Status make(FemMesh *made, const AppUnseenBody *body, uint64_t seed) {
  double size[3];
  for (int c = 0; c < 3; c++) size[c] = body->cells[c] * body->cell[c];
  return body->is_made ? make_box(made, size, body->cell[0] * (1 + 0.05 * (double)(seed % 5)), body->growth)
                       : STATUS_OK;
}

static Status put_together(AppUnseenMesh *mesh, const AppUnseenCase *what, const FemMesh made[2],
                           uint64_t seed) {
  size_t vertices = (size_t)(vertices_of(&what->lower, &made[0]) + vertices_of(&what->upper, &made[1]));
  size_t tets = (size_t)(tets_of(&what->lower, &made[0]) + tets_of(&what->upper, &made[1]));
  *mesh = (AppUnseenMesh){.rest = memory_zeroed(3 * vertices, sizeof(double)),
                          .x = memory_zeroed(3 * vertices, sizeof(double)),
                          .tets = memory_zeroed(tets, sizeof *mesh->tets)};
  if (!mesh->rest || !mesh->x || !mesh->tets) {
    app_unseen_mesh_destroy(mesh);
    return status_no_memory("a case's meshes");
  }
  Random random = random_seeded(seed, 0);
  add_body(mesh, &what->lower, &made[0], 0, &random);
  add_body(mesh, &what->upper, &made[1], 1, &random);
  lay_on_ground(mesh);
  return STATUS_OK;
}

Status app_unseen_mesh_create(AppUnseenMesh *mesh, const AppUnseenCase *what, uint64_t seed) {
  FemMesh made[2] = {{0}};
  *mesh = (AppUnseenMesh){0};
  Status status = make(&made[0], &what->lower, seed);
  if (!status) status = make(&made[1], &what->upper, seed + 1);
  if (!status) status = put_together(mesh, what, made, seed);
  fem_mesh_destroy(&made[0]), fem_mesh_destroy(&made[1]);
  return status;
}
