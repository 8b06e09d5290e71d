// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/mesh.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/surface/surface.h"

// How far the slope on an outer face may be off before its tetrahedron is split.
static const double SLOPE_TOLERANCE = 0.02;

// What creation works on.
typedef struct Work {
  const ContactSystemDef *def;
  ContactMesh *mesh;
  unsigned char *outer; // of each tetrahedron, bit f: its face opposite to vertex f  (tet_count)
  bool *is_thick;       // a tetrahedron at the vertex has one inside          (vertex_count)
} Work;

static Vec3 rest_of(const ContactSystemDef *def, int vertex) {
  return vec3_at(def->rest + 3 * (size_t)vertex);
}

// ---- Depths of the vertices.

// The surface of a body, with its tree.
static Status find_surface(const ContactSystemDef *def, int b, ContactSurface *surface) {
  int kept = 0;
  TRY(contact_surface_find(surface, def->tets, def->bodies[b].tet_begin, def->bodies[b].tet_end));
  for (int f = 0; f < surface->count; f++) {
    const int *v = surface->faces[f].vertices;
    bool is_inner = def->inner && (def->inner[v[0]] & def->inner[v[1]] & def->inner[v[2]]);
    if (!is_inner) surface->faces[kept++] = surface->faces[f];
  }
  surface->count = kept;
  return contact_surface_index(surface, def->rest);
}

static bool has_height(const ContactSystemDef *def, int vertex) {
  return def->heights && !isnan(def->heights[vertex]);
}

static Status measure_body(Work *work, int b) {
  const ContactSystemDef *def = work->def;
  const ContactBody *body = &def->bodies[b];
  ContactSurface surface;
  Status status = find_surface(def, b, &surface);
  if (!status) {
    double *depths = work->mesh->depths;
    for (int v = body->vertex_begin; v < body->vertex_end; v++) depths[v] = 1;
    for (int f = 0; f < surface.count; f++) {
      const ContactSurfaceFace *face = &surface.faces[f];
      work->outer[face->tet] |= (unsigned char)(1 << face->corner);
      for (int v = 0; v < 3; v++) depths[face->vertices[v]] = 0;
    }
#pragma omp parallel for schedule(static) if (body->vertex_end - body->vertex_begin > 512)
    for (int v = body->vertex_begin; v < body->vertex_end; v++)
      if (depths[v] > 0)
        depths[v] =
            has_height(def, v) ? def->heights[v] : contact_surface_distance(&surface, rest_of(def, v));
  }
  contact_surface_destroy(&surface);
  return status;
}

// ---- Which tetrahedra are split, and where.

// 1/height over each face.
static void inverse_heights(const ContactSystemDef *def, int tet, double inverse[4]) {
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = rest_of(def, def->tets[tet][v]);
  double six = fabs(vec3_det4(x[0], x[1], x[2], x[3]));
  for (int f = 0; f < 4; f++) {
    Vec3 a = x[(f + 1) % 4], b = x[(f + 2) % 4], c = x[(f + 3) % 4];
    inverse[f] = vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / six;
  }
}

static double deepest_of(const Work *work, int tet) {
  double deepest = 0;
  for (int v = 0; v < 4; v++) deepest = fmax(deepest, work->mesh->depths[work->def->tets[tet][v]]);
  return deepest;
}

// What is more than a sheet of one layer.
static void find_thick(Work *work) {
  for (int i = 0; i < work->def->tet_count; i++) {
    if (!(deepest_of(work, i) > 0)) continue;
    for (int v = 0; v < 4; v++) work->is_thick[work->def->tets[i][v]] = true;
  }
}

static bool is_split(const Work *work, int tet) {
  const int *vertices = work->def->tets[tet];
  const double *depths = work->mesh->depths;
  double inverse[4];
  if (!(deepest_of(work, tet) > 0)) return true;
  if (!work->outer[tet]) return false;
  inverse_heights(work->def, tet, inverse);
  for (int f = 0; f < 4; f++)
    if (work->outer[tet] >> f & 1 && !has_height(work->def, vertices[f]) &&
        !(fabs(depths[vertices[f]] * inverse[f] - 1) <= SLOPE_TOLERANCE))
      return true;
  return false;
}

