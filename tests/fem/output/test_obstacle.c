// SPDX-License-Identifier: GPL-3.0-or-later
// fem/output/vtk/obstacle_surface.h: what is drawn of obstacles without a mesh is where contact meets them,
// at all times.
#include "scene.h"

#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "contact/shape/shape.h"
#include "fem/output/vtk/obstacle_surface.h"
#include "fem/output/vtk/pvd.h"
#include "fem/output/vtk/vtu_read.h"
#include "fem/scene/obstacle.h"

enum { STANDING, MOVING, SET_COUNT };

typedef struct Fixture {
  SceneRun run;
  FemObstacleSurface sets[SET_COUNT];
} Fixture;

static Fixture *open_scene(void) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  scene_open(&f->run, "obstacle_shapes", NULL);
  for (int k = 0; k < SET_COUNT; k++)
    ck_assert_ok(fem_obstacle_surface_create(&f->sets[k], &f->run.model, k == MOVING));
  return f;
}

static void close_scene(Fixture *f) {
  for (int k = 0; k < SET_COUNT; k++) fem_obstacle_surface_destroy(&f->sets[k]);
  scene_close(&f->run);
  free(f);
}

static const FemObstacleDef *obstacle_named(const Fixture *f, const char *name) {
  for (int o = 0; o < f->run.scene.obstacle_count; o++)
    if (strcmp(f->run.scene.obstacles[o].name, name) == 0) return &f->run.scene.obstacles[o];
  ck_abort_msg("the scene has no obstacle %s", name);
}

static const FemObstacleDef *def_of(const FemObstacleSurface *surface, int triangle) {
  return surface->defs[surface->triangles[triangle][0]];
}

static void corners_of(const FemObstacleSurface *surface, int triangle, Vec3 x[3]) {
  for (int k = 0; k < 3; k++)
    x[k] = vec3_at(surface->positions + 3 * (size_t)surface->triangles[triangle][k]);
}

// Twice the area, outward.
static Vec3 normal_of(const Vec3 x[3]) {
  return vec3_cross(vec3_sub(x[1], x[0]), vec3_sub(x[2], x[0]));
}

// Under the surface of one obstacle, by the divergence theorem.
static double volume_of(const FemObstacleSurface *surface, const FemObstacleDef *def) {
  double volume = 0;
  for (int t = 0; t < surface->triangle_count; t++) {
    Vec3 x[3];
    if (def_of(surface, t) != def) continue;
    corners_of(surface, t, x);
    volume += vec3_dot(x[0], vec3_cross(x[1], x[2])) / 6;
  }
  return volume;
}

START_TEST(surfaces_are_closed_and_look_outward) {
  Fixture *f = open_scene();
  for (int k = 0; k < SET_COUNT; k++) {
    const FemObstacleSurface *surface = &f->sets[k];
    size_t count = (size_t)surface->vertex_count;
    ck_assert_int_gt(surface->triangle_count, 0);
    signed char *edges = calloc(count * count, 1); // from, to
    ck_assert_ptr_nonnull(edges);
    for (int t = 0; t < surface->triangle_count; t++)
      for (int c = 0; c < 3; c++) {
        const int *corners = surface->triangles[t];
        ck_assert_ptr_eq(surface->defs[corners[c]], def_of(surface, t));
        ck_assert_int_eq(edges[(size_t)corners[c] * count + (size_t)corners[(c + 1) % 3]]++, 0);
      }
    int open = 0;
    for (size_t a = 0; a < count; a++)
      for (size_t b = 0; b < count; b++)
        open +=
            surface->defs[a]->kind != FEM_OBSTACLE_HALFSPACE && edges[a * count + b] != edges[b * count + a];
    ck_assert_int_eq(open, 0);
    free(edges);
  }
  close_scene(f);
}
END_TEST

