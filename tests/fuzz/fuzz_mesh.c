// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes: every reader of ours, and the gate that every mesh passes. The first byte chooses:
//
//   'T'  TetGen: a .node file, a zero byte, an .ele file        'A'  raw arrays: counts, positions, indices
//   'M', 'D', 'V'  what is asked of a .msh, a MEDIT .mesh, a legacy .vtk before gmsh gets it
//   'F'  a frame (.vtu) that `tetlap report` reads back
//
// What gmsh itself reads it reads in a process of its own, which is not fuzzed.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../fem/mesh/from_arrays.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/mesh/mesh.h"
#include "fem/mesh/reader/header.h"
#include "fem/mesh/reader/tetgen.h"
#include "fem/mesh/validate.h"
#include "fem/output/vtk/vtu.h"
#include "fem/output/vtk/vtu_read.h"
#include "target.h"

static void check_refusal(Status status) {
  FUZZ_CLAIM(status == STATUS_INPUT, "status %d: %s", (int)status, status_message());
  FUZZ_CLAIM(strlen(status_message()) > 8, "message '%s'", status_message());
}

// What fem/mesh/mesh.h promises of every mesh, and that its measures can be taken.
static void check_mesh(const FemMesh *mesh) {
  FUZZ_CLAIM(mesh->tet_count > 0 && mesh->vertex_count >= 4, "%d tetrahedra", mesh->tet_count);
  for (int t = 0; t < mesh->tet_count; t++) {
    Vec3 x[4];
    for (int k = 0; k < 4; k++) {
      int v = mesh->tets[t][k];
      FUZZ_CLAIM(v >= 0 && v < mesh->vertex_count, "vertex %d of %d", v, mesh->vertex_count);
      x[k] = vec3_at(mesh->rest + 3 * (size_t)v);
    }
    double det = vec3_det4(x[0], x[1], x[2], x[3]);
    FUZZ_CLAIM(det > 0, "element %d: 6 V = %g", t, det);
  }
  for (int g = 0; g < mesh->group_count; g++)
    for (int k = 0; k < mesh->groups[g].vertex_count; k++) {
      const int *list = mesh->groups[g].vertices;
      FUZZ_CLAIM(list[k] >= 0 && list[k] < mesh->vertex_count && (k == 0 || list[k] > list[k - 1]),
                 "group %s", mesh->groups[g].name);
    }
  FemMeshQuality quality;
  FUZZ_CLAIM(fem_mesh_quality(mesh, &quality) == STATUS_OK, "%s", status_message());
  FemMeshCurvature curvature;
  FUZZ_CLAIM(fem_mesh_curvature(mesh, &curvature) == STATUS_OK, "%s", status_message());
  FUZZ_CLAIM(quality.volume > 0 && quality.surface_triangle_count >= 4, "volume %g, %d triangles",
             quality.volume, quality.surface_triangle_count);
}

// With the nodes that a second-order file has: refused, or as sound as any.
static void promote(FemMesh *mesh) {
  Status status = fem_mesh_make_quadratic(mesh);
  if (status)
    check_refusal(status);
  else
    check_mesh(mesh);
}

static void validate(FemMeshSource *source) {
  FemMesh mesh;
  Status status = fem_mesh_validate(&mesh, source, "fuzz", NULL);
  if (status)
    check_refusal(status);
  else
    check_mesh(&mesh);
  if (!status && mesh.middles) promote(&mesh);
  fem_mesh_destroy(&mesh);
}

static void run_tetgen(const uint8_t *data, size_t size) {
  const uint8_t *zero = memchr(data, 0, size);
  size_t length = zero ? (size_t)(zero - data) : size;
  const char *path = fuzz_target_file("fuzz.node", data, length);
  fuzz_target_file("fuzz.ele", zero ? zero + 1 : data, zero ? size - length - 1 : 0);
  FemMeshSource source;
  Status status = fem_mesh_tetgen_read(&source, path);
  if (status)
    check_refusal(status);
  else
    validate(&source);
  fem_mesh_source_destroy(&source);
}

static void run_header(FemMeshFormat format, const uint8_t *data, size_t size) {
  FemMeshHeader header;
  Status status = fem_mesh_header_check(fuzz_target_file("fuzz.header", data, size), format, &header);
  if (status) check_refusal(status);
  if (!status)
    FUZZ_CLAIM(header.tet_count >= -1 && header.size == size, "%lld tetrahedra in %zu bytes",
               header.tet_count, header.size);
}

// Two counts, then as many positions and corners as there are bytes for.
static void run_arrays(const uint8_t *data, size_t size) {
  if (size < 2) return;
  size_t vertices = data[0], tets = data[1];
  double *positions = memory_zeroed(3 * vertices, sizeof *positions);
  int *corners = memory_zeroed(4 * tets, sizeof *corners);
  FUZZ_CLAIM(positions && corners, "no memory");
  data += 2, size -= 2;
  size_t part = size < 24 * vertices ? size : 24 * vertices;
  memcpy(positions, data, part);
  data += part, size -= part;
  for (size_t i = 0; i < 4 * tets && i < size; i++) corners[i] = (int8_t)data[i];
  FemMesh mesh;
  Status status = mesh_from_arrays(&mesh, "fuzz", (int)vertices, positions, (int)tets, corners, NULL);
  if (status)
    check_refusal(status);
  else
    check_mesh(&mesh);
  fem_mesh_destroy(&mesh);
  memory_free(positions);
  memory_free(corners);
}

