// SPDX-License-Identifier: GPL-3.0-or-later
// app/report and what it is made of: frames read back, codes, the surface, the page as a whole, messages.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/report/codes.h"
#include "app/report/collect.h"
#include "app/report/page.h"
#include "app/report/report.h"
#include "app/report/surface.h"
#include "base/files/deflate.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/output/vtk/base64.h"
#include "fem/output/vtk/pvd.h"
#include "fem/output/vtk/vtu.h"

enum { FRAMES = 3, VERTICES = 5, TETS = 2 };

static char directory[64];

// Two tetrahedra with a common face and the apexes a unit above and below it.
static const int tets[TETS][4] = {{0, 1, 2, 3}, {0, 2, 1, 4}};
static const double rest[3 * VERTICES] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};

static void make_directory(void) {
  snprintf(directory, sizeof directory, "/tmp/tetlap_report_%ld", (long)getpid());
  ck_assert_ok(file_make_directories(directory));
}

static void remove_directory(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf %s", directory);
  ck_assert_int_eq(system(command), 0);
}

static void write_text(const char *name, const char *text) {
  FileWriter writer;
  char *path = file_join(directory, name);
  ck_assert_ok(file_begin(&writer, path));
  fputs(text, writer.stream);
  ck_assert_ok(file_commit(&writer));
  memory_free(path);
}

// Position, at time k, of a mesh that moves by k along x.
static void write_frame(const char *name, int k) {
  double positions[3 * VERTICES], force[3 * VERTICES] = {0}, stress[6 * TETS] = {0};
  int body[TETS] = {0, 1};
  memcpy(positions, rest, sizeof rest);
  for (int i = 0; i < VERTICES; i++) positions[3 * i] += k;
  force[3] = 3 * k, force[4] = 4 * k;
  stress[0] = stress[1] = stress[2] = -7;
  const FemVtuArray arrays[] = {{.name = "contact_force", .components = 3, .reals = force},
                                {.name = "body", .is_cell = true, .components = 1, .integers = body},
                                {.name = "stress", .is_cell = true, .components = 6, .reals = stress}};
  const FemVtuFrame frame = {.time = k,
                             .vertex_count = VERTICES,
                             .positions = positions,
                             .cell_count = TETS,
                             .cells = &tets[0][0],
                             .arrays = arrays,
                             .array_count = 3};
  char *path = file_join(directory, name);
  ck_assert_ok(fem_vtu_write(path, &frame));
  memory_free(path);
}

static void write_run(void) {
  static const char *const names[FRAMES] = {"f0.vtu", "f1.vtu", "f2.vtu"};
  const double times[FRAMES] = {0, 1, 2};
  for (int k = 0; k < FRAMES; k++) write_frame(names[k], k);
  char *path = file_join(directory, "frames.pvd");
  FileWriter list;
  ck_assert_ok(fem_pvd_begin(&list, path));
  for (int k = 0; k < FRAMES; k++) fem_pvd_add(&list, times[k], 0, NULL, names[k]);
  ck_assert_ok(fem_pvd_commit(&list));
  memory_free(path);
  write_text("summary.json", "{\"format\": 1, \"title\": \"</script><b>&\", \"wall_s\": 1.5}\n");
  write_text("history.csv", "time_s,kinetic_J\n0,0\n1,0.5\n2,1\n");
}

static char *write_page(AppReport *report) {
  char *path = file_join(directory, "page.html"), *text;
  size_t size;
  ck_assert_ok(app_report_write(report, path));
  ck_assert_ok(file_read(path, &text, &size));
  memory_free(path);
  return text;
}

enum { STANDING_VERTICES = 3, MOVING_VERTICES = 4 };
static const int one_triangle[3] = {0, 1, 2}, two_triangles[6] = {0, 1, 2, 0, 2, 3};