// The virtual vertex of a tetrahedron with outer faces; without any, the centroid, its depth to be measured.
static ContactVirtual virtual_of(const Work *work, int tet, double *depth) {
  ContactVirtual virtual = {.tet = tet, .weights = {0.25, 0.25, 0.25, 0.25}};
  double inverse[4], sum = 0;
  int count = 0;
  inverse_heights(work->def, tet, inverse);
  for (int f = 0; f < 4; f++)
    if (work->outer[tet] >> f & 1) sum += inverse[f], count++;
  *depth = count > 0 ? count / (4 * sum) : INFINITY;
  for (int f = 0; f < 4; f++)
    if (work->outer[tet] >> f & 1) virtual.weights[f] = *depth * inverse[f];
  return virtual;
}

// ---- The cells.

static int count_split(const Work *work) {
  int count = 0;
  for (int i = 0; i < work->def->tet_count; i++) count += is_split(work, i);
  return count;
}

static Status reserve(ContactMesh *mesh, const ContactSystemDef *def, int split_count) {
  size_t cells = (size_t)def->tet_count + 3 * (size_t)split_count;
  double *depths = mesh->depths;
  mesh->position_count = def->vertex_count + split_count;
  mesh->depths = memory_zeroed((size_t)mesh->position_count, sizeof *mesh->depths);
  for (int v = 0; mesh->depths && v < def->vertex_count; v++) mesh->depths[v] = depths[v];
  memory_free(depths);
  mesh->own = memory_zeroed(cells, sizeof *mesh->own);
  mesh->tets = memory_zeroed(cells, sizeof *mesh->tets);
  mesh->replaced = memory_zeroed(cells, 1);
  mesh->turns = memory_zeroed(cells, 1);
  mesh->outer = memory_zeroed(cells, 1);
  mesh->virtuals = memory_zeroed((size_t)split_count, sizeof *mesh->virtuals);
  bool fits = mesh->depths && mesh->own && mesh->tets && mesh->replaced && mesh->turns && mesh->outer &&
              mesh->virtuals;
  return fits ? STATUS_OK : status_no_memory("the contact mesh");
}

static signed char turn_of(const Work *work, int tet) {
  const int *vertices = work->def->tets[tet];
  bool is_thick = false;
  Vec3 x[4];
  for (int v = 0; v < 4; v++) {
    is_thick = is_thick || work->is_thick[vertices[v]];
    x[v] = rest_of(work->def, vertices[v]);
  }
  if (!is_thick) return 0;
  return vec3_det4(x[0], x[1], x[2], x[3]) < 0 ? -1 : 1;
}

static void add_cell(Work *work, int tet, int replaced, int virtual) {
  ContactMesh *mesh = work->mesh;
  int cell = mesh->cell_count++;
  for (int v = 0; v < 4; v++) mesh->own[cell][v] = v == replaced ? virtual : work->def->tets[tet][v];
  mesh->tets[cell] = tet;
  mesh->replaced[cell] = (signed char)replaced;
  mesh->turns[cell] = turn_of(work, tet);
  mesh->outer[cell] = replaced < 0 ? work->outer[tet] : work->outer[tet] & (unsigned char)(1 << replaced);
}

static void add_tet(Work *work, int tet, int *virtual) {
  if (!is_split(work, tet)) {
    add_cell(work, tet, -1, -1);
    return;
  }
  ContactVirtual *own = &work->mesh->virtuals[*virtual - work->def->vertex_count];
  *own = virtual_of(work, tet, &work->mesh->depths[*virtual]);
  for (int f = 0; f < 4; f++) add_cell(work, tet, f, *virtual);
  (*virtual)++;
}

