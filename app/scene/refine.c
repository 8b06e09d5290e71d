// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/refine.h"

#include <math.h>

static Status refine_body(FemBodyDef *body, double level, const char *path) {
  if (body->mesh_path && !(body->mesh_options.size > 0))
    return status_fail(
        STATUS_INPUT,
        "%s: body '%s' has the mesh %s as it is, which has no other levels; give it a box, or a "
        ".geo or .stl file with a `size`",
        path, body->name, body->mesh_path);
  body->mesh_options.size /= level;
  for (int c = 0; c < 3; c++) body->box_cells[c] = (int)fmax(1, round(body->box_cells[c] * level));
  return STATUS_OK;
}

Status app_scene_refine(FemSceneDef *scene, double level) {
  if (level == 1) return STATUS_OK;
  for (int b = 0; b < scene->body_count; b++) TRY(refine_body(&scene->bodies[b], level, scene->path));
  return STATUS_OK;
}