// A surface that has gone by `way` along y.
static void write_surface(const char *name, int vertices, const int *triangles, int count, double way) {
  double positions[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const int bodies[] = {2, 3}, faces[] = {4, 5};
  for (int i = 0; i < vertices; i++) positions[3 * i + 1] += way;
  const FemVtuArray arrays[] = {{.name = "body", .is_cell = true, .components = 1, .integers = bodies},
                                {.name = "face", .is_cell = true, .components = 1, .integers = faces}};
  const FemVtuFrame frame = {.time = NAN,
                             .vertex_count = vertices,
                             .positions = positions,
                             .cell = FEM_VTU_TRIANGLES,
                             .cell_count = count,
                             .cells = triangles,
                             .arrays = arrays,
                             .array_count = 2};
  char *path = file_join(directory, name);
  ck_assert_ok(fem_vtu_write(path, &frame));
  memory_free(path);
}

// The run of write_run with an obstacle that stands and two that move.
static void write_run_with_obstacles(void) {
  char *path = file_join(directory, "frames.pvd");
  FileWriter list;
  write_run();
  write_surface("o.vtu", STANDING_VERTICES, one_triangle, 1, 0);
  ck_assert_ok(fem_pvd_begin(&list, path));
  for (int k = 0; k < FRAMES; k++) {
    char name[16], moving[16];
    snprintf(name, sizeof name, "f%d.vtu", k);
    snprintf(moving, sizeof moving, "o%d.vtu", k);
    write_surface(moving, MOVING_VERTICES, two_triangles, 2, 10 * k);
    fem_pvd_add(&list, k, 0, "bodies", name);
    fem_pvd_add(&list, k, 1, "standing", "o.vtu");
    fem_pvd_add(&list, k, 2, "moving", moving);
  }
  ck_assert_ok(fem_pvd_commit(&list));
  memory_free(path);
}

static void read_run(AppReportRun *run) {
  write_run();
  ck_assert_ok(app_report_run_read(run, directory, 0));
}

START_TEST(deflated_bytes_come_back_and_damaged_ones_are_refused) {
  unsigned char bytes[1000], packed[2000], back[1000];
  for (size_t i = 0; i < sizeof bytes; i++) bytes[i] = (unsigned char)(i * i / 7);
  size_t size;
  ck_assert_uint_le(deflate_bound(sizeof bytes), sizeof packed);
  ck_assert(deflate_pack(packed, &size, bytes, sizeof bytes, DEFLATE_SMALL));
  ck_assert(deflate_unpack(back, sizeof back, packed, size));
  ck_assert_mem_eq(back, bytes, sizeof bytes);
  ck_assert(!deflate_unpack(back, sizeof back - 1, packed, size));
  packed[size / 2] ^= 0x55;
  ck_assert(!deflate_unpack(back, sizeof back, packed, size));
}
END_TEST

START_TEST(base64_of_the_rfc_reads_back) {
  // RFC 4648, section 10.
  static const char *const texts[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (size_t count = 0; count <= 6; count++) {
    char bytes[7] = {0};
    const char *text = texts[count], *end = text + strlen(text);
    ck_assert_ptr_eq(fem_base64_read(text, end, bytes, count), end);
    ck_assert_mem_eq(bytes, "foobar", count);
    ck_assert_ptr_null(fem_base64_read(text, end, bytes, count + 3));
  }
  char bytes[3];
  ck_assert_ptr_null(fem_base64_read("Zm*v", "Zm*v" + 4, bytes, 3));
}
END_TEST

START_TEST(a_run_reads_back_as_it_was_written) {
  AppReportRun run;
  read_run(&run);
  ck_assert_int_eq(run.frame_count, FRAMES);
  ck_assert_int_eq(run.vertex_count, VERTICES);
  ck_assert_mem_eq(run.tets, tets, sizeof tets);
  ck_assert(run.positions[3 * VERTICES * 2] == 2.0); // first vertex in the last frame
  ck_assert_int_eq(run.field_count, 3);
  ck_assert_str_eq(run.fields[0].name, "contact_force");
  ck_assert(run.fields[0].values[2 * VERTICES + 1] == 10.0); // |(6, 8, 0)|
  ck_assert(run.fields[1].is_integer && run.fields[1].values[1] == 1.0);
  ck_assert_str_eq(run.fields[2].name, "pressure");
  ck_assert(run.fields[2].values[0] == 7.0 && run.fields[2].values[1] == 0.0);
  app_report_run_destroy(&run);
}
END_TEST

// As of a run that is being written, or was killed.
START_TEST(half_a_line_at_the_end_of_the_history_is_left_out) {
  AppReportRun run;
  write_run();
  write_text("history.csv", "time_s,kinetic_J\n0,0\n1,0.");
  ck_assert_ok(app_report_run_read(&run, directory, 0));
  ck_assert_str_eq(run.history, "time_s,kinetic_J\n0,0\n");
  app_report_run_destroy(&run);
}
END_TEST

START_TEST(obstacles_read_back_those_that_stand_once) {
  AppReportRun run;
  write_run_with_obstacles();
  ck_assert_ok(app_report_run_read(&run, directory, 2)); // the first frame and the last
  ck_assert_int_eq(run.frame_count, 2);
  ck_assert_int_eq(run.obstacles_count, 2);
  const AppReportObstacles *standing = &run.obstacles[0], *moving = &run.obstacles[1];
  ck_assert_int_eq(standing->row_count, 1);
  ck_assert_int_eq(standing->vertex_count, STANDING_VERTICES);
  ck_assert_int_eq(standing->triangle_count, 1);
  ck_assert_int_eq(moving->row_count, 2);
  ck_assert_int_eq(moving->triangle_count, 2);
  const int second[5] = {0, 2, 3, 3, 5}; // vertices, body, face
  ck_assert_mem_eq(moving->triangles + 5, second, sizeof second);
  ck_assert(moving->positions[3 * 2 + 1] == 1.0);                      // the third vertex's y, at first
  ck_assert(moving->positions[3 * (MOVING_VERTICES + 2) + 1] == 21.0); // and in the last frame
  app_report_run_destroy(&run);
}
END_TEST

START_TEST(obstacles_of_another_kind_are_refused_by_name) {
  AppReportRun run;
  write_run_with_obstacles();
  write_surface("o1.vtu", STANDING_VERTICES, one_triangle, 1, 0); // fewer than in the first frame
  ck_assert_int_eq(app_report_run_read(&run, directory, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "o1.vtu"));
  write_frame("o0.vtu", 0); // tetrahedra
  ck_assert_int_eq(app_report_run_read(&run, directory, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "o0.vtu"));
}
END_TEST

START_TEST(the_page_has_the_obstacles_beside_the_frames) {
  AppReport report = {.run_count = 1};
  write_run_with_obstacles();
  ck_assert_ok(app_report_run_read(&report.runs[0], directory, 0));
  char *page = write_page(&report);
  ck_assert_ptr_nonnull(strstr(page, "\"obstacles\":[{\"vertices\":3,\"triangles\":1,"));
  const char *moving = strstr(page, "{\"vertices\":4,\"triangles\":2,"), *high;
  ck_assert_ptr_nonnull(moving);
  high = strstr(moving, "\"high\":[");
  ck_assert_ptr_nonnull(high);
  ck_assert(strtod(strchr(high, ',') + 1, NULL) == 21.0);
  for (int k = 0; k < 2; k++) {
    char name[64];
    snprintf(name, sizeof name, "id=\"run-0-obstacle-positions-%d\">", k);
    ck_assert_ptr_nonnull(strstr(page, name));
    snprintf(name, sizeof name, "id=\"run-0-obstacle-triangles-%d\">", k);
    ck_assert_ptr_nonnull(strstr(page, name));
  }
  memory_free(page);
  app_report_destroy(&report);
}
END_TEST

START_TEST(fewer_frames_keep_the_first_and_the_last) {
  AppReportRun run;
  write_run();
  ck_assert_ok(app_report_run_read(&run, directory, 2));
  ck_assert_int_eq(run.frame_count, 2);
  ck_assert(run.times[0] == 0.0 && run.times[1] == 2.0);
  app_report_run_destroy(&run);
}
END_TEST

// As the page does (report/src).
static double decode(AppReportScale scale, uint16_t code) {
  if (code == APP_REPORT_NO_CODE) return NAN;
  return scale.low + (double)code / APP_REPORT_LEVELS * (scale.high - scale.low);
}

START_TEST(a_code_is_off_by_half_a_step_at_most) {
  Random random = random_seeded(7, 0);
  double values[1000];
  for (int i = 0; i < 1000; i++) values[i] = random_between(&random, -3e4, 4e4);
  AppReportScale scale = app_report_codes_scale(values, 1000, 1);
  double bound = (scale.high - scale.low) / (2 * APP_REPORT_LEVELS) * (1 + 1e-9);
  for (int i = 0; i < 1000; i++)
    ck_assert_near(decode(scale, app_report_codes_encode(scale, values[i])), values[i], bound);
  ck_assert(decode(scale, app_report_codes_encode(scale, scale.low)) == scale.low);
  ck_assert(decode(scale, app_report_codes_encode(scale, scale.high)) == scale.high);
}
END_TEST

START_TEST(what_is_not_finite_has_a_code_of_its_own_and_no_part_in_the_scale) {
  const double values[] = {NAN, 2, -INFINITY, 5, INFINITY};
  AppReportScale scale = app_report_codes_scale(values, 5, 1);
  ck_assert(scale.low == 2.0 && scale.high == 5.0);
  for (int i = 0; i < 5; i++) {
    uint16_t code = app_report_codes_encode(scale, values[i]);
    ck_assert_int_eq(code == APP_REPORT_NO_CODE, !isfinite(values[i]));
  }
  ck_assert(isnan(decode(scale, APP_REPORT_NO_CODE)));
  AppReportScale same = {4, 4};
  ck_assert(decode(same, app_report_codes_encode(same, 4)) == 4.0);
}
END_TEST

// Base64 and deflate taken off: `byte_count` bytes.
static void unpack_text(const char *text, size_t size, unsigned char *bytes, size_t byte_count) {
  unsigned char packed[4096];
  size_t packed_count = size / 4 * 3 - (size_t)(text[size - 1] == '=') - (size_t)(text[size - 2] == '=');
  ck_assert_uint_le(packed_count, sizeof packed);
  ck_assert_ptr_nonnull(fem_base64_read(text, text + size, packed, packed_count));
  ck_assert(deflate_unpack(bytes, byte_count, packed, packed_count));
}

START_TEST(codes_as_text_undo_by_the_documented_way_back) {
  enum { ROWS = 3, SIZE = 6, STRIDE = 3, COUNT = ROWS * SIZE };
  uint16_t codes[COUNT];
  for (int i = 0; i < COUNT; i++) codes[i] = (uint16_t)(i % 5 == 0 ? 65535 - i : i * 977);
  char *text = NULL;
  size_t size;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ok(app_report_codes_write(stream, codes, ROWS, SIZE, STRIDE));
  fclose(stream);
  unsigned char bytes[2 * COUNT];
  unpack_text(text, size, bytes, sizeof bytes);
  uint16_t back[COUNT];
  for (int i = 0; i < COUNT; i++) {
    int folded = bytes[i] | bytes[COUNT + i] << 8, before = i < SIZE ? i - STRIDE : i - SIZE;
    back[i] = (uint16_t)((folded >> 1 ^ -(folded & 1)) + (before < 0 ? 0 : back[before]));
  }
  ck_assert_mem_eq(back, codes, sizeof codes);
  free(text);
}
END_TEST

START_TEST(whole_numbers_as_text_undo_likewise) {
  const int numbers[] = {0, 1, 2, 3, 100000, -5, 7, INT32_MAX, INT32_MIN, 0, 1, 2};
  enum { COUNT = sizeof numbers / sizeof *numbers, STRIDE = 4 };
  char *text = NULL;
  size_t size;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ok(app_report_codes_write_integers(stream, numbers, COUNT, STRIDE));
  fclose(stream);
  unsigned char bytes[4 * COUNT];
  unpack_text(text, size, bytes, sizeof bytes);
  uint32_t back[COUNT];
  for (size_t i = 0; i < COUNT; i++) {
    uint32_t folded = 0;
    for (size_t plane = 0; plane < 4; plane++) folded |= (uint32_t)bytes[plane * COUNT + i] << (8 * plane);
    back[i] = (folded >> 1 ^ (0U - (folded & 1))) + (i < STRIDE ? 0 : back[i - STRIDE]);
    ck_assert_int_eq((int)back[i], numbers[i]);
  }
  free(text);
}
END_TEST

// Volume under a surface, by the divergence theorem.
static double volume_of(const AppReportSurface *surface, const double *positions) {
  double volume = 0;
  for (int t = 0; t < surface->triangle_count; t++) {
    const double *p[3];
    for (int k = 0; k < 3; k++) p[k] = positions + 3 * (size_t)surface->triangles[4 * t + k];
    volume += (p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
               p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
               p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0])) /
              6;
  }
  return volume;
}

