// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/obstacle_surface.h"

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/output/vtk/vtu.h"
#include "fem/scene/drive.h"
#include "fem/scene/obstacle.h"

// Triangles along a quarter of a great circle. They lie 0.35 % of the radius within the ball at most.
enum { BALL_ROWS = 16 };

// Sides of the prism that is drawn of a cylinder; its surface is within 0.14 % of the radius.
enum { CYLINDER_SIDES = 48 };

// Half the edge of a half-space's square, over the diagonal of all meshes at rest.
static const double SQUARE_SHARE = 1.5;

static int count_vertices(const FemObstacleDef *def) {
  switch (def->kind) {
  case FEM_OBSTACLE_MESH:
    return 0;
  case FEM_OBSTACLE_HALFSPACE:
    return 4;
  case FEM_OBSTACLE_BALL:
    return 4 * BALL_ROWS * BALL_ROWS + 2;
  case FEM_OBSTACLE_BOX:
    return 8 + 6; // corners, and the faces' centres
  case FEM_OBSTACLE_CYLINDER:
    return 2 * CYLINDER_SIDES + CYLINDER_SIDES + 2;
  }
  return 0;
}

static int count_triangles(const FemObstacleDef *def) {
  switch (def->kind) {
  case FEM_OBSTACLE_MESH:
    return 0;
  case FEM_OBSTACLE_HALFSPACE:
    return 2;
  case FEM_OBSTACLE_BALL:
    return 8 * BALL_ROWS * BALL_ROWS;
  case FEM_OBSTACLE_BOX:
    return 6 * 4; // four in each face, about its centre
  case FEM_OBSTACLE_CYLINDER:
    return 3 * 2 * CYLINDER_SIDES;
  }
  return 0;
}

// A surface while it grows: the obstacle that is added, and its own frame.
typedef struct Growth {
  FemObstacleSurface *surface;
  const FemObstacleDef *def;
  int body;
  Vec3 point, axes[3];
  int begin; // its first vertex
} Growth;

static void add_vertex(Growth *growth, Vec3 x) {
  FemObstacleSurface *surface = growth->surface;
  surface->defs[surface->vertex_count] = growth->def;
  vec3_store(surface->rest + 3 * (size_t)surface->vertex_count++, x);
}

static void add_own_vertex(Growth *growth, Vec3 own) {
  Vec3 x = growth->point;
  x = vec3_add(x, vec3_scale(own.x, growth->axes[0]));
  x = vec3_add(x, vec3_scale(own.y, growth->axes[1]));
  add_vertex(growth, vec3_add(x, vec3_scale(own.z, growth->axes[2])));
}

// Vertices are counted from the obstacle's first.
static void add_triangle(Growth *growth, int a, int b, int c, int face) {
  FemObstacleSurface *surface = growth->surface;
  int t = surface->triangle_count++, *corners = surface->triangles[t];
  corners[0] = growth->begin + a, corners[1] = growth->begin + b, corners[2] = growth->begin + c;
  surface->bodies[t] = growth->body;
  surface->faces[t] = face;
}

// ---- A half-space.

// The middle and the diagonal of all meshes at rest.
static double measure_meshes(const FemModel *model, Vec3 *middle) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, centre[3];
  for (int i = 0; i < 3 * model->vertex_count; i++) {
    low[i % 3] = fmin(low[i % 3], model->rest[i]);
    high[i % 3] = fmax(high[i % 3], model->rest[i]);
  }
  for (int c = 0; c < 3; c++) centre[c] = (low[c] + high[c]) / 2;
  *middle = vec3_at(centre);
  return vec3_length(vec3_sub(vec3_at(high), vec3_at(low)));
}

