// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/loop/groups.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/scene/drive.h"

enum { TABLE_OF_DRIVE = 8, TABLE_OF_LOAD = 4 };

static int external_count(const FemBodyDef *body, AppLoopKind kind) {
  int count = 0;
  for (int i = 0; kind == APP_LOOP_DRIVE && i < body->driven_count; i++) count += body->driven[i].is_external;
  for (int i = 0; kind == APP_LOOP_LOAD && i < body->load_count; i++)
    count += body->loads[i].kind == FEM_LOAD_EXTERNAL;
  return count;
}

static AppLoopGroup *add(AppLoopGroups *groups, AppLoopKind kind, const char *name, int number, int of) {
  AppLoopGroup *group = &groups->groups[groups->count++];
  group->kind = kind;
  if (of > 1)
    snprintf(group->name, sizeof group->name, "%s.%d", name, number);
  else
    snprintf(group->name, sizeof group->name, "%s", name);
  return group;
}

static FemLoad *load_of(FemModel *model, const FemLoadDef *def) {
  for (int i = 0; i < model->load_count; i++)
    if (model->loads[i].def == def) return &model->loads[i];
  return NULL;
}

static void add_of_body(AppLoopGroups *groups, FemBodyDef *body, FemModel *model) {
  const int drives = external_count(body, APP_LOOP_DRIVE), loads = external_count(body, APP_LOOP_LOAD);
  for (int i = 0, k = 0; i < body->driven_count; i++)
    if (body->driven[i].is_external)
      add(groups, APP_LOOP_DRIVE, body->name, k++, drives)->drive = &body->driven[i];
  for (int i = 0, k = 0; i < body->load_count; i++) {
    if (body->loads[i].kind != FEM_LOAD_EXTERNAL) continue;
    AppLoopGroup *group = add(groups, APP_LOOP_LOAD, body->name, k++, loads);
    group->load_def = &body->loads[i];
    group->load = load_of(model, group->load_def);
  }
}

// At most: 3, or 3 for each vertex of a load.
static int count_values(const AppLoopGroup *group) {
  return group->kind == APP_LOOP_DRIVE ? 3 : 3 * group->load->vertex_count;
}

Status app_loop_groups_create(AppLoopGroups *groups, FemSceneDef *scene, FemModel *model) {
  size_t most = (size_t)scene->obstacle_count;
  for (int b = 0; b < scene->body_count; b++)
    most += (size_t)(external_count(&scene->bodies[b], APP_LOOP_DRIVE) +
                     external_count(&scene->bodies[b], APP_LOOP_LOAD));
  *groups = (AppLoopGroups){.is_static = scene->is_static};
  groups->groups = memory_zeroed(most, sizeof *groups->groups);
  if (!groups->groups) return status_no_memory("the groups that are set from outside");
  for (int b = 0; b < scene->body_count; b++) add_of_body(groups, &scene->bodies[b], model);
  for (int o = 0; o < scene->obstacle_count; o++)
    if (scene->obstacles[o].motion.is_external)
      add(groups, APP_LOOP_DRIVE, scene->obstacles[o].name, 0, 1)->drive = &scene->obstacles[o].motion;
  for (int g = 0; g < groups->count; g++) {
    AppLoopGroup *group = &groups->groups[g];
    group->target = memory_zeroed((size_t)count_values(group), sizeof *group->target);
    if (!group->target) return status_no_memory("the groups that are set from outside");
  }
  return STATUS_OK;
}

void app_loop_groups_destroy(AppLoopGroups *groups) {
  for (int g = 0; g < groups->count; g++) memory_free(groups->groups[g].target);
  memory_free(groups->groups);
  *groups = (AppLoopGroups){0};
}

Status app_loop_groups_find(const AppLoopGroups *groups, AppLoopKind kind, const char *name,
                            AppLoopGroup **group) {
  char known[1024] = "";
  const char *what = kind == APP_LOOP_DRIVE ? "driven" : "loaded";
  for (int g = 0; g < groups->count; g++) {
    const AppLoopGroup *it = &groups->groups[g];
    if (it->kind != kind) continue;
    *group = &groups->groups[g];
    if (strcmp(it->name, name) == 0) return STATUS_OK;
    size_t length = strlen(known);
    snprintf(known + length, sizeof known - length, "%s'%s'", length > 0 ? ", " : "", it->name);
  }
  if (known[0])
    return status_fail(STATUS_INPUT, "nothing that is %s from outside is called '%s'; there is %s", what,
                       name, known);
  return status_fail(STATUS_INPUT,
                     "'%s' is not %s from outside: the scene has no `external: true` among its %s", name,
                     what, kind == APP_LOOP_DRIVE ? "driven vertices and motions" : "loads");
}