START_TEST(volumes_are_those_of_the_solids_wherever_they_are) {
  Fixture *f = open_scene();
  static const struct {
    const char *name;
    int set;
    double volume, error; // of the facets of a ball, inside it; a prism has the cylinder's own volume
  } solids[] = {{"crate", STANDING, 0.2 * 0.3 * 0.4, 1e-12},
                {"pipe", STANDING, M_PI * 0.01 * 0.5, 1e-12},
                {"ball", STANDING, 4 * M_PI / 3 * 0.015625, 0.01},
                {"blade", MOVING, 0.4 * 0.1 * 0.2, 1e-12},
                {"roller", MOVING, M_PI * 0.09, 1e-12},
                {"planet", MOVING, 4 * M_PI / 3 * 0.008, 0.01}};
  for (double time = 0; time < 2; time += 0.7)
    for (size_t i = 0; i < sizeof solids / sizeof *solids; i++) {
      FemObstacleSurface *surface = &f->sets[solids[i].set];
      fem_obstacle_surface_place(surface, time);
      double volume = volume_of(surface, obstacle_named(f, solids[i].name));
      ck_assert_msg(volume > (1 - solids[i].error) * solids[i].volume &&
                        volume < (1 + 1e-12) * solids[i].volume,
                    "%s has %.17g instead of %.17g", solids[i].name, volume, solids[i].volume);
    }
  close_scene(f);
}
END_TEST

START_TEST(what_moves_is_where_its_motion_takes_it) {
  Fixture *f = open_scene();
  FemObstacleSurface *moving = &f->sets[MOVING];
  const FemObstacleDef *blade = obstacle_named(f, "blade");
  fem_obstacle_surface_place(moving, 1); // a quarter turn: its edges of 0.4 and 0.1 have changed places
  Vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < moving->vertex_count; i++) {
    if (moving->defs[i] != blade) continue;
    Vec3 x = vec3_at(moving->positions + 3 * i);
    low = (Vec3){fmin(low.x, x.x), fmin(low.y, x.y), fmin(low.z, x.z)};
    high = (Vec3){fmax(high.x, x.x), fmax(high.y, x.y), fmax(high.z, x.z)};
  }
  ck_assert_near(low.x, 2.95, 1e-14);
  ck_assert_near(high.x, 3.05, 1e-14);
  ck_assert_near(low.y, 0.8, 1e-14);
  ck_assert_near(high.y, 1.2, 1e-14);
  ck_assert_near(low.z, 0.9, 1e-14);
  ck_assert_near(high.z, 1.1, 1e-14); // 0.5 ± 0.1, risen by 0.5
  fem_obstacle_surface_place(moving, 0.5);
  for (int i = 0; i < moving->vertex_count; i++) {
    if (moving->defs[i] != blade) continue;
    Vec3 arm = vec3_sub(vec3_at(moving->positions + 3 * i), (Vec3){3, 1, 0});
    Vec3 speed = {-M_PI_2 * arm.y, M_PI_2 * arm.x, 0.5};
    ck_assert_near(vec3_length(vec3_sub(speed, vec3_at(moving->velocities + 3 * i))), 0, 1e-14);
  }
  close_scene(f);
}
END_TEST

// Whether contact finds that shape at x: does it share volume with a tetrahedron of that size about there?
static bool is_met(const ContactShape *shape, double time, Vec3 x, double size) {
  static const double arms[4][3] = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  double tet[12], volume;
  for (int v = 0; v < 4; v++) vec3_store(tet + 3 * v, vec3_add(x, vec3_scale(size, vec3_at(arms[v]))));
  contact_shape_overlap(shape, time, tet, &volume, NULL);
  return volume > 0;
}