// The centroids among the virtual vertices of a body.
static Status measure_centroids(Work *work, int b, int begin, int end) {
  const ContactSystemDef *def = work->def;
  ContactMesh *mesh = work->mesh;
  ContactSurface surface = {0};
  Status status = STATUS_OK;
  for (int u = begin; u < end && !status; u++) {
    if (mesh->depths[u] < INFINITY) continue;
    if (!surface.faces) {
      status = find_surface(def, b, &surface);
      if (status) break;
    }
    const int *vertices = def->tets[mesh->virtuals[u - def->vertex_count].tet];
    Vec3 middle = {0, 0, 0};
    for (int v = 0; v < 4; v++) middle = vec3_add(middle, vec3_scale(0.25, rest_of(def, vertices[v])));
    mesh->depths[u] = contact_surface_distance(&surface, middle);
  }
  contact_surface_destroy(&surface);
  return status;
}

static Status cut_cells(Work *work) {
  const ContactSystemDef *def = work->def;
  ContactMesh *mesh = work->mesh;
  int virtual = def->vertex_count;
  TRY(reserve(mesh, def, count_split(work)));
  for (int b = 0; b < def->body_count; b++) {
    int begin = virtual;
    mesh->cell_begin[b] = mesh->cell_count;
    for (int i = def->bodies[b].tet_begin; i < def->bodies[b].tet_end; i++) add_tet(work, i, &virtual);
    TRY(measure_centroids(work, b, begin, virtual));
  }
  mesh->cell_begin[def->body_count] = mesh->cell_count;
  mesh->cells = (const int(*)[4])mesh->own;
  return STATUS_OK;
}

static Status make_field(Work *work) {
  const ContactSystemDef *def = work->def;
  work->mesh->depths = memory_zeroed((size_t)def->vertex_count, sizeof(double));
  work->outer = memory_zeroed((size_t)def->tet_count, 1);
  work->is_thick = memory_zeroed((size_t)def->vertex_count, sizeof *work->is_thick);
  if (!work->mesh->depths || !work->outer || !work->is_thick) return status_no_memory("the contact mesh");
  for (int b = 0; b < def->body_count; b++) TRY(measure_body(work, b));
  find_thick(work);
  return cut_cells(work);
}

Status contact_mesh_create(ContactMesh *mesh, const ContactSystemDef *def) {
  *mesh =
      (ContactMesh){.cell_count = def->tet_count, .cells = def->tets, .position_count = def->vertex_count};
  mesh->cell_begin = memory_zeroed((size_t)def->body_count + 1, sizeof *mesh->cell_begin);
  if (!mesh->cell_begin) return status_no_memory("the contact mesh");
  for (int b = 0; b < def->body_count; b++) {
    mesh->cell_begin[b] = def->bodies[b].tet_begin;
    mesh->cell_begin[b + 1] = def->bodies[b].tet_end;
  }
  if (def->potential != CONTACT_POTENTIAL_FIELD) return STATUS_OK;
  mesh->cell_count = 0;
  Work work = {.def = def, .mesh = mesh};
  Status status = make_field(&work);
  memory_free(work.outer);
  memory_free(work.is_thick);
  return status;
}

void contact_mesh_destroy(ContactMesh *mesh) {
  memory_free(mesh->cell_begin);
  memory_free(mesh->own);
  memory_free(mesh->tets);
  memory_free(mesh->replaced);
  memory_free(mesh->turns);
  memory_free(mesh->outer);
  memory_free(mesh->virtuals);
  memory_free(mesh->depths);
  *mesh = (ContactMesh){0};
}

void contact_mesh_place(const ContactMesh *mesh, const ContactSystemDef *def, double *positions) {
  int count = mesh->position_count - def->vertex_count;
#pragma omp parallel for schedule(static) if (count > 8192)
  for (int u = 0; u < count; u++) {
    const ContactVirtual *virtual = &mesh->virtuals[u];
    const int *vertices = def->tets[virtual->tet];
    Vec3 x = {0, 0, 0};
    for (int v = 0; v < 4; v++)
      x = vec3_add(x, vec3_scale(virtual->weights[v], vec3_at(positions + 3 * (size_t)vertices[v])));
    vec3_store(positions + 3 * ((size_t)def->vertex_count + (size_t)u), x);
  }
}