static void add_square(Growth *growth, const FemModel *model) {
  Vec3 normal = vec3_at(growth->def->normal), middle;
  normal = vec3_scale(1 / vec3_length(normal), normal);
  double size = measure_meshes(model, &middle);
  double height = vec3_dot(vec3_sub(middle, growth->point), normal);
  double half = fmax(SQUARE_SHARE * size, fabs(height));
  Vec3 aside = fabs(normal.x) < 0.6 ? (Vec3){1, 0, 0} : (Vec3){0, 1, 0};
  Vec3 u = vec3_sub(aside, vec3_scale(vec3_dot(aside, normal), normal));
  u = vec3_scale(half / vec3_length(u), u);
  Vec3 v = vec3_cross(normal, u), foot = vec3_sub(middle, vec3_scale(height, normal));
  for (int k = 0; k < 4; k++)
    add_vertex(growth,
               vec3_add(foot, vec3_add(vec3_scale(k & 1 ? 1 : -1, u), vec3_scale(k & 2 ? 1 : -1, v))));
  add_triangle(growth, 0, 1, 3, 0);
  add_triangle(growth, 0, 3, 2, 0);
}

// ---- A ball: an octahedron's net, its rows circles of latitude.

// The number of the vertex at place s of row m from a pole, in quarter q; row m has m places a quarter, row 0
// is the pole.
static int ball_vertex(bool is_south, int m, int q, int s) {
  int first = m == 0 ? 0 : 1 + 2 * m * (m - 1);
  if (is_south) first = 4 * BALL_ROWS * BALL_ROWS + 1 - 2 * m * (m + 1);
  return m == 0 ? first : first + (q * m + s) % (4 * m);
}

static void add_ball_vertices(Growth *growth) {
  for (int row = 0; row <= 2 * BALL_ROWS; row++) {
    int places = row <= BALL_ROWS ? row : 2 * BALL_ROWS - row, count = places ? 4 * places : 1;
    double polar = M_PI * row / (2 * BALL_ROWS);
    for (int k = 0; k < count; k++) {
      double turn = 2 * M_PI * k / count;
      Vec3 own = {sin(polar) * cos(turn), sin(polar) * sin(turn), cos(polar)};
      add_own_vertex(growth, vec3_scale(growth->def->radius, own));
    }
  }
}

// Between rows m and m + 1 of a quarter; what is counter-clockwise in the north is clockwise in the south.
static void add_ball_strip(Growth *growth, bool is_south, int m, int q) {
  int face = (is_south ? 4 : 0) + q;
  for (int s = 0; s <= m; s++) {
    int inner = ball_vertex(is_south, m, q, s), outer = ball_vertex(is_south, m + 1, q, s),
        next = ball_vertex(is_south, m + 1, q, s + 1);
    add_triangle(growth, inner, is_south ? next : outer, is_south ? outer : next, face);
    if (s == m) continue;
    int beside = ball_vertex(is_south, m, q, s + 1);
    add_triangle(growth, inner, is_south ? beside : next, is_south ? next : beside, face);
  }
}

static void add_ball(Growth *growth) {
  add_ball_vertices(growth);
  for (int side = 0; side < 2; side++)
    for (int m = 0; m < BALL_ROWS; m++)
      for (int q = 0; q < 4; q++) add_ball_strip(growth, side, m, q);
}

// ---- A box and a prism: each face a fan about its centre.

// The number of a corner: those that the solid lists, then the opposite ones.
static Vec3 corner_of(const ContactConvex *solid, int k) {
  return k < solid->corner_count ? solid->corners[k]
                                 : vec3_scale(-1, solid->corners[k - solid->corner_count]);
}

typedef struct Ring {
  int count;
  int corners[CONTACT_CONVEX_FACE_COUNT]; // counter-clockwise from outside
  double angles[CONTACT_CONVEX_FACE_COUNT];
  Vec3 centre;
} Ring;

static void insert_corner(Ring *ring, int corner, double angle) {
  int at = ring->count++;
  for (; at > 0 && ring->angles[at - 1] > angle; at--)
    ring->corners[at] = ring->corners[at - 1], ring->angles[at] = ring->angles[at - 1];
  ring->corners[at] = corner, ring->angles[at] = angle;
}

