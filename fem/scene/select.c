// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/select.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"

static bool is_inside_box(const double p[3], const double low[3], const double high[3]) {
  for (int c = 0; c < 3; c++)
    if (!(p[c] >= low[c] && p[c] <= high[c])) return false;
  return true;
}

static bool is_selected(const FemSelectDef *select, const double p[3]) {
  switch (select->kind) {
  case FEM_SELECT_ALL:
    return true;
  case FEM_SELECT_BOX:
    return is_inside_box(p, select->box_min, select->box_max);
  case FEM_SELECT_HALFSPACE:
    return vec3_dot(vec3_at(select->normal), vec3_sub(vec3_at(p), vec3_at(select->point))) <= 0;
  case FEM_SELECT_GROUP:
    break;
  }
  return false;
}

static const FemMeshGroup *find_group(const FemMesh *mesh, const char *name) {
  for (int g = 0; g < mesh->group_count; g++)
    if (strcmp(mesh->groups[g].name, name) == 0) return &mesh->groups[g];
  return NULL;
}

static Status refuse_group(const FemSelectDef *select, const FemMesh *mesh) {
  char known[512] = "";
  for (int g = 0; g < mesh->group_count; g++) {
    size_t used = strlen(known);
    snprintf(known + used, sizeof known - used, "%s%s", g ? ", " : "", mesh->groups[g].name);
  }
  return status_fail(STATUS_INPUT, "the mesh has no group '%s'; %s%s", select->group,
                     mesh->group_count ? "it has " : "it has no named groups: select by box or halfspace",
                     known);
}

static Status refuse_empty(const FemMesh *mesh) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < 3 * mesh->vertex_count; i++) {
    low[i % 3] = fmin(low[i % 3], mesh->rest[i]);
    high[i % 3] = fmax(high[i % 3], mesh->rest[i]);
  }
  return status_fail(
      STATUS_INPUT,
      "the selection holds no vertex; in the scene the mesh lies in [%g, %g, %g] … [%g, %g, %g]", low[0],
      low[1], low[2], high[0], high[1], high[2]);
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
  int *chosen = memory_zeroed((size_t)mesh->vertex_count, sizeof *chosen);
  if (!chosen) return status_no_memory("a selection of vertices");
  int count = 0;
  for (int i = 0; i < mesh->vertex_count; i++)
    if (is_selected(select, mesh->rest + 3 * i)) chosen[count++] = i;
  if (count == 0) {
    memory_free(chosen);
    return refuse_empty(mesh);
  }
  *vertices = chosen;
  *vertex_count = count;
  return STATUS_OK;
}
