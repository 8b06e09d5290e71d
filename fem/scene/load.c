// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/load.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/tet.h"
#include "base/vec3.h"
#include "fem/element/quadratic.h"
#include "fem/element/quadratic_face.h"
#include "fem/mesh/faces.h"
#include "fem/scene/select.h"
#include "fem/scene/table.h"
#include "fem/scene/torque.h"

static Vec3 corner(const double *positions, int vertex) {
  return vec3_at(positions + 3 * (size_t)vertex);
}

// ½ (b − a) × (c − a)
static Vec3 area_of(const double *positions, const int triangle[3]) {
  Vec3 a = corner(positions, triangle[0]);
  Vec3 ab = vec3_sub(corner(positions, triangle[1]), a), ac = vec3_sub(corner(positions, triangle[2]), a);
  return vec3_scale(0.5, vec3_cross(ab, ac));
}

// What a load is made of: the mesh's vertices that it may touch, and nodal forces by the mesh's numbers.
typedef struct Builder {
  const FemLoadDef *def;
  const FemMesh *mesh;
  int *selected; // vertices                       (selected_count)
  int selected_count;
  bool *is_selected;   //                         (mesh->vertex_count)
  double *force;       //                         (mesh->vertex_count, 3)
  int (*triangles)[3]; // of the surface          (triangle_count)
  int triangle_count;
  int (*faces)[6]; // of quadratic tetrahedra     (face_count)
  int face_count;
} Builder;

static void destroy_builder(Builder *builder) {
  memory_free(builder->selected);
  memory_free(builder->is_selected);
  memory_free(builder->force);
  memory_free(builder->triangles);
  memory_free(builder->faces);
}

static Status select_all(Builder *builder) {
  const FemMesh *mesh = builder->mesh;
  if (!builder->selected)
    TRY(fem_select_vertices(&builder->def->select, mesh, &builder->selected, &builder->selected_count));
  builder->is_selected = memory_zeroed((size_t)mesh->vertex_count, sizeof *builder->is_selected);
  builder->force = memory_zeroed(3 * (size_t)mesh->vertex_count, sizeof *builder->force);
  if (!builder->is_selected || !builder->force) return status_no_memory("a load");
  for (int i = 0; i < builder->selected_count; i++) builder->is_selected[builder->selected[i]] = true;
  return STATUS_OK;
}

static Status check_surface(const Builder *builder, int count) {
  if (count > 0) return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "the selection holds %d vertices but no triangle of the surface; a traction or a pressure "
      "needs all three corners of a triangle",
      builder->selected_count);
}

// The middle of the edge between two corners of a quadratic tetrahedron.
static int middle_of(const int nodes[10], int a, int b) {
  for (int k = 0; k < 6; k++) {
    int p = nodes[fem_quadratic_edges[k][0]], q = nodes[fem_quadratic_edges[k][1]];
    if ((p == a && q == b) || (p == b && q == a)) return nodes[4 + k];
  }
  return -1;
}

// The surface's faces of quadratic tetrahedra whose six nodes are selected.
static Status pick_faces(Builder *builder, const int (*corners)[4]) {
  const FemMesh *mesh = builder->mesh;
  FemMeshFace *faces;
  int all = 4 * mesh->quadratic_count;
  TRY(fem_mesh_faces_list(&faces, mesh->vertex_count, mesh->quadratic_count, corners));
  builder->faces = memory_zeroed((size_t)all, sizeof *builder->faces);
  for (int begin = 0, end; builder->faces && begin < all; begin = end) {
    end = fem_mesh_faces_end(faces, all, begin);
    if (end - begin > 1) continue;
    const int *nodes = mesh->quadratic[faces[begin].tet], *order = tet_faces[faces[begin].local];
    int *face = builder->faces[builder->face_count];
    bool is_whole = true;
    for (int k = 0; k < 3; k++) {
      face[k] = nodes[order[k]];
      face[3 + k] = middle_of(nodes, nodes[order[k]], nodes[order[(k + 1) % 3]]);
      is_whole = is_whole && builder->is_selected[face[k]] && builder->is_selected[face[3 + k]];
    }
    builder->face_count += is_whole;
  }
  memory_free(faces);
  if (!builder->faces) return status_no_memory("a load");
  return check_surface(builder, builder->face_count);
}