START_TEST(the_surface_of_two_tetrahedra_has_six_faces_that_look_outward) {
  AppReportRun run;
  AppReportSurface surface;
  read_run(&run);
  ck_assert_ok(app_report_surface_find(&surface, &run));
  ck_assert_int_eq(surface.triangle_count, 6);
  ck_assert_near(volume_of(&surface, run.positions), 1.0 / 3, 1e-15);
  app_report_surface_destroy(&surface);
  app_report_run_destroy(&run);
}
END_TEST

START_TEST(a_stripped_run_has_the_same_surface_and_no_inside) {
  AppReportRun run;
  AppReportSurface surface;
  read_run(&run);
  // A vertex inside that no face of the surface has: take one that the tetrahedra do not use.
  run.tet_count = 1;
  ck_assert_ok(app_report_surface_find(&surface, &run));
  ck_assert_ok(app_report_surface_strip(&surface, &run));
  ck_assert_int_eq(run.vertex_count, 4);
  ck_assert_ptr_null(run.tets);
  const double *last = run.positions + (size_t)2 * 3 * 4;
  ck_assert_near(volume_of(&surface, last), 1.0 / 6, 1e-15);
  ck_assert(last[0] == 2.0 && run.fields[0].values[2 * 4 + 1] == 10.0);
  app_report_surface_destroy(&surface);
  app_report_run_destroy(&run);
}
END_TEST