static void run_frame(const uint8_t *data, size_t size) {
  FemVtuContent content;
  Status status = fem_vtu_read(fuzz_target_file("fuzz.vtu", data, size), &content);
  if (status) {
    check_refusal(status);
    return;
  }
  for (int i = 0; i < fem_vtu_corner_count(content.cell) * content.cell_count; i++)
    FUZZ_CLAIM(content.cells[i] >= 0 && content.cells[i] < content.vertex_count, "corner %d",
               content.cells[i]);
  fem_vtu_read_destroy(&content);
}

static void run(const uint8_t *data, size_t size) {
  if (size == 0) return;
  switch (data[0]) {
  case 'T':
    run_tetgen(data + 1, size - 1);
    break;
  case 'M':
    run_header(FEM_MESH_FORMAT_MSH, data + 1, size - 1);
    break;
  case 'D':
    run_header(FEM_MESH_FORMAT_MEDIT, data + 1, size - 1);
    break;
  case 'V':
    run_header(FEM_MESH_FORMAT_VTK, data + 1, size - 1);
    break;
  case 'A':
    run_arrays(data + 1, size - 1);
    break;
  case 'F':
    run_frame(data + 1, size - 1);
    break;
  default:
    break;
  }
}

// Files of the tests, each behind its letter.
static size_t seed_file(char letter, const char *name, uint8_t *data) {
  data[0] = (uint8_t)letter;
  return 1 + fuzz_target_source(name, data + 1, FUZZ_MAX_INPUT - 1);
}

static size_t seed_tetgen(uint8_t *data) {
  size_t size = seed_file('T', "tests/data/mesh/box.node", data);
  data[size++] = 0;
  return size + fuzz_target_source("tests/data/mesh/box.ele", data + size, FUZZ_MAX_INPUT - size);
}

// Two tetrahedra on both sides of a triangle, in numbers that are written short.
static size_t seed_small_tetgen(uint8_t *data) {
  static const char text[] = "T5 3 1 1\n0 0 0 0 9 1\n1 1 0 0 9 1\n2 0 1 0 9 2\n3 0 0 1 9 0\n4 1 1 1 9 -3\n"
                             "\0"
                             "2 4 1\n0 0 1 2 3 7\n1 1 2 3 4 8\n";
  memcpy(data, text, sizeof text - 1);
  return sizeof text - 1;
}

// The same of the second order, the node on edge 12 displaced.
static size_t seed_second_order_tetgen(uint8_t *data) {
  static const char text[] =
      "T14 3 0 1\n0 0 0 0 1\n1 1 0 0 1\n2 0 1 0 2\n3 0 0 1 0\n4 1 1 1 0\n5 .5 0 0 1\n6 .6 .5 0 1\n7 0 .5 0 "
      "1\n"
      "8 0 0 .5 0\n9 .5 0 .5 0\n10 0 .5 .5 0\n11 1 .5 .5 0\n12 .5 1 .5 0\n13 .5 .5 1 0\n"
      "\0"
      "2 10 0\n0 0 1 2 3 10 8 5 6 9 7\n1 1 2 3 4 13 11 6 10 12 9\n";
  memcpy(data, text, sizeof text - 1);
  return sizeof text - 1;
}

static const double points[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};

static size_t seed_arrays(uint8_t *data) {
  static const uint8_t corners[8] = {0, 1, 2, 3, 1, 2, 3, 4};
  data[0] = 'A', data[1] = 5, data[2] = 2;
  memcpy(data + 3, points, sizeof points);
  memcpy(data + 3 + sizeof points, corners, sizeof corners);
  return 3 + sizeof points + sizeof corners;
}

static size_t seed_frame(uint8_t *data) {
  static const int tets[8] = {0, 1, 2, 3, 1, 2, 3, 4}, marks[2] = {0, 1};
  const FemVtuArray arrays[] = {
      {.name = "displacement", .components = 3, .reals = points[0]},
      {.name = "body", .is_cell = true, .components = 1, .integers = marks},
  };
  const FemVtuFrame frame = {.time = 0.5,
                             .vertex_count = 5,
                             .positions = points[0],
                             .cell_count = 2,
                             .cells = tets,
                             .arrays = arrays,
                             .array_count = 2};
  const char *path = fuzz_target_file("fuzz.vtu", "", 0);
  FUZZ_CLAIM(fem_vtu_write(path, &frame) == STATUS_OK, "%s", status_message());
  data[0] = 'F';
  return 1 + fuzz_target_read(path, data + 1, FUZZ_MAX_INPUT - 1);
}

static size_t seed(int k, uint8_t *data) {
  switch (k) {
  case 0:
    return seed_tetgen(data);
  case 1:
    return seed_small_tetgen(data);
  case 2:
    return seed_arrays(data);
  case 3:
    return seed_frame(data);
  case 4:
    return seed_file('D', "tests/data/mesh/box.mesh", data);
  case 5:
    return seed_file('V', "tests/data/mesh/box.vtk", data);
  case 6:
    return seed_file('M', "tests/data/mesh/box_22.msh", data);
  case 7:
    return seed_file('D', "meshes/tet.mesh", data);
  case 8:
    return seed_second_order_tetgen(data);
  default:
    return 0;
  }
}

const FuzzTarget fuzz_mesh = {.name = "mesh", .run = run, .seed = seed};