static Status check(const AppLoopGroup *group, double ramp, const double *values, int count) {
  for (int i = 0; i < count; i++)
    if (!isfinite(values[i]))
      return status_fail(STATUS_INPUT, "'%s': value %d is %g; it must be a number", group->name, i,
                         values[i]);
  if (!(ramp >= 0 || ramp == APP_LOOP_NEXT_ADVANCE) || isinf(ramp))
    return status_fail(STATUS_INPUT, "'%s': a ramp takes a number of seconds, not %g", group->name, ramp);
  if (group->kind == APP_LOOP_DRIVE && count != 3)
    return status_fail(STATUS_INPUT, "'%s': a displacement has 3 values, not %d", group->name, count);
  if (group->kind == APP_LOOP_DRIVE || count == 3 || count == 6 || count == count_values(group))
    return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "'%s': a load has 3 values (force), 6 (force and moment), or %d (a force for each of "
                     "its %d vertices), not %d",
                     group->name, count_values(group), group->load->vertex_count, count);
}

// f_a = F/n + ω × r_a with Σ r_a × (ω × r_a) = M: of all forces with that sum and moment the smallest.
static Status share_wrench(const AppLoopGroup *group, const double wrench[6], const double *positions,
                           double *force) {
  const int n = group->load->vertex_count, *vertices = group->load->vertices;
  Vec3 mean = {0, 0, 0}, m = vec3_at(wrench + 3);
  double I[3][3] = {{0}};
  for (int i = 0; i < n; i++)
    mean = vec3_add(mean, vec3_scale(1.0 / n, vec3_at(positions + 3 * (size_t)vertices[i])));
  for (int i = 0; i < n; i++) {
    double r[3];
    vec3_store(r, vec3_sub(vec3_at(positions + 3 * (size_t)vertices[i]), mean));
    const double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) I[a][b] += (a == b ? square : 0) - r[a] * r[b];
  }
  Vec3 rows[3] = {vec3_at(I[0]), vec3_at(I[1]), vec3_at(I[2])};
  const double det = vec3_dot(rows[0], vec3_cross(rows[1], rows[2])), trace = I[0][0] + I[1][1] + I[2][2];
  static const double FLAT = 1e-12; // vertices on a line cannot carry a moment about it
  const bool turns = vec3_length(m) > 0;
  if (turns && !(det > FLAT * trace * trace * trace))
    return status_fail(STATUS_INPUT,
                       "'%s': its vertices lie on a line, which carries no moment about it; give forces of "
                       "vertices",
                       group->name);
  Vec3 omega = {0, 0, 0};
  if (turns) // the matrix is symmetric: its cofactors over det are its inverse
    omega = vec3_scale(1 / det, vec3_add(vec3_add(vec3_scale(m.x, vec3_cross(rows[1], rows[2])),
                                                  vec3_scale(m.y, vec3_cross(rows[2], rows[0]))),
                                         vec3_scale(m.z, vec3_cross(rows[0], rows[1]))));
  for (int i = 0; i < n; i++) {
    Vec3 r = vec3_sub(vec3_at(positions + 3 * (size_t)vertices[i]), mean);
    vec3_store(force + 3 * (size_t)i, vec3_add(vec3_scale(1.0 / n, vec3_at(wrench)), vec3_cross(omega, r)));
  }
  return STATUS_OK;
}

// What was given, as it is kept.
static Status find_target(AppLoopGroup *group, const double *values, int count, const double *positions) {
  double wrench[6] = {0};
  const bool is_nodal = group->kind == APP_LOOP_DRIVE || (count == count_values(group) && count != 6);
  if (is_nodal) {
    memcpy(group->target, values, (size_t)count * sizeof *values);
    return STATUS_OK;
  }
  memcpy(wrench, values, (size_t)count * sizeof *values);
  return share_wrench(group, wrench, positions, group->target);
}