START_TEST(the_page_holds_the_data_and_asks_for_no_other_file) {
  AppReport report = {.run_count = 1};
  read_run(&report.runs[0]);
  char *page = write_page(&report);
  ck_assert_ptr_null(strstr(page, APP_REPORT_PAGE_MARK));
  const char *data = strstr(page, "id=\"tetlap-data\">");
  ck_assert_ptr_nonnull(data);
  ck_assert_ptr_nonnull(strstr(data, "\\u003c/script>\\u003cb>&")); // a title cannot end the element
  ck_assert_ptr_nonnull(strstr(data, "time_s,kinetic_J"));
  ck_assert_ptr_nonnull(strstr(page, "id=\"run-0-positions\">"));
  ck_assert_ptr_nonnull(strstr(page, "id=\"run-0-field-2\">"));
  ck_assert_ptr_null(strstr(page, "<script src"));
  ck_assert_ptr_null(strstr(page, "<link rel=\"stylesheet\""));
  memory_free(page);
  app_report_destroy(&report);
}
END_TEST

START_TEST(the_page_without_frames_stays_below_five_megabytes) {
  ck_assert_uint_lt(strlen(app_report_page_text()), 5000000);
  AppReport report = {.run_count = 1};
  write_text("summary.json", "{\"format\": 1, \"title\": \"no frames\"}\n");
  ck_assert_ok(app_report_run_read(&report.runs[0], directory, 0));
  char *page = write_page(&report);
  ck_assert_uint_lt(strlen(page), 5000000);
  memory_free(page);
  app_report_destroy(&report);
}
END_TEST