// A corner's coordinates are right to rounding, each for itself: of a thin plate they differ by any factor.
static bool is_on_plane(Vec3 corner, Vec3 normal, double offset) {
  const double parts[3] = {corner.x * normal.x, corner.y * normal.y, corner.z * normal.z};
  return fabs(parts[0] + parts[1] + parts[2] - offset) <=
         1e-9 * (fabs(parts[0]) + fabs(parts[1]) + fabs(parts[2]));
}

// The corners of a face. The solid is symmetric, so that a face's centre is the foot of its normal.
static void find_ring(Ring *ring, const ContactConvex *solid, int plane) {
  Vec3 normal = solid->normals[plane], u = {0, 0, 0}, v = {0, 0, 0};
  ring->count = 0;
  ring->centre = vec3_scale(solid->offsets[plane], normal);
  for (int k = 0; k < 2 * solid->corner_count; k++) {
    Vec3 corner = corner_of(solid, k), arm = vec3_sub(corner, ring->centre);
    if (!is_on_plane(corner, normal, solid->offsets[plane])) continue;
    if (ring->count == 0) u = arm, v = vec3_cross(normal, u);
    insert_corner(ring, k, atan2(vec3_dot(arm, v), vec3_dot(arm, u)));
  }
}

// The quarter of a prism about its axis in which one of its sides lies, by the side's direction.
static int quarter_of(Vec3 direction) {
  int side = (int)lround(atan2(direction.y, direction.x) / (2 * M_PI / CYLINDER_SIDES));
  return 4 * ((side + CYLINDER_SIDES) % CYLINDER_SIDES) / CYLINDER_SIDES;
}

static int face_of(const FemObstacleDef *def, const ContactConvex *solid, int plane, Vec3 outward) {
  if (def->kind == FEM_OBSTACLE_BOX) return plane;
  if (plane < CYLINDER_SIDES) return quarter_of(solid->normals[plane]);
  return 4 * (1 + plane - CYLINDER_SIDES) + quarter_of(outward);
}

static void add_solid(Growth *growth, const ContactConvex *solid) {
  Ring ring;
  int centre = 2 * solid->corner_count;
  for (int k = 0; k < centre; k++) add_own_vertex(growth, corner_of(solid, k));
  for (int plane = 0; plane < solid->plane_count; plane++, centre++) {
    find_ring(&ring, solid, plane);
    add_own_vertex(growth, ring.centre);
    for (int k = 0; k < ring.count; k++) {
      int a = ring.corners[k], b = ring.corners[(k + 1) % ring.count];
      Vec3 outward = vec3_sub(vec3_add(corner_of(solid, a), corner_of(solid, b)), vec3_scale(2, ring.centre));
      add_triangle(growth, centre, a, b, face_of(growth->def, solid, plane, outward));
    }
  }
}

// ---- All of them.