static Status select_faces(Builder *builder) {
  const FemMesh *mesh = builder->mesh;
  int(*corners)[4] = memory_zeroed((size_t)mesh->quadratic_count, sizeof *corners);
  if (!corners) return status_no_memory("a load");
  for (int e = 0; e < mesh->quadratic_count; e++) memcpy(corners[e], mesh->quadratic[e], sizeof corners[e]);
  Status status = pick_faces(builder, (const int(*)[4])corners);
  memory_free(corners);
  return status;
}

// The surface triangles whose corners are all selected.
static Status select_triangles(Builder *builder) {
  if (builder->mesh->quadratic) return select_faces(builder);
  int count, kept = 0;
  TRY(fem_mesh_surface(builder->mesh, &builder->triangles, &count));
  for (int i = 0; i < count; i++) {
    const int *t = builder->triangles[i];
    if (!builder->is_selected[t[0]] || !builder->is_selected[t[1]] || !builder->is_selected[t[2]]) continue;
    memmove(builder->triangles[kept++], t, sizeof *builder->triangles);
  }
  builder->triangle_count = kept;
  return check_surface(builder, kept);
}

static void share_force(Builder *builder) {
  for (int i = 0; i < builder->selected_count; i++)
    vec3_store(builder->force + 3 * (size_t)builder->selected[i],
               vec3_scale(1.0 / builder->selected_count, vec3_at(builder->def->vector)));
}

static double six_volumes_of(const FemMesh *mesh, const int tet[4]) {
  return vec3_det4(corner(mesh->rest, tet[0]), corner(mesh->rest, tet[1]), corner(mesh->rest, tet[2]),
                   corner(mesh->rest, tet[3]));
}

static void share_over_quadratic(Builder *builder, Vec3 density) {
  const FemMesh *mesh = builder->mesh;
  for (int e = 0; e < mesh->quadratic_count; e++) {
    const int *nodes = mesh->quadratic[e];
    double x[3 * FEM_QUADRATIC_NODES];
    FemQuadratic element;
    for (int k = 0; k < FEM_QUADRATIC_NODES; k++) vec3_store(x + 3 * k, corner(mesh->rest, nodes[k]));
    fem_quadratic_create_curved(&element, x);
    for (int k = 0; k < FEM_QUADRATIC_NODES; k++)
      if (builder->is_selected[nodes[k]])
        vec3_accumulate(builder->force + 3 * (size_t)nodes[k],
                        vec3_scale(element.volume * fem_quadratic_mass_share(k), density));
  }
}

// density × the volume around each selected vertex.
static void share_over_volume(Builder *builder, Vec3 density) {
  const FemMesh *mesh = builder->mesh;
  if (mesh->quadratic) {
    share_over_quadratic(builder, density);
    return;
  }
  for (int e = 0; e < mesh->tet_count; e++) {
    const int *tet = mesh->tets[e];
    double six_volumes = six_volumes_of(mesh, tet);
    for (int k = 0; k < 4; k++)
      if (builder->is_selected[tet[k]])
        vec3_accumulate(builder->force + 3 * (size_t)tet[k], vec3_scale(six_volumes / 24, density));
  }
}

static void share_over_faces(Builder *builder) {
  const FemLoadDef *def = builder->def;
  for (int i = 0; i < builder->face_count; i++) {
    const int *face = builder->faces[i];
    double x[3 * FEM_QUADRATIC_FACE_NODES], share[FEM_QUADRATIC_FACE_NODES],
        area[3 * FEM_QUADRATIC_FACE_NODES];
    for (int k = 0; k < FEM_QUADRATIC_FACE_NODES; k++)
      vec3_store(x + 3 * k, corner(builder->mesh->rest, face[k]));
    fem_quadratic_face_share(x, share);
    fem_quadratic_face_area(x, area);
    for (int k = 0; k < FEM_QUADRATIC_FACE_NODES; k++)
      vec3_accumulate(builder->force + 3 * (size_t)face[k],
                      def->kind == FEM_LOAD_TRACTION ? vec3_scale(share[k], vec3_at(def->vector))
                                                     : vec3_scale(-def->pressure, vec3_at(area + 3 * k)));
  }
}

