// SPDX-License-Identifier: GPL-3.0-or-later
// A regular mesh of a box.
#include <math.h>
#include <stdio.h>

#include "base/memory.h"
#include "fem/mesh/validate.h"

static int grid_index(const int cells[3], int i, int j, int k) {
  return i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
}

static Status check_box(const double size[3], const int cells[3]) {
  double vertices = 1, tets = 6;
  for (int c = 0; c < 3; c++) {
    if (!(size[c] > 0 && isfinite(size[c])))
      return status_fail(STATUS_INPUT, "box: size is (%g, %g, %g); give three positive lengths", size[0],
                         size[1], size[2]);
    if (cells[c] < 1)
      return status_fail(STATUS_INPUT, "box: cells are (%d, %d, %d); give three counts of at least 1",
                         cells[0], cells[1], cells[2]);
    vertices *= cells[c] + 1.0, tets *= cells[c];
  }
  if (vertices > FEM_MESH_MAX_VERTICES || tets > FEM_MESH_MAX_TETS)
    return status_fail(STATUS_INPUT,
                       "box: %d × %d × %d cells are %.3g tetrahedra; at most %d can be numbered", cells[0],
                       cells[1], cells[2], tets, FEM_MESH_MAX_TETS);
  return STATUS_OK;
}

// Kuhn's six tetrahedra of a cube: each walks from its lowest to its highest corner along the three axes in
// one of their orders. Odd orders are turned to positive orientation.
static void fill_cube(int (*tets)[4], const int cells[3], const int low[3]) {
  static const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  for (int n = 0; n < 6; n++) {
    int at[3] = {low[0], low[1], low[2]}, walk[4];
    walk[0] = grid_index(cells, at[0], at[1], at[2]);
    for (int step = 0; step < 3; step++) {
      at[orders[n][step]]++;
      walk[step + 1] = grid_index(cells, at[0], at[1], at[2]);
    }
    int is_odd = n >= 3;
    tets[n][0] = walk[0], tets[n][1] = walk[1];
    tets[n][2] = walk[is_odd ? 3 : 2], tets[n][3] = walk[is_odd ? 2 : 3];
  }
}

static void fill_grid(FemMesh *mesh, const double size[3], const int cells[3]) {
  int tet = 0;
  for (int k = 0; k <= cells[2]; k++)
    for (int j = 0; j <= cells[1]; j++)
      for (int i = 0; i <= cells[0]; i++) {
        int at[3] = {i, j, k};
        double *x = mesh->rest + 3 * (size_t)grid_index(cells, i, j, k);
        for (int c = 0; c < 3; c++) x[c] = size[c] * ((double)at[c] / cells[c]);
        if (i == cells[0] || j == cells[1] || k == cells[2]) continue;
        fill_cube(mesh->tets + tet, cells, at);
        tet += 6;
      }
}

// The vertices of the face where coordinate c is lowest (side 0) or highest (side 1).
static Status fill_group(FemMeshGroup *group, const int cells[3], int c, int side) {
  int a = (c + 1) % 3, b = (c + 2) % 3;
  char name[8];
  int length = snprintf(name, sizeof name, "%c_%s", "xyz"[c], side ? "max" : "min");
  group->name = memory_copy(name, (size_t)length + 1, 1);
  group->vertices = memory_zeroed((size_t)(cells[a] + 1) * (size_t)(cells[b] + 1), sizeof(int));
  if (!group->name || !group->vertices) return status_no_memory("the groups of a box");
  // In increasing order: the higher axis outside.
  int inner = a < b ? a : b, outer = a < b ? b : a;
  for (int o = 0; o <= cells[outer]; o++)
    for (int i = 0; i <= cells[inner]; i++) {
      int at[3];
      at[c] = side ? cells[c] : 0, at[inner] = i, at[outer] = o;
      group->vertices[group->vertex_count++] = grid_index(cells, at[0], at[1], at[2]);
    }
  return STATUS_OK;
}

static Status fill(FemMesh *mesh, const double size[3], const int cells[3]) {
  mesh->rest = memory_zeroed((size_t)mesh->vertex_count, sizeof(double[3]));
  mesh->tets = memory_zeroed((size_t)mesh->tet_count, sizeof(int[4]));
  mesh->groups = memory_zeroed(6, sizeof *mesh->groups);
  if (!mesh->rest || !mesh->tets || !mesh->groups) return status_no_memory("a box");
  fill_grid(mesh, size, cells);
  for (mesh->group_count = 0; mesh->group_count < 6;) {
    int g = mesh->group_count++;
    TRY(fill_group(&mesh->groups[g], cells, g / 2, g % 2));
  }
  return STATUS_OK;
}

Status fem_mesh_box(FemMesh *mesh, const double size[3], const int cells[3]) {
  *mesh = (FemMesh){0};
  TRY(check_box(size, cells));
  mesh->vertex_count = (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
  mesh->tet_count = 6 * cells[0] * cells[1] * cells[2];
  Status status = fill(mesh, size, cells);
  if (status != STATUS_OK) fem_mesh_destroy(mesh);
  return status;
}
