// SPDX-License-Identifier: GPL-3.0-or-later
// app/plot/along, app/plot/sample: a quantity along a path is what it is there; what is not there is refused
// by what is.
#include "app/plot/along.h"

#include <stdio.h>
#include <string.h>

#include "app/plot/gnuplot.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/mesh/mesh.h"
#include "fem/output/vtk/pvd.h"
#include "fem/output/vtk/vtu.h"
#include "folder.h"
#include "suite.h"

// Two boxes 1 × 1 × 1 in cells of a half, beside each other along x with a gap of 1: bodies 0 and 1. At
// vertices f = x + 2 y + 3 z and the vector (f, 0, 2); on cells g = 7.
typedef struct Boxes {
  int vertex_count, cell_count;
  double *x, *f, *v, *g;
  int *cells, *bodies;
} Boxes;

static void make_boxes(Boxes *boxes) {
  FemMesh mesh;
  ck_assert_ok(fem_mesh_box(&mesh, (double[]){1, 1, 1}, (int[]){2, 2, 2}));
  size_t n = (size_t)mesh.vertex_count, m = (size_t)mesh.tet_count;
  *boxes = (Boxes){.vertex_count = 2 * mesh.vertex_count, .cell_count = 2 * mesh.tet_count};
  boxes->x = memory_zeroed(6 * n, sizeof(double)), boxes->f = memory_zeroed(2 * n, sizeof(double));
  boxes->v = memory_zeroed(6 * n, sizeof(double)), boxes->g = memory_zeroed(2 * m, sizeof(double));
  boxes->cells = memory_zeroed(8 * m, sizeof(int)), boxes->bodies = memory_zeroed(2 * m, sizeof(int));
  for (size_t v = 0; v < 2 * n; v++) {
    double *x = boxes->x + 3 * v;
    memcpy(x, mesh.rest + 3 * (v % n), 3 * sizeof *x);
    if (v >= n) x[0] += 2;
    boxes->f[v] = x[0] + 2 * x[1] + 3 * x[2];
    boxes->v[3 * v] = boxes->f[v], boxes->v[3 * v + 2] = 2;
  }
  for (size_t c = 0; c < 2 * m; c++) {
    boxes->g[c] = 7, boxes->bodies[c] = c >= m;
    for (size_t k = 0; k < 4; k++) boxes->cells[4 * c + k] = mesh.tets[c % m][k] + (c < m ? 0 : (int)n);
  }
  fem_mesh_destroy(&mesh);
}

static void free_boxes(Boxes *boxes) {
  void *arrays[] = {boxes->x, boxes->f, boxes->v, boxes->g, boxes->cells, boxes->bodies};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) memory_free(arrays[k]);
}

// A run of frames at 0, 1 and 2 s.
static void write_run(void) {
  Boxes boxes;
  char path[sizeof folder + 32];
  folder_make();
  make_boxes(&boxes);
  const FemVtuArray arrays[] = {{.name = "f", .components = 1, .reals = boxes.f},
                                {.name = "displacement", .components = 3, .reals = boxes.v},
                                {.name = "von_mises", .is_cell = true, .components = 1, .reals = boxes.g},
                                {.name = "body", .is_cell = true, .components = 1, .integers = boxes.bodies}};
  snprintf(path, sizeof path, "%s/frame.vtu", folder);
  ck_assert_ok(fem_vtu_write(path, &(FemVtuFrame){.vertex_count = boxes.vertex_count,
                                                  .positions = boxes.x,
                                                  .cell = FEM_VTU_TETRAHEDRA,
                                                  .cell_count = boxes.cell_count,
                                                  .cells = boxes.cells,
                                                  .arrays = arrays,
                                                  .array_count = 4}));
  FileWriter list;
  snprintf(path, sizeof path, "%s/frames.pvd", folder);
  ck_assert_ok(fem_pvd_begin(&list, path));
  for (int k = 0; k < 3; k++) fem_pvd_add(&list, k, 0, NULL, "frame.vtu");
  ck_assert_ok(fem_pvd_commit(&list));
  snprintf(path, sizeof path, "%s/manifest.json", folder);
  FileWriter manifest;
  ck_assert_ok(file_begin(&manifest, path));
  fputs("{\"format\": 1, \"scene\": {\"bodies\": [{\"name\": \"left\"}],"
        " \"obstacles\": [{\"name\": \"ball\"}, {\"name\": \"right\", \"mesh\": {}}]}}",
        manifest.stream);
  ck_assert_ok(file_commit(&manifest));
  free_boxes(&boxes);
}

// Reads the frame, samples and gives what was found; the caller frees it.
static AppPlotPoints sample(const char *path, double within, const char *name, int component, int body) {
  char file[sizeof folder + 32];
  FemVtuContent frame;
  AppPlotPath along;
  AppPlotPoints points;
  AppPlotQuantity quantity = {.component = component};
  snprintf(file, sizeof file, "%s/frame.vtu", folder);
  ck_assert_ok(fem_vtu_read(file, &frame));
  for (int k = 0; k < frame.field_count; k++)
    if (strcmp(frame.fields[k].name, name) == 0) quantity.field = &frame.fields[k];
  ck_assert_ptr_nonnull(quantity.field);
  ck_assert(app_plot_path_read(&along, path));
  along.within = within;
  ck_assert_ok(app_plot_sample(&points, &frame, &along, &quantity, body));
  fem_vtu_read_destroy(&frame);
  return points;
}