// A traction, or a dead pressure along the normals at rest.
static void share_over_triangles(Builder *builder) {
  const FemLoadDef *def = builder->def;
  for (int i = 0; i < builder->triangle_count; i++) {
    Vec3 area = area_of(builder->mesh->rest, builder->triangles[i]);
    Vec3 third = def->kind == FEM_LOAD_TRACTION ? vec3_scale(vec3_length(area) / 3, vec3_at(def->vector))
                                                : vec3_scale(-def->pressure / 3, area);
    for (int k = 0; k < 3; k++) vec3_accumulate(builder->force + 3 * (size_t)builder->triangles[i][k], third);
  }
  share_over_faces(builder);
}

static Status keep_triangles(FemLoad *load, const Builder *builder, int vertex_begin) {
  load->triangles = memory_copy(builder->triangles, (size_t)builder->triangle_count, sizeof *load->triangles);
  if (!load->triangles) return status_no_memory("a load");
  load->triangle_count = builder->triangle_count;
  for (int i = 0; i < load->triangle_count; i++)
    for (int k = 0; k < 3; k++) load->triangles[i][k] += vertex_begin;
  load->faces = memory_copy(builder->faces, (size_t)builder->face_count, sizeof *load->faces);
  if (!load->faces) return status_no_memory("a load");
  load->face_count = builder->face_count;
  for (int i = 0; i < load->face_count; i++)
    for (int k = 0; k < FEM_QUADRATIC_FACE_NODES; k++) load->faces[i][k] += vertex_begin;
  return STATUS_OK;
}

static Status keep_forces(FemLoad *load, const Builder *builder, int vertex_begin) {
  size_t count = (size_t)builder->selected_count;
  load->vertices = memory_zeroed(count, sizeof *load->vertices);
  load->force = memory_zeroed(3 * count, sizeof *load->force);
  if (!load->vertices || !load->force) return status_no_memory("a load");
  if (builder->def->kind == FEM_LOAD_EXTERNAL && !(load->from = memory_zeroed(3 * count, sizeof *load->from)))
    return status_no_memory("a load");
  load->vertex_count = builder->selected_count;
  for (size_t i = 0; i < count; i++) {
    load->vertices[i] = vertex_begin + builder->selected[i];
    memcpy(load->force + 3 * i, builder->force + 3 * (size_t)builder->selected[i], 3 * sizeof *load->force);
  }
  return STATUS_OK;
}

// Of a torque, from the volumes that stand in place of forces along x.
static Status keep_weights(FemLoad *load, const Builder *builder) {
  // Beyond it the arms are too short for a moment along the line to be shared.
  static const double LEAST_BREADTH = 1e-9;
  load->weight = memory_zeroed((size_t)load->vertex_count, sizeof *load->weight);
  if (!load->weight) return status_no_memory("a load");
  for (int i = 0; i < load->vertex_count; i++) load->weight[i] = load->force[3 * (size_t)i];
  memory_free(load->force);
  load->force = NULL;
  if (fem_torque_breadth(load->vertex_count, builder->selected, load->weight, builder->mesh->rest) >
      LEAST_BREADTH)
    return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "the selection holds %d vertices on a line or at a point; a torque needs vertices around "
      "its axis: select a face",
      load->vertex_count);
}