START_TEST(two_runs_are_held_against_each_other_frame_by_frame) {
  AppReport report = {.run_count = 2};
  read_run(&report.runs[0]);
  read_run(&report.runs[1]);
  double mean, largest;
  report.runs[1].positions[3 * VERTICES] += 0.5; // one vertex in the second frame
  ck_assert(app_report_distance(&report, 1, 0, &mean, &largest));
  ck_assert(mean == 0.0 && largest == 0.0);
  ck_assert(app_report_distance(&report, 1, 1, &mean, &largest));
  ck_assert_near(mean, 0.5 / sqrt(VERTICES), 1e-15);
  ck_assert_near(largest, 0.5, 1e-15);
  report.runs[1].times[1] = 1.25;
  ck_assert(!app_report_distance(&report, 1, 1, &mean, &largest));
  app_report_destroy(&report);
}
END_TEST

START_TEST(a_directory_that_is_no_run_is_named_and_told_what_to_give) {
  AppReportRun run;
  ck_assert_int_eq(app_report_run_read(&run, directory, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), directory));
  ck_assert_ptr_nonnull(strstr(status_message(), "tetlap run"));
}
END_TEST

START_TEST(a_foreign_or_damaged_frame_is_refused_by_name) {
  FemVtuContent content;
  write_run();
  char *path = file_join(directory, "f1.vtu"), *text;
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  for (size_t cut = 0; cut < size; cut += 1 + size / 97) {
    text[cut] = text[cut] == '#' ? '$' : '#'; // in a tag, a number or an array
    write_text("f1.vtu", text);
    Status status = fem_vtu_read(path, &content);
    ck_assert(status == STATUS_OK || status == STATUS_INPUT);
    if (status) ck_assert_ptr_nonnull(strstr(status_message(), "f1.vtu"));
    fem_vtu_read_destroy(&content);
  }
  memory_free(text);
  write_text("f1.vtu", "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\"></VTKFile>");
  ck_assert_int_eq(fem_vtu_read(path, &content), STATUS_INPUT);
  write_text("f1.vtu", "");
  ck_assert_int_eq(fem_vtu_read(path, &content), STATUS_INPUT);
  memory_free(path);
}
END_TEST

