// SPDX-License-Identifier: GPL-3.0-or-later
// Where rays meet the surface of a body.
#include "contact/surface/surface.h"

#include <math.h>

#include "base/random.h"
#include "fem/mesh/mesh.h"
#include "suite.h"

static const double SIZE[3] = {0.7, 0.31, 0.13};
enum { RAYS = 5000 };

static void open_box(FemMesh *mesh, ContactSurface *surface) {
  ck_assert_ok(fem_mesh_box(mesh, SIZE, (int[]){7, 6, 5}));
  ck_assert_ok(contact_surface_find(surface, (const int(*)[4])mesh->tets, 0, mesh->tet_count));
  ck_assert_ok(contact_surface_index(surface, mesh->rest));
}

static void close_box(FemMesh *mesh, ContactSurface *surface) {
  contact_surface_destroy(surface);
  fem_mesh_destroy(mesh);
}

static Vec3 point_within(Random *random) {
  return (Vec3){random_between(random, 0.01, 0.99) * SIZE[0], random_between(random, 0.01, 0.99) * SIZE[1],
                random_between(random, 0.01, 0.99) * SIZE[2]};
}

// Where a ray leaves the box.
static double way_out(Vec3 x, Vec3 d) {
  const double from[3] = {x.x, x.y, x.z}, to[3] = {d.x, d.y, d.z};
  double way = INFINITY;
  for (int c = 0; c < 3; c++)
    if (to[c] != 0) way = fmin(way, ((to[c] > 0 ? SIZE[c] : 0) - from[c]) / to[c]);
  return way;
}

static const ContactSurfaceFace NO_FACE = {.tet = -1};

// Any way, along an axis, and towards an edge or a vertex that faces share.
START_TEST(a_ray_leaves_a_box_where_its_faces_are) {
  FemMesh mesh;
  ContactSurface surface;
  Random random = random_seeded(7, 0);
  open_box(&mesh, &surface);
  for (int k = 0; k < RAYS; k++) {
    Vec3 x = point_within(&random), d = {0, 0, 0};
    const int *vertices = surface.faces[random_below(&random, surface.count)].vertices;
    Vec3 a = vec3_at(mesh.rest + 3 * vertices[0]), b = vec3_at(mesh.rest + 3 * vertices[1]);
    double share = k % 5 == 4 ? 0 : random_uniform(&random), way[3];
    random_direction(&random, way);
    if (k % 5 == 0) d = vec3_at(way);
    if (k % 5 == 1) d = (Vec3){k % 3 == 0, k % 3 == 1, k % 3 == 2};
    if (k % 5 > 1) d = vec3_sub(vec3_add(a, vec3_scale(share, vec3_sub(b, a))), x);
    d = vec3_scale(1 / vec3_length(d), d);
    double expected = way_out(x, d);
    ck_assert_near(contact_surface_meet(&surface, &NO_FACE, x, d), expected, 1e-9);
  }
  close_box(&mesh, &surface);
}
END_TEST

START_TEST(the_face_that_a_ray_begins_at_is_left_out) {
  FemMesh mesh;
  ContactSurface surface;
  open_box(&mesh, &surface);
  for (int f = 0; f < surface.count; f++) {
    const ContactSurfaceFace *face = &surface.faces[f];
    Vec3 middle = {0, 0, 0}, centre = {SIZE[0] / 2, SIZE[1] / 2, SIZE[2] / 2};
    for (int v = 0; v < 3; v++)
      middle = vec3_add(middle, vec3_scale(1.0 / 3, vec3_at(mesh.rest + 3 * face->vertices[v])));
    Vec3 d = vec3_sub(centre, middle);
    d = vec3_scale(1 / vec3_length(d), d);
    ck_assert_near(contact_surface_meet(&surface, face, middle, d), 2 * vec3_length(vec3_sub(centre, middle)),
                   1e-9);
    ck_assert(isinf(contact_surface_meet(&surface, face, middle, vec3_scale(-1, d))));
  }
  close_box(&mesh, &surface);
}
END_TEST

START_TEST(without_faces_nothing_is_met) {
  ContactSurface surface = {0};
  ck_assert_ok(contact_surface_index(&surface, NULL));
  ck_assert(isinf(contact_surface_meet(&surface, &NO_FACE, (Vec3){0, 0, 0}, (Vec3){1, 0, 0})));
  contact_surface_destroy(&surface);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("surface");
  tcase_add_test(cases, a_ray_leaves_a_box_where_its_faces_are);
  tcase_add_test(cases, the_face_that_a_ray_begins_at_is_left_out);
  tcase_add_test(cases, without_faces_nothing_is_met);
  return suite_run("surface", cases, 30);
}