START_TEST(contact_meets_the_drawn_surface_and_nothing_outside_it) {
  Fixture *f = open_scene();
  static const double DEPTH = 4e-3, SIZE = 1e-4; // facets of a ball lie within it by 0.2 % of its radius
  int tried = 0, met = 0, met_outside = 0;
  for (int k = 0; k < SET_COUNT; k++)
    for (double time = 0; time < 2; time += 0.35) {
      fem_obstacle_surface_place(&f->sets[k], time);
      for (int t = 0; t < f->sets[k].triangle_count; t++) {
        ContactConvex solid;
        ContactShape shape;
        Vec3 x[3];
        corners_of(&f->sets[k], t, x);
        Vec3 normal = normal_of(x), middle = vec3_scale(1.0 / 3, vec3_add(x[0], vec3_add(x[1], x[2])));
        fem_obstacle_shape(def_of(&f->sets[k], t), &shape, &solid);
        Vec3 out = vec3_scale(DEPTH / vec3_length(normal), normal);
        met += is_met(&shape, time, vec3_sub(middle, out), SIZE);
        met_outside += is_met(&shape, time, vec3_add(middle, out), SIZE);
        tried++;
      }
    }
  ck_assert_int_gt(tried, 10000);
  ck_assert_int_eq(met, tried);
  ck_assert_int_eq(met_outside, 0);
  close_scene(f);
}
END_TEST

START_TEST(a_halfspace_is_a_square_below_the_bodies_that_moves_along_its_normal) {
  Fixture *f = open_scene();
  const Vec3 normal = {0.6, 0, 0.8};
  Vec3 before[4];
  FemObstacleSurface *moving = &f->sets[MOVING];
  ck_assert_ptr_eq(moving->defs[0], obstacle_named(f, "slope"));
  for (int i = 0; i < 4; i++) {
    before[i] = vec3_at(moving->positions + 3 * i);
    ck_assert_near(vec3_dot(vec3_sub(before[i], (Vec3){0, 0, -3}), normal), 0, 1e-14);
  }
  fem_obstacle_surface_place(moving, 2); // by (2, 4, 6): 6 along the normal
  for (int i = 0; i < 4; i++) {
    Vec3 way = vec3_sub(vec3_at(moving->positions + 3 * i), before[i]);
    ck_assert_near(vec3_length(vec3_sub(way, vec3_scale(6, normal))), 0, 1e-13);
    ck_assert(moving->velocities[3 * i + 1] == 2.0); // its material moves on
  }
  // From above every vertex of a mesh is seen on the ground's square.
  const FemObstacleSurface *standing = &f->sets[STANDING];
  ck_assert_ptr_eq(standing->defs[0], obstacle_named(f, "ground"));
  Vec3 x[3];
  corners_of(standing, 0, x);
  ck_assert(normal_of(x).z > 0 && normal_of(x).x == 0.0 && normal_of(x).y == 0.0);
  double half = sqrt(normal_of(x).z) / 2, middle_x = 0, middle_y = 0;
  for (int i = 0; i < 4; i++)
    middle_x += standing->rest[3 * i] / 4, middle_y += standing->rest[3 * i + 1] / 4;
  for (int v = 0; v < f->run.model.vertex_count; v++) {
    ck_assert(fabs(f->run.model.rest[3 * v] - middle_x) < half);
    ck_assert(fabs(f->run.model.rest[3 * v + 1] - middle_y) < half);
  }
  close_scene(f);
}
END_TEST

// Thinner than rounding of its length: each face has its own four corners, not those of the face opposite.
START_TEST(a_thin_plate_and_a_long_rod_have_closed_surfaces) {
  static const struct {
    const char *obstacle;
    double volume;
    int triangles;
  } cases[] = {{"{name: plate, box: {centre: [0, 0, -1e-5], size: [1e7, 1e7, 1e-5]}}", 1e9, 24},
               {"{name: rod, cylinder: {centre: [0, 0, -1e-5], axis: [1, 0, 0], radius: 1e-5, length: 1e7}}",
                M_PI * 1e-3, 0}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    SceneRun run;
    FemObstacleSurface surface;
    char override[256];
    snprintf(override, sizeof override, "obstacles=[%s]", cases[k].obstacle);
    scene_open(&run, "drop", (const char *const[]){override, NULL});
    ck_assert_ok(fem_obstacle_surface_create(&surface, &run.model, false));
    if (cases[k].triangles) ck_assert_int_eq(surface.triangle_count, cases[k].triangles);
    ck_assert_near(volume_of(&surface, &run.scene.obstacles[0]) / cases[k].volume, 1, 1e-3);
    fem_obstacle_surface_destroy(&surface);
    scene_close(&run);
  }
}
END_TEST