static Status begin(AppLoopGroup *group, double time, double end) {
  group->is_pending = false;
  if (group->kind == APP_LOOP_DRIVE) return fem_drive_set(group->drive, time, end, group->target);
  return fem_load_set(group->load, group->load_def, time, end, group->target);
}

Status app_loop_group_set(AppLoopGroups *groups, AppLoopGroup *group, double time, double ramp,
                          const double *values, int count, const double *positions, bool *jumps) {
  *jumps = false;
  TRY(check(group, ramp, values, count));
  const bool is_pending = ramp == APP_LOOP_NEXT_ADVANCE || (ramp == 0 && groups->is_static);
  if (ramp == 0 && !groups->is_static && group->kind == APP_LOOP_DRIVE)
    return status_fail(STATUS_INPUT,
                       "'%s': driven vertices cannot jump in a motion; give the ramp a time, or let the next "
                       "advance be the ramp",
                       group->name);
  TRY(find_target(group, values, count, positions));
  group->is_pending = is_pending;
  if (is_pending) return STATUS_OK;
  *jumps = ramp == 0;
  return begin(group, time, time + ramp);
}

Status app_loop_groups_begin(AppLoopGroups *groups, double time, double end, bool *has_changed) {
  *has_changed = false;
  for (int g = 0; g < groups->count; g++) {
    if (!groups->groups[g].is_pending) continue;
    *has_changed = true;
    TRY(begin(&groups->groups[g], time, end));
  }
  return STATUS_OK;
}

// Of each group: whether it is pending and its target; its table; the forces of a load at factors 0 and 1.
static void keep(double **to, const double *values, int count) {
  if (*to && values) memcpy(*to, values, (size_t)count * sizeof **to);
  if (*to && !values) memset(*to, 0, (size_t)count * sizeof **to);
  if (*to) *to += count;
}

static size_t count_of(const AppLoopGroup *group) {
  size_t values = (size_t)count_values(group);
  return 2 + values + (group->drive ? TABLE_OF_DRIVE : TABLE_OF_LOAD + 2 * values);
}

size_t app_loop_groups_save(const AppLoopGroups *groups, double *values) {
  size_t count = 0;
  for (int g = 0; g < groups->count; g++) {
    const AppLoopGroup *group = &groups->groups[g];
    const int n = count_values(group);
    const double flags[2] = {group->is_pending,
                             group->drive ? group->drive->table_count : group->load_def->table_count};
    count += count_of(group);
    keep(&values, flags, 2);
    keep(&values, group->target, n);
    if (group->drive) keep(&values, group->drive->table, TABLE_OF_DRIVE);
    if (group->drive) continue;
    keep(&values, group->load_def->table, TABLE_OF_LOAD);
    keep(&values, group->load->from, n);
    keep(&values, group->load->force, n);
  }
  return count;
}

static const double *fetch(double *to, const double *from, int count) {
  memcpy(to, from, (size_t)count * sizeof *to);
  return from + count;
}

// Rows of a table that was never filled are not asked for.
static Status fetch_table(double **table, int *row_count, const double **from, int size, double rows) {
  if (!*table) *table = memory_zeroed((size_t)size, sizeof **table);
  if (!*table) return status_no_memory("a state");
  *from = fetch(*table, *from, size);
  *row_count = (int)rows;
  return STATUS_OK;
}

Status app_loop_groups_load(AppLoopGroups *groups, const double *values, size_t count) {
  if (count != app_loop_groups_save(groups, NULL))
    return status_fail(STATUS_INPUT, "the state is of a scene with other `external: true` groups");
  for (int g = 0; g < groups->count; g++) {
    AppLoopGroup *group = &groups->groups[g];
    const int n = count_values(group);
    const double rows = values[1];
    group->is_pending = values[0] != 0;
    values = fetch(group->target, values + 2, n);
    if (group->drive) {
      TRY(fetch_table(&group->drive->table, &group->drive->table_count, &values, TABLE_OF_DRIVE, rows));
      continue;
    }
    TRY(fetch_table(&group->load_def->table, &group->load_def->table_count, &values, TABLE_OF_LOAD, rows));
    values = fetch(group->load->from, values, n);
    values = fetch(group->load->force, values, n);
  }
  return STATUS_OK;
}
