// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene declares as `external: true`: motions and loads that are set by the program that steps the
// run.
//
// A group has the name of its body or obstacle; the groups of a body with several of a kind are NAME.0,
// NAME.1, … in the scene's order.
#ifndef TETLAP_APP_LOOP_GROUPS_H
#define TETLAP_APP_LOOP_GROUPS_H

#include "fem/model/model.h"

enum { APP_LOOP_NAME = 256 };

typedef enum AppLoopKind { APP_LOOP_DRIVE, APP_LOOP_LOAD } AppLoopKind;

typedef struct AppLoopGroup {
  char name[APP_LOOP_NAME];
  AppLoopKind kind;
  FemConstraintDef *drive; // of a motion; borrowed
  FemLoadDef *load_def;    // of a load; borrowed
  FemLoad *load;
  // Set, to be reached where the next advance ends: 3 values, or 3 for each vertex of a load.
  bool is_pending;
  double *target; // owned                                            (3) or (vertices, 3)
} AppLoopGroup;

typedef struct AppLoopGroups {
  AppLoopGroup *groups; // owned                                         (count)
  int count;
  bool is_static;
} AppLoopGroups;

// Of a scene and the model made of it, both of which settings change; borrowed. A zeroed one, and one whose
// creation failed, can be destroyed.
Status app_loop_groups_create(AppLoopGroups *groups, FemSceneDef *scene, FemModel *model);
void app_loop_groups_destroy(AppLoopGroups *groups);

// The group of that kind and name. STATUS_INPUT names those that there are.
Status app_loop_groups_find(const AppLoopGroups *groups, AppLoopKind kind, const char *name,
                            AppLoopGroup **group);

// When a value is reached, straight on: a number of seconds ≥ 0, or where the next advance ends.
#define APP_LOOP_NEXT_ADVANCE (-1.0)

// From `time` on a motion goes to a displacement [m] (3), or a load becomes a force (3) shared evenly [N], a
// wrench (6): force [N] and moment about the mean of the selected vertices [N m], or forces of the selected
// vertices (vertex_count, 3) [N]. `*jumps`: a force does, now. STATUS_INPUT: a number of values that means
// nothing, a value that is not finite, a motion that jumps.
Status app_loop_group_set(AppLoopGroups *groups, AppLoopGroup *group, double time, double ramp,
                          const double *values, int count, const double *positions, bool *jumps);

// An advance to `end` begins: what is pending is on its way. `*has_changed`: there was something.
Status app_loop_groups_begin(AppLoopGroups *groups, double time, double end, bool *has_changed);

// What is set, as numbers: for states. `values` NULL: only how many.
size_t app_loop_groups_save(const AppLoopGroups *groups, double *values);
// STATUS_INPUT: they do not fit; STATUS_MEMORY.
Status app_loop_groups_load(AppLoopGroups *groups, const double *values, size_t count);

#endif