START_TEST(what_rounding_leaves_no_surface_is_refused) {
  static const char *const shapes[] = {
      "box: {centre: [0, 0, -5e11], size: [1, 1, 1e12]}", "sphere: {centre: [0, 0, -1e3], radius: 1e3}",
      "cylinder: {centre: [0, 0, -1e6], axis: [1, 0, 0], radius: 1e6, length: 1}",
      "cylinder: {centre: [0, 0, -1], axis: [1, 0, 0], radius: 1, length: 1e12}"};
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
    FemSceneDef scene;
    FemModel model;
    char override[256];
    const char *const overrides[] = {override};
    snprintf(override, sizeof override, "obstacles=[{name: wide, %s}]", shapes[k]);
    ck_assert_ok(app_scene_read(TETLAP_SOURCE_DIR "/tests/scenes/drop.yaml", overrides, 1, &scene));
    ck_assert_int_eq(fem_model_create(&model, &scene), STATUS_INPUT);
    ck_assert_msg(strstr(status_message(), "obstacle 'wide': is ") && strstr(status_message(), "a halfspace"),
                  "%s", status_message());
    fem_scene_destroy(&scene);
  }
}
END_TEST

// A block that falls on the largest ones lies on them as on a half-space.
START_TEST(the_largest_that_are_allowed_bear_a_block_like_a_halfspace) {
  static const char *const shapes[] = {
      "halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}", "box: {centre: [0, 0, -1], size: [1e7, 1e7, 2]}",
      "sphere: {centre: [0, 0, -30], radius: 30}",
      "cylinder: {centre: [0, 0, -1e3], axis: [1, 0, 0], radius: 1e3, length: 1e7}"};
  double force[4];
  for (int k = 0; k < 4; k++) {
    SceneRun run;
    char override[256];
    snprintf(override, sizeof override, "obstacles=[{name: ground, %s}]", shapes[k]);
    scene_run(&run, "drop", (const char *const[]){override, "time.end=0.15", NULL});
    force[k] = run.result.contact.force_max;
    scene_close(&run);
  }
  for (int k = 1; k < 4; k++)
    ck_assert_near(force[k] / force[0], 1, k == 2 ? 0.05 : 0.01); // the ball is round
}
END_TEST

START_TEST(obstacles_are_numbered_as_the_sides_of_interfaces) {
  Fixture *f = open_scene();
  // The cube and the brick have meshes; the others follow in the scene's order.
  static const char *const names[] = {"ground", "ball",   "crate", "pipe",
                                      "slope",  "planet", "blade", "roller"};
  for (int k = 0; k < SET_COUNT; k++)
    for (int t = 0; t < f->sets[k].triangle_count; t++)
      ck_assert_str_eq(def_of(&f->sets[k], t)->name, names[f->sets[k].bodies[t] - 2]);
  close_scene(f);
}
END_TEST

