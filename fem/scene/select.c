// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/select.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "base/vec3.h"

static bool is_inside_box(const double p[3], const double low[3], const double high[3]) {
  for (int c = 0; c < 3; c++)
    if (!(p[c] >= low[c] && p[c] <= high[c])) return false;
  return true;
}

// Of a line through the point, or of the point.
static double distance(const FemSelectDef *select, const double p[3]) {
  Vec3 arm = vec3_sub(vec3_at(p), vec3_at(select->point)), axis = vec3_at(select->normal);
  double length = vec3_length(axis);
  return length > 0 ? vec3_length(vec3_cross(axis, arm)) / length : vec3_length(arm);
}

static bool is_selected(const FemSelectDef *select, const double p[3]) {
  switch (select->kind) {
  case FEM_SELECT_ALL:
    return true;
  case FEM_SELECT_BOX:
    return is_inside_box(p, select->box_min, select->box_max);
  case FEM_SELECT_HALFSPACE:
    return vec3_dot(vec3_at(select->normal), vec3_sub(vec3_at(p), vec3_at(select->point))) <= 0;
  case FEM_SELECT_RADIUS: {
    double r = distance(select, p);
    return r >= select->radius_min && r <= select->radius_max;
  }
  case FEM_SELECT_GROUP:
  case FEM_SELECT_NORMAL:
    break;
  }
  return false;
}

static Vec3 corner(const FemMesh *mesh, int vertex) {
  return vec3_at(mesh->rest + 3 * (size_t)vertex);
}

static bool faces(const FemSelectDef *select, const FemMesh *mesh, const int triangle[3]) {
  Vec3 a = corner(mesh, triangle[0]), direction = vec3_at(select->normal);
  Vec3 normal = vec3_cross(vec3_sub(corner(mesh, triangle[1]), a), vec3_sub(corner(mesh, triangle[2]), a));
  double angle = atan2(vec3_length(vec3_cross(normal, direction)), vec3_dot(normal, direction));
  return angle <= select->degrees * (M_PI / 180);
}

// Marks the corners of the triangles of the surface that face the direction.
static Status mark_facing(const FemSelectDef *select, const FemMesh *mesh, bool *is_chosen) {
  int(*triangles)[3], count;
  TRY(fem_mesh_surface(mesh, &triangles, &count));
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 3 && faces(select, mesh, triangles[i]); k++) is_chosen[triangles[i][k]] = true;
  memory_free(triangles);
  return STATUS_OK;
}

static Status mark(const FemSelectDef *select, const FemMesh *mesh, bool *is_chosen) {
  if (select->kind == FEM_SELECT_NORMAL) return mark_facing(select, mesh, is_chosen);
  for (int i = 0; i < mesh->vertex_count; i++) is_chosen[i] = is_selected(select, mesh->rest + 3 * i);
  return STATUS_OK;
}

static const FemMeshGroup *find_group(const FemMesh *mesh, const char *name) {
  for (int g = 0; g < mesh->group_count; g++)
    if (strcmp(mesh->groups[g].name, name) == 0) return &mesh->groups[g];
  return NULL;
}

// The names of groups, of those with tetrahedra or of all.
static void list_names(const FemMesh *mesh, bool with_tets, char *text, size_t size) {
  size_t used = 0;
  text[0] = 0;
  for (int g = 0; g < mesh->group_count; g++)
    if (!with_tets || mesh->groups[g].tet_count > 0)
      text_append(text, size, &used, "%s%s", used ? ", " : "", mesh->groups[g].name);
}

static Status refuse_group(const FemSelectDef *select, const FemMesh *mesh) {
  char known[512];
  list_names(mesh, false, known, sizeof known);
  return status_fail(STATUS_INPUT, "the mesh has no group '%s'; %s%s", select->group,
                     mesh->group_count ? "it has "
                                       : "it has no named groups: select by box, halfspace, radius or normal",
                     known);
}