static Status build(FemLoad *load, Builder *builder, int vertex_begin) {
  TRY(select_all(builder));
  switch (builder->def->kind) {
  case FEM_LOAD_FORCE:
    share_force(builder);
    break;
  case FEM_LOAD_BODY_FORCE:
    share_over_volume(builder, vec3_at(builder->def->vector));
    break;
  case FEM_LOAD_TORQUE:
    share_over_volume(builder, (Vec3){1, 0, 0});
    TRY(keep_forces(load, builder, vertex_begin));
    return keep_weights(load, builder);
  case FEM_LOAD_PRESSURE:
    TRY(select_triangles(builder));
    if (!builder->def->is_dead) return keep_triangles(load, builder, vertex_begin);
    share_over_triangles(builder);
    break;
  case FEM_LOAD_TRACTION:
    TRY(select_triangles(builder));
    share_over_triangles(builder);
    break;
  case FEM_LOAD_EXTERNAL:
    break;
  }
  return keep_forces(load, builder, vertex_begin);
}

Status fem_load_create(FemLoad *load, const FemLoadDef *def, const FemMesh *mesh, int vertex_begin) {
  *load = (FemLoad){.def = def};
  Builder builder = {.def = def, .mesh = mesh};
  Status status = build(load, &builder, vertex_begin);
  destroy_builder(&builder);
  if (status) fem_load_destroy(load);
  return status;
}

Status fem_load_create_like(FemLoad *load, const FemLoad *of, const FemMesh *mesh, int vertex_begin) {
  *load = (FemLoad){.def = of->def};
  Builder builder = {.def = of->def, .mesh = mesh, .selected_count = of->vertex_count};
  builder.selected = memory_copy(of->vertices, (size_t)of->vertex_count, sizeof *of->vertices);
  for (int i = 0; builder.selected && i < of->vertex_count; i++) builder.selected[i] -= vertex_begin;
  Status status =
      builder.selected ? build(load, &builder, vertex_begin) : status_no_memory("a load of another shape");
  destroy_builder(&builder);
  if (status) fem_load_destroy(load);
  return status;
}

void fem_load_destroy(FemLoad *load) {
  memory_free(load->vertices);
  memory_free(load->force);
  memory_free(load->weight);
  memory_free(load->from);
  memory_free(load->triangles);
  memory_free(load->faces);
  *load = (FemLoad){0};
}

static FemTable table_of(const FemLoadDef *def) {
  return (FemTable){def->table, 2, def->table_count};
}

static ExpressionValue factor_at(const FemLoadDef *def, double time) {
  ExpressionValue factor = {1, 0, 0};
  if (def->factor) factor = expression_eval(def->factor, time);
  if (def->table_count > 0) fem_table_eval(table_of(def), time, &factor.value, &factor.rate);
  return factor;
}

Status fem_load_factor(const FemLoadDef *def, double time, double *factor) {
  *factor = factor_at(def, time).value;
  if (isfinite(*factor)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "a load's factor '%s' is not a number at t = %g s",
                     def->factor ? def->factor->text : "table", time);
}

// Of an external load at the present factor.
static Vec3 external_force(const FemLoad *load, double factor, int i) {
  Vec3 from = vec3_at(load->from + 3 * (size_t)i), to = vec3_at(load->force + 3 * (size_t)i);
  return factor == 1 ? to : vec3_add(from, vec3_scale(factor, vec3_sub(to, from)));
}

Status fem_load_set(FemLoad *load, FemLoadDef *def, double time, double end, const double *force) {
  const double factor = factor_at(def, time).value;
  if (!def->table) def->table = memory_zeroed(4, sizeof *def->table);
  if (!def->table) return status_no_memory("a load");
  for (int i = 0; i < load->vertex_count; i++)
    vec3_store(load->from + 3 * (size_t)i, external_force(load, factor, i));
  memcpy(load->force, force, 3 * (size_t)load->vertex_count * sizeof *force);
  const double rows[4] = {time, end > time ? 0 : 1, end, 1};
  memcpy(def->table, rows, sizeof rows);
  def->table_count = end > time ? 2 : 1;
  return STATUS_OK;
}

double fem_load_next_change(const FemLoadDef *def, double time) {
  bool has_jumped = def->kind == FEM_LOAD_EXTERNAL && def->table_count == 1 && time <= def->table[0];
  if (has_jumped) return time;
  if (def->factor && !expression_is_constant(def->factor)) return time;
  return fem_table_next_change(table_of(def), time);
}