START_TEST(frames_of_another_mesh_are_refused) {
  AppReportRun run;
  write_run();
  const double positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const FemVtuFrame frame = {
      .time = 1, .vertex_count = 4, .positions = positions, .cell_count = 1, .cells = &tets[0][0]};
  char *path = file_join(directory, "f1.vtu");
  ck_assert_ok(fem_vtu_write(path, &frame));
  memory_free(path);
  ck_assert_int_eq(app_report_run_read(&run, directory, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "f1.vtu"));
}
END_TEST

START_TEST(a_folder_of_another_format_is_refused_with_the_program_that_reads_it) {
  static const struct {
    const char *name, *text, *says;
  } cases[] = {
      {"summary.json", "{\"title\": \"old\"}",
       "/summary.json: has no format number, so it is older than format 1; it was written by tetlap 0.0.9."},
      {"summary.json", "{\"format\": 2}", "/summary.json: is of format 2; it was written by tetlap 0.0.9."},
      {"manifest.json", "{\"title\": \"old\"}", "it was written by an unknown program."}};
  AppReportRun run;
  write_text("manifest.json", "{\"format\": 1, \"versions\": {\"tetlap\": \"0.0.9\"}}");
  for (int k = 0; k < 3; k++) {
    write_text(cases[k].name, cases[k].text);
    ck_assert_int_eq(app_report_run_read(&run, directory, 0), STATUS_INPUT);
    ck_assert_msg(strstr(status_message(), cases[k].says) != NULL, "%s", status_message());
    ck_assert_ptr_nonnull(strstr(status_message(), "reads format 1: "));
  }
}
END_TEST

START_TEST(a_comparison_of_another_format_is_refused) {
  AppReport report = {0};
  write_text("compare.json", "[{\"model\": \"clip\", \"reference\": \"clip\", \"summary\": {}}]");
  ck_assert_int_eq(app_report_collect(&report, directory, true, 0), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "/compare.json: has no format number") != NULL, "%s",
                status_message());
  app_report_destroy(&report);
}
END_TEST

static void refuse_verdict(const char *text, bool is_alone, Status status, const char *message) {
  AppReport report = {0};
  write_text("verdict.json", text);
  ck_assert_int_eq(app_report_collect(&report, directory, is_alone, 0), status);
  ck_assert_msg(strstr(status_message(), message) != NULL, "%s", status_message());
  app_report_destroy(&report);
}

START_TEST(a_verdict_has_a_page_of_its_own) {
  AppReport report = {0};
  static const char verdict[] = "{\"format\": 1, \"models\": [{\"model\": \"mine\"}]}";
  refuse_verdict(verdict, false, STATUS_USAGE, "holds a verdict, which has a page of its own; give it alone");
  refuse_verdict("{\"format\": 1, \"models\": []}", true, STATUS_INPUT, "verdict.json: judges no model yet");
  refuse_verdict("{\"format\": 9}", true, STATUS_INPUT, "verdict.json: is of format 9");
  refuse_verdict("{\n\"format\": x}", true, STATUS_INPUT, "verdict.json:2:");
  write_text("verdict.json", verdict);
  ck_assert_ok(app_report_collect(&report, directory, true, 0));
  ck_assert_int_eq(report.run_count, 0);
  char *page = write_page(&report);
  ck_assert_ptr_nonnull(strstr(page, "\"verdict\":{\"format\":1,\"models\":[{\"model\":\"mine\"}]}"));
  memory_free(page);
  app_report_destroy(&report);
}
END_TEST

START_TEST(broken_json_is_told_with_its_line) {
  AppReportRun run;
  write_text("summary.json", "{\n  \"title\": oops\n}\n");
  ck_assert_int_eq(app_report_run_read(&run, directory, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "summary.json:2:"));
}
END_TEST