static Status refuse_empty(const FemMesh *mesh, const char *what) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < 3 * mesh->vertex_count; i++) {
    low[i % 3] = fmin(low[i % 3], mesh->rest[i]);
    high[i % 3] = fmax(high[i % 3], mesh->rest[i]);
  }
  return status_fail(STATUS_INPUT,
                     "the selection holds %s; in the scene the mesh lies in [%g, %g, %g] … [%g, %g, %g]",
                     what, low[0], low[1], low[2], high[0], high[1], high[2]);
}

Status fem_select_vertices(const FemSelectDef *select, const FemMesh *mesh, int **vertices,
                           int *vertex_count) {
  *vertices = NULL;
  *vertex_count = 0;
  if (select->kind == FEM_SELECT_GROUP) {
    const FemMeshGroup *group = find_group(mesh, select->group);
    if (!group) return refuse_group(select, mesh);
    *vertices = memory_copy(group->vertices, (size_t)group->vertex_count, sizeof **vertices);
    if (!*vertices) return status_no_memory("a selection of vertices");
    *vertex_count = group->vertex_count;
    return STATUS_OK;
  }
  int *chosen = memory_zeroed((size_t)mesh->vertex_count, sizeof *chosen), count = 0;
  bool *is_chosen = memory_zeroed((size_t)mesh->vertex_count, sizeof *is_chosen);
  Status status =
      chosen && is_chosen ? mark(select, mesh, is_chosen) : status_no_memory("a selection of vertices");
  for (int i = 0; i < mesh->vertex_count && !status; i++)
    if (is_chosen[i]) chosen[count++] = i;
  memory_free(is_chosen);
  if (!status && count == 0) status = refuse_empty(mesh, "no vertex");
  if (status) {
    memory_free(chosen);
    return status;
  }
  *vertices = chosen;
  *vertex_count = count;
  return STATUS_OK;
}

// ---- Tetrahedra.

static Status refuse_group_of_tets(const FemSelectDef *select, const FemMesh *mesh) {
  char known[512];
  const FemMeshGroup *group = find_group(mesh, select->group);
  list_names(mesh, true, known, sizeof known);
  return status_fail(
      STATUS_INPUT, "the mesh has no group '%s'%s; %s%s", select->group,
      group ? " of tetrahedra, only one of vertices" : "",
      known[0] ? "it has " : "no group of it has tetrahedra: select by box, halfspace or radius", known);
}

static Status take_group(const FemSelectDef *select, const FemMesh *mesh, int **elements,
                         int *element_count) {
  const FemMeshGroup *group = find_group(mesh, select->group);
  if (!group || group->tet_count == 0) return refuse_group_of_tets(select, mesh);
  *elements = memory_copy(group->tets, (size_t)group->tet_count, sizeof **elements);
  if (!*elements) return status_no_memory("a selection of tetrahedra");
  *element_count = group->tet_count;
  return STATUS_OK;
}

static Vec3 middle_of(const FemMesh *mesh, int element) {
  const int *nodes = mesh->quadratic ? mesh->quadratic[element] : mesh->tets[element];
  Vec3 sum = {0, 0, 0};
  for (int k = 0; k < 4; k++) sum = vec3_add(sum, corner(mesh, nodes[k]));
  return vec3_scale(0.25, sum);
}

Status fem_select_elements(const FemSelectDef *select, const FemMesh *mesh, int **elements,
                           int *element_count) {
  *elements = NULL;
  *element_count = 0;
  if (select->kind == FEM_SELECT_GROUP) return take_group(select, mesh, elements, element_count);
  int all = mesh->quadratic ? mesh->quadratic_count : mesh->tet_count, count = 0;
  int *chosen = memory_zeroed((size_t)all, sizeof *chosen);
  if (!chosen) return status_no_memory("a selection of tetrahedra");
  for (int e = 0; e < all; e++) {
    double middle[3];
    vec3_store(middle, middle_of(mesh, e));
    if (is_selected(select, middle)) chosen[count++] = e;
  }
  if (count == 0) {
    memory_free(chosen);
    return refuse_empty(mesh, "no tetrahedron's middle");
  }
  *elements = chosen;
  *element_count = count;
  return STATUS_OK;
}
