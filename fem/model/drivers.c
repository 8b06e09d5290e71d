// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/drivers.h"

#include "base/memory.h"
#include "fem/scene/drive.h"
#include "fem/scene/select.h"

// Makes the driver of one constraint and marks its coordinates by the driver's number + 1 in `owner`.
static Status add_driver(FemModel *model, const FemConstraintDef *def, const FemMesh *mesh,
                         const FemModelBody *body, int *owner) {
  int *vertices, count;
  TRY(fem_select_vertices(&def->select, mesh, &vertices, &count));
  FemModelDriver *driver = &model->drivers[model->driver_count++];
  *driver = (FemModelDriver){.def = def, .is_fixed = fem_drive_is_still(def)};
  driver->dofs = memory_zeroed(3 * (size_t)count, sizeof *driver->dofs);
  Status status = driver->dofs ? STATUS_OK : status_no_memory("the prescribed vertices");
  for (int i = 0; i < count && !status; i++)
    for (int c = 0; c < 3 && !status; c++) {
      if (!def->components[c]) continue;
      int dof = 3 * (body->vertex_begin + vertices[i]) + c;
      const FemModelDriver *other = owner[dof] ? &model->drivers[owner[dof] - 1] : NULL;
      if (other && !(other->is_fixed && driver->is_fixed && other->def->release == def->release)) {
        const double *p = model->rest + (dof - c);
        status =
            status_fail(STATUS_INPUT,
                        "vertex %d at (%g, %g, %g) is prescribed twice in %c, by two selections that differ; "
                        "make the selections disjoint or name their components",
                        vertices[i], p[0], p[1], p[2], "xyz"[c]);
        break;
      }
      owner[dof] = model->driver_count;
      if (other) continue;
      model->is_prescribed[dof] = true;
      model->free_count--;
      driver->dofs[driver->dof_count++] = dof;
    }
  memory_free(vertices);
  return status;
}

static Status add_drivers_of_body(FemModel *model, int b, const FemMesh *mesh, int *owner) {
  const FemBodyDef *def = &model->scene->bodies[b];
  for (int kind = 0; kind < 2; kind++) {
    const FemConstraintDef *list = kind == 0 ? def->fixed : def->driven;
    int count = kind == 0 ? def->fixed_count : def->driven_count;
    for (int i = 0; i < count; i++) {
      Status status = add_driver(model, &list[i], mesh, &model->bodies[b], owner);
      if (status)
        return status_prefix(status, "%s: body '%s', %s[%d]",
                             fem_scene_where(model->scene, &list[i].select.place).text, def->name,
                             kind == 0 ? "fixed" : "driven", i);
    }
  }
  return STATUS_OK;
}

Status fem_model_drivers_create(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  size_t most = (size_t)scene->obstacle_count;
  for (int b = 0; b < scene->body_count; b++)
    most += (size_t)scene->bodies[b].fixed_count + (size_t)scene->bodies[b].driven_count;
  model->free_count = 3 * model->vertex_count;
  int *owner = memory_zeroed(3 * (size_t)model->vertex_count, sizeof *owner);
  model->drivers = memory_zeroed(most, sizeof *model->drivers);
  Status status = owner && model->drivers ? STATUS_OK : status_no_memory("the prescribed vertices");
  for (int b = 0; b < scene->body_count && !status; b++)
    status = add_drivers_of_body(model, b, &meshes[b], owner);
  int body = scene->body_count;
  for (int o = 0; o < scene->obstacle_count && !status; o++) {
    if (scene->obstacles[o].kind != FEM_OBSTACLE_MESH) continue;
    status = add_driver(model, &scene->obstacles[o].motion, &meshes[body], &model->bodies[body], owner);
    body++;
  }
  memory_free(owner);
  return status;
}

void fem_model_drivers_move(const FemModel *model, double released, double time, double *positions,
                            double *velocities) {
  const double *from = model->start ? model->start->positions : model->rest;
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    for (int i = 0; i < driver->dof_count && !fem_model_is_released(driver, released); i++) {
      int dof = driver->dofs[i];
      double position[3], velocity[3];
      if (driver->is_fixed) {
        positions[dof] = from[dof];
        velocities[dof] = 0;
        continue;
      }
      fem_drive_point(driver->def, time, from + (dof - dof % 3), position, velocity);
      positions[dof] = position[dof % 3];
      velocities[dof] = velocity[dof % 3];
    }
  }
}