START_TEST(a_page_is_written_whole_or_not_at_all) {
  AppReport report = {.run_count = 1};
  read_run(&report.runs[0]);
  ck_assert_int_eq(app_report_write(&report, "/nowhere/at/all/page.html"), STATUS_IO);
  for (long k = 1; k <= 12; k++) {
    memory_fail_at(k);
    char *path = file_join(directory, "page.html");
    Status status = path ? app_report_write(&report, path) : STATUS_MEMORY;
    memory_fail_at(0);
    ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
    if (path) ck_assert_int_eq(file_exists(path), status == STATUS_OK);
    if (path) unlink(path);
    memory_free(path);
  }
  app_report_destroy(&report);
}
END_TEST

static Record *summary_of(const char *overlap, const char *weights) {
  Record *summary = record_new();
  record_text(summary, "overlap", overlap);
  record_text(summary, "weights", weights);
  return summary;
}

START_TEST(runs_of_networks_of_one_base_name_are_told_apart) {
  AppReportRun runs[3] = {{.summary = summary_of("net", "/x/a/net.safetensors")},
                          {.summary = summary_of("net", "/x/b/net.safetensors")},
                          {.summary = summary_of("clip", NULL)}};
  AppModelName names[3];
  ck_assert(app_report_run_models(runs, 3, names));
  ck_assert_str_eq(names[0], "a/net");
  ck_assert_str_eq(names[1], "b/net");
  ck_assert_str_eq(names[2], "clip");
  record_destroy(runs[1].summary);
  runs[1].summary = summary_of("net", "/x/a/net.safetensors"); // of the same network: by their folders
  ck_assert(!app_report_run_models(runs, 3, names));
  for (int r = 0; r < 3; r++) record_destroy(runs[r].summary);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("report");
  tcase_add_checked_fixture(test_case, make_directory, remove_directory);
  tcase_add_test(test_case, deflated_bytes_come_back_and_damaged_ones_are_refused);
  tcase_add_test(test_case, base64_of_the_rfc_reads_back);
  tcase_add_test(test_case, a_run_reads_back_as_it_was_written);
  tcase_add_test(test_case, half_a_line_at_the_end_of_the_history_is_left_out);
  tcase_add_test(test_case, obstacles_read_back_those_that_stand_once);
  tcase_add_test(test_case, obstacles_of_another_kind_are_refused_by_name);
  tcase_add_test(test_case, the_page_has_the_obstacles_beside_the_frames);
  tcase_add_test(test_case, fewer_frames_keep_the_first_and_the_last);
  tcase_add_test(test_case, a_code_is_off_by_half_a_step_at_most);
  tcase_add_test(test_case, what_is_not_finite_has_a_code_of_its_own_and_no_part_in_the_scale);
  tcase_add_test(test_case, codes_as_text_undo_by_the_documented_way_back);
  tcase_add_test(test_case, whole_numbers_as_text_undo_likewise);
  tcase_add_test(test_case, the_surface_of_two_tetrahedra_has_six_faces_that_look_outward);
  tcase_add_test(test_case, a_stripped_run_has_the_same_surface_and_no_inside);
  tcase_add_test(test_case, the_page_holds_the_data_and_asks_for_no_other_file);
  tcase_add_test(test_case, the_page_without_frames_stays_below_five_megabytes);
  tcase_add_test(test_case, two_runs_are_held_against_each_other_frame_by_frame);
  tcase_add_test(test_case, a_directory_that_is_no_run_is_named_and_told_what_to_give);
  tcase_add_test(test_case, a_foreign_or_damaged_frame_is_refused_by_name);
  tcase_add_test(test_case, frames_of_another_mesh_are_refused);
  tcase_add_test(test_case, a_folder_of_another_format_is_refused_with_the_program_that_reads_it);
  tcase_add_test(test_case, a_comparison_of_another_format_is_refused);
  tcase_add_test(test_case, a_verdict_has_a_page_of_its_own);
  tcase_add_test(test_case, runs_of_networks_of_one_base_name_are_told_apart);
  tcase_add_test(test_case, broken_json_is_told_with_its_line);
  tcase_add_test(test_case, a_page_is_written_whole_or_not_at_all);
  return suite_run("report", test_case, 20);
}