// From .25 outside: f is linear, and so is what is found; nothing in the gap; the way counts from the first
// end.
START_TEST(a_line_runs_through_elements) {
  AppPlotPoints points = sample("-0.25,0.3,0.4:3.75,0.3,0.4", 0, "f", -1, _i);
  double low = _i ? 2 : 0;
  ck_assert_int_ge(points.count, 4);
  for (int k = 0; k < points.count; k++) {
    double x = points.points[k].along - 0.25;
    ck_assert_near(points.points[k].value, x + 1.8, 1e-12);
    ck_assert(x >= low - 1e-12 && x <= low + 1 + 1e-12);
    ck_assert_int_eq(points.points[k].is_apart, k == 0);
  }
  ck_assert_near(points.points[0].along, low + 0.25, 1e-12);
  ck_assert_near(points.points[points.count - 1].along, low + 1.25, 1e-12);
  memory_free(points.points);
}
END_TEST

// 3³ vertices a box, of which one lies inside.
START_TEST(coordinates_and_radii_take_all_vertices_of_the_surface) {
  AppPlotPoints points = sample("z", 0, "f", -1, 0);
  ck_assert_int_eq(points.count, 26);
  for (int k = 1; k < points.count; k++)
    ck_assert_double_ge(points.points[k].along, points.points[k - 1].along);
  ck_assert_double_eq(points.points[25].along, 1);
  memory_free(points.points);
  points =
      sample("radius:z:3,0,0", 0, "displacement", -1, 1); // of the vertices on the edge at (3, 0, z) first
  ck_assert_int_eq(points.count, 26);
  for (int k = 0; k < 3; k++) ck_assert_double_eq(points.points[k].along, 0);
  double found = points.points[0].value + points.points[1].value + points.points[2].value;
  ck_assert_near(found, hypot(3, 2) + hypot(4.5, 2) + hypot(6, 2), 1e-12);
  memory_free(points.points);
}
END_TEST

START_TEST(a_line_takes_the_vertices_near_it) {
  AppPlotPoints points = sample("0,0,1:4,0,1", 0.1, "displacement", 0, 0);
  ck_assert_int_eq(points.count, 3);
  for (int k = 0; k < 3; k++) {
    ck_assert_near(points.points[k].along, 0.5 * k, 1e-12);
    ck_assert_near(points.points[k].value, 0.5 * k + 3, 1e-12);
  }
  memory_free(points.points);
  points = sample("0,0,1:0.6,0,1", 0.1, "von_mises", -1, 0); // ends before the last; of cells the mean
  ck_assert_int_eq(points.count, 2);
  ck_assert_near(points.points[1].value, 7, 1e-12);
  memory_free(points.points);
}
END_TEST

START_TEST(what_is_no_path_is_none) {
  static const char *const wrong[] = {"",
                                      "w",
                                      "xy",
                                      "radius",
                                      "radius:",
                                      "radius:w",
                                      "radius:z:1,2",
                                      "0,0:1,1",
                                      "0,0,0:1,1",
                                      "0,0,0:1,1,1,",
                                      "1,2,3:1,2,3",
                                      "nan,0,0:1,1,1",
                                      "radius:x:1,2,3,4",
                                      "0,0,0"};
  AppPlotPath path;
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    ck_assert_msg(!app_plot_path_read(&path, wrong[k]), "%s", wrong[k]);
}
END_TEST

static char picture[sizeof folder + 32], script[sizeof folder + 40];

static Status draw(const AppPlotAlong *along) {
  const char *directories[] = {folder, folder}, *labels[] = {"one", "two"};
  FileWriter writer;
  snprintf(picture, sizeof picture, "%s/along.svg", folder);
  snprintf(script, sizeof script, "%s.gp", picture);
  ck_assert_ok(file_begin(&writer, script));
  Status status = app_plot_along(writer.stream, picture, along, directories, 2, labels);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}

// Two runs, two times, two bodies; the frames next to the times, whose data stand in the script.
START_TEST(a_script_has_a_curve_for_each_run_time_and_body) {
  AppPlotAlong along = {.quantity = "displacement:x", .times = {0.4, 1.9}, .time_count = 2};
  ck_assert(app_plot_path_read(&along.path, "-1,0.3,0.4:4,0.3,0.4"));
  ck_assert_ok(draw(&along));
  char *text = folder_read("along.svg.gp");
  int count = 0;
  for (const char *at = text; (at = strstr(at, " title ")); at++) count++;
  ck_assert_int_eq(count, 8);
  ck_assert_ptr_nonnull(strstr(text, "\"one, left, 0 s\""));
  ck_assert_ptr_nonnull(strstr(text, "\"two, right, 2 s\""));
  ck_assert_ptr_nonnull(strstr(text, "displacement:x [m]"));
  ck_assert_ptr_nonnull(strstr(text, "$series0 << END\n1 1.8\n"));
  memory_free(text);
  ck_assert_ok(app_gnuplot_run(script, picture));
}
END_TEST

