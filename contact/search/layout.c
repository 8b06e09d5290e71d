// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/layout.h"

#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "base/vec3.h"
#include "contact/limits.h"
#include "contact/shape/shape.h"

static double volume_of(const int vertices[4], const double *positions) {
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = vec3_at(positions + 3 * (size_t)vertices[v]);
  return fabs(vec3_det4(x[0], x[1], x[2], x[3])) / 6;
}

// Rest volumes of tetrahedra, and their quarters summed at the vertices.
static Status measure_volumes(ContactLayout *layout) {
  const ContactSystemDef *def = &layout->def;
  for (int i = 0; i < def->tet_count; i++) {
    double volume = volume_of(def->tets[i], def->rest);
    if (!(volume > 0 && isfinite(volume)))
      return status_fail(STATUS_INPUT, "contact: tetrahedron %d has rest volume %g; it must be positive", i,
                         volume);
    layout->tet_volumes[i] = volume;
    for (int v = 0; v < 4; v++) layout->vertex_volumes[def->tets[i][v]] += volume / 4;
  }
  return STATUS_OK;
}

// The contact mesh, where it is at rest, and its volumes.
static Status make_cells(ContactLayout *layout) {
  ContactSystemDef *def = &layout->def;
  TRY(contact_mesh_create(&layout->mesh, def));
  layout->rest = memory_zeroed((size_t)layout->mesh.position_count, 3 * sizeof(double));
  layout->cell_volumes = memory_zeroed((size_t)layout->mesh.cell_count, sizeof(double));
  if (!layout->rest || !layout->cell_volumes) return status_no_memory("the contact mesh");
  memcpy(layout->rest, def->rest, 3 * (size_t)def->vertex_count * sizeof(double));
  contact_mesh_place(&layout->mesh, def, layout->rest);
  def->rest = layout->rest;
  for (int i = 0; i < layout->mesh.cell_count; i++)
    layout->cell_volumes[i] = volume_of(layout->mesh.cells[i], layout->rest);
  return STATUS_OK;
}

static double mean_edge(const ContactSystemDef *def, const ContactBody *body) {
  double sum = 0;
  for (int i = body->tet_begin; i < body->tet_end; i++)
    for (int v = 0; v < 4; v++)
      for (int w = 0; w < v; w++)
        sum += vec3_length(vec3_sub(vec3_at(def->rest + 3 * (size_t)def->tets[i][v]),
                                    vec3_at(def->rest + 3 * (size_t)def->tets[i][w])));
  return sum / (6 * (body->tet_end - body->tet_begin));
}

double contact_layout_margin(const ContactSystemDef *def) {
  double shortest = INFINITY;
  for (int b = 0; b < def->body_count; b++)
    if (def->bodies[b].tet_end > def->bodies[b].tet_begin)
      shortest = fmin(shortest, mean_edge(def, &def->bodies[b]));
  return isfinite(shortest) ? shortest / 2 : 1;
}

static double stiffness_of(const ContactSystemDef *def, int a, int b) {
  return def->pair_stiffness ? def->pair_stiffness[a * (def->body_count + def->shape_count) + b]
                             : def->stiffness;
}

static const struct ContactLaw *law_of(const ContactSystemDef *def, int a, int b) {
  return def->pair_laws ? def->pair_laws[a * (def->body_count + def->shape_count) + b] : NULL;
}

static ContactInterfaceDef interface_of_bodies(const ContactSystemDef *def, int a, int b) {
  bool one_sided = def->bodies[a].is_obstacle || def->bodies[b].is_obstacle;
  return (ContactInterfaceDef){.a = a,
                               .b = b,
                               .shape = -1,
                               .stiffness = stiffness_of(def, a, b),
                               .law = law_of(def, a, b),
                               .weight = {one_sided ? !def->bodies[a].is_obstacle : 0.5,
                                          one_sided ? !def->bodies[b].is_obstacle : 0.5}};
}

static void list_interfaces(ContactLayout *layout) {
  const ContactSystemDef *def = &layout->def;
  int count = 0;
  for (int a = 0; a < def->body_count; a++)
    for (int b = a; b < def->body_count; b++)
      if (a == b ? def->bodies[a].meets_itself && !def->bodies[a].is_obstacle
                 : !def->bodies[a].is_obstacle || !def->bodies[b].is_obstacle)
        layout->interfaces[count++] = interface_of_bodies(def, a, b);
  for (int a = 0; a < def->body_count; a++)
    for (int h = 0; h < def->shape_count; h++)
      if (!def->bodies[a].is_obstacle)
        layout->interfaces[count++] =
            (ContactInterfaceDef){.a = a,
                                  .b = def->body_count + h,
                                  .shape = h,
                                  .stiffness = stiffness_of(def, a, def->body_count + h),
                                  .law = law_of(def, a, def->body_count + h),
                                  .weight = {1, 0}};
  layout->interface_count = count;
}