static void eval_factor(const void *self, double time, double value[3], double rate[3]) {
  ExpressionValue factor = factor_at(self, time);
  value[0] = factor.value, rate[0] = factor.rate;
  value[1] = value[2] = rate[1] = rate[2] = 0;
}

static double next_knot(const void *self, double time) {
  const FemLoadDef *def = self;
  double next = fem_table_next_row(table_of(def), time);
  return def->factor ? fmin(next, expression_next_kink(def->factor, time)) : next;
}

double fem_load_horizon(const FemLoadDef *def, double acceleration, const FemForesight *foresight,
                        double time, double farthest) {
  bool is_constant = def->table_count == 0 && (!def->factor || expression_is_constant(def->factor));
  if (is_constant) return farthest;
  FemSignal signal = {.def = def,
                      .eval = eval_factor,
                      .next_knot = next_knot,
                      .is_curved = def->factor != NULL,
                      .deviation = foresight->static_share > 0 ? 0 : INFINITY,
                      .impulse = foresight->static_share > 0 ? INFINITY : foresight->velocity / acceleration};
  return fem_signal_horizon(&signal, foresight, time, farthest);
}

bool fem_load_follows(const FemLoad *load) {
  return load->triangle_count + load->face_count > 0 || load->weight;
}

void fem_load_add_force(const FemLoad *load, double factor, const double *positions, double *force) {
  if (load->weight) {
    double moment[3];
    vec3_store(moment, vec3_scale(factor, vec3_at(load->def->vector)));
    fem_torque_add_force(moment, load->vertex_count, load->vertices, load->weight, positions, force);
    return;
  }
  for (int i = 0; i < load->vertex_count; i++)
    vec3_accumulate(force + 3 * (size_t)load->vertices[i],
                    load->from ? external_force(load, factor, i)
                               : vec3_scale(factor, vec3_at(load->force + 3 * (size_t)i)));
  for (int i = 0; i < load->triangle_count; i++) {
    Vec3 third = vec3_scale(-factor * load->def->pressure / 3, area_of(positions, load->triangles[i]));
    for (int k = 0; k < 3; k++) vec3_accumulate(force + 3 * (size_t)load->triangles[i][k], third);
  }
  for (int i = 0; i < load->face_count; i++) {
    double x[18], area[18];
    for (int k = 0; k < FEM_QUADRATIC_FACE_NODES; k++)
      memcpy(x + 3 * k, positions + 3 * (size_t)load->faces[i][k], 3 * sizeof *x);
    fem_quadratic_face_area(x, area);
    for (int k = 0; k < FEM_QUADRATIC_FACE_NODES; k++)
      vec3_accumulate(force + 3 * (size_t)load->faces[i][k],
                      vec3_scale(-factor * load->def->pressure, vec3_at(area + 3 * k)));
  }
}

// f = −(p/6)(a × b + b × c + c × a) at every corner: −∂f/∂a = (p/6)[c − b]ₓ, whatever the row. Its symmetric
// part has the blocks ½ (B_column − B_row).
void fem_load_triangle_stiffness(double pressure, const double a[3], const double b[3], const double c[3],
                                 double stiffness[81]) {
  const double *corners[3] = {a, b, c};
  double blocks[3][9];
  for (int k = 0; k < 3; k++) {
    Vec3 w = vec3_sub(vec3_at(corners[(k + 2) % 3]), vec3_at(corners[(k + 1) % 3]));
    const double cross[9] = {0, -w.z, w.y, w.z, 0, -w.x, -w.y, w.x, 0};
    for (int r = 0; r < 9; r++) blocks[k][r] = pressure / 6 * cross[r];
  }
  for (int r = 0; r < 9; r++)
    for (int s = 0; s < 9; s++) {
      int entry = 3 * (r % 3) + s % 3;
      stiffness[9 * r + s] = 0.5 * (blocks[s / 3][entry] - blocks[r / 3][entry]);
    }
}