START_TEST(what_is_not_there_is_refused_by_what_is) {
  static const struct {
    AppPlotAlong along;
    const char *word;
  } cases[] = {
      {{.quantity = "g"}, "frame.vtu: has no array 'g'; it has f, displacement, von_mises, body"},
      {{.quantity = "displacement:w"}, "as in displacement:z: x, y, z"},
      {{.quantity = "f:x"}, "f has no components"},
      {{.quantity = "f", .body = "ball"}, "has no body 'ball' with elements; it has left, right"},
      {{.quantity = "f", .times = {3}, .time_count = 1}, "--at has 3, and its frames are from 0 to 2 s"},
      {{.quantity = "f", .path = {.kind = APP_PLOT_LINE, .from = {9, 9, 9}, .to = {8, 9, 9}}},
       "no line through elements of the frame"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    ck_assert_int_eq(draw(&cases[k].along), STATUS_INPUT);
    ck_assert_msg(strstr(status_message(), cases[k].word) != NULL, "%s", status_message());
  }
  char path[sizeof folder + 32];
  snprintf(path, sizeof path, "%s/frames.pvd", folder);
  ck_assert_int_eq(remove(path), 0);
  ck_assert_int_eq(draw(&cases[0].along), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "has no frames to plot"));
}
END_TEST

static void write_lines(const char *name, const char *rows) {
  char text[1000];
  snprintf(text, sizeof text,
           "line,time_s,way_m,x_m,y_m,z_m,displacement_x_m,displacement_y_m,"
           "displacement_z_m,stress_xx_Pa,von_mises_Pa\n%s",
           rows);
  char path[sizeof folder + 32];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  ck_assert_int_ge(fputs(text, file), 0);
  ck_assert_int_eq(fclose(file), 0);
}

START_TEST(a_line_of_the_scene_is_read_from_its_files) {
  static const char rows[] = "top,2,0,0,0,0,3,4,12,7,1\nside,2,0,0,0,0,3,4,12,7,1\n"
                             "side,2,0.5,0,0,0,0,0,-2,-8,nan\nside,2,1,0,0,0,0,0,1,9,5\n";
  AppPlotAlong along = {.quantity = "displacement", .times = {2}, .time_count = 1};
  ck_assert(app_plot_path_read(&along.path, "line:side"));
  ck_assert(!app_plot_path_read(&along.path, "line:"));
  ck_assert(app_plot_path_read(&along.path, "line:side"));
  ck_assert_int_eq(draw(&along), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "has no lines_00000.csv; give the scene bodies[].lines"));
  write_lines("lines_00000.csv", "side,0,0,0,0,0,0,0,0,0,0\n");
  write_lines("lines_00001.csv", rows);
  ck_assert_ok(draw(&along));
  char *text = folder_read("along.svg.gp");
  ck_assert_msg(strstr(text, "$series0 << END\n0 13\n0.5 2\n1 1\nEND\n") != NULL, "%s", text);
  ck_assert_ptr_nonnull(strstr(text, "way along 'side' [m]"));
  memory_free(text);
  along.quantity = "von_mises"; // NaN is left out
  ck_assert_ok(draw(&along));
  text = folder_read("along.svg.gp");
  ck_assert_msg(strstr(text, "$series0 << END\n0 1\n1 5\nEND\n") != NULL, "%s", text);
  memory_free(text);
  along.quantity = "stress:zz";
  ck_assert_int_eq(draw(&along), STATUS_INPUT);
  ck_assert_msg(
      strstr(status_message(), "it has displacement:x, displacement:y, displacement:z, stress:xx, von_mises"),
      "%s", status_message());
  along.quantity = "stress:xx", along.path.name = "front";
  ck_assert_int_eq(draw(&along), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "has no line 'front'; it has ") &&
                    strstr(status_message(), "top, side"),
                "%s", status_message());
  write_lines("lines_00001.csv", "side,2,0,0,0,0,3,4,12,7,\n1\n");
  ck_assert_int_eq(draw(&along), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "lines_00001.csv:2: expected a name and 10 numbers"), "%s",
                status_message());
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("plot_along");
  tcase_add_checked_fixture(tests, write_run, folder_remove);
  tcase_add_loop_test(tests, a_line_runs_through_elements, 0, 2);
  tcase_add_test(tests, coordinates_and_radii_take_all_vertices_of_the_surface);
  tcase_add_test(tests, a_line_takes_the_vertices_near_it);
  tcase_add_test(tests, what_is_no_path_is_none);
  tcase_add_test(tests, a_script_has_a_curve_for_each_run_time_and_body);
  tcase_add_test(tests, a_line_of_the_scene_is_read_from_its_files);
  tcase_add_test(tests, what_is_not_there_is_refused_by_what_is);
  return suite_run("plot_along", tests, 20);
}