static const uint64_t NUDGE_SEED = 20240229;

static void nudge_bodies(ContactLayout *layout) {
  layout->nudge = CONTACT_ROUNDING * layout->margin;
  for (int b = 0; b < layout->def.body_count; b++) {
    Random random = random_seeded(NUDGE_SEED, (uint64_t)b);
    random_direction(&random, layout->nudges[b]);
    for (int c = 0; c < 3; c++) layout->nudges[b][c] *= layout->nudge;
  }
}

// x ↦ nudge · R (x − centre)/radius over each body that meets itself, the rows of R random directions / √3.
static void warp_body(ContactLayout *layout, int b) {
  const ContactBody *body = &layout->def.bodies[b];
  const double *rest = layout->def.rest;
  Random random = random_seeded(NUDGE_SEED, (uint64_t)(layout->def.body_count + b));
  double rows[3][3], radius = 0;
  for (int c = 0; c < 3; c++) random_direction(&random, rows[c]);
  Vec3 centre = {0, 0, 0};
  for (size_t v = (size_t)body->vertex_begin; v < (size_t)body->vertex_end; v++)
    centre =
        vec3_add(centre, vec3_scale(1.0 / (body->vertex_end - body->vertex_begin), vec3_at(rest + 3 * v)));
  for (size_t v = (size_t)body->vertex_begin; v < (size_t)body->vertex_end; v++)
    radius = fmax(radius, vec3_length(vec3_sub(vec3_at(rest + 3 * v), centre)));
  for (size_t v = (size_t)body->vertex_begin; v < (size_t)body->vertex_end; v++)
    for (size_t c = 0; c < 3; c++)
      layout->shifts[3 * v + c] = layout->nudge / (sqrt(3) * radius) *
                                  vec3_dot(vec3_at(rows[c]), vec3_sub(vec3_at(rest + 3 * v), centre));
}

static Status prepare_self(ContactLayout *layout) {
  TRY(contact_self_create(&layout->self, &layout->def, &layout->mesh, CONTACT_ROUNDING * layout->margin));
  if (!layout->self.outer) return STATUS_OK;
  layout->shifts = memory_zeroed((size_t)layout->mesh.position_count, 3 * sizeof(double));
  if (!layout->shifts) return status_no_memory("the contact system's volumes");
  for (int b = 0; b < layout->def.body_count; b++)
    if (layout->def.bodies[b].meets_itself) warp_body(layout, b);
  contact_mesh_place(&layout->mesh, &layout->def, layout->shifts);
  return STATUS_OK;
}

static Status check_stiffness(double stiffness) {
  if (stiffness > 0 && isfinite(stiffness)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "contact: stiffness is %g; it must be positive", stiffness);
}

static Status check(const ContactSystemDef *def) {
  if (!def->pair_stiffness) TRY(check_stiffness(def->stiffness));
  if (!(def->margin >= 0 && isfinite(def->margin)))
    return status_fail(STATUS_INPUT, "contact: margin is %g m; it must be positive, or 0 for the default",
                       def->margin);
  for (int h = 0; h < def->shape_count; h++) TRY(contact_shape_check(&def->shapes[h]));
  return STATUS_OK;
}

Status contact_layout_create(ContactLayout *layout, const ContactSystemDef *def) {
  *layout = (ContactLayout){.def = *def, .party_count = def->body_count + def->shape_count};
  TRY(check(def));
  size_t most_interfaces = (size_t)def->body_count * (size_t)layout->party_count;
  layout->tet_volumes = memory_zeroed((size_t)def->tet_count, sizeof(double));
  layout->vertex_volumes = memory_zeroed((size_t)def->vertex_count, sizeof(double));
  layout->interfaces = memory_zeroed(most_interfaces, sizeof(ContactInterfaceDef));
  layout->nudges = memory_zeroed((size_t)def->body_count, sizeof *layout->nudges);
  if (!layout->tet_volumes || !layout->vertex_volumes || !layout->interfaces || !layout->nudges)
    return status_no_memory("the contact system's volumes");
  list_interfaces(layout);
  for (int f = 0; f < layout->interface_count; f++) TRY(check_stiffness(layout->interfaces[f].stiffness));
  layout->margin = def->margin > 0 ? def->margin : contact_layout_margin(def);
  nudge_bodies(layout);
  TRY(measure_volumes(layout));
  TRY(make_cells(layout));
  return prepare_self(layout);
}

void contact_layout_destroy(ContactLayout *layout) {
  memory_free(layout->rest);
  memory_free(layout->tet_volumes);
  memory_free(layout->cell_volumes);
  memory_free(layout->vertex_volumes);
  memory_free(layout->interfaces);
  memory_free(layout->nudges);
  memory_free(layout->shifts);
  contact_self_destroy(&layout->self);
  contact_mesh_destroy(&layout->mesh);
  *layout = (ContactLayout){0};
}