START_TEST(faces_part_a_surface_evenly) {
  Fixture *f = open_scene();
  static const struct {
    const char *name;
    int set, count;
  } solids[] = {{"crate", STANDING, 6}, {"roller", MOVING, 12}, {"planet", MOVING, 8}, {"ball", STANDING, 8}};
  for (size_t i = 0; i < sizeof solids / sizeof *solids; i++) {
    const FemObstacleSurface *surface = &f->sets[solids[i].set];
    double areas[16] = {0};
    for (int t = 0; t < surface->triangle_count; t++) {
      Vec3 x[3];
      if (def_of(surface, t) != obstacle_named(f, solids[i].name)) continue;
      ck_assert_int_lt(surface->faces[t], solids[i].count);
      corners_of(surface, t, x);
      areas[surface->faces[t]] += vec3_length(normal_of(x)) / 2;
    }
    for (int face = 0; face < solids[i].count; face++) {
      // Of a box two opposite faces are alike, else the four quarters or octants of a side.
      int like = solids[i].count == 6 ? face ^ 1 : face ^ 2;
      ck_assert(areas[face] > 0);
      ck_assert_near(areas[face] / areas[like], 1, 1e-12);
    }
  }
  close_scene(f);
}
END_TEST

static char folder[64];

static void open_folder(void) {
  snprintf(folder, sizeof folder, "/tmp/tetlap_obstacle_%ld", (long)getpid());
}

static void remove_folder(void) {
  char command[96];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  ck_assert_int_eq(system(command), 0);
}

static void run_into_folder(Fixture *f, const char *const *overrides) {
  scene_open(&f->run, "obstacle_shapes", overrides);
  FemRunOptions options = {.directory = folder};
  ck_assert_msg(fem_run(&f->run.model, &options, &f->run.result) == STATUS_OK, "%s", status_message());
}

static void read_list(FemPvdList *list) {
  char *path = file_join(folder, "frames.pvd");
  ck_assert_ok(fem_pvd_read(path, list));
  memory_free(path);
}

// A file of the run's must hold the surface as it was placed last.
static void assert_written(const char *name, const FemObstacleSurface *surface, double time) {
  FemVtuContent content;
  char *path = file_join(folder, name);
  ck_assert_ok(fem_vtu_read(path, &content));
  ck_assert_int_eq(content.cell, FEM_VTU_TRIANGLES);
  ck_assert_int_eq(content.vertex_count, surface->vertex_count);
  ck_assert_int_eq(content.cell_count, surface->triangle_count);
  ck_assert_mem_eq(content.positions, surface->positions, (size_t)surface->vertex_count * sizeof(double[3]));
  ck_assert_mem_eq(content.cells, surface->triangles, (size_t)surface->triangle_count * sizeof(int[3]));
  ck_assert(isnan(time) ? isnan(content.time) : content.time == time);
  ck_assert_int_eq(content.field_count, 3);
  ck_assert_str_eq(content.fields[0].name, "velocity");
  ck_assert_mem_eq(content.fields[0].values, surface->velocities,
                   (size_t)surface->vertex_count * sizeof(double[3]));
  ck_assert_str_eq(content.fields[1].name, "body");
  ck_assert_str_eq(content.fields[2].name, "face");
  for (int t = 0; t < surface->triangle_count; t++) {
    ck_assert(content.fields[1].values[t] == surface->bodies[t]);
    ck_assert(content.fields[2].values[t] == surface->faces[t]);
  }
  fem_vtu_read_destroy(&content);
  memory_free(path);
}

START_TEST(a_run_writes_what_stands_once_and_what_moves_with_every_frame) {
  Fixture f = {0};
  FemPvdList list;
  run_into_folder(&f, NULL);
  for (int k = 0; k < SET_COUNT; k++)
    ck_assert_ok(fem_obstacle_surface_create(&f.sets[k], &f.run.model, k == MOVING));
  read_list(&list);
  ck_assert_int_eq(list.count, 3);
  ck_assert_int_eq(list.part_count, 3);
  for (int frame = 0; frame < 3; frame++) {
    char frame_name[32], moving_name[32];
    snprintf(frame_name, sizeof frame_name, "frame_%05d.vtu", frame);
    snprintf(moving_name, sizeof moving_name, "obstacles_%05d.vtu", frame);
    ck_assert_str_eq(list.files[3 * frame], frame_name);
    ck_assert_str_eq(list.files[3 * frame + 1], "obstacles.vtu");
    ck_assert_str_eq(list.files[3 * frame + 2], moving_name);
    fem_obstacle_surface_place(&f.sets[MOVING], list.times[frame]);
    assert_written(moving_name, &f.sets[MOVING], list.times[frame]);
  }
  assert_written("obstacles.vtu", &f.sets[STANDING], NAN);
  fem_pvd_destroy(&list);
  for (int k = 0; k < SET_COUNT; k++) fem_obstacle_surface_destroy(&f.sets[k]);
  scene_close(&f.run);
}
END_TEST