static void add_obstacle(FemObstacleSurface *surface, const FemModel *model, const FemObstacleDef *def,
                         int body) {
  static const Vec3 space[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Growth growth = {.surface = surface, .def = def, .body = body, .begin = surface->vertex_count};
  ContactConvex solid;
  ContactShape shape;
  fem_obstacle_shape(def, &shape, &solid);
  bool has_axes = shape.kind == CONTACT_SHAPE_CONVEX || shape.kind == CONTACT_SHAPE_CYLINDER;
  growth.point = vec3_at(shape.point);
  for (int k = 0; k < 3; k++) growth.axes[k] = has_axes ? vec3_at(shape.axes[k]) : space[k];
  if (shape.kind == CONTACT_SHAPE_HALFSPACE) add_square(&growth, model);
  if (shape.kind == CONTACT_SHAPE_BALL) add_ball(&growth);
  if (shape.kind == CONTACT_SHAPE_CYLINDER)
    contact_convex_make_prism(&solid, shape.radius, shape.half_length, CYLINDER_SIDES);
  if (has_axes) add_solid(&growth, &solid);
}

static bool is_taken(const FemObstacleDef *def, bool are_moving) {
  return def->kind != FEM_OBSTACLE_MESH && fem_drive_is_still(&def->motion) != are_moving;
}

static bool reserve(FemObstacleSurface *surface, const FemSceneDef *scene, bool are_moving) {
  size_t vertices = 0, triangles = 0;
  for (int o = 0; o < scene->obstacle_count; o++) {
    if (!is_taken(&scene->obstacles[o], are_moving)) continue;
    vertices += (size_t)count_vertices(&scene->obstacles[o]);
    triangles += (size_t)count_triangles(&scene->obstacles[o]);
  }
  surface->rest = memory_zeroed(3 * vertices, sizeof *surface->rest);
  surface->positions = memory_zeroed(3 * vertices, sizeof *surface->positions);
  surface->velocities = memory_zeroed(3 * vertices, sizeof *surface->velocities);
  surface->defs = memory_zeroed(vertices, sizeof *surface->defs);
  surface->triangles = memory_zeroed(triangles, sizeof *surface->triangles);
  surface->bodies = memory_zeroed(triangles, sizeof *surface->bodies);
  surface->faces = memory_zeroed(triangles, sizeof *surface->faces);
  return surface->rest && surface->positions && surface->velocities && surface->defs && surface->triangles &&
         surface->bodies && surface->faces;
}

Status fem_obstacle_surface_create(FemObstacleSurface *surface, const FemModel *model, bool are_moving) {
  const FemSceneDef *scene = model->scene;
  *surface = (FemObstacleSurface){0};
  if (!reserve(surface, scene, are_moving)) {
    fem_obstacle_surface_destroy(surface);
    return status_no_memory("the surfaces of obstacles");
  }
  for (int o = 0, body = model->body_count; o < scene->obstacle_count; o++) {
    const FemObstacleDef *def = &scene->obstacles[o];
    if (is_taken(def, are_moving)) add_obstacle(surface, model, def, body);
    body += def->kind != FEM_OBSTACLE_MESH;
  }
  fem_obstacle_surface_place(surface, 0);
  return STATUS_OK;
}

void fem_obstacle_surface_destroy(FemObstacleSurface *surface) {
  memory_free(surface->rest);
  memory_free(surface->positions);
  memory_free(surface->velocities);
  memory_free(surface->defs);
  memory_free(surface->triangles);
  memory_free(surface->bodies);
  memory_free(surface->faces);
  *surface = (FemObstacleSurface){0};
}

// Leaves of a vertex's way the part along the half-space's normal.
static void keep_below(const double normal[3], const double rest[3], double position[3]) {
  Vec3 n = vec3_at(normal), way = vec3_sub(vec3_at(position), vec3_at(rest));
  vec3_store(position, vec3_add(vec3_at(rest), vec3_scale(vec3_dot(way, n) / vec3_dot(n, n), n)));
}

void fem_obstacle_surface_place(FemObstacleSurface *surface, double time) {
  for (size_t i = 0; i < (size_t)surface->vertex_count; i++) {
    const FemObstacleDef *def = surface->defs[i];
    double *position = surface->positions + 3 * i;
    fem_drive_point(&def->motion, time, surface->rest + 3 * i, position, surface->velocities + 3 * i);
    if (def->kind == FEM_OBSTACLE_HALFSPACE) keep_below(def->normal, surface->rest + 3 * i, position);
  }
}

Status fem_obstacle_surface_write(const FemObstacleSurface *surface, const char *path, double time) {
  const FemVtuArray arrays[] = {
      {.name = "velocity", .components = 3, .reals = surface->velocities},
      {.name = "body", .is_cell = true, .components = 1, .integers = surface->bodies},
      {.name = "face", .is_cell = true, .components = 1, .integers = surface->faces},
  };
  const FemVtuFrame frame = {.time = time,
                             .vertex_count = surface->vertex_count,
                             .positions = surface->positions,
                             .cell = FEM_VTU_TRIANGLES,
                             .cell_count = surface->triangle_count,
                             .cells = surface->triangles[0],
                             .arrays = arrays,
                             .array_count = sizeof arrays / sizeof *arrays};
  return fem_vtu_write(path, &frame);
}