START_TEST(a_run_without_such_obstacles_writes_frames_alone) {
  Fixture f = {0};
  FemPvdList list;
  char command[256], *path, *text;
  size_t size;
  snprintf(command, sizeof command, "mkdir -p %s && touch %s/obstacles.vtu %s/obstacles_00001.vtu", folder,
           folder, folder);
  ck_assert_int_eq(system(command), 0); // of an earlier run
  run_into_folder(
      &f, (const char *const[]){
              "obstacles=[{name: brick, mesh: {box: {size: [1, 1, 1], cells: [1, 1, 1]}}, place: {translate: "
              "[-0.5, -0.5, -1]}}]",
              NULL});
  read_list(&list);
  ck_assert_int_eq(list.count, 3);
  ck_assert_int_eq(list.part_count, 1);
  fem_pvd_destroy(&list);
  snprintf(command, sizeof command, "[ $(ls %s | grep -c obstacles) = 0 ]", folder);
  ck_assert_int_eq(system(command), 0);
  path = file_join(folder, "frames.pvd");
  ck_assert_ok(file_read(path, &text, &size));
  ck_assert_ptr_nonnull(strstr(text, "<DataSet timestep=\"0\" part=\"0\" file=\"frame_00000.vtu\"/>"));
  memory_free(text);
  memory_free(path);
  scene_close(&f.run);
}
END_TEST

START_TEST(a_scene_of_meshes_has_none) {
  SceneRun run;
  FemObstacleSurface surface;
  scene_open(&run, "obstacle_shapes",
             (const char *const[]){
                 "obstacles=[{name: brick, mesh: {box: {size: [1, 1, 1], cells: [1, 1, 1]}}}]", NULL});
  for (int k = 0; k < SET_COUNT; k++) {
    ck_assert_ok(fem_obstacle_surface_create(&surface, &run.model, k == MOVING));
    ck_assert_int_eq(surface.vertex_count, 0);
    ck_assert_int_eq(surface.triangle_count, 0);
    fem_obstacle_surface_destroy(&surface);
  }
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("obstacle");
  tcase_add_checked_fixture(cases, open_folder, remove_folder);
  tcase_add_test(cases, surfaces_are_closed_and_look_outward);
  tcase_add_test(cases, volumes_are_those_of_the_solids_wherever_they_are);
  tcase_add_test(cases, what_moves_is_where_its_motion_takes_it);
  tcase_add_test(cases, contact_meets_the_drawn_surface_and_nothing_outside_it);
  tcase_add_test(cases, a_halfspace_is_a_square_below_the_bodies_that_moves_along_its_normal);
  tcase_add_test(cases, a_thin_plate_and_a_long_rod_have_closed_surfaces);
  tcase_add_test(cases, what_rounding_leaves_no_surface_is_refused);
  tcase_add_test(cases, the_largest_that_are_allowed_bear_a_block_like_a_halfspace);
  tcase_add_test(cases, obstacles_are_numbered_as_the_sides_of_interfaces);
  tcase_add_test(cases, faces_part_a_surface_evenly);
  tcase_add_test(cases, a_scene_of_meshes_has_none);
  tcase_add_test(cases, a_run_writes_what_stands_once_and_what_moves_with_every_frame);
  tcase_add_test(cases, a_run_without_such_obstacles_writes_frames_alone);
  return suite_run("obstacle", cases, 20);
}
